"""SagCurve: how far a body sags at any Cs and Cd of its springs, from a few runs of its own solver.

What it stands at is held by Cs / (1 - y Cd) alone. In the direct solver y is 1; the iterative ones take a part of the
damping from what stands, and runs at two Cd tell which.
"""

from dataclasses import dataclass

import numpy as np

from sandbox.physics.arrays import Floats
from sandbox.physics.equation import HIGHEST_COEFFICIENT

# Cs below this counts as this.
_LEAST = 1e-12


@dataclass(frozen=True)
class SagCurve:
    """Sags, a share of its length, over softness (1 - y Cd) / Cs in a substep, both ascending; y: `damping_share`."""

    damping_share: float
    softness: tuple[float, ...]
    sag: tuple[float, ...]

    def softness_of(self, stiffness: Floats, damping: Floats) -> Floats:
        """The softness (k,) of springs of Cs and Cd (k,) in a substep."""
        return softness_of(stiffness, damping, self.damping_share)

    def of(self, stiffness: Floats, damping: Floats) -> Floats:
        """The sag (k,) at Cs and Cd (k,) in a substep; what is softer or stiffer than any run: in proportion."""
        soft = np.log(self.softness_of(stiffness, damping))
        known, sag = np.log(self.softness), np.log(np.maximum(self.sag, 1e-12))
        beyond = np.maximum(soft - known[-1], 0.0) - np.maximum(known[0] - soft, 0.0)
        return np.asarray(np.exp(np.interp(soft, known, sag) + beyond))


def softness_of(stiffness: Floats, damping: Floats, damping_share: float) -> Floats:
    """(1 - y Cd) / Cs (k,); Cd and then Cs too are limited as the direct solver limits them."""
    capped = np.minimum(damping, HIGHEST_COEFFICIENT)
    limited = np.where(damping > HIGHEST_COEFFICIENT, np.minimum(stiffness, HIGHEST_COEFFICIENT), stiffness)
    return np.asarray((1.0 - damping_share * capped) / np.maximum(limited, _LEAST))
