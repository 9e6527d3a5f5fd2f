"""The same bits at every tick: in a fresh process, compiled and interpreted, without numba, without a cache."""

import functools
import importlib.util
import os
import subprocess
import sys
from pathlib import Path

import pytest

SCRIPT = Path(__file__).with_name("kernel_script.py")
SOLVERS = ("single_pass", "iterative", "direct")
TICKS = 40

needs_numba = pytest.mark.skipif(
    importlib.util.find_spec("numba") is None, reason="compares with compiled kernels, and numba is not installed"
)


@functools.cache
def lines(solver, substeps, *mode, interpreted=False, attempt=0):
    """What the script prints in a process of its own: how kernels ran, then a hash per tick."""
    environment = {**os.environ, "NUMBA_DISABLE_JIT": "1" if interpreted else "0"}
    command = [sys.executable, str(SCRIPT), solver, str(substeps), str(TICKS), *mode]
    ended = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert ended.returncode == 0, ended.stderr
    return ended.stdout.splitlines()


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_fresh_process_repeats_every_bit(solver):
    first, again = lines(solver, 4), lines(solver, 4, attempt=1)
    assert len(set(first[1 : TICKS + 1])) == TICKS
    assert again == first


@needs_numba
@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("substeps", [1, 4, "auto"])
def test_compiled_and_interpreted_kernels_give_the_same_bits(solver, substeps):
    compiled, interpreted = lines(solver, substeps), lines(solver, substeps, interpreted=True)
    assert (compiled[0], interpreted[0]) == ("compiled", "interpreted")
    assert interpreted[1:] == compiled[1:]


@pytest.mark.parametrize("mode", ["--without-numba", "--broken-numba"])
def test_physics_runs_interpreted_where_numba_cannot_be_imported(mode):
    without = lines("iterative", 1, mode)
    assert without[0] == "interpreted"
    assert without[1:] == lines("iterative", 1)[1:]


@needs_numba
def test_kernels_compile_uncached_where_no_cache_can_be_written():
    uncached = lines("single_pass", 1, "--without-cache")
    assert (uncached[0], len(uncached)) == ("compiled", 1 + TICKS)
    assert uncached[1:] == lines("single_pass", 1)[-TICKS:]


@needs_numba
@pytest.mark.parametrize(("solver", "tick"), [("single_pass", 0), ("direct", 17), ("direct", 53), ("iterative", 61)])
def test_a_run_that_is_switched_between_two_ticks_from_interpreted_to_compiled_gives_the_same_bits(solver, tick):
    switched = lines(solver, 1, "--switch", str(tick))
    assert switched[0] == "interpreted"
    assert switched[1:] == lines(solver, 1)[1:]
