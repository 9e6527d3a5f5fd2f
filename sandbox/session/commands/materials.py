"""What things are made of is changed while they move: Cs and Cd of springs, and masses."""

from dataclasses import dataclass
from typing import Annotated

from pydantic import Field

from sandbox.level.format.quantities import Share
from sandbox.session.commands.command import Command
from sandbox.session.commands.named import MaterialSlot, ParticleSlot
from sandbox.session.commands.ramping import Duration


@dataclass(frozen=True)
class SetCoefficients(Command):
    """Set Cs, Cd or both (None = leave), of one material by index or of all (None), in `duration` ticks."""

    type = "set_coefficients"
    stiffness: Share | None = None
    damping: Share | None = None
    material: MaterialSlot | None = None
    duration: Duration = 0


@dataclass(frozen=True)
class ScaleMass(Command):
    """Make every particle of the body of a particle so many times as heavy, pinned ones too; velocities stay.

    Springs of the body keep Cs and Cd, so that it is as soft as it was.
    """

    type = "scale_mass"
    particle: ParticleSlot
    factor: Annotated[float, Field(gt=0.0, le=1000.0)]
