"""Models of what is driven: muscles, hydraulics and motors."""

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
)


class MuscleDef(Description):
    """A wave of the rest length: two parabolas a period, one up and one down, much like a sine."""

    amplitude: Amplitude = Field(description="How far the rest length swings either way, as a share of it.")
    period: Period = Field(description="Ticks from one swing to the next; it repeats exactly.")
    phase: Phase = Field(default=0.0, description="Part of a period that the wave is ahead; 0 = begins to lengthen.")
    force: Force | None = Field(default=None, description="Largest force of each spring; null = any.")


class _KeyedDef(Description):
    """What can be driven by keys or commands."""

    key: Key | None = Field(
        default=None,
        description="Key that drives it while held down: a letter, a digit, or the arrow left, right, up or down.",
    )
    reverse_key: Key | None = Field(default=None, description="Key that drives it the other way.")


class HydraulicDef(_KeyedDef):
    """A rest length that goes from one length to another at a rate, while a key or command drives it."""

    shortest: Size = Field(description="Least rest length; where it begins, if the spring has no `rest_length`.")
    longest: Size = Field(description="Largest rest length.")
    rate: Rate = Field(description="How fast the rest length grows while driven forward.")
    force: Force | None = Field(default=None, description="Largest force; null = any.")
    returns: bool = Field(
        default=False,
        description="Whether it goes back to the length where it began, as fast, while nothing drives it; false = it "
        "stays.",
    )


class MotorDef(_KeyedDef):
    """Turns a wheel about its hub; what springs join to the hub takes the reaction."""

    speed: TurnRate = Field(description="Turning rate against what the hub is fixed to, counter-clockwise.")
    torque: Torque = Field(description="Largest torque; it gives less where less is needed.")
