"""Every shipped level, played for 20 s by a scripted person, verifies everywhere with the same bits."""

import os
import subprocess
import sys

import pytest

from sandbox.level.files import read_level, shipped_levels
from sandbox.physics.jit import COMPILED
from sandbox.session.reading import read_replay
from sandbox.session.replay import ReplayError, verify
from sandbox.session.session import Session
from tests.session.play import play

SECONDS = 20
# Interpreted kernels are some hundred times slower, so that run is cut to what the promise names.
INTERPRETED_TICKS = 120
# Contacts cost more than all else there: levels in which things touch are cut further [particles times ticks].
INTERPRETED_TOUCHES = 6_000


@pytest.mark.parametrize("path", shipped_levels(), ids=lambda path: path.stem)
def test_a_played_level_verifies_in_every_way(path, tmp_path):
    level = read_level(path)
    few = INTERPRETED_TICKS
    if level.has_contacts:
        few = min(few, INTERPRETED_TOUCHES // Session(level).world.particle_count)
    ticks = SECONDS * level.settings.tick_rate if COMPILED else few
    long, short = tmp_path / "long.replay.gz", tmp_path / "short.replay.gz"
    for name, length in ((long, ticks), (short, few)):
        session = Session(level)
        session.record_to(name)
        play(session, length)
        session.stop_recording()
        assert session.tick == length
    replay = read_replay(long)
    assert len(replay.script) > 0.4 * ticks
    assert verify(replay) is None
    assert _verifies_from_the_middle(replay)
    _run_fresh([str(long), str(short)])
    _run_fresh([str(short)], NUMBA_DISABLE_JIT="1")


def _verifies_from_the_middle(replay) -> bool:
    """From the first stored state past the middle behind which nothing is undone that was done before it."""
    for start in sorted(tick for tick in replay.states if tick >= replay.ticks // 2):
        try:
            return verify(replay, start=start) is None
        except ReplayError as error:
            assert "undo reaches back" in str(error)
    return False


def _run_fresh(files: list[str], **environment: str) -> None:
    command = [sys.executable, "-m", "sandbox", "replay", *files]
    run = subprocess.run(command, env={**os.environ, **environment}, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stdout + run.stderr
    assert run.stdout.count(": equal, ") == len(files)
