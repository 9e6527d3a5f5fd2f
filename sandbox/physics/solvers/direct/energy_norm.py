"""The energy norm of a tick whose number of substeps is its own choice ("auto"): one for every number of them.

A spring's k differs by up to some factor with the number of parts. Were energy measured in the k of the moment, a body
could be pumped by changing parts: stretched with a low k, let go with a high one. So the test measures in the LEAST
k of any number of parts, and the body's bank starts with what the MOST would add, which no step can top up: kinetic
energy plus spring energy in the least k, plus the bank, never exceeds kinetic plus spring energy in the most k at the
start, and the work done since. A change of parts changes neither side.
"""

import numpy as np

from sandbox.physics.equation import capped, half_step_of_network, highest_coefficient
from sandbox.physics.jit import inner_kernel, kernel, scalar_kernel
from sandbox.physics.substeps import MOST_AUTO
from sandbox.physics.world import Floats

# Where the largest k is within this factor of the least, the norm is the k of one part: its bank has nothing to add.
SAME = 1.001


@scalar_kernel
def norm_range(stiffness: float, damping: float, lowest_mode: float) -> tuple[float, float]:
    """Least and most k h^2 / m_r of a spring over the substeps that a tick may have; h, Cs, Cd of the tick.

    lowest_mode: that of the body whose firmness they come from, 0: they are its own.
    """
    # Cs parts^2 / (1 - Cd), of the Cs and Cd of a part
    whole = 0.0
    least = 0.0
    most = 0.0
    parts = 1
    while parts <= MOST_AUTO:
        cs, cd = capped(stiffness, damping, highest_coefficient(parts))
        constant = cs / (1.0 - cd) * (parts * parts)
        if parts == 1:
            whole = constant
            least = constant
            most = constant
        least = min(least, constant)
        most = max(most, constant)
        stiffness, damping = half_step_of_network(stiffness, damping, lowest_mode)
        parts *= 2
    if most <= SAME * least:
        return whole, whole
    return least, most


@inner_kernel
def load_range(k, family, stiffness, damping, lowest_mode):  # type: ignore[no-untyped-def]
    """Bring the range of one of the springs or constraints into their scratch, anew where Cs or Cd have changed."""
    if (
        family.tick_stiffness[k] != stiffness
        or family.tick_damping[k] != damping
        or family.tick_lowest_mode[k] != lowest_mode
    ):
        family.tick_stiffness[k] = stiffness
        family.tick_damping[k] = damping
        family.tick_lowest_mode[k] = lowest_mode
        family.least[k], family.most[k] = norm_range(stiffness, damping, lowest_mode)


@kernel
def _extremes(stiffness: Floats, damping: Floats, lowest_mode: Floats, least: Floats, most: Floats) -> None:
    for s in range(stiffness.shape[0]):
        least[s], most[s] = norm_range(stiffness[s], damping[s], lowest_mode[s])


def extremes(stiffness: Floats, damping: Floats, lowest_mode: Floats) -> tuple[Floats, Floats]:
    """Least and most k h^2 / m_r of springs or constraints (m,), h of the tick, over the parts that a tick may have.

    stiffness, damping: Cs and Cd (m,) of the tick; lowest_mode (m,): see `norm_range`.
    """
    least, most = np.empty((2, len(stiffness)))
    _extremes(stiffness, damping, lowest_mode, least, most)
    return least, most
