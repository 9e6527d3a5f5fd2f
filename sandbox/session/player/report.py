"""Report: the page that plays a recorded run beside the one that diverged from it; and runs as reels of a page."""

from collections.abc import Callable, Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.world import World
from sandbox.session.player.page import PlayerPage
from sandbox.session.player.reel import Reel, gathered, shown_box, steps_between, told_states
from sandbox.session.replay.divergence import Divergence, differing_particle
from sandbox.session.replay.recording import Replay
from sandbox.session.replay.verify import Comparison
from sandbox.session.session import Session

# What looks on while states are gathered: gives on what it is given.
Watched = Callable[[Iterable[World]], Iterable[World]]
Played = tuple[NDArray[np.float64], int, list[Reel]]


def played(
    names: Sequence[str], runs: Sequence[Session], ticks: int, also: int | None = None, watched: Watched = iter
) -> Played:
    """The box, the tick rate and the reels of runs that have not begun, or are where they part; they are advanced.

    also: a tick that is not left out.
    """
    level = runs[0].level
    box = shown_box(level, runs[0].keyframes(0, runs[0].tick)[0])
    step = steps_between(ticks, runs[0].world.particle_count, len(runs))
    reels = [
        gathered(Reel(name, run.level, box), watched(told_states(run, 0, ticks)), step, also)
        for name, run in zip(names, runs, strict=True)
    ]
    return box, level.settings.tick_rate, reels


def first_difference_shown(divergence: Divergence | None, run: Session) -> tuple[int, int | None] | None:
    """The tick that a page goes to, and the particle that it rings there."""
    return None if divergence is None else (divergence.tick, differing_particle(divergence, run.snapshot()))


def command_marks(replay: Replay | None) -> list[tuple[int, str]]:
    """The first command of each gesture."""
    gestures: dict[int, tuple[int, str]] = {}
    for line in replay.script if replay else ():
        gestures.setdefault(line.gesture, (line.tick, str(line.record.get("type"))))
    return list(gestures.values())


def report_page(found: Comparison, watched: Watched = iter) -> PlayerPage:
    """The page of a divergence; the run that diverged is advanced to its end."""
    replay, tick = found.replay, found.telling_tick
    runs, names = [Session(replay.level, script=replay.script), found.actual], ["expected", "actual"]
    first = first_difference_shown(found.divergence, found.actual)
    if found.telling_slots is not None:
        first = tick, found.telling_slots[1]
    if found.expected is None:
        names[0] = "as this version steps it; the recorded states are not known"
    return PlayerPage(
        f"{replay.source}: diverged at tick {found.divergence.tick}", *played(names, runs, replay.ticks, tick, watched),
        marks=command_marks(replay), difference=first, lines=found.lines(),
    )  # fmt: skip
