"""Acceptance checks: what a level promises about its own run, and how values are compared with the bounds."""

import math
from dataclasses import dataclass
from typing import Literal

from pydantic import Field

from sandbox.level.format.quantities import Coordinate, Description, Key, Name, Seconds, empty, unit
from sandbox.physics.rules import STILL as STILL

Metric = Literal[
    "max_strain",
    "rms_strain",
    "strain",
    "kinetic_energy",
    "potential_energy",
    "energy",
    "max_speed",
    "non_finite",
    "broken_springs",
    "x",
    "y",
    "speed",
    "distance",
    "inside",
    "settled",
    "held",
]
Box = tuple[Coordinate, Coordinate, Coordinate, Coordinate]
# Keys that a check may hold.
HOLD_LIMIT = 20


@dataclass(frozen=True)
class Measured:
    """A metric: the fields that it needs, the fields of which it needs one, the fields that it may have, and its unit.

    label: its name for people. words: a check of it as a sentence; {owner}, {of} and {other} stand for what it
    measures, {bounds} for the bounds. at_least: the lower bound of a check without bounds. momentary: whether it has
    a value at every tick. usual: the bounds of a new check.
    """

    label: str
    words: str
    unit: str = ""
    needs: tuple[str, ...] = ()
    needs_one: tuple[str, ...] = ()
    may_have: tuple[str, ...] = ()
    at_least: float | None = None
    momentary: bool = True
    usual: tuple[float | None, float | None] = (None, 0.0)

    def takes(self, field: str) -> bool:
        """Whether the metric uses a field."""
        return field in (*self.needs, *self.needs_one, *self.may_have)


_OWNER = ("particle", "body")
METRICS: dict[str, Measured] = {
    "x": Measured("x", "x{of} is {bounds}", "m", needs_one=_OWNER, usual=(0.0, None)),
    "y": Measured("height y", "y{of} is {bounds}", "m", needs_one=_OWNER, usual=(0.0, None)),
    "speed": Measured("speed", "the speed{of} is {bounds}", "m/s", needs_one=_OWNER, usual=(None, 0.1)),
    "inside": Measured(
        "inside a box", "{owner} is inside the box by {bounds}", "m", ("box",), may_have=_OWNER, at_least=0.0,
        usual=(0.0, None),
    ),
    "settled": Measured(
        "stands still", "{owner} stands still for {bounds}", "s", may_have=("body",), at_least=1.0, usual=(1.0, None)
    ),
    "held": Measured("hands that hold", "hands that hold something: {bounds}", at_least=1.0, usual=(1.0, None)),
    "distance": Measured(
        "distance", "the distance from {owner} to {other} is {bounds}", "m", ("particle", "other"), usual=(None, 1.0)
    ),
    "strain": Measured("largest strain", "the largest strain{of} is {bounds}", may_have=("body",), usual=(None, 0.1)),
    "max_strain": Measured(
        "largest strain, last 2 s", "the largest strain of the last 2 s is {bounds}", momentary=False, usual=(None, 0.1)
    ),
    "rms_strain": Measured(
        "mean strain, last 2 s", "the root mean square strain of the last 2 s is {bounds}", momentary=False,
        usual=(None, 0.1),
    ),
    "broken_springs": Measured("broken springs", "{bounds} springs{of} break", may_have=("body",)),
    "max_speed": Measured("speed of the fastest", "the speed of the fastest particle is {bounds}", "m/s",
                          usual=(None, 100.0)),
    "kinetic_energy": Measured("energy of motion", "the energy of motion is {bounds}", "J", usual=(None, 1.0)),
    "potential_energy": Measured(
        "energy of springs and height", "the energy of springs and height is {bounds}", "J", usual=(None, 1.0)
    ),
    "energy": Measured("energy", "the energy is {bounds}", "J", usual=(None, 1.0)),
    "non_finite": Measured("places that are no number", "{bounds} particles have no place or speed"),
}  # fmt: skip
# Sentences for usual checks, by metric, lower and upper bound.
PROMISES = {
    ("non_finite", -math.inf, 0.0): "every place and speed is a number",
    ("broken_springs", -math.inf, 0.0): "no spring{of} breaks",
    ("inside", 0.0, math.inf): "{owner} is inside the box",
}
# Digits of a measured value, and those that tell any two numbers apart.
DIGITS, EXACT = 6, 17
# Fields that only some metrics take.
SUBJECTS = ("particle", "other", "body", "box")


class HoldDef(Description):
    """A key that a check holds while the level runs."""

    key: Key = Field(description="Key of a motor or a hydraulic.")
    during: tuple[Seconds, Seconds] = Field(description="From when to when the check holds it.")


class CheckDef(Description):
    """A metric of the level's run and the bounds that it must keep: at one time, always or eventually."""

    name: Name = Field(description="What the check promises.")
    metric: Metric = Field(description="What it measures: a name of [Metrics](#metrics).")
    particle: Name | None = Field(
        default=None, description="Particle that it measures.", json_schema_extra=empty("none")
    )
    other: Name | None = Field(
        default=None, description="Particle to which it measures the `distance`.", json_schema_extra=empty("none")
    )
    body: Name | None = Field(
        default=None,
        description="Body that it measures; for x, y and speed the centre of mass.",
        json_schema_extra=empty("the whole level"),
    )
    box: Box | None = Field(
        default=None,
        description="Box of the metric `inside`: left, bottom, right, top.",
        json_schema_extra=unit("m") | empty("none"),
    )
    after: Seconds = Field(default=5.0, description="When it measures, from the start of the run.")
    always: tuple[Seconds, Seconds] | None = Field(
        default=None,
        description="In place of `after`: it must hold at every tick from the first time to the second.",
        json_schema_extra=empty("once"),
    )
    eventually: tuple[Seconds, Seconds] | None = Field(
        default=None,
        description="In place of `after`: it must hold at one tick at least from the first time to the second.",
        json_schema_extra=empty("once"),
    )
    at_most: float | None = Field(
        default=None, description="Upper bound.", json_schema_extra=unit("the metric's") | empty("no bound")
    )
    at_least: float | None = Field(
        default=None,
        description="Lower bound. Without bounds, a check of `inside` has 0, and one of `settled` or `held` 1.",
        json_schema_extra=unit("the metric's") | empty("no bound"),
    )
    hold: tuple[HoldDef, ...] = Field(
        default=(), max_length=HOLD_LIMIT, description="Keys that it holds while the level runs. It presses no others."
    )


@dataclass(frozen=True)
class CheckResult:
    """A check, the measured value, whether it passed, and one line that says so; at [s]: when it measured."""

    check: CheckDef
    value: float
    passed: bool
    text: str
    at: float


def bounds_of(check: CheckDef) -> tuple[float, float]:
    """The least and the largest value that pass, both included; infinite without a bound."""
    low, high = check.at_least, check.at_most
    if low is None and high is None:
        low = METRICS[check.metric].at_least
    return -math.inf if low is None else low, math.inf if high is None else high


def window_of(check: CheckDef) -> tuple[float, float]:
    """Start and end [s] of the time in which a check measures; equal if it measures once."""
    return check.always or check.eventually or (check.after, check.after)


def excess(check: CheckDef, value: float) -> float:
    """How far a value is beyond the bounds of a check: at most 0 if it passes, infinite if it is not a number."""
    low, high = bounds_of(check)
    beyond = max(low - value if low > -math.inf else -math.inf, value - high if high < math.inf else -math.inf)
    return math.inf if math.isnan(value) else beyond


def subject_text(check: CheckDef) -> str:
    """The measure of a check in words: "distance of a to b"."""
    owner = check.particle or check.body
    other = f" to {check.other}" if check.other is not None else ""
    return check.metric + (f" of {owner}" if owner is not None else "") + other


def time_text(check: CheckDef) -> str:
    """When a check is measured."""
    start, end = window_of(check)
    if check.always or check.eventually:
        return f"{'always' if check.always else 'eventually'} from {start:g} to {end:g} s"
    return f"after {check.after:g} s"


def held_text(check: CheckDef) -> str:
    """The keys that a check holds: "D from 1 to 8 s"; empty if it holds none."""
    return ", ".join(f"{hold.key.upper()} from {hold.during[0]:g} to {hold.during[1]:g} s" for hold in check.hold)


def expected_text(check: CheckDef) -> str:
    """The bounds of a check."""
    low, high = bounds_of(check)
    parts = [f"at least {low:g}"] if low > -math.inf else []
    return " and ".join([*parts, *([f"at most {high:g}"] if high < math.inf else [])])


def promise_text(check: CheckDef) -> str:
    """The promise of a check, in words for people: "the speed of ball is at most 2 m/s"."""
    measured, owner = METRICS[check.metric], check.particle or check.body
    words = PROMISES.get((check.metric, *bounds_of(check)), measured.words)
    return words.format(
        owner=owner or "everything", of="" if owner is None else f" of {owner}", other=check.other,
        bounds=f"{expected_text(check)} {measured.unit}".rstrip(),
    )  # fmt: skip


def value_text(check: CheckDef, value: float, digits: int) -> str:
    """A measured value with that many digits, or with as many as show on which side of a bound it is."""
    fits = excess(check, value) <= 0.0
    texts = (f"{value:.{count}g}" for count in range(digits, EXACT + 1))
    return next((text for text in texts if (excess(check, float(text)) <= 0.0) == fits), f"{value:.{EXACT}g}")


def judge(check: CheckDef, value: float, at: float | None = None) -> CheckResult:
    """The result of a check for a value measured at a time [s]. A value that is not a number fails."""
    passed = excess(check, value) <= 0.0
    when = check.after if at is None else at
    text = value_text(check, value, DIGITS)
    measured = f"is {text}"
    if check.always or check.eventually:
        measured = f"is at {'worst' if check.always else 'best'} {text}, after {when:g} s"
    text = (
        f"{check.name}: {'holds' if passed else 'FAILS'}: {subject_text(check)} {time_text(check)} {measured}, "
        f"wanted {expected_text(check)}"
    )
    return CheckResult(check, value, passed, text, when)
