"""Outlines of bodies, from the particles along their borders: grown outwards, and their corners cut."""

import math
from typing import NamedTuple

from sandbox.physics.arrays import FloatRows, Floats, Slots
from sandbox.physics.jit import inner_kernel, kernel


class Loops(NamedTuple):
    """Closed loops of particles: slot (k,), start (c + 1,); rounds (c,): how often corners are cut (Chaikin).

    keep (c,): which part of a side a cut takes at each end. Each round doubles the points of an outline; point_start
    (c + 1,): where they begin.
    """

    slot: Slots
    start: Slots
    rounds: Slots
    keep: Floats
    point_start: Slots


@inner_kernel
def _grow(pixels: FloatRows, loops: Loops, c: int, grow: float, point: FloatRows) -> None:
    """The corners of a loop moved outwards along their normals."""
    first, last, out = loops.start[c], loops.start[c + 1], loops.point_start[c]
    area = 0.0
    for k in range(first, last):
        a, b = loops.slot[k], loops.slot[k + 1 if k + 1 < last else first]
        area += pixels[a, 0] * pixels[b, 1] - pixels[b, 0] * pixels[a, 1]
    by = grow if area > 0.0 else -grow
    for k in range(first, last):
        p = loops.slot[k - 1 if k > first else last - 1]
        q = loops.slot[k]
        r = loops.slot[k + 1 if k + 1 < last else first]
        dx, dy = pixels[r, 0] - pixels[p, 0], pixels[r, 1] - pixels[p, 1]
        length = math.sqrt(dx * dx + dy * dy) + 1e-12
        point[out + k - first, 0] = pixels[q, 0] + dy / length * by
        point[out + k - first, 1] = pixels[q, 1] - dx / length * by


@inner_kernel
def _cut_corners(point: FloatRows, first: int, count: int, keep: float, spare: FloatRows) -> None:
    """Two points in place of each of `count` from `first` on."""
    for k in range(count):
        spare[k, 0], spare[k, 1] = point[first + k, 0], point[first + k, 1]
    for k in range(count):
        j = k + 1 if k + 1 < count else 0
        for axis in range(2):
            a, b = spare[k, axis], spare[j, axis]
            point[first + 2 * k, axis] = a + (b - a) * keep
            point[first + 2 * k + 1, axis] = b + (a - b) * keep


@kernel
def trace_outlines(pixels: FloatRows, loops: Loops, grow: Floats, point: FloatRows, spare: FloatRows) -> None:
    """Write the outlines of loops of particles at pixels (n, 2), grown by grow (c,) [pixels], into point (k, 2)."""
    for c in range(loops.rounds.shape[0]):
        _grow(pixels, loops, c, grow[c], point)
        count = loops.start[c + 1] - loops.start[c]
        for _ in range(loops.rounds[c]):
            _cut_corners(point, loops.point_start[c], count, loops.keep[c], spare)
            count *= 2
