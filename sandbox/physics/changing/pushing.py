"""Pushing: an impulse on everything near a place, as a gust of wind or a burst gives it. No part of a tick."""

import numpy as np

from sandbox.physics.analysis.query import shown_particles
from sandbox.physics.geometry.sums import sum_in_order
from sandbox.physics.world import World


def push(world: World, place: tuple[float, float], impulse: tuple[float, float], outward: float, radius: float) -> bool:
    """Give the free particles nearer to place [m] than radius [m] an impulse [N s] together; False: there are none.

    outward [N s]: the sum of the impulses that also drive each one straight away from the place. A particle at a
    distance d gets the velocity

        dv_i = (J + outward n_i) w_i / sum m w,     w_i = 1 - (d_i / radius)^2

    so that what is near moves more, whatever its mass, and the momentum grows by J.
    """
    away = world.position - np.array(place)
    squares = away[:, 0] * away[:, 0] + away[:, 1] * away[:, 1]
    with np.errstate(over="ignore", invalid="ignore"):
        near = shown_particles(world) & (world.inverse_mass > 0.0) & (squares < radius * radius)
    pushed = np.flatnonzero(near)
    if not len(pushed):
        return False
    weight = 1.0 - squares[pushed] / (radius * radius)
    total = sum_in_order(world.mass[pushed] * weight)
    distance = np.sqrt(squares[pushed])
    share = np.divide(outward, distance, out=np.zeros_like(distance), where=distance > 0.0)
    dv = (np.array(impulse) + share[:, None] * away[pushed]) * (weight / total)[:, None]
    for name in ("velocity", "slow_velocity"):
        world.change(name, getattr(world, name)[pushed] + dv, pushed)
    world.disturb(pushed)
    return True
