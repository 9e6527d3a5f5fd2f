"""Water has the same bits in every way in which kernels run."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


def hashes(solver, way, ticks):
    environment = {**os.environ, "SANDBOX_KERNELS": way, "PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-m", "tests.determinism.water_script", solver, str(ticks)]
    ended = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert ended.returncode == 0, ended.stderr
    return ended.stdout.splitlines()


@pytest.mark.parametrize("solver", ["single_pass", "iterative", "direct"])
def test_what_floats_has_the_bits_of_interpreted_kernels(solver):
    found = hashes(solver, "library", 24)
    assert len(set(found)) == 24
    assert found == hashes(solver, "interpreted", 24)
