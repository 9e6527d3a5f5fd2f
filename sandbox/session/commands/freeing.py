"""Bodies that are stuck in others are freed."""

from dataclasses import dataclass

from sandbox.physics.components import body_of
from sandbox.physics.world import World
from sandbox.session.commands.command import Command, CommandError
from sandbox.session.commands.named import ParticleSlot


@dataclass(frozen=True)
class Free(Command):
    """Move the body of a particle to the nearest place where it touches nothing, at rest.

    The body is what springs join to the particle; if it is one solid body it gets its own form back.
    """

    type = "free"
    particle: ParticleSlot

    def carry_out(self, world: World, giver: int) -> None:
        name = world.particle_names[self.particle]
        if not world.has_contacts:
            raise CommandError("nothing touches anything here: there is nothing to free")
        # What finds contacts, which a run in which nothing touches does without.
        from sandbox.physics.changing.freeing import NothingFree, free_body

        if (world.inverse_mass[body_of(world, self.particle)] == 0.0).any():
            raise CommandError(f"the body of {name} is pinned: unpin it to free it")
        try:
            free_body(world, self.particle)
        except NothingFree:
            raise CommandError(f"there is no free place for the body of {name} near by") from None
