"""Compiling in child processes."""

import os
import subprocess
import sys
from collections import Counter
from pathlib import Path

import pytest

from sandbox.app.kernels import compiling
from sandbox.app.kernels.compiling import Crew, divide, is_prepared, note_prepared
from sandbox.physics import jit

ROOT = Path(__file__).resolve().parents[2]


class FakeChild:
    """A child that does what it is told to."""

    def __init__(self, arguments):
        self.arguments, self.result, self.is_ended = arguments, None, False
        self.wanted, self.done = Counter(), Counter()

    def end(self):
        self.is_ended = True


@pytest.fixture
def crew():
    """Two children, and where the second is."""
    children = []

    def start(arguments):
        children.append(FakeChild(arguments))
        return children[-1]

    return Crew(2, start=start), *children


def test_each_child_is_told_its_share(crew):
    _, first, second = crew
    assert [child.arguments[:2] for child in (first, second)] == [["0", "2"], ["1", "2"]]


def test_progress_is_known_once_every_child_has_counted_its_share(crew):
    crew, first, second = crew
    first.wanted.update(basics=3)
    assert crew.progress == (0, 0)
    second.wanted.update(basics=1, contacts=4)
    first.done.update(basics=2)
    assert crew.progress == (2, 8)


def test_a_group_is_there_when_every_child_has_compiled_its_part_of_it(crew):
    crew, first, second = crew
    assert not crew.has(["basics"])
    first.wanted.update(basics=1)
    second.wanted.update(basics=1, contacts=1)
    first.done.update(basics=1)
    assert not crew.has(["basics"])
    second.done.update(basics=1)
    assert crew.has(["basics"]) and not crew.has(["basics", "contacts"])


def test_nobody_waits_for_a_child_that_has_failed(crew):
    crew, first, second = crew
    first.wanted.update(basics=2)
    second.wanted.update(basics=1)
    second.done.update(basics=1)
    assert crew.is_busy
    first.result, second.result = False, True
    assert not crew.is_busy and crew.has_failed and crew.has(["basics", "contacts"])


def test_where_no_process_can_be_started_nothing_is_waited_for():
    def start(arguments):
        raise OSError("no more processes")

    crew = Crew(2, start=start)
    assert crew.has_failed and not crew.is_busy and crew.has(["contacts"])


def test_an_early_end_leaves_no_child(crew):
    crew, first, second = crew
    crew.end()
    assert first.is_ended and second.is_ended


def kernels(**lengths):
    """Entries by name that call no part, of so many additions each."""
    made = []
    for name, length in lengths.items():
        scope = {}
        exec(f"def {name}(x):\n    return x{' + x' * length}", scope)
        made.append(jit.Kernel("kernel", scope[name], group="contacts" if name.startswith("c") else "basics"))
    return made


def test_shares_take_about_the_same_time_and_are_one_to_one_with_the_kernels():
    found = kernels(a=900, b=500, d=450, e=60, c1=300, c2=200)
    shares = divide(found, 2)
    assert sorted(one.name for share in shares for one in share) == sorted(one.name for one in found)
    loads = [sum(len(one.function.__code__.co_code) for one in share) for share in shares]
    assert max(loads) < 1.2 * min(loads)
    for share in shares:
        groups = [one.group for one in share]
        assert groups == sorted(groups)
    assert divide(found, 1)[0][-1].name.endswith("c1")


def test_kernels_that_call_the_same_long_part_come_together(monkeypatch):
    found = kernels(a=20, b=20, d=640, e=200, f=150)
    (part,) = kernels(part=600)
    part.held = part.function
    for one in found[:2]:
        # As a kernel that calls it by its name would.
        one.function.__globals__["part"] = part.function
        one.function.__code__ = one.function.__code__.replace(co_names=("part",))
    monkeypatch.setattr(jit, "KERNELS", [part])
    # Counted twice, it would leave no time for f beside them.
    shares = [{one.function.__name__ for one in share} for share in divide(found, 2)]
    assert shares == [{"d", "e"}, {"a", "b", "f"}]


def test_that_all_is_prepared_is_noted_until_kernels_are_gone(monkeypatch, tmp_path):
    monkeypatch.setattr(compiling.platformdirs, "user_cache_dir", lambda *_, **__: str(tmp_path / "cache"))
    kept = tmp_path / "kernels"
    kept.mkdir()
    (kept / "one.kernel").touch()
    monkeypatch.setattr("sandbox.physics.jit.cache.cache_folders", lambda: [kept, tmp_path / "nowhere"])
    assert not is_prepared()
    note_prepared()
    assert is_prepared()
    (kept / "one.kernel").unlink()
    assert not is_prepared()


def test_a_child_that_nobody_listens_to_and_one_that_cannot_compile_end_by_themselves():
    environment = {**os.environ, "NUMBA_DISABLE_JIT": "1", "SDL_VIDEODRIVER": "dummy"}
    command = [sys.executable, "-m", "sandbox.app.kernels.compiling", "0", "8", "basics", "single_pass"]
    child = subprocess.Popen(command, cwd=ROOT, env=environment, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
    assert child.stdout is not None
    child.stdout.close()
    assert child.wait() != 0
