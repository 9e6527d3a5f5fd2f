"""Pools and hulls of a world, as kernels read them: tables that never change while it runs."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from sandbox.physics.arrays import FloatRows, SlotRows

# Columns of a pool: left, bottom, right, top [m]; density [kg/m^2]; fast drag, of the square of the speed; slow drag
# [m/s], of the speed; flow [m/s] (2).
LEFT, BOTTOM, RIGHT, TOP, DENSITY, FAST, SLOW, FLOW_X, FLOW_Y, POOL_NUMBERS = range(10)
# Columns of a hull's spring: number of the hull, the spring, and whether what the hull encloses lies on the left of
# its way from the second end to the first.
HULL, SPRING, TURNED, HULL_NUMBERS = range(4)

NO_POOLS: FloatRows = np.zeros((0, POOL_NUMBERS))
NO_HULLS: SlotRows = np.zeros((0, HULL_NUMBERS), np.int64)


class Pool(NamedTuple):
    """Water in a box: left, bottom, right, top [m], of a density [kg/m^2], whose surface is the top.

    fast_drag: a coefficient C; slow_drag [m/s]; flow [m/s]. See push.py.
    """

    box: tuple[float, float, float, float]
    density: float
    fast_drag: float
    slow_drag: float
    flow: tuple[float, float]


def pools_of(pools: Sequence[Pool]) -> FloatRows:
    """Pools as kernels read them (w, POOL_NUMBERS)."""
    rows = [(*pool.box, pool.density, pool.fast_drag, pool.slow_drag, *pool.flow) for pool in pools]
    # Adding 0.0 turns -0.0 into 0.0.
    return np.array(rows, np.float64).reshape(-1, POOL_NUMBERS) + 0.0
