"""The same bits at every tick: in a fresh process, by library, numba and interpreter, without numba or a cache."""

import functools
import importlib.util
import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.support.wants import needs
from tests.support.wholes import part_and_whole

SCRIPT = Path(__file__).with_name("kernel_script.py")
SOLVERS = ("single_pass", "iterative", "direct")
SUBSTEPS = (1, 4, "auto")
TICKS = 40

needs_numba = needs("numba", importlib.util.find_spec("numba"))


@functools.cache
def runs(solver, *mode, way="library", substeps=SUBSTEPS, attempt=0):
    """What the script prints for each number of substeps in one process: how kernels ran, then a hash per tick.

    After the first of them, what substeps do not change is left out.
    """
    environment = {**os.environ, "SANDBOX_KERNELS": way}
    substeps = substeps[:1] if mode else substeps
    command = [sys.executable, str(SCRIPT), solver, ",".join(map(str, substeps)), str(TICKS), *mode]
    ended = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert ended.returncode == 0, ended.stderr
    printed = ended.stdout.splitlines()
    begins = [k for k, line in enumerate(printed) if line in ("library", "numba", "interpreted")]
    blocks = [printed[first:end] for first, end in zip(begins, [*begins[1:], None], strict=True)]
    return dict(zip(substeps, blocks, strict=True))


def lines(solver, *mode):
    return runs(solver, *mode)[1]


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_fresh_process_repeats_every_bit(solver):
    first, again = runs(solver), runs(solver, attempt=1)
    assert len(set(first[4][1 : TICKS + 1])) == TICKS
    assert again == first


@pytest.mark.parametrize("substeps", part_and_whole(SUBSTEPS[:1], SUBSTEPS), ids=lambda substeps: f"{substeps[-1]}")
@pytest.mark.parametrize("solver", SOLVERS)
def test_the_library_gives_the_bits_of_interpreted_kernels(solver, substeps):
    assert_same(runs(solver), runs(solver, way="interpreted", substeps=substeps), "interpreted")


@needs_numba
@pytest.mark.whole_world
def test_the_library_gives_the_bits_of_kernels_that_numba_compiles():
    # The first process compiles them, which the others then find: one after the other.
    for solver in SOLVERS:
        assert_same(runs(solver), runs(solver, way="numba"), "numba")


def assert_same(library, other, way):
    """Whether the runs of another way have the bits of the library's."""
    for substeps in other:
        assert (library[substeps][0], other[substeps][0]) == ("library", way)
        assert other[substeps][1:] == library[substeps][1:], f"{substeps} substeps"


@pytest.mark.parametrize("mode", ["--without-numba", "--broken-numba"])
def test_physics_runs_interpreted_where_numba_is_asked_for_and_cannot_be_imported(mode):
    without = runs("iterative", mode, way="numba")[1]
    assert without[0] == "interpreted"
    assert without[1:] == lines("iterative")[1:]


@needs_numba
@pytest.mark.whole_world
def test_kernels_compile_uncached_where_no_cache_can_be_written():
    uncached = runs("single_pass", "--without-cache", way="numba")[1]
    assert (uncached[0], len(uncached)) == ("numba", 1 + TICKS)
    assert uncached[1:] == lines("single_pass")[-TICKS:]
