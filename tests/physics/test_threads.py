"""Threads that share the loops of a tick: the same bits with any number, and nothing left behind."""

import copy
import json
import multiprocessing
import os
import pickle
import signal
import subprocess
import sys
import threading

import numpy as np
import pytest

from sandbox.level.assembly.build_world import build_world
from sandbox.level.reading.files import read_level, shipped_levels
from sandbox.physics import jit
from sandbox.physics.jit import COMPILED
from sandbox.physics.pipeline.block_owner import block_of
from sandbox.physics.snapshot import state_hash
from sandbox.physics.solvers.linear import elimination, fronts
from tests.bench import scenes
from tests.physics.test_large import mesh, play, run
from tests.support.laid_out import laid_out
from tests.support.wholes import part_and_whole, some_and_whole

compiled = pytest.mark.skipif(not COMPILED, reason="interpreted kernels run loops in turn")
NUMBERS = (2, 3, 8)


@pytest.fixture(autouse=True)
def as_many_as_before(monkeypatch):
    monkeypatch.setattr(fronts, "WORTH_DIVIDING", 1)
    before = jit.threads()
    yield
    jit.use_threads(before)


def hash_after_play(seed):
    return state_hash(play(mesh(seed), 8))


# How a body is divided


@pytest.mark.parametrize("build", [lambda: mesh(1), lambda: mesh(2), lambda: scenes.lattice(24).world()])
def test_tasks_of_one_stage_are_not_joined_to_each_other(build):
    made = block_of(build()).arrays.system.fronts
    first, last = made.stages[-1]
    assert last - first >= 2
    task_of = np.repeat(np.arange(len(made.task)), np.diff(made.task, axis=1)[:, 0])[np.argsort(_fronts_of(made.task))]
    stage_of = np.repeat(np.arange(last), np.diff(made.stage[: last + 1]))
    of_border = task_of[made.of_row[made.border]]
    of_owner = np.repeat(task_of, np.diff(made.border_start))
    assert sorted(_fronts_of(made.task)) == list(range(len(made.first)))
    apart = of_border != of_owner
    assert apart.any()
    assert (stage_of[of_border[apart]] > stage_of[of_owner[apart]]).all()


def _fronts_of(task):
    return np.concatenate([np.arange(first, last) for first, last in task])


@pytest.mark.parametrize("build", [lambda: mesh(3), lambda: scenes.lattice(32).world()])
def test_what_waits_for_other_tasks_lies_where_no_other_is_kept_until_they_are_done(build):
    made = block_of(build()).arrays.system.fronts
    border = 2 * np.diff(made.border_start)
    ends = made.remains + border**2
    for first, last in made.task:
        own = (made.remains[first:last].min(), ends[first:last].max())
        others = np.ones(len(made.first), bool)
        others[first:last] = False
        others &= border > 0
        assert not (others & (made.remains < own[1]) & (ends > own[0])).any()


def test_the_longest_subtree_is_divided_first():
    child = np.array([[-1, -1], [-1, -1], [0, 1], [-1, -1], [-1, -1], [3, 4], [2, 5]])
    places = laid_out(jit_new_places, 7)
    places.lowest[:] = [0, 1, 0, 3, 4, 3, 0]
    places.before[:] = [0, 1, 2, 3, 13, 23, 33, 43]
    assert fronts.divide(0, 7, child, places, 20) == 3
    assert places.height.tolist() == [-1, -1, 0, 0, 0, 1, 1]
    assert fronts.divide(0, 7, child, places, 50) == 1
    assert places.height.tolist() == [-1, -1, -1, -1, -1, -1, 0]


def jit_new_places(count, arena):
    return fronts.new_tuple(fronts.FrontPlaces, arena, rows=count, fronts=count)


def test_fronts_and_the_sparse_factorisation_agree(monkeypatch):
    world = play(mesh(4), 8)
    assert len(block_of(world).arrays.system.fronts.task) > 3
    monkeypatch.setattr(elimination, "SMALLEST_BODY", 10**9)
    assert np.abs(play(mesh(4), 8).position - world.position).max() < 1e-9


# Bits


@compiled
@pytest.mark.parametrize("build", [lambda: play(mesh(5), 8), lambda: run(scenes.blocks(40).world(), 60)])
def test_any_number_of_threads_gives_the_same_bits(build):
    jit.use_threads(1)
    expected = state_hash(build())
    for count in NUMBERS:
        jit.use_threads(count, worth=0)
        assert state_hash(build()) == expected


@compiled
@pytest.mark.parametrize(
    "path", some_and_whole([path for path in shipped_levels() if path.stem == "jelly_pile"], shipped_levels())
)
def test_shipped_levels_keep_their_bits_with_any_number_of_threads(path):
    level, found = read_level(path), set()
    for count in (1, *NUMBERS):
        jit.use_threads(count, worth=0)
        found.add(state_hash(run(build_world(level), 90)))
    assert len(found) == 1


@pytest.mark.slow
@pytest.mark.parametrize("way", part_and_whole("library", "interpreted"))
def test_a_fresh_process_computes_the_same_bits(way):
    code = "from tests.physics.test_threads import *; fronts.WORTH_DIVIDING = 1; print(hash_after_play(8))"
    environment = {
        **os.environ, "SANDBOX_KERNELS": way, "SANDBOX_THREADS": "2", "PYTHONPATH": os.pathsep.join(sys.path)
    }  # fmt: skip
    fresh = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True)
    assert fresh.stdout.strip() == hash_after_play(8)


@compiled
def test_worlds_in_several_threads_of_python_keep_their_bits():
    expected, found = [hash_after_play(seed) for seed in (15, 16, 17)], {}
    jit.use_threads(3, worth=0)
    threads = [
        threading.Thread(target=lambda seed: found.setdefault(seed, hash_after_play(seed)), args=(seed,))
        for seed in (15, 16, 17)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert [found[seed] for seed in (15, 16, 17)] == expected


def test_a_copy_of_a_world_goes_on_with_the_same_bits():
    world = play(mesh(19), 3)
    copies = [copy.deepcopy(world), pickle.loads(pickle.dumps(world))]
    ticks = 5 if COMPILED else 1
    assert {state_hash(run(other, ticks)) for other in copies} == {state_hash(run(world, ticks))}


# Processes


@pytest.mark.skipif(
    not COMPILED or "fork" not in multiprocessing.get_all_start_methods(), reason="processes are not forked here"
)
def test_a_forked_process_starts_threads_of_its_own():
    jit.use_threads(2, worth=0)
    world = play(mesh(18), 3)
    receiver, sender = multiprocessing.Pipe(duplex=False)

    def go_on():
        before = jit.threads_started()
        sender.send((before, state_hash(run(world, 5)), jit.threads_started()))

    child = multiprocessing.get_context("fork").Process(target=go_on)
    child.start()
    before, reached, after = receiver.recv()
    child.join()
    assert (before, after) == (0, 1)
    assert reached == state_hash(run(world, 5))


_RUNS = """
import signal
from sandbox.physics import jit
from tests.bench import scenes
from sandbox.physics.step import step
# Whoever starts tests in the background has them ignore it.
signal.signal(signal.SIGINT, signal.default_int_handler)
jit.use_threads(3, worth=0)
world = scenes.lattice(48).world()
step(world)
print("runs", flush=True)
while True:
    step(world)
"""


@compiled
@pytest.mark.skipif(sys.platform == "win32", reason="signals are sent")
@pytest.mark.parametrize(("sent", "code"), [("SIGINT", -signal.SIGINT), ("SIGTERM", -signal.SIGTERM)])
def test_a_process_ends_at_once_in_the_middle_of_a_tick(sent, code):
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    with subprocess.Popen(
        [sys.executable, "-c", _RUNS], env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        assert process.stdout.readline().strip() == "runs"
        process.send_signal(getattr(signal, sent))
        try:
            assert process.wait(timeout=60) == code
        finally:
            process.kill()


_MADE_AND_DROPPED = """
import json, sys
from sandbox.physics import jit
from tests.bench import scenes
from sandbox.physics.step import step
jit.use_threads(3, worth=0)
def make(count):
    for k in range(count):
        step(scenes.lattice(20 + k % 4).world())
    status = dict(line.split(":") for line in open("/proc/self/status"))
    return int(status["Threads"]), 1024 * int(status["VmRSS"].split()[0])
make(40)
before = make(10)
after = make(int(sys.argv[1]))
print(json.dumps([before, after]))
"""


@compiled
@pytest.mark.skipif(sys.platform != "linux", reason="asks Linux")
@pytest.mark.parametrize("worlds", part_and_whole(100, 1000))
def test_worlds_that_are_dropped_leave_no_thread_and_no_memory(worlds):
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    ended = subprocess.run(
        [sys.executable, "-c", _MADE_AND_DROPPED, str(worlds)], env=environment, capture_output=True, text=True,
        check=True,
    )  # fmt: skip
    (threads, memory), (threads_after, memory_after) = json.loads(ended.stdout)
    assert threads_after == threads
    assert memory_after < memory + 20e6


# How many


def test_small_scenes_start_no_thread():
    code = (
        "from sandbox.physics import jit; from tests.bench import scenes; from sandbox.physics.step import step\n"
        "jit.use_threads(8)\n"
        "for scene in (scenes.rope(20), scenes.lattice(8)):\n"
        "    world = scene.world()\n"
        "    for _ in range(60): step(world)\n"
        "print(jit.threads_started())"
    )
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    ended = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True)
    assert ended.stdout.strip() == "0"


@pytest.mark.parametrize(("wish", "said"), [("0", True), ("9", True), ("two", True), ("3", False)])
def test_the_number_comes_from_the_environment_or_is_said_to_be_wrong(wish, said):
    code = "from sandbox.physics import jit; print(jit.threads())"
    environment = {**os.environ, "SANDBOX_THREADS": wish, "PYTHONPATH": os.pathsep.join(sys.path)}
    ended = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True)
    usual = max(1, min(jit.cores() - 1, jit.MOST_THREADS))
    assert int(ended.stdout) == (usual if said else int(wish))
    assert ended.stderr.splitlines() == [
        f"SANDBOX_THREADS is a number from 1 to 8, not {wish!r}: it is left out" for _ in range(said)
    ]


@pytest.mark.parametrize("count", [0, 9, -1])
def test_no_other_number_is_taken(count):
    with pytest.raises(ValueError, match=f"{count} threads: a number from 1 to 8 is wanted"):
        jit.use_threads(count)
