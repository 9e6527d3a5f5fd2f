"""Bodies that are stuck in others are freed."""

from dataclasses import dataclass

from sandbox.session.commands.command import Command
from sandbox.session.commands.named import ParticleSlot


@dataclass(frozen=True)
class Free(Command):
    """Move the body of a particle to the nearest place where it touches nothing, at rest.

    The body is what springs join to the particle; if it is one solid body it gets its own form back.
    """

    type = "free"
    particle: ParticleSlot
