"""Keys that rules ask for are pressed and let go."""

from collections.abc import Hashable
from dataclasses import dataclass

from sandbox.physics.world import World
from sandbox.session.commands.command import Command
from sandbox.session.commands.named import KeySlot


@dataclass(frozen=True)
class HoldKey(Command):
    """Press a key that a rule of the level asks for, or let it go."""

    type = "hold_key"
    key: KeySlot
    down: bool

    def begins(self) -> Hashable:
        return "key", self.key

    def ending(self, world: World) -> Command | None:
        return HoldKey(self.key, False) if self.down else None
