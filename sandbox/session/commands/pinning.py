"""Particles are pinned and unpinned."""

from dataclasses import dataclass

from sandbox.physics.world import World
from sandbox.session.commands.command import Command
from sandbox.session.commands.conditions import pinned
from sandbox.session.commands.named import ParticleSlot


@dataclass(frozen=True)
class Pin(Command):
    """Hold a particle where it is."""

    type = "pin"
    particle: ParticleSlot
    conditions = (pinned(False, "{} is pinned already"),)

    def carry_out(self, world: World) -> None:
        world.pin(self.particle)


@dataclass(frozen=True)
class Unpin(Command):
    """Let a pinned particle move."""

    type = "unpin"
    particle: ParticleSlot
    conditions = (pinned(True, "{} is not pinned"),)

    def carry_out(self, world: World) -> None:
        world.unpin(self.particle)
