"""SpringMotion: how one spring of some Cs and Cd, or a wobble, visibly moves: it swings or creeps back.

An error x of the equation, let go, follows  x'' = (2 - Cs - Cd) x' - (1 - Cd) x  from step to step.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.equation import frequency_from_coefficients

# It is at rest once no error above this share of the first is left.
AT_REST = 0.02
# Steps that are looked at one by one; what takes longer is known by its slowest part alone.
LONGEST = 100_000


@dataclass(frozen=True)
class SpringMotion:
    """How an error goes back: hz, ratio: frequency [Hz] without damping, and damping ratio; inf where Cd is 1.

    swings: whether it crosses zero; half, rest [s]: when half of it, and when all but AT_REST is gone for good, inf:
    never.
    """

    hz: float
    ratio: float
    swings: bool
    half: float
    rest: float


def motion_of(stiffness: float, damping: float, h: float) -> SpringMotion:
    """That of one spring of Cs and Cd in steps of h [s]."""
    hz, ratio = frequency_from_coefficients(stiffness, damping, h)
    swings = bool(swings_back(np.array(stiffness), np.array(damping)))
    if stiffness <= 0.0:
        return SpringMotion(hz, ratio, False, math.inf, math.inf)
    return SpringMotion(
        hz, ratio, bool(swings), h * _last_above(stiffness, damping, 0.5), h * _last_above(stiffness, damping, AT_REST)
    )


def swings_back(stiffness: NDArray[np.float64], damping: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Whether a spring of each Cs and Cd crosses its length: its roots are no positive numbers."""
    # (Cs + Cd)^2 < 4 Cs, or both roots are below 0
    total = stiffness + damping
    return np.asarray((total * total < 4.0 * stiffness) | (total > 2.0))


def errors_of(stiffness: float, damping: float, steps: int) -> NDArray[np.float64]:
    """Error (steps + 1,) of one spring that is let go from an error of 1, step by step."""
    first, second = _roots(stiffness, damping)
    n = np.arange(steps + 1)
    if abs(first - second) < 1e-9:
        # x_n = (1 + n (1 - r)) r^n of equal roots
        return np.asarray(((1.0 + n * (1.0 - first)) * first**n).real)
    # x_0 = 1, x_1 = 1 - Cs
    share = (1.0 - stiffness - second) / (first - second)
    return np.asarray((share * first**n + (1.0 - share) * second**n).real)


def _roots(stiffness: float, damping: float) -> tuple[complex, complex]:
    # Roots 1 - s of r^2 - (2 - Cs - Cd) r + (1 - Cd), from s^2 - (Cs + Cd) s + Cs: small ones keep their digits.
    total = stiffness + damping
    apart = complex(total * total - 4.0 * stiffness) ** 0.5
    quick = 0.5 * (total + apart)
    slow = stiffness / quick if quick else 0.0
    return complex(1.0 - slow), complex(1.0 - quick)


def _last_above(stiffness: float, damping: float, share: float) -> float:
    """Steps until no error above a share is left; inf: never."""
    slow = max(map(abs, _roots(stiffness, damping)))
    if slow >= 1.0:
        return math.inf
    if slow == 0.0:
        return 1.0
    # Where it creeps the first part of it is larger than the whole; where it swings, crossing takes it below.
    first, second = _roots(stiffness, damping)
    amount = abs((1.0 - stiffness - second) / (first - second)) if first != second else 1.0
    steps = math.log(share / max(amount, 1.0)) / math.log(slow) + 1.0
    if steps > LONGEST:
        return steps
    errors = np.abs(errors_of(stiffness, damping, 2 * math.ceil(steps) + 8))
    return float(np.flatnonzero(errors > share)[-1] + 1)
