"""Shaking: moves the frame that holds the world, its terrain and its pins; free particles stay behind."""

import numpy as np

from sandbox.physics.analysis.query import shown_particles
from sandbox.physics.world import World


def shake(world: World, acceleration: tuple[float, float]) -> bool:
    """Accelerate the frame by `acceleration` [m/s^2] for the coming tick; False: nothing can move.

    Seen from the frame, every free particle gets the opposite velocity, for any gravity scale:

        dv_i = -a / tick_rate
    """
    free = np.flatnonzero(shown_particles(world) & (world.inverse_mass > 0.0))
    if not len(free):
        return False
    dv = np.array(acceleration) / world.settings.tick_rate
    for name in ("velocity", "slow_velocity"):
        world.change(name, getattr(world, name)[free] - dv, free)
    world.disturb(free)
    return True
