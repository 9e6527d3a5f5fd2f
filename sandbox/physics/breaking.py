"""Springs that yield and break by strain: looked at once, at the end of a tick, from positions alone.

Both only take energy out: a spring that yields is less strained than before, a broken one holds nothing.
"""

import math

import numpy as np

from sandbox.physics.jit import kernel
from sandbox.physics.world import World


@kernel
def _yield_and_break(  # type: ignore[no-untyped-def]
    position, particle_a, particle_b, rest_length, good_rest_length, natural_length, material, spring_active, driven,
    tension, compression, yielding, yield_share, broken,
):  # fmt: skip
    # e = (l - L) / L.  |e| > yielding: L' = l / (1 + yielding sign(e)), within L0 (1 - share)..L0 (1 + share).
    # Then e > tension or -e > compression: broken. Of rest length 0 a spring has no strain.
    count = 0
    for s in range(rest_length.shape[0]):
        m = material[s]
        rest = rest_length[s]
        if not spring_active[s] or m < 0 or not rest > 0.0:
            continue
        a = particle_a[s]
        b = particle_b[s]
        dx = position[b, 0] - position[a, 0]
        dy = position[b, 1] - position[a, 1]
        length = math.sqrt(dx * dx + dy * dy)
        if not driven[s]:
            if length - rest > yielding[m] * rest:
                rest = max(rest, min(length / (1.0 + yielding[m]), natural_length[s] * (1.0 + yield_share[m])))
            elif rest - length > yielding[m] * rest:
                rest = min(rest, max(length / (1.0 - yielding[m]), natural_length[s] * (1.0 - yield_share[m])))
            rest_length[s] = rest
            good_rest_length[s] = rest
        if length - rest > tension[m] * rest or rest - length > compression[m] * rest:
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
    count = _yield_and_break(
        world.position, world.particle_a, world.particle_b, world.rest_length, world.good["rest_length"],
        world.natural_length, world.material, world.spring_active, world.actuators.springs(world.spring_count),
        limits.tension, limits.compression, limits.yielding, limits.yield_share, broken,
    )  # fmt: skip
    if count:
        world.break_springs(broken[:count])
