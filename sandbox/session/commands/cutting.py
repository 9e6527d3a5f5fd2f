"""Springs are cut."""

from dataclasses import dataclass

from sandbox.session.commands.command import Command
from sandbox.session.commands.named import SpringSlot


@dataclass(frozen=True)
class CutSprings(Command):
    """Take springs out of the world."""

    type = "cut_springs"
    springs: tuple[SpringSlot, ...]
