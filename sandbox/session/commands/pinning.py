"""Particles are pinned and unpinned."""

from dataclasses import dataclass

from sandbox.physics.world import World
from sandbox.session.commands.command import Command, CommandError
from sandbox.session.commands.named import ParticleSlot, particle_of


@dataclass(frozen=True)
class Pin(Command):
    """Hold a particle where it is."""

    type = "pin"
    particle: ParticleSlot

    def carry_out(self, world: World) -> None:
        name = particle_of(world, self.particle)
        if world.inverse_mass[self.particle] == 0.0:
            raise CommandError(f"{name} is pinned already")
        world.pin(self.particle)


@dataclass(frozen=True)
class Unpin(Command):
    """Let a pinned particle move."""

    type = "unpin"
    particle: ParticleSlot

    def carry_out(self, world: World) -> None:
        name = particle_of(world, self.particle)
        if world.inverse_mass[self.particle] > 0.0:
            raise CommandError(f"{name} is not pinned")
        world.unpin(self.particle)
