"""Particles are pinned and unpinned."""

from dataclasses import dataclass

from sandbox.session.commands.command import Command
from sandbox.session.commands.named import ParticleSlot


@dataclass(frozen=True)
class Pin(Command):
    """Hold a particle where it is."""

    type = "pin"
    particle: ParticleSlot


@dataclass(frozen=True)
class Unpin(Command):
    """Let a pinned particle move."""

    type = "unpin"
    particle: ParticleSlot
