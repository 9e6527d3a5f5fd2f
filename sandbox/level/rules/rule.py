"""Rules: a question, and the actions that follow when it holds; and counters, which they change and ask for."""

from typing import Annotated, Literal, get_args

from pydantic import Field

from sandbox.level.checks import Metric
from sandbox.level.format.limits import ACTION_LIMIT, QUESTION_LIMIT
from sandbox.level.format.quantities import (
    Description,
    Drive,
    Extras,
    Gravity,
    Id,
    Key,
    Line,
    Name,
    Sag,
    Seconds,
    Text,
    Velocity,
    empty,
    unit,
)

Asks = Literal["metric", "touches", "crosses", "breaks", "counter", "key", "time", "all", "any", "none"]
# Of these fields a question has one.
ASKS: tuple[Asks, ...] = get_args(Asks)
# Those that ask other questions.
GROUPS = ("all", "any", "none")
# Fields that name several things, where a question is of one.
MANY = ("any_of", "all_of", "each_of")
# Metrics of checks that no rule asks for: they look back over seconds, or are found by the solver's spring constants.
UNASKED = ("max_strain", "rms_strain", "potential_energy", "energy")
# What touches may name beside things with an id.
WALLS = "walls"

_Several = Annotated[tuple[Name, ...], Field(min_length=1, max_length=QUESTION_LIMIT)]
_Members = Annotated[tuple["QuestionDef", ...], Field(min_length=1, max_length=QUESTION_LIMIT)]


class QuestionDef(Description):
    """What a rule asks. It has one of metric, touches, crosses, breaks, counter, key, time, all, any and none."""

    metric: Metric | None = Field(
        default=None,
        description="A metric of [Metrics](#metrics) lies between the bounds. Those that look back over seconds, and "
        "`potential_energy` and `energy`, are left to checks.",
        json_schema_extra=empty("none"),
    )
    particle: Name | None = Field(
        default=None, description="Particle that the metric is of, or that crosses.", json_schema_extra=empty("none")
    )
    other: Name | None = Field(
        default=None, description="Particle to which `distance` is measured.", json_schema_extra=empty("none")
    )
    body: Name | None = Field(
        default=None, description="Body that the metric is of, or that crosses.", json_schema_extra=empty("none")
    )
    zone: Name | None = Field(
        default=None,
        description="Zone of the metric `inside`. The whole body must be inside at the end of a tick.",
        json_schema_extra=empty("none"),
    )
    any_of: _Several | None = Field(
        default=None,
        description="Bodies, loose particles and groups, in place of `body`, `particle` or what touches: one of them "
        "is enough.",
        json_schema_extra=empty("none"),
    )
    all_of: _Several | None = Field(
        default=None, description="As `any_of`, but it must hold of all of them.", json_schema_extra=empty("none")
    )
    each_of: _Several | None = Field(
        default=None,
        description="As `any_of`, but the rule is one of its own for each of them, and acts for each.",
        json_schema_extra=empty("none"),
    )
    touches: Annotated[tuple[Name, ...], Field(max_length=2)] | None = Field(
        default=None,
        description="A body, loose particle or piece of terrain, or `walls`, and what it pushes; one alone: anything. "
        "Of several things it names what they push, or nothing: anything.",
        json_schema_extra=empty("none"),
    )
    crosses: Name | None = Field(
        default=None,
        description="Zone that a particle of `body`, or `particle`, is in or passes through in a tick, at any speed.",
        json_schema_extra=empty("none"),
    )
    breaks: Name | None = Field(
        default=None,
        description="Body of which a spring is gone, broken or cut.",
        json_schema_extra=empty("none"),
    )
    counter: Name | None = Field(
        default=None, description="Counter that lies between the bounds.", json_schema_extra=empty("none")
    )
    key: Key | None = Field(default=None, description="Key that is held.", json_schema_extra=empty("none"))
    time: Seconds | None = Field(
        default=None, description="Time of the run that is over.", json_schema_extra=empty("none")
    )
    all: _Members | None = Field(default=None, description="Questions that each hold.", json_schema_extra=empty("none"))
    any: _Members | None = Field(
        default=None, description="Questions of which one holds at least.", json_schema_extra=empty("none")
    )
    none: _Members | None = Field(
        default=None, description="Questions of which none holds.", json_schema_extra=empty("none")
    )
    at_most: float | None = Field(
        default=None, description="Upper bound.", json_schema_extra=unit("the metric's") | empty("no bound")
    )
    at_least: float | None = Field(
        default=None,
        description="Lower bound. Without bounds, `inside` has 0, and `settled` and `held` 1.",
        json_schema_extra=unit("the metric's") | empty("no bound"),
    )

    @property
    def asked(self) -> tuple[Asks, ...]:
        """The fields of ASKS that the question has: one, where it is sound."""
        return tuple(name for name in ASKS if getattr(self, name) is not None)

    @property
    def members(self) -> tuple["QuestionDef", ...]:
        """The questions inside the question."""
        return self.all or self.any or self.none or ()


Sound = Literal["bell", "coin", "drum", "buzzer"]
Does = Literal[
    "win", "fail", "say", "sound", "count", "checkpoint", "cut", "pin", "unpin", "drive", "sag", "gravity", "wind",
]  # fmt: skip
# Of these fields an action has one.
DOES: tuple[Does, ...] = get_args(Does)


class StarsDef(Description):
    """What earns the second and the third star of a win; the first is for winning."""

    counter: Name | None = Field(
        default=None, description="Counter that is compared.", json_schema_extra=empty("the time of the win")
    )
    second: float = Field(description="Bound for two stars.", json_schema_extra=unit("s, or the counter's"))
    third: float = Field(
        description="Bound for three stars. Above `second`, both are least values, else largest ones.",
        json_schema_extra=unit("s, or the counter's"),
    )


class ActionDef(Description):
    """What a rule does from the next tick on. It has one field that says what, and those that this one takes."""

    win: Text | None = Field(
        default=None, description="The level is won, in these words.", json_schema_extra=empty("none")
    )
    stars: StarsDef | None = Field(
        default=None, description="Stars of `win`.", json_schema_extra=empty("three for each win")
    )
    fail: Text | None = Field(
        default=None, description="The level is lost, in these words.", json_schema_extra=empty("none")
    )
    say: Text | None = Field(default=None, description="A line is shown.", json_schema_extra=empty("none"))
    sound: Sound | None = Field(default=None, description="A sound is heard.", json_schema_extra=empty("none"))
    count: Name | None = Field(default=None, description="Counter that changes.", json_schema_extra=empty("none"))
    by: float = Field(default=1.0, description="By how much `count` changes it.")
    checkpoint: bool = Field(default=False, description="Restart goes back to here.")
    cut: Name | None = Field(
        default=None,
        description="Body, of which all springs are cut, or one spring.",
        json_schema_extra=empty("none"),
    )
    pin: Name | None = Field(default=None, description="Particle that is pinned.", json_schema_extra=empty("none"))
    unpin: Name | None = Field(
        default=None, description="Particle that is pinned no longer.", json_schema_extra=empty("none")
    )
    drive: Name | None = Field(
        default=None,
        description="Wheel with a motor, or loose spring with a hydraulic, that is driven.",
        json_schema_extra=empty("none"),
    )
    value: Drive = Field(default=1.0, description="How `drive` is driven: 1 forward, -1 backward, 0 not at all.")
    sag: Sag | None = Field(
        default=None,
        description="How soft `body` becomes: the part of its height by which it sags where it stands.",
        json_schema_extra=empty("none"),
    )
    body: Name | None = Field(default=None, description="Body of `sag`.", json_schema_extra=empty("none"))
    gravity: Gravity | None = Field(default=None, description="Gravity changes.", json_schema_extra=empty("none"))
    wind: Velocity | None = Field(default=None, description="The wind changes.", json_schema_extra=empty("none"))
    during: Seconds = Field(default=0.0, description="Time that `sag`, `gravity` and `wind` take to come.")

    @property
    def done(self) -> tuple[Does, ...]:
        """The fields of DOES that the action has: one, where it is sound."""
        return tuple(name for name in DOES if not (getattr(self, name) is None or getattr(self, name) is False))


# The field that says what, for those that belong to one.
BELONGS = {
    "stars": ("win",), "by": ("count",), "value": ("drive",), "body": ("sag",), "during": ("sag", "gravity", "wind"),
}  # fmt: skip


class CounterDef(Description):
    """A number that rules change and ask for, such as a score."""

    id: Id = Field(description="Name of the counter. No other counter has it.")
    start: float = Field(default=0.0, description="Its value at the start.")
    text: Line = Field(default="", description="Its name for players, who see it then.")


class RuleDef(Description):
    """When something holds, something is done. A rule that wins is a goal of the level."""

    id: Id = Field(description="Name of the rule. No other rule has it.")
    when: QuestionDef = Field(description="What it asks at the end of each tick.")
    for_seconds: Seconds = Field(default=0.0, description="For how long that must have held.")
    once: bool = Field(
        default=False, description="Whether it acts once in a run, not each time that its question begins to hold."
    )
    then: Annotated[tuple[ActionDef, ...], Field(min_length=1, max_length=ACTION_LIMIT)] = Field(
        description="What it does, in this order, before the next tick."
    )
    extras: Extras = Field(default_factory=dict)


def has_clock(rules: tuple[RuleDef, ...]) -> bool:
    """Whether time counts for players: a rule asks for it, or stars are earned by it."""
    stars = [action.stars for rule in rules for action in rule.then if action.stars is not None]
    return any(each.counter is None for each in stars) or any(_asks_time(rule.when) for rule in rules)


def _asks_time(question: QuestionDef) -> bool:
    return question.time is not None or any(map(_asks_time, question.members))
