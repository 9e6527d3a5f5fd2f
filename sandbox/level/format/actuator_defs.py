"""Models of actuators: muscles, hydraulics and motors."""

from pydantic import Field

from sandbox.level.format.quantities import (
    Amplitude,
    Description,
    Force,
    Key,
    Period,
    Phase,
    Rate,
    Size,
    Torque,
    TurnRate,
    empty,
)


class MuscleDef(Description):
    """A muscle: its rest length follows a wave of two parabolas a period, one up and one down, much like a sine."""

    amplitude: Amplitude = Field(
        description="How far the rest length swings either way, as a share of the rest length."
    )
    period: Period = Field(description="Ticks from one swing to the next. The wave repeats exactly.")
    phase: Phase = Field(
        default=0.0, description="How far ahead the wave is, as a share of a period. At 0 it begins to lengthen."
    )
    force: Force | None = Field(
        default=None, description="Largest force of each spring.", json_schema_extra=empty("no limit")
    )


class _KeyedDef(Description):
    """Base of actuators that keys and commands drive."""

    key: Key | None = Field(
        default=None,
        description="Key that drives it forward while a player holds it: a letter, a digit, or the arrow `left`, "
        "`right`, `up` or `down`.",
        json_schema_extra=empty("none"),
    )
    reverse_key: Key | None = Field(
        default=None, description="Key that drives it backward.", json_schema_extra=empty("none")
    )


class HydraulicDef(_KeyedDef):
    """A hydraulic: its rest length moves between two lengths at a rate while a key or command drives it."""

    shortest: Size = Field(description="Shortest rest length. It begins here if the spring has no `rest_length`.")
    longest: Size = Field(description="Longest rest length.")
    rate: Rate = Field(description="How fast the rest length grows while it is driven forward.")
    force: Force | None = Field(default=None, description="Largest force.", json_schema_extra=empty("no limit"))
    returns: bool = Field(
        default=False,
        description="Whether it goes back to its first length, at the same rate, while nothing drives it.",
    )


class MotorDef(_KeyedDef):
    """A motor turns a wheel about its hub. What springs join to the hub takes the reaction."""

    speed: TurnRate = Field(
        description="Turning rate relative to what the hub is fixed to; counter-clockwise is positive."
    )
    torque: Torque = Field(description="Largest torque. The motor gives less where less is enough.")
