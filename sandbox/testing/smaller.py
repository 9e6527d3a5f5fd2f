"""What a test of a recording or a level does where it is asked for: shrink what diverges, go back at every tick."""

from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from sandbox.testing.failed import Failed

if TYPE_CHECKING:
    from collections.abc import Callable

    from sandbox.level.document.model import Level
    from sandbox.session.replay.recording import Replay

# Smaller runs that the test of one recording tries, at most.
MOST_RUNS = 2_000


def shrunk_lines(
    config: pytest.Config, replay: "Replay", level: "Level | None", output: "Callable[[], Path]"
) -> list[str]:
    """The smallest run that still diverges on a level, as lines, and written; none where nobody asks for it.

    output: where what is written of the recording goes.
    """
    if not config.getoption("--replay-shrink"):
        return []
    if level is None:
        return ["smallest: only the build that recorded it knows the bits of other commands; --replay-against compares "
                "with a level"]  # fmt: skip
    from sandbox.session.shrink.diverging import Diverges
    from sandbox.session.shrink.play import short_json
    from sandbox.session.shrink.shrinker import shrinker_of
    from sandbox.session.shrink.writing import write_recording

    shrinker = shrinker_of(replay, Diverges(level))
    if shrinker.seen is None:
        return ["smallest: what differs does so from the beginning, without any command"]
    for _ in shrinker.steps():
        if shrinker.tries >= MOST_RUNS:
            break
    try:
        path = Path(f"{str(output()).partition('.replay')[0]}.smallest.replay.gz")
        write_recording(shrinker.smallest, shrinker.level, path)
    except OSError as error:
        return [f"smallest: {error}"]
    return [
        f"smallest: {path}: {shrinker.smallest.counts()}: {shrinker.seen}",
        *(f"  tick {line.tick}: {short_json(line.record)}" for line in shrinker.smallest.lines),
    ]


def check_rollback(config: pytest.Config, replay: "Replay", level: "Level | None") -> None:
    """Go back at every tick of a recording, where --replay-rollback says so. Raises Failed and ReplayError."""
    from sandbox.session.replay.rollback import roll_back

    back = config.getoption("--replay-rollback")
    found = roll_back(replay, back, level).found if back else None
    if found is not None:
        raise Failed(f"{Path(replay.source).name}: rolled back {back} ticks, diverged: {found}", *found.lines())


def check_rollback_of_level(config: pytest.Config, level: "Level") -> None:
    """The same of a level that random hands play. Raises Failed."""
    from sandbox.session.replay.rollback import roll_back_level

    back = config.getoption("--replay-rollback")
    found = roll_back_level(level, back).found if back else None
    if found is not None:
        raise Failed(f"{level.name}: rolled back {back} ticks under random hands, diverged: {found}", *found.lines())
