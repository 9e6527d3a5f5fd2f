"""The whole world is shaken."""

from dataclasses import dataclass

from sandbox.level.format.quantities import Gravity
from sandbox.session.commands.command import Command


@dataclass(frozen=True)
class Shake(Command):
    """Accelerate the frame of the world, with its terrain and pins, by this [m/s^2] for the coming tick.

    Free particles stay behind. A frame that starts and stops is one command for each tick, all of one gesture.
    """

    type = "shake"
    acceleration: Gravity
