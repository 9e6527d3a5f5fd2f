"""Actuators are driven."""

from collections.abc import Hashable
from dataclasses import dataclass

from sandbox.level.format.quantities import Drive
from sandbox.physics.world import World
from sandbox.session.commands.command import Command
from sandbox.session.commands.named import PartSlot


@dataclass(frozen=True)
class SetDrive(Command):
    """Drive a part, a motor or hydraulic, forward (1), backward (-1), slower, or not at all (0)."""

    type = "set_drive"
    part: PartSlot
    value: Drive

    def begins(self) -> Hashable:
        return "drive", self.part

    def ending(self, world: World) -> Command | None:
        return SetDrive(self.part, 0.0) if self.value != 0.0 else None
