"""Actions: what a rule does when what it asks holds."""

from typing import Literal, get_args

from pydantic import Field

from sandbox.level.format.limits import SAG_LIMIT
from sandbox.level.format.quantities import Description, Gravity, Name, Seconds, Text, Velocity, empty, unit

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
    value: float = Field(
        default=1.0, ge=-1.0, le=1.0, description="How `drive` is driven: 1 forward, -1 backward, 0 not at all."
    )
    sag: float | None = Field(
        default=None,
        ge=0.0,
        le=SAG_LIMIT,
        description="How soft `body` becomes: the part of its height by which it sags where it stands.",
        json_schema_extra=empty("none"),
    )
    body: Name | None = Field(default=None, description="Body of `sag`.", json_schema_extra=empty("none"))
    gravity: Gravity | None = Field(default=None, description="Gravity changes.", json_schema_extra=empty("none"))
    wind: Velocity | None = Field(default=None, description="The wind changes.", json_schema_extra=empty("none"))
    during: Seconds = Field(default=0.0, description="Time that `sag`, `gravity` and `wind` take to come.")

    @property
    def done(self) -> tuple[Does, ...]:
        """The fields of DOES that it has: one, where it is sound."""
        return tuple(name for name in DOES if getattr(self, name) not in (None, False))


# The field that says what, for those that belong to one.
BELONGS = {
    "stars": ("win",), "by": ("count",), "value": ("drive",), "body": ("sag",), "during": ("sag", "gravity", "wind"),
}  # fmt: skip
