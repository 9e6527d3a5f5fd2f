"""Report: the page that plays a recorded run beside the one that diverged from it; and runs as reels of a page."""

from collections.abc import Callable, Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from sandbox.level.assembly.level_world import LevelWorld
from sandbox.session.events.happening import shortened
from sandbox.session.events.story import story
from sandbox.session.events.touch_watch import TouchWatch
from sandbox.session.player.page import PlayerPage, ToldLine
from sandbox.session.player.reel import Reel, gathered, shown_box, steps_between, told_states
from sandbox.session.replay.divergence import Divergence, differing_particle
from sandbox.session.replay.recording import Replay
from sandbox.session.replay.verify import Comparison
from sandbox.session.session import Session

# What looks on while states are gathered: gives on what it is given.
Watched = Callable[[Iterable[LevelWorld]], Iterable[LevelWorld]]
Played = tuple[NDArray[np.float64], int, list[Reel]]


def played(
    names: Sequence[str],
    runs: Sequence[Session],
    ticks: int,
    also: int | None = None,
    watched: Watched = iter,
    watches: Sequence[TouchWatch] = (),
) -> Played:
    """The box, the tick rate and the reels of runs that have not begun, or are where they part; they are advanced.

    also: a tick that is not left out. watches: one for each run, that is told of its ticks.
    """
    level = runs[0].level
    box = shown_box(level, runs[0].keyframes(0, runs[0].tick)[0])
    step = steps_between(ticks, runs[0].world.particle_count, len(runs))
    states = [told_states(run, 0, ticks) for run in runs]
    if watches:
        states = [watch.following(each) for watch, each in zip(watches, states, strict=True)]
    reels = [
        gathered(Reel(name, run.level, box), watched(each), step, also)
        for name, run, each in zip(names, runs, states, strict=True)
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


def watches_of(runs: Sequence[Session]) -> list[TouchWatch]:
    """One for each run."""
    return [TouchWatch(run.level.zones) for run in runs]


def told_of(runs: Sequence[Session], watches: Sequence[TouchWatch]) -> list[ToldLine]:
    """What happened in a run, or in two: what both tell in the same tick is said once, all else of its side."""
    rate = runs[0].level.settings.tick_rate
    sides = []
    for run, watch in zip(runs, watches, strict=True):
        found, dropped = shortened(story(run, watch))
        sides.append([(each.tick, each.line(rate).strip()) for each in found])
        if dropped:
            sides[-1].append((run.tick, f"{dropped} more lines of who touched whom: `sandbox info --all` lists them"))
    common = set.intersection(*map(set, sides))
    told = {line: ToldLine(*line, None if line in common else side) for side, of in enumerate(sides) for line in of}
    return sorted(told.values(), key=lambda line: line.tick)


def report_page(found: Comparison, watched: Watched = iter) -> PlayerPage:
    """The page of a divergence; the run that diverged is advanced to its end."""
    replay, tick = found.replay, found.telling_tick
    runs, names = [Session(replay.level, script=replay.script), found.actual], ["expected", "actual"]
    first = first_difference_shown(found.divergence, found.actual)
    if found.telling_slots is not None:
        first = tick, found.telling_slots[1]
    if found.expected is None:
        names[0] = "as this version steps it; the recorded states are not known"
    watches = watches_of(runs)
    return PlayerPage(
        f"{replay.source}: diverged at tick {found.divergence.tick}",
        *played(names, runs, replay.ticks, tick, watched, watches), marks=command_marks(replay), difference=first,
        lines=found.lines(), happened=told_of(runs, watches),
    )  # fmt: skip
