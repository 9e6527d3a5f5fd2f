"""The same bits at every tick: in a fresh process, and in every way in which kernels run."""

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


@functools.cache
def runs(solver, way="library", substeps=SUBSTEPS, attempt=0):
    """What the script prints for each number of substeps in one process: how kernels ran, then a hash per tick.

    After the first of them, what substeps do not change is left out.
    """
    environment = {**os.environ, "SANDBOX_KERNELS": way}
    command = [sys.executable, str(SCRIPT), solver, ",".join(map(str, substeps)), str(TICKS)]
    ended = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert ended.returncode == 0, ended.stderr
    printed = ended.stdout.splitlines()
    begins = [k for k, line in enumerate(printed) if line in ("library", "generic", "checked", "interpreted")]
    blocks = [printed[first:end] for first, end in zip(begins, [*begins[1:], None], strict=True)]
    return dict(zip(substeps, blocks, strict=True))


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_fresh_process_repeats_every_bit(solver):
    first, again = runs(solver), runs(solver, attempt=1)
    assert len(set(first[4][1 : TICKS + 1])) == TICKS
    assert again == first


@pytest.mark.parametrize("substeps", part_and_whole(SUBSTEPS[:1], SUBSTEPS), ids=lambda substeps: f"{substeps[-1]}")
@pytest.mark.parametrize("solver", SOLVERS)
def test_the_library_gives_the_bits_of_interpreted_kernels(solver, substeps):
    assert_same(runs(solver), runs(solver, "interpreted", substeps), "interpreted")


@pytest.mark.parametrize("solver", SOLVERS)
def test_the_library_gives_the_bits_of_that_which_every_processor_runs(solver):
    assert_same(runs(solver), runs(solver, "generic"), "generic")


@needs("zig", importlib.util.find_spec("ziglang"))
@pytest.mark.whole_world
def test_the_library_gives_the_bits_of_kernels_that_look_at_every_index():
    for solver in SOLVERS:
        assert_same(runs(solver), runs(solver, "checked"), "checked")


def assert_same(library, other, way):
    """Whether the runs of another way have the bits of the library's."""
    for substeps in other:
        assert (library[substeps][0], other[substeps][0]) == ("library", way)
        assert other[substeps][1:] == library[substeps][1:], f"{substeps} substeps"
