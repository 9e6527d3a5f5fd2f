"""The measure of energy of a tick whose number of parts is its own choice ("auto"): one for every number of parts.

A spring's k differs by up to some factor with the number of parts. Were energy measured in the k of the moment, a body
could be pumped by changing parts: stretched with a low k, let go with a high one. So the test measures in the LEAST
k of any number of parts, and the body's bank starts with what the MOST would add, which no step can top up: kinetic
energy plus spring energy in the least k, plus the bank, never exceeds kinetic plus spring energy in the most k at the
start, and the work done since. A change of parts changes neither side.
"""

import numpy as np

from sandbox.physics.equation import half_step
from sandbox.physics.jit import kernel
from sandbox.physics.solvers.direct.constraint_terms import HIGHEST_COEFFICIENT
from sandbox.physics.substeps import MOST_AUTO
from sandbox.physics.world import Floats

# Where the largest k is within this factor of the least, the measure is the k of one part: its bank has nothing to add.
SAME = 1.001


@kernel
def _extremes(stiffness, damping, highest, most_parts, least, most):  # type: ignore[no-untyped-def]
    # Least and most of k h^2 / m_r (h of the tick) of each spring over its parts, from Cs and Cd of the tick.
    for s in range(stiffness.shape[0]):
        if s > 0 and stiffness[s] == stiffness[s - 1] and damping[s] == damping[s - 1]:
            least[s] = least[s - 1]
            most[s] = most[s - 1]
            continue
        cs = stiffness[s]
        cd = damping[s]
        whole = 0.0
        parts = 1
        while parts <= most_parts:
            cap = 1.0 - (1.0 - highest) * (parts * parts)
            constant = (min(cs, cap) if cd > cap else cs) / (1.0 - min(cd, cap)) * (parts * parts)
            if parts == 1:
                whole = constant
                least[s] = constant
                most[s] = constant
            least[s] = min(least[s], constant)
            most[s] = max(most[s], constant)
            cs, cd = half_step(cs, cd)
            parts *= 2
        if most[s] <= SAME * least[s]:
            least[s] = whole
            most[s] = whole


def extremes(stiffness: Floats, damping: Floats) -> tuple[Floats, Floats]:
    """Least and most k h^2 / m_r of springs or elements (m,), h of the tick, over the parts that a tick may have.

    stiffness, damping: Cs and Cd (m,) of the tick.
    """
    least, most = np.empty((2, len(stiffness)))
    _extremes(stiffness, damping, HIGHEST_COEFFICIENT, MOST_AUTO, least, most)
    return least, most


def cap(stiffness: Floats, damping: Floats, parts: int) -> tuple[Floats, Floats]:
    """Cs and Cd (m,) of one of `parts` substeps, capped so that a rigid spring has the k of one part."""
    if parts == 1:
        return stiffness, damping
    highest = 1.0 - (1.0 - HIGHEST_COEFFICIENT) * (parts * parts)
    return np.where(damping > highest, np.minimum(stiffness, highest), stiffness), np.minimum(damping, highest)
