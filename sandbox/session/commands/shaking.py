"""The whole world is shaken."""

from dataclasses import dataclass

from sandbox.level.format.quantities import Gravity
from sandbox.physics.world import World
from sandbox.session.commands.command import Command, CommandError


@dataclass(frozen=True)
class Shake(Command):
    """Accelerate the frame of the world, with its terrain and pins, by this [m/s^2] for the coming tick.

    Free particles stay behind. A frame that starts and stops is one command for each tick, all of one gesture.
    """

    type = "shake"
    acceleration: Gravity
    nothing = "there is nothing that moves to be shaken"

    def carry_out(self, world: World) -> None:
        if not world.shake(self.acceleration):
            raise CommandError(self.nothing)
