"""Zones: parts of the plane, and whether places lie in them and ways meet them."""

import math
from typing import NamedTuple

from sandbox.physics.arrays import FloatRows, Slots
from sandbox.physics.geometry.segment import segments_cross, squared_distance
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
def meets_zone(zones: Zones, z: int, ax: float, ay: float, bx: float, by: float) -> bool:
    """Whether the way from a to b begins in a zone, ends in it, or passes through."""
    if depth_inside(zones, z, ax, ay) >= 0.0 or depth_inside(zones, z, bx, by) >= 0.0:
        return True
    kind, shape, corner = zones.kind[z], zones.shape, zones.corner
    if kind == CIRCLE:
        return squared_distance(shape[z, 0], shape[z, 1], ax, ay, bx, by) <= shape[z, 2] * shape[z, 2]
    if kind == BOX:
        left, bottom, right, top = shape[z, 0], shape[z, 1], shape[z, 2], shape[z, 3]
        # What crosses a box crosses one of its diagonals.
        rises = segments_cross(ax, ay, bx, by, left, bottom, right, top)
        return rises or segments_cross(ax, ay, bx, by, left, top, right, bottom)
    first, last = zones.first[z], zones.first[z + 1]
    before = last - 1
    for c in range(first, last):
        if segments_cross(ax, ay, bx, by, corner[before, 0], corner[before, 1], corner[c, 0], corner[c, 1]):
            return True
        before = c
    return False
