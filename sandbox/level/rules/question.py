"""Questions: what a rule asks at the end of each tick."""

from typing import Annotated, Literal, get_args

from pydantic import Field

from sandbox.level.checks import Metric
from sandbox.level.format.limits import QUESTION_LIMIT
from sandbox.level.format.quantities import Description, Key, Name, Seconds, empty, unit

Asks = Literal["metric", "touches", "crosses", "breaks", "counter", "key", "time", "all", "any", "none"]
# Of these fields a question has one.
ASKS: tuple[Asks, ...] = get_args(Asks)
# Those that ask other questions.
GROUPS = ("all", "any", "none")
# Metrics of checks that no rule asks for: they look back over seconds, or are found by the solver's spring constants.
UNASKED = ("max_strain", "rms_strain", "potential_energy", "energy")
# What touches may name beside things with an id.
WALLS = "walls"

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
    touches: Annotated[tuple[Name, ...], Field(min_length=1, max_length=2)] | None = Field(
        default=None,
        description="A body, loose particle or piece of terrain, or `walls`, and what it pushes; one alone: anything.",
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
        description="Lower bound. Without bounds, `inside` has 0, and `settled` 1.",
        json_schema_extra=unit("the metric's") | empty("no bound"),
    )

    @property
    def asked(self) -> tuple[Asks, ...]:
        """The fields of ASKS that it has: one, where it is sound."""
        return tuple(name for name in ASKS if getattr(self, name) is not None)

    @property
    def members(self) -> tuple["QuestionDef", ...]:
        """The questions that it asks in turn."""
        return self.all or self.any or self.none or ()
