"""Every shipped level, played for a while by a scripted person, verifies everywhere with the same bits.

From the level's beginning in a fresh process, from the middle in the one that made it, and interpreted. A cycle of all
acts takes two seconds; that of some levels is played by day, the whole while of all by whole-world tests.
"""

import os
import subprocess
import sys

import pytest

from sandbox.level.reading.files import read_level, shipped_levels
from sandbox.physics.jit import COMPILED
from sandbox.physics.settings import AUTO
from sandbox.session.compare.comparison import verify
from sandbox.session.replay.reader import read_replay
from sandbox.session.replay.recording import ReplayError
from sandbox.session.session import Session
from tests.support.play import play, without_limits

# The person does everything there is to do in two seconds, and begins again.
CYCLE = 120  # [ticks]
# Where things touch, the wild person makes ticks of many contacts: there, a part of it has to do; and no more than so
# many elements times substeps times ticks where they are many.
SECONDS, TOUCHING_SECONDS = 20, 5
WORK = 600_000
# Interpreted kernels are some hundred times slower, those of contacts most of all: runs there are cut to the ticks that
# the promise names, and those of many elements further; where things touch, to so many particles times ticks.
INTERPRETED_TICKS = 120
INTERPRETED_WORK = 24_000
INTERPRETED_TOUCHES = 2_000
# Of those ticks so many have to do beside one cycle.
INTERPRETED_PART = 5
# Levels that share a fresh process, which takes seconds to start.
SHARING = 3
SHARES = [shipped_levels()[first::SHARING] for first in range(SHARING)]
BY_DAY = shipped_levels()[::6]


def _lengths(level, is_whole: bool) -> tuple[int, int]:
    """For how many ticks a level is played with compiled kernels, and with interpreted ones."""
    many, few = _whole_lengths(level)
    return (many, few) if is_whole else (CYCLE, -(-few // INTERPRETED_PART))


def _whole_lengths(level) -> tuple[int, int]:
    world, rate = Session(level).world, level.settings.tick_rate
    if level.has_contacts:
        return TOUCHING_SECONDS * rate, min(INTERPRETED_TICKS, INTERPRETED_TOUCHES // world.particle_count)
    substeps = 1 if world.settings.substeps == AUTO else world.settings.substeps
    work = substeps * (world.particle_count + len(world.particle_a) + 2 * len(world.constraint_kind))
    seconds = min(SECONDS, max(TOUCHING_SECONDS, WORK // work // rate))
    return seconds * rate, max(1, min(INTERPRETED_TICKS, INTERPRETED_WORK // work))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("paths", "is_whole"),
    [(BY_DAY, False), *(pytest.param(share, True, marks=pytest.mark.whole_world) for share in SHARES)],
)
def test_played_levels_verify_in_every_way(paths, is_whole, tmp_path):
    recordings, short_ones = [], []
    for path in paths:
        # Whatever hands may do.
        level = without_limits(read_level(path))
        many, few = _lengths(level, is_whole)
        ticks = many if COMPILED else few
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
    _run_fresh(short_ones, SANDBOX_KERNELS="interpreted")


def _verifies_from_the_middle(replay) -> bool:
    """From the last stored state before which nothing lies that is undone after it, and which all acts follow."""
    middle, late = replay.ticks // 2, max(replay.ticks - CYCLE, replay.ticks // 2)
    stored = [tick for tick in replay.states if tick >= middle]
    for start in sorted(stored, key=lambda tick: (tick > late, abs(tick - late))):
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
