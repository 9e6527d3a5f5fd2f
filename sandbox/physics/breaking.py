"""Springs that yield and break by strain: looked at once, at the end of a tick, from positions alone.

Both only take energy out: a spring that yields is less strained than before, a broken one holds nothing.
"""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from sandbox.physics.arrays import Flags, Floats, Slots
from sandbox.physics.jit import inner_kernel
from sandbox.physics.state import GoodValues, State

NEVER = np.inf


@dataclass(frozen=True, eq=False)
class StrainLimits:
    """Strains at which springs break or yield, one row for each material (k,); infinite = never.

    tension, compression: a spring breaks beyond; yielding: beyond it the rest length follows, by at most the share
    yield_share of the natural length either way.
    """

    tension: Floats
    compression: Floats
    yielding: Floats
    yield_share: Floats

    @cached_property
    def exist(self) -> bool:
        """Whether any spring can break or yield."""
        return bool(np.isfinite(self.tension).any() or np.isfinite(self.compression).any() or self.yields)

    @cached_property
    def yields(self) -> bool:
        """Whether any spring can yield."""
        return bool(np.isfinite(self.yielding).any())


class MaterialLimits(NamedTuple):
    """Limits of strain by material (k,), see StrainLimits; no rows: nothing yields or breaks.

    driven (m,): springs that never yield. broken (m,): filled in with those that broke.
    """

    tension: Floats
    compression: Floats
    yielding: Floats
    yield_share: Floats
    driven: Flags
    broken: Slots


def unlimited(materials: int) -> StrainLimits:
    """Limits of a number of materials that neither break nor yield."""
    never = np.full(materials, NEVER)
    return StrainLimits(never, never, never, np.zeros(materials))


@inner_kernel
def yield_and_break(state: State, good: GoodValues, limits: MaterialLimits) -> int:
    """Let springs yield, then find those that are strained beyond their material's limits; how many are in `broken`.

    e = (l - L) / L.  |e| > yielding: L' = l / (1 + yielding sign(e)), within L0 (1 - share)..L0 (1 + share).
    Then e > tension or -e > compression: broken. Of rest length 0 a spring has no strain.
    """
    count = 0
    if limits.tension.shape[0] == 0:
        return count
    for s in range(state.rest_length.shape[0]):
        m = state.material[s]
        rest = state.rest_length[s]
        if not state.spring_active[s] or m < 0 or not rest > 0.0:
            continue
        a, b = state.particle_a[s], state.particle_b[s]
        dx, dy = state.position[b, 0] - state.position[a, 0], state.position[b, 1] - state.position[a, 1]
        length = math.sqrt(dx * dx + dy * dy)
        if not limits.driven[s]:
            yielding = limits.yielding[m]
            natural = state.natural_length[s]
            share = limits.yield_share[m]
            if length - rest > yielding * rest:
                rest = max(rest, min(length / (1.0 + yielding), natural * (1.0 + share)))
            elif rest - length > yielding * rest:
                rest = min(rest, max(length / (1.0 - yielding), natural * (1.0 - share)))
            state.rest_length[s] = rest
            good.rest_length[s] = rest
        if length - rest > limits.tension[m] * rest or rest - length > limits.compression[m] * rest:
            limits.broken[count] = s
            count += 1
    return count
