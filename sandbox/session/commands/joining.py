"""Bodies are added to a running world."""

from dataclasses import dataclass
from typing import Any

from sandbox.level.assembly.build_world import LevelWorld
from sandbox.level.assembly.joining import join_definition
from sandbox.level.format.level_error import LevelError
from sandbox.session.commands.command import Command, CommandError
from sandbox.session.commands.named import ParticleSlot

Definition = dict[str, Any]


@dataclass(frozen=True)
class AddBody(Command):
    """Add a body, as a level file defines it, or a kit of bodies; it is named +1, +2, ... in order of adding.

    others: further bodies that belong to it, the next in order; springs, welds: between these bodies, which go by their
    ids in the definition; materials: those that the world does not have. kit: bodies as rows, in place of all these.
    passes: where it is said, the bodies have a collision group of their own, if one is free, and touch nothing of the
    groups of these particles: () passes nothing yet, but what comes later may pass it.
    """

    type = "add_body"
    body: Definition | None = None
    others: tuple[Definition, ...] | None = None
    springs: tuple[Definition, ...] | None = None
    welds: tuple[tuple[str, str], ...] | None = None
    materials: dict[str, Any] | None = None
    kit: Definition | None = None
    passes: tuple[ParticleSlot, ...] | None = None

    def carry_out(self, world: LevelWorld, giver: int) -> None:
        fields = {name: value for name, value in vars(self).items() if value is not None}
        if ("kit" in fields) == ("body" in fields) or ("kit" in fields and len(fields) > 1):
            raise CommandError("say body, or kit: one of the two")
        try:
            join_definition(world, fields, giver)
        except LevelError as error:
            raise CommandError(str(error)) from None
