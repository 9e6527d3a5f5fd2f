"""Hands hold particles, move them and let go."""

from collections.abc import Hashable
from dataclasses import dataclass
from typing import Annotated

from pydantic import Field

from sandbox.level.format.quantities import Length, Point
from sandbox.physics.marks import GRAB_COUNT
from sandbox.physics.world import HAND_STRENGTH, World
from sandbox.session.commands.command import Command
from sandbox.session.commands.named import ParticleSlot

# The strongest hand [m/s^2]: more than any body bears.
STRONGEST_HAND = 1e6
Hand = Annotated[int, Field(ge=0, lt=GRAB_COUNT)]
# Largest force of a hand over the mass of the body that it holds [m/s^2].
Strength = Annotated[float, Field(gt=0.0, le=STRONGEST_HAND)]


@dataclass(frozen=True)
class Grab(Command):
    """Hold a particle with hand number `grab` (0..9) at target [m].

    strength [m/s^2]: the hand pulls with at most this times the mass of the body. radius [m]: particles of
    the body that are nearer to this one share the force, the nearer the more; 0 = it bears all of it.
    """

    type = "grab"
    grab: Hand
    particle: ParticleSlot
    target: Point
    strength: Strength = HAND_STRENGTH
    radius: Length = 0.0

    def begins(self) -> Hashable:
        return "hand", self.grab

    def ending(self, world: World) -> Command | None:
        return Release(self.grab) if world.is_held(self.grab) else None


@dataclass(frozen=True)
class MoveGrab(Command):
    """Move a hand that holds something to target [m]."""

    type = "move_grab"
    grab: Hand
    target: Point


@dataclass(frozen=True)
class Release(Command):
    """Let go of what a hand holds."""

    type = "release"
    grab: Hand
