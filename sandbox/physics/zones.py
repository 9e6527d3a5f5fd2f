"""Zones: parts of the plane that rules ask about, and which part of a way lies in one."""

import math
from typing import NamedTuple

from sandbox.physics.arrays import FloatRows, Slots
from sandbox.physics.geometry.segment import doubled_area, squared_distance
from sandbox.physics.jit import inner_kernel

BOX, CIRCLE, POLYGON = range(3)


class Zones(NamedTuple):
    """The zones of a level, by their order in the file."""

    kind: Slots
    shape: FloatRows  # [m] (z, 4): left, bottom, right, top; of a circle x, y, radius, 0
    first: Slots  # (z + 1,): the first corner of each
    corner: FloatRows  # [m] of all polygons


@inner_kernel
def depth_inside(zones: Zones, z: int, x: float, y: float) -> float:
    """How far inside a zone a place is [m]; below 0: how far outside, of a box at least."""
    kind, shape = zones.kind[z], zones.shape
    if kind == BOX:
        return min(min(x - shape[z, 0], shape[z, 2] - x), min(y - shape[z, 1], shape[z, 3] - y))
    if kind == CIRCLE:
        dx, dy = x - shape[z, 0], y - shape[z, 1]
        return shape[z, 2] - math.sqrt(dx * dx + dy * dy)
    corner, first, last = zones.corner, zones.first[z], zones.first[z + 1]
    is_inside, nearest, before = False, math.inf, last - 1
    for c in range(first, last):
        ax, ay, bx, by = corner[before, 0], corner[before, 1], corner[c, 0], corner[c, 1]
        if (ay > y) != (by > y) and x - ax < (bx - ax) * (y - ay) / (by - ay):
            is_inside = not is_inside
        nearest = min(nearest, squared_distance(x, y, ax, ay, bx, by))
        before = c
    return math.sqrt(nearest) if is_inside else -math.sqrt(nearest)


@inner_kernel
def may_be_inside(zones: Zones, z: int, x: float, y: float) -> bool:
    """Whether a place lies in the box around a zone that is no circle."""
    shape = zones.shape
    return zones.kind[z] == CIRCLE or (shape[z, 0] <= x <= shape[z, 2] and shape[z, 1] <= y <= shape[z, 3])


@inner_kernel
def span_inside(zones: Zones, z: int, ax: float, ay: float, bx: float, by: float) -> tuple[float, float]:
    """Where the way from a to b is in a zone first and last, as shares of it; the first is above the last: nowhere."""
    kind, shape = zones.kind[z], zones.shape
    if kind == CIRCLE:
        return _span_in_circle(ax - shape[z, 0], ay - shape[z, 1], bx - ax, by - ay, shape[z, 2])
    first, last = _span_between(ax, bx - ax, shape[z, 0], shape[z, 2], 0.0, 1.0)
    first, last = _span_between(ay, by - ay, shape[z, 1], shape[z, 3], first, last)
    if kind == BOX or first > last:
        return first, last
    return _span_in_polygon(zones, z, ax, ay, bx, by)


@inner_kernel
def _span_between(a: float, d: float, low: float, high: float, first: float, last: float) -> tuple[float, float]:
    # The part of a span in which a + share d lies between two bounds.
    if d == 0.0:
        return (first, last) if low <= a <= high else (1.0, 0.0)
    one, other = (low - a) / d, (high - a) / d
    return max(first, min(one, other)), min(last, max(one, other))


@inner_kernel
def _span_in_circle(px: float, py: float, dx: float, dy: float, radius: float) -> tuple[float, float]:
    # |p + share d| <= radius
    squared, outside = dx * dx + dy * dy, px * px + py * py - radius * radius
    if not squared > 0.0:
        return (0.0, 1.0) if outside <= 0.0 else (1.0, 0.0)
    along = px * dx + py * dy
    inside = along * along - squared * outside
    if inside < 0.0:
        return 1.0, 0.0
    root = math.sqrt(inside)
    return max(0.0, (-along - root) / squared), min(1.0, (root - along) / squared)


@inner_kernel
def _span_in_polygon(zones: Zones, z: int, ax: float, ay: float, bx: float, by: float) -> tuple[float, float]:
    first, last = 1.0, 0.0
    if depth_inside(zones, z, ax, ay) >= 0.0:
        first = 0.0
    if depth_inside(zones, z, bx, by) >= 0.0:
        last = 1.0
    corner, before = zones.corner, zones.first[z + 1] - 1
    for c in range(zones.first[z], zones.first[z + 1]):
        cx, cy, dx, dy = corner[before, 0], corner[before, 1], corner[c, 0], corner[c, 1]
        one, other = doubled_area(cx, cy, dx, dy, ax, ay), doubled_area(cx, cy, dx, dy, bx, by)
        third, fourth = doubled_area(ax, ay, bx, by, cx, cy), doubled_area(ax, ay, bx, by, dx, dy)
        if (one > 0.0) != (other > 0.0) and (third > 0.0) != (fourth > 0.0):
            share = one / (one - other)
            first, last = min(first, share), max(last, share)
        before = c
    return first, last
