"""Compiling in processes of their own."""

import os
import subprocess
import sys
from pathlib import Path

from sandbox.app.kernels import compiling
from sandbox.app.kernels.compiling import divide
from sandbox.physics import jit

ROOT = Path(__file__).resolve().parents[2]


def kernels(**lengths):
    """Entries by name that call no part, of so many additions each."""
    made = []
    for name, length in lengths.items():
        scope = {}
        exec(f"def {name}(x):\n    return x{' + x' * length}", scope)
        made.append(jit.Kernel("kernel", scope[name]))
    return made


def test_shares_take_about_the_same_time_and_are_one_to_one_with_the_kernels():
    found = kernels(a=900, b=500, d=450, e=60, c1=300, c2=200)
    shares = divide(found, 2)
    assert sorted(one.name for share in shares for one in share) == sorted(one.name for one in found)
    loads = [sum(len(one.function.__code__.co_code) for one in share) for share in shares]
    assert max(loads) < 1.2 * min(loads)
    assert [one.function.__name__ for one in divide(found, 1)[0]] == ["e", "c2", "c1", "d", "b", "a"]


def test_kernels_that_call_the_same_long_part_come_together(monkeypatch):
    found = kernels(a=20, b=20, d=640, e=200, f=150)
    (part,) = kernels(part=600)
    part.held = part.function
    for one in found[:2]:
        # As a kernel that calls it by its name would.
        one.function.__globals__["part"] = part.function
        one.function.__code__ = one.function.__code__.replace(co_names=("part",))
    monkeypatch.setitem(jit._BY_FUNCTION, part.function, part)
    # Counted twice, it would leave no time for f beside them.
    shares = [{one.function.__name__ for one in share} for share in divide(found, 2)]
    assert shares == [{"d", "e"}, {"a", "b", "f"}]


def test_a_process_that_nobody_listens_to_ends_and_fails_where_numba_is_missing():
    missing = "import sys; sys.modules['numba'] = None"
    program = f"{missing}; from sandbox.app.kernels.compiling import _main; _main('0', '8')"
    environment = {**os.environ, "SDL_VIDEODRIVER": "dummy"}
    command = [sys.executable, "-c", program]
    process = subprocess.Popen(command, cwd=ROOT, env=environment, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
    assert process.stdout is not None
    process.stdout.close()
    assert process.wait() != 0


def test_no_process_is_left_where_one_cannot_be_started(monkeypatch):
    ended = []

    class Started:
        wanted = done = 0
        result = None

        def __init__(self, number, processes):
            if number == 1:
                raise OSError("no more processes")

        def end(self):
            ended.append(self)

    monkeypatch.setattr(compiling, "Compiler", Started)
    assert not compiling.compile_all(2, lambda *_: None)
    assert len(ended) == 1
