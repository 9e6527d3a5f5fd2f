"""Points and pairs for the forms of several kinds: rows, chains, rings and spokes."""

import math

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.geometry.segment import lengths

Points = NDArray[np.float64]
Pairs = NDArray[np.int64]

# Sine and cosine are rounded to this many decimals, so that different libraries of mathematics build the same bits.
TRIGONOMETRY_DECIMALS = 12


def distances(points: Points, pairs: Pairs) -> Points:
    """Distance [m] (m,) of the two particles of each pair."""
    return lengths(points[pairs[:, 1]] - points[pairs[:, 0]])


def turn(angle: float) -> tuple[float, float]:
    """Cosine and sine of an angle [rad], rounded."""
    return round(math.cos(angle), TRIGONOMETRY_DECIMALS), round(math.sin(angle), TRIGONOMETRY_DECIMALS)


def row(start: tuple[float, float], end: tuple[float, float], segments: int) -> Points:
    """Places [m] (segments + 1, 2), evenly from start to end."""
    steps = np.arange(segments + 1, dtype=np.float64)
    x = start[0] + (end[0] - start[0]) * steps / segments
    y = start[1] + (end[1] - start[1]) * steps / segments
    places = np.stack([x, y], axis=1)
    places[-1] = end
    return places


def chain(segments: int) -> Pairs:
    """Pairs (segments, 2) of neighbours in a row of particles."""
    first = np.arange(segments, dtype=np.int64)
    return np.stack([first, first + 1], axis=1)


def spokes(angle: float, count: int) -> Points:
    """Unit vectors (count, 2) all around, counter-clockwise from an angle [rad]."""
    return np.array([turn(angle + math.tau * spoke / count) for spoke in range(count)])


def ring(first: int, size: int) -> Pairs:
    """Pairs (size, 2) of neighbours in a ring of particles; first: index of the first one."""
    spoke = np.arange(size, dtype=np.int64)
    return first + np.stack([spoke, (spoke + 1) % size], axis=1)
