"""Springs that yield and break by strain: looked at once, at the end of a tick, from positions alone.

Both only take energy out: a spring that yields is less strained than before, a broken one holds nothing.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.jit import kernel
from sandbox.physics.state import Floats, Slots
from sandbox.physics.world import World


class StrainedSprings(NamedTuple):
    """The arrays of springs (m,) that yielding and breaking read and change, see StateArrays; driven: never yields."""

    particle_a: NDArray[np.int32]
    particle_b: NDArray[np.int32]
    rest_length: Floats
    good_rest_length: Floats
    natural_length: Floats
    material: NDArray[np.int32]
    active: NDArray[np.bool_]
    driven: NDArray[np.bool_]


class MaterialLimits(NamedTuple):
    """Limits of strain by material, see StrainLimits."""

    tension: Floats
    compression: Floats
    yielding: Floats
    yield_share: Floats


@kernel
def _yield_and_break(position: Floats, springs: StrainedSprings, limits: MaterialLimits, broken: Slots) -> int:
    # e = (l - L) / L.  |e| > yielding: L' = l / (1 + yielding sign(e)), within L0 (1 - share)..L0 (1 + share).
    # Then e > tension or -e > compression: broken. Of rest length 0 a spring has no strain.
    count = 0
    for s in range(springs.rest_length.shape[0]):
        m = springs.material[s]
        rest = springs.rest_length[s]
        if not springs.active[s] or m < 0 or not rest > 0.0:
            continue
        a = springs.particle_a[s]
        b = springs.particle_b[s]
        dx = position[b, 0] - position[a, 0]
        dy = position[b, 1] - position[a, 1]
        length = math.sqrt(dx * dx + dy * dy)
        if not springs.driven[s]:
            yielding = limits.yielding[m]
            natural = springs.natural_length[s]
            share = limits.yield_share[m]
            if length - rest > yielding * rest:
                rest = max(rest, min(length / (1.0 + yielding), natural * (1.0 + share)))
            elif rest - length > yielding * rest:
                rest = min(rest, max(length / (1.0 - yielding), natural * (1.0 - share)))
            springs.rest_length[s] = rest
            springs.good_rest_length[s] = rest
        if length - rest > limits.tension[m] * rest or rest - length > limits.compression[m] * rest:
            broken[count] = s
            count += 1
    return count


def yield_and_break(world: World) -> None:
    """Let springs yield, then break those that are strained beyond their material's limits; `broken` holds them.

    A spring that is driven does not yield.
    """
    if len(world.broken):
        world.broken = world.broken[:0]
    limits = world.limits
    if not limits.exist:
        return
    broken = np.zeros(world.spring_count, dtype=np.int64)
    springs = StrainedSprings(
        world.particle_a, world.particle_b, world.rest_length, world.good["rest_length"], world.natural_length,
        world.material, world.spring_active, world.actuators.springs(world.spring_count),
    )  # fmt: skip
    of_material = MaterialLimits(limits.tension, limits.compression, limits.yielding, limits.yield_share)
    count = _yield_and_break(world.position, springs, of_material, broken)
    if count:
        world.break_springs(broken[:count])
