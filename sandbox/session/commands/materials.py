"""What things are made of is changed while they move: Cs and Cd of springs, and masses."""

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from pydantic import Field

from sandbox.level.format.limits import MASS_RANGE
from sandbox.level.format.quantities import Share
from sandbox.physics.world import World
from sandbox.session.commands.command import Command, CommandError
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

    def carry_out(self, world: World) -> None:
        world.set_coefficients(self.stiffness, self.damping, self.material, self.duration)


@dataclass(frozen=True)
class ScaleMass(Command):
    """Make every particle of the body of a particle so many times as heavy, pinned ones too; velocities stay.

    Springs of the body keep Cs and Cd, so that it is as soft as it was.
    """

    type = "scale_mass"
    particle: ParticleSlot
    factor: Annotated[float, Field(gt=0.0, le=1000.0)]

    def carry_out(self, world: World) -> None:
        body = np.flatnonzero(world.particle_active & (world.owner == world.owner[self.particle]))
        masses = world.mass[body] * self.factor
        least, most = MASS_RANGE
        if not ((masses >= least) & (masses <= most)).all():
            raise CommandError(f"{world.particle_names[self.particle]}: a mass is from {least:g} to {most:g} kg")
        free = body[world.inverse_mass[body] > 0.0]
        world.change("mass", masses, body)
        world.change("inverse_mass", 1.0 / world.mass[free], free)
        world.disturb(body)
