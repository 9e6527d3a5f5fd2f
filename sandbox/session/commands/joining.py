"""Bodies are added to a running world."""

from dataclasses import dataclass
from typing import Any

from sandbox.level.assembly.joining import Joiners
from sandbox.level.format.level_error import LevelError
from sandbox.physics.world import World
from sandbox.session.commands.command import Command, CommandError

Definition = dict[str, Any]


@dataclass(frozen=True)
class AddBody(Command):
    """Add a body, as a level file defines it; it is named +1, +2, ... in order of adding.

    others: further bodies that belong to it, the next in order; springs, welds: between these bodies, which go by their
    ids in the definition; materials: those that the world does not have.
    """

    type = "add_body"
    body: Definition
    others: tuple[Definition, ...] | None = None
    springs: tuple[Definition, ...] | None = None
    welds: tuple[tuple[str, str], ...] | None = None
    materials: dict[str, Any] | None = None

    def carry_out(self, world: World, giver: int) -> None:
        given = {name: value for name, value in vars(self).items() if value is not None}
        try:
            Joiners(world, given).join(world)
        except LevelError as error:
            raise CommandError(str(error)) from None
