"""Every shipped level, played for a while by a scripted person, verifies everywhere with the same bits.

From the level's beginning in a fresh process, from the middle in the one that made it, and interpreted.
"""

import os
import subprocess
import sys

import pytest

from sandbox.level.format.files import read_level, shipped_levels
from sandbox.physics.jit import COMPILED
from sandbox.session.replay.reader import read_replay
from sandbox.session.replay.recording import ReplayError
from sandbox.session.replay.verify import verify
from sandbox.session.session import Session
from tests.support.play import play

# Where things touch, the wild person makes ticks of many contacts: there, a part of it has to do.
SECONDS, TOUCHING_SECONDS = 20, 5
# Interpreted kernels are some hundred times slower, those of contacts most of all: runs there are cut to the ticks that
# the promise names, and those of many particles further, to so many particles times ticks.
INTERPRETED_TICKS = 120
INTERPRETED_WORK = 8_000
INTERPRETED_TOUCHES = 2_000
# Levels that share a fresh process, which takes seconds to start.
SHARING = 6
SHARES = [shipped_levels()[first::SHARING] for first in range(SHARING)]


def _interpreted_ticks(level) -> int:
    work = INTERPRETED_TOUCHES if level.has_contacts else INTERPRETED_WORK
    return min(INTERPRETED_TICKS, work // Session(level).world.particle_count)


@pytest.mark.parametrize("paths", SHARES, ids=lambda paths: "+".join(path.stem for path in paths))
def test_played_levels_verify_in_every_way(paths, tmp_path):
    recordings, short_ones = [], []
    for path in paths:
        level = read_level(path)
        few = _interpreted_ticks(level)
        seconds = TOUCHING_SECONDS if level.has_contacts else SECONDS
        ticks = seconds * level.settings.tick_rate if COMPILED else few
        long, short = tmp_path / f"{path.stem}.replay.gz", tmp_path / f"{path.stem}.short.replay.gz"
        for name, length in ((long, ticks), (short, few)):
            session = Session(level)
            session.record_to(name, state_ticks=60)
            play(session, length)
            session.stop_recording()
            assert session.tick == length
        replay = read_replay(long)
        assert len(replay.script) > 0.4 * ticks
        assert _verifies_from_the_middle(replay)
        recordings.append(str(long))
        short_ones.append(str(short))
    _run_fresh(recordings)
    _run_fresh(short_ones, NUMBA_DISABLE_JIT="1")


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
