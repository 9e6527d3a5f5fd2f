"""Segments, triangles and polygons in the plane: parts of kernels, and their twins for arrays of places (..., 2).

Signed areas are above 0 counter-clockwise.
"""

import math

import numpy as np

from sandbox.physics.arrays import FloatRows, Floats
from sandbox.physics.jit import inlined_kernel, inner_kernel

# Below this length [m] a segment has no direction of its own; squares of smaller numbers underflow.
SHORTEST = 1e-150
# A segment whose length squared is below this [m^2] is a point.
LEAST_SQUARE = 1e-300


@inlined_kernel
def doubled_area(ax: float, ay: float, bx: float, by: float, cx: float, cy: float) -> float:
    """Signed area [m^2] of the triangle a b c, doubled: above 0 where c is on the left of the way from a to b."""
    return (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)


@inlined_kernel
def doubled_area_of(a: int, b: int, c: int, position: FloatRows) -> float:
    """`doubled_area` of three rows of positions (n, 2)."""
    return doubled_area(position[a, 0], position[a, 1], position[b, 0], position[b, 1], position[c, 0], position[c, 1])


@inlined_kernel
def unit(x: float, y: float) -> tuple[float, float]:
    """A vector at length 1; upward where it has none."""
    length = math.sqrt(x * x + y * y)
    return (x / length, y / length) if length > SHORTEST else (0.0, 1.0)


@inlined_kernel
def nearest_share(px: float, py: float, dx: float, dy: float) -> float:
    """The place nearest to p of the segment from 0 to d, as a share of it; 0 where it has no length."""
    squared = dx * dx + dy * dy
    return min(1.0, max(0.0, (px * dx + py * dy) / squared)) if squared > 0.0 else 0.0


@inner_kernel
def squared_distance(x: float, y: float, ax: float, ay: float, bx: float, by: float) -> float:
    """Square of the distance [m^2] of a place from the segment a to b."""
    dx, dy = bx - ax, by - ay
    share = nearest_share(x - ax, y - ay, dx, dy)
    px, py = x - ax - share * dx, y - ay - share * dy
    return px * px + py * py


@inner_kernel
def segments_cross(
    ax: float, ay: float, bx: float, by: float, cx: float, cy: float, dx: float, dy: float
) -> bool:  # fmt: skip
    """Whether the segments a to b and c to d cross. A place on a line counts as on its right."""
    one, other = doubled_area(cx, cy, dx, dy, ax, ay), doubled_area(cx, cy, dx, dy, bx, by)
    third, fourth = doubled_area(ax, ay, bx, by, cx, cy), doubled_area(ax, ay, bx, by, dx, dy)
    return (one > 0.0) != (other > 0.0) and (third > 0.0) != (fourth > 0.0)


@inlined_kernel
def difference(a: int, b: int, rows: FloatRows) -> tuple[float, float]:
    """Row b of (n, 2) less row a: the way from one place to another, or how fast that changes."""
    return rows[b, 0] - rows[a, 0], rows[b, 1] - rows[a, 1]


@inlined_kernel
def segment_of(a: int, b: int, position: FloatRows) -> tuple[float, float, float, float]:
    """Where the segment from row a to row b of positions (n, 2) begins, and its way [m]: x, y, dx, dy."""
    ax, ay = position[a, 0], position[a, 1]
    return ax, ay, position[b, 0] - ax, position[b, 1] - ay


@inner_kernel
def closest_on_segment(p: int, a: int, b: int, position: FloatRows) -> tuple[float, float, float, int]:
    """The place nearest to p of the segment a b, as a share of it; distance and signed distance [m]; region.

    The signed distance is that from the straight line, above 0 on its right. region: -1 and 1 where an end is nearest.
    """
    dx, dy = difference(a, b, position)
    px, py = difference(a, p, position)
    squared = dx * dx + dy * dy
    if not squared > SHORTEST:
        distance = math.sqrt(px * px + py * py)
        return 0.0, distance, distance, -1
    share = nearest_share(px, py, dx, dy)
    region = -1 if share <= 0.0 else 1 if share >= 1.0 else 0
    qx, qy = px - share * dx, py - share * dy
    return share, math.sqrt(qx * qx + qy * qy), (px * dy - py * dx) / math.sqrt(squared), region


def doubled_areas(a: Floats, b: Floats, c: Floats) -> Floats:
    """`doubled_area` of places (..., 2), each with each."""
    along, away = b - a, c - a
    return np.asarray(along[..., 0] * away[..., 1] - along[..., 1] * away[..., 0])


def nearest_on_segments(places: Floats, a: Floats, b: Floats) -> tuple[Floats, Floats]:
    """The nearest places of segments a b, as shares (...,) of them, and the ways [m] (..., 2) from there to `places`.

    Places (..., 2), each with each.
    """
    along, away = b - a, places - a
    squared = along[..., 0] * along[..., 0] + along[..., 1] * along[..., 1]
    dot = away[..., 0] * along[..., 0] + away[..., 1] * along[..., 1]
    share = np.clip(dot / np.maximum(squared, LEAST_SQUARE), 0.0, 1.0)
    return share, away - share[..., None] * along


def distances_from_segments(places: Floats, a: Floats, b: Floats) -> Floats:
    """Distances [m] (...,) of places from segments a b (..., 2), each with each."""
    return lengths(nearest_on_segments(places, a, b)[1])


def lengths(vectors: Floats) -> Floats:
    """Lengths (...,) of vectors (..., 2)."""
    return np.asarray(np.sqrt(vectors[..., 0] * vectors[..., 0] + vectors[..., 1] * vectors[..., 1]))


@inner_kernel
def polygon_area(place: FloatRows, first: int, last: int) -> float:
    """Signed area [m^2] of the polygon of the corners first..last at place (q, 2)."""
    total = 0.0
    for c in range(first + 1, last - 1):
        total += 0.5 * doubled_area_of(first, c, c + 1, place)
    return total


@inlined_kernel
def winding_of_side(is_below_a: bool, is_below_b: bool, area: float) -> int:
    """The part of a side from a to b in the winding number of a place, by which of the two are below that.

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
