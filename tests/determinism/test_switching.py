"""A run goes on with the same bits when its kernels are compiled between two of its ticks."""

import random
import subprocess
import sys
from pathlib import Path

import pytest

from sandbox.physics.jit import COMPILED
from tests.support.switching import LEVELS

ROOT = Path(__file__).resolve().parents[2]
SEED = 20


@pytest.mark.skipif(not COMPILED, reason="nothing is compiled here")
def test_recordings_of_runs_that_were_interpreted_first_verify(tmp_path):
    # All levels, a hundred switches: tests/bench/switching.py
    names = random.Random(SEED).sample(LEVELS, 4)
    command = [sys.executable, "-m", "tests.support.switching", str(tmp_path), str(SEED), "40", *names]
    ended = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert ended.returncode == 0, ended.stderr
    lines = ended.stdout.splitlines()
    assert len(lines) == len(names)
    assert all(line.endswith(": None") for line in lines), ended.stdout
