"""Coefficients of springs are set while they move."""

from dataclasses import dataclass

from sandbox.level.format.quantities import Share
from sandbox.physics.world import World
from sandbox.session.commands.command import Command
from sandbox.session.commands.named import MaterialSlot
from sandbox.session.commands.ramping import Duration


@dataclass(frozen=True)
class SetCoefficients(Command):
    """Set Cs, Cd or both (None = leave), of one material by index or of all (None), in `duration` ticks."""

    type = "set_coefficients"
    stiffness: Share | None = None
    damping: Share | None = None
    material: MaterialSlot | None = None
    duration: Duration = 0

    def carry_out(self, world: World) -> None:
        world.set_coefficients(self.stiffness, self.damping, self.material, self.duration)
