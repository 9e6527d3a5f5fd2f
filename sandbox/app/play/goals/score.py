"""The score of a run: what chips at the top of the world say of its goal, clock, counters and result."""

import math
from dataclasses import dataclass

from sandbox.app.draw.colours import ACCENT, DANGER, TEXT, WARNING, Colour
from sandbox.level.document.model import Level
from sandbox.level.rules.hands import left_of
from sandbox.level.rules.rule import has_clock
from sandbox.physics.snapshot import Snapshot
from sandbox.session.outcome import Outcome

# Time left from which on a clock that counts down warns [s].
SHORT_TIME = 10.0


@dataclass(frozen=True)
class Chip:
    """One of the chips: an icon, a name, a value; stars: how many are lit, None = there are none on it."""

    icon: str = ""
    name: str = ""
    value: str = ""
    colour: Colour = TEXT
    stars: int | None = None


def told_time(seconds: float, decimals: int = 2) -> str:
    """A time of a run: "12.35 s", or from a minute on "1:02.35"; a hundredth that is not over does not count."""
    parts = math.floor(seconds * 10**decimals + 1e-6)
    whole, rest = divmod(parts, 10**decimals)
    if whole < 60:
        return f"{whole}.{rest:0{decimals}} s"
    return f"{whole // 60}:{whole % 60:02}.{rest:0{decimals}}"


def time_limit(level: Level) -> float | None:
    """The time [s] at which a level is lost, whatever else happens; None: there is none."""
    limits = [
        rule.when.time + rule.for_seconds
        for rule in level.rules
        if rule.when.time is not None and any(action.fail is not None for action in rule.then)
    ]
    return min(limits, default=None)


def chips_of(level: Level, state: Snapshot, result: Outcome | None) -> list[Chip]:
    """What is shown of a state of a level that has this result."""
    chips = [Chip("goal", colour=ACCENT)] if level.goal else []
    if has_clock(level.rules):
        chips.append(_clock(level, state.tick if result is None else result.tick))
    values = zip(level.counters, state.counter.tolist(), strict=False)
    chips += [Chip(name=counter.text, value=f"{value + 0.0:.6g}") for counter, value in values if counter.text]
    chips += [
        Chip(name=f"{name} left", value=f"{state.counter[row]:.0f} of {most}")
        for row, name, most in left_of(level.hands, len(state.counter))
    ]
    if result is not None and result.is_won:
        chips.append(Chip("won", colour=ACCENT, stars=result.stars))
    elif result is not None:
        chips.append(Chip("lost", value="Lost", colour=DANGER))
    return chips


def _clock(level: Level, tick: int) -> Chip:
    seconds, limit = tick / level.settings.tick_rate, time_limit(level)
    if limit is None:
        return Chip("clock", value=told_time(seconds, 1))
    left = max(limit - seconds, 0.0)
    return Chip("clock", value=told_time(left, 1), colour=WARNING if left <= SHORT_TIME else TEXT)
