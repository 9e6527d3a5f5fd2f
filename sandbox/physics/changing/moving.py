"""Moving: puts everything that hangs together somewhere else at once. Not part of a tick: a person asks for it."""

import numpy as np

from sandbox.physics.components import body_of
from sandbox.physics.keeping import arguments
from sandbox.physics.marks import BANK_UNOPENED
from sandbox.physics.world import World


def move_body(world: World, particle: int, by: tuple[float, float], limit: float, at_rest: bool = False) -> bool:
    """Move all that springs join to a particle by a way [m]; False, and nothing is moved, where it ends beyond limit
    [m]. at_rest: it stands still there. Raises IndexError and ValueError."""
    by = arguments.point("by", by)
    body = body_of(world, particle)
    places = world.position[body] + np.array(by)
    if not (np.abs(places) <= limit).all():
        return False
    world.change("position", places, body)
    if at_rest:
        world.change("velocity", 0.0, body)
        world.slow_velocity[body] = 0.0
    world.energy_bank[body] = BANK_UNOPENED
    return True
