"""CoefficientScale: where on an axis from little to 1 a coefficient lies, so that equal steps make an equal difference.

By Cs where that is small and by 1 - Cs where it is near 1: what is seen goes by Cs / (1 - Cd).
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from sandbox.physics.arrays import Floats

# Sags (k,) of pairs of Cs and Cd (k,) each.
SagOf = Callable[[Floats, Floats], Floats]
# Values that have a number on an axis, where there is room.
NUMBERED = (1e-5, 1e-4, 1e-3, 3e-3, 0.01, 0.03, 0.1, 0.3, 0.5, 0.7, 0.9, 0.97, 0.99, 0.997, 0.999, 1.0)
# Significant digits of a value, or of what it is below 1 by.
DIGITS = 3
# The last part of an axis is 1 itself.
END = 0.997


@dataclass(frozen=True)
class CoefficientScale:
    """An axis from `lowest` to 1; `rest`: what 1 - value fades out at, the less the wider the last tenth."""

    lowest: float
    rest: float

    def _height(self, value: float | Floats) -> Floats:
        return np.log10(np.asarray(value) / (1.0 - np.asarray(value) + self.rest))

    @property
    def _ends(self) -> tuple[float, float]:
        return float(self._height(self.lowest)), -math.log10(self.rest)

    def place_of(self, value: float) -> float:
        """Where on the axis (0..1) a value lies; values below it, 0 among them, lie at its start."""
        if value <= self.lowest:
            return 0.0
        low, high = self._ends
        return min((float(self._height(min(value, 1.0))) - low) / (high - low), 1.0)

    def values(self, count: int) -> Floats:
        """Values (count,) at equal distances, from the lowest to 1."""
        power = 10.0 ** np.linspace(*self._ends, count)
        return np.minimum(1.0, power * (1.0 + self.rest) / (1.0 + power))

    def value_at(self, place: float) -> float:
        """The value at a place on the axis, in three significant digits, of 1 - value where that is small."""
        if place >= END:
            return 1.0
        low, high = self._ends
        power = 10.0 ** (low + max(place, 0.0) * (high - low))
        value = min(1.0, power * (1.0 + self.rest) / (1.0 + power))
        if value < 0.9:
            return float(f"{value:.{DIGITS}g}")
        below = float(f"{1.0 - value:.{DIGITS - 1}g}")
        return round(1.0 - below, 9)

    def numbers(self) -> list[float]:
        """The values with a number that lie on it."""
        return [value for value in NUMBERED if value >= self.lowest * 0.999]


# Where nothing is known of what is seen.
PLAIN = CoefficientScale(0.003, 0.02)
# Softest ends and widths of the last tenth that an axis may have.
_LOWEST, _RESTS = (0.03, 0.01, 0.003, 0.001, 3e-4, 1e-4), (0.1, 0.03, 0.01, 0.003, 0.001, 0.0003)
# From 0.9 to 1 is this share of an axis at least: a thumb of a pad as wide as the panel.
_THUMB = 0.13
ALIVE = (0.005, 1.0)
_SAMPLES = 40


def scale_for(sag_of: SagOf, includes: tuple[float, ...]) -> CoefficientScale:
    """The axis for Cs and Cd on which most pairs sag by what can be seen, and that has these values on it."""
    best, most = PLAIN, -1.0
    for lowest in _LOWEST:
        if any(0.0 < value < lowest for value in includes):
            continue
        for rest in _RESTS:
            scale = CoefficientScale(lowest, rest)
            if 1.0 - scale.place_of(0.9) < _THUMB:
                continue
            alive = share_alive(scale, sag_of)
            if alive > most + 0.01:
                best, most = scale, alive
    return best


def share_alive(scale: CoefficientScale, sag_of: SagOf) -> float:
    """The share of a pad of this axis both ways on which what is seen sags by a half to a hundred per cent."""
    values = scale.values(_SAMPLES)
    stiffness, damping = (axis.reshape(-1) for axis in np.meshgrid(values, values, indexing="ij"))
    sag = sag_of(stiffness, damping)
    return float(np.mean((sag > ALIVE[0]) & (sag < ALIVE[1])))
