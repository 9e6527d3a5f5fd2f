"""Shaking: the frame that holds the world, its terrain and its pins, is moved; what can move stays behind it."""

import numpy as np

from sandbox.physics.analysis.query import shown_particles
from sandbox.physics.world import World


def shake(world: World, acceleration: tuple[float, float]) -> bool:
    """Accelerate the frame by `acceleration` [m/s^2] for the coming tick; whether there is anything that can move.

    Seen from the frame, every free particle gets what the frame's motion leaves behind, whatever its gravity scale:

        dv_i = -a / tick_rate
    """
    free = np.flatnonzero(shown_particles(world) & (world.inverse_mass > 0.0))
    if not len(free):
        return False
    change = np.array(acceleration) / world.settings.tick_rate
    for name in ("velocity", "slow_velocity"):
        world.change(name, getattr(world, name)[free] - change, free)
    world.disturb(free)
    return True
