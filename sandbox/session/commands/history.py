"""Gestures are undone and redone; the session carries it out, as only it knows them."""

from dataclasses import dataclass

from sandbox.physics.world import World
from sandbox.session.commands.command import Command, CommandError


@dataclass(frozen=True)
class HistoryCommand(Command):
    """A command about commands."""

    def carry_out(self, world: World, giver: int) -> None:
        raise CommandError(f"{type(self).__name__} is no command for a world")


@dataclass(frozen=True)
class Undo(HistoryCommand):
    """Take the last gesture back, as if it had never been made."""

    type = "undo"


@dataclass(frozen=True)
class Redo(HistoryCommand):
    """Make the gesture again that was undone last."""

    type = "redo"
