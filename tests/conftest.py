"""What holds in every test."""

import ctypes
import gc
import os
import sys
from contextlib import suppress
from pathlib import Path

import pytest

from sandbox.physics import jit
from sandbox.physics.state import COLUMNS
from sandbox.physics.world import World
from tests.support import wants

with suppress(ImportError):
    import resource

# The node of this Python's packages goes before any other.
os.environ["PATH"] = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")])

# The marks of tests that are begun first.
LONG_ONES = ("whole_world", "slow")
TOPOLOGY = [column.name for column in COLUMNS if column.topology]
# Looks at one world that are made one after another, and ticks between two of them after that.
FIRST_LOOKS, LATER = 10, 16
# Where a world keeps how often it was looked at, and the version, arrays and tick that it was last seen with.
SEEN = "_seen_by_tests"
# Of a process that runs tests [bytes].
MOST_MEMORY = 1.3e9
# So much more memory [bytes] than after the last search for garbage is worth another.
WORTH_A_SEARCH = 100e6
# After how many objects more, and how many such searches, the next generation of them is searched for garbage: the
# usual numbers cost tests a twentieth of their time.
SEARCHES_AFTER = 3_000, 20, 50
# A setting of the C library, by its number in malloc.h: what is as large [bytes] gets pages of its own.
M_MMAP_THRESHOLD, OWN_PAGES_FROM = -3, 1_000_000


_held = 0.0


def memory_held():
    """What this process holds now [bytes]; 0 where the system does not say it cheaply."""
    if sys.platform != "linux":
        return 0.0
    with open("/proc/self/statm") as figures:
        return resource.getpagesize() * float(figures.read().split()[1])


def pytest_configure(config):
    """Let each run of tests say what was not here."""
    config.pluginmanager.register(wants)


def pytest_sessionstart(session):
    """Let kernels that were edited be compiled before workers begin."""
    if not session.config.option.collectonly:
        jit.way()


def pytest_runtest_logfinish():
    """Give back what a test left behind, where it is much: garbage, and pages of the heap that hold nothing now."""
    global _held
    if memory_held() > _held + WORTH_A_SEARCH:
        gc.collect()
        if hasattr(ctypes.pythonapi, "malloc_trim"):
            ctypes.pythonapi.malloc_trim(0)
        _held = memory_held()


def pytest_collection_modifyitems(config, items):
    """Deal slow tests first, some to each worker: or one is left with them where the others have nothing more to do."""
    workers = getattr(config, "workerinput", {}).get("workercount", 1)
    slow = [item for item in items if any(map(item.get_closest_marker, LONG_ONES))]
    others = [item for item in items if not any(map(item.get_closest_marker, LONG_ONES))]
    left = len(items)
    items.clear()
    for worker in range(workers):
        # The first workers get as many tests in a row.
        size = left // (workers - worker)
        left -= size
        share = slow[worker::workers]
        rest = max(size - len(share), 0)
        items += share + others[:rest]
        del others[:rest]
    items += others


def pytest_collection_finish():
    """Leave what is imported out of garbage collection, which takes long, and is put off while so much is alive."""
    gc.collect()
    gc.freeze()
    gc.set_threshold(*SEARCHES_AFTER)
    if hasattr(ctypes.pythonapi, "mallopt"):
        # Pictures that are let go of return to the system, and leave no holes that the next do not fit in.
        ctypes.pythonapi.mallopt(M_MMAP_THRESHOLD, OWN_PAGES_FROM)


@pytest.fixture(autouse=True, scope="session")
def nothing_is_derived_from_a_topology_that_was_changed_behind_a_worlds_back():
    """What a world keeps derived is made for the topology that it has: nobody writes those arrays but its methods."""
    derived = World.derived

    def checked(world, make, of_hands=True):
        seen = world.__dict__.get(SEEN)
        if seen is None or seen[0] < FIRST_LOOKS:
            look(world, *(seen or (0, -1, ())))
        elif world.tick % LATER == 0 and world.tick != seen[3]:
            look(world, *seen)
        return derived(world, make, of_hands)

    def look(world, looks, version, arrays, _=0):
        # Kept on the world: every tick asks some ten times, and a weak dictionary would cost more than the answers.
        present = [getattr(world, name).tobytes() for name in TOPOLOGY]
        if version == world.topology_version + world.hand_version:
            changed = [name for name, now, then in zip(TOPOLOGY, present, arrays, strict=True) if now != then]
            assert not changed, f"{', '.join(changed)} written in place: use World.change"
        world.__dict__[SEEN] = looks + 1, world.topology_version + world.hand_version, present, world.tick

    World.derived = checked
    yield
    World.derived = derived


@pytest.fixture(autouse=True, scope="session")
def tests_give_back_the_memory_that_they_take():
    """What a test has opened or built is let go of after it: no process that runs tests grows with their number."""
    yield
    if sys.platform == "linux":
        peak = 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        assert peak <= MOST_MEMORY, f"{peak / 1e6:.0f} MB at their most"


@pytest.fixture(autouse=True, scope="session")
def tests_within_tests_say_the_same_wherever_they_run():
    """Where nobody watches, pytest prints whole messages a second time: these names are the outer run's alone."""
    with pytest.MonkeyPatch.context() as patch:
        for name in ("CI", "BUILD_NUMBER", "PYTEST_ADDOPTS", "PY_COLORS", "FORCE_COLOR"):
            patch.delenv(name, raising=False)
        yield
