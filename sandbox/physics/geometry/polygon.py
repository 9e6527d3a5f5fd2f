"""Polygons: signed areas, counter-clockwise above 0, and how often sides run round a place."""

import numpy as np

from sandbox.physics.arrays import FloatRows, Floats
from sandbox.physics.geometry.segment import doubled_area_of, doubled_areas
from sandbox.physics.jit import inlined_kernel, inner_kernel


@inner_kernel
def polygon_area(place: FloatRows, first: int, last: int) -> float:
    """Signed area [m^2] of the polygon of the corners first..last at place (q, 2)."""
    total = 0.0
    for c in range(first + 1, last - 1):
        total += 0.5 * doubled_area_of(first, c, c + 1, place)
    return total


@inlined_kernel
def winding_of_side(is_below_a: bool, is_below_b: bool, area: float) -> int:
    """What a side from a to b adds to the winding number of a place, by which of the two are below that.

    area: the `doubled_area` of a, b and the place. A ray to the right meets what rises with the place on its left, and
    what falls with it on its right.
    """
    if is_below_a and not is_below_b and area > 0.0:
        return 1
    if is_below_b and not is_below_a and area < 0.0:
        return -1
    return 0


def winding_number(place: Floats, a: Floats, b: Floats) -> int:
    """How often sides from a to b (k, 2) run round a place (2,) counter-clockwise."""
    below, area = (a[:, 1] <= place[1], b[:, 1] <= place[1]), doubled_areas(a, b, place)
    return int(np.count_nonzero(below[0] & ~below[1] & (area > 0.0))) - int(
        np.count_nonzero(below[1] & ~below[0] & (area < 0.0))
    )


def signed_area(a: Floats, b: Floats) -> float:
    """Signed area [m^2] inside closed lines, whose sides are a to b (k, 2)."""
    return 0.5 * float(np.sum(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]))
