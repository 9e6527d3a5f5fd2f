"""Polygons: whether one is simple, which points of a square grid lie inside, and what a hand meant to draw."""

import math
from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.arena import FIRST_ARENA, answer_of
from sandbox.physics.arrays import FloatRows, Slots
from sandbox.physics.meshing.fitting import OVERSHOOT
from sandbox.physics.meshing.loops import BORDER, grid_points, is_simple_loop, loops_meet, trace

Corners = Sequence[tuple[float, float]] | NDArray[np.float64]


def rows_of(loops: Sequence[Corners]) -> tuple[FloatRows, Slots]:
    """Corners of loops [m] (n, 2), one loop after another, and where each begins, and ends at last."""
    rows = [np.array(loop, dtype=np.float64).reshape(-1, 2) for loop in loops]
    return np.concatenate(rows), np.cumsum([0, *map(len, rows)], dtype=np.int64)


def grid_bounds(corners: Corners, spacing: float) -> tuple[int, int, int, int]:
    """Left, bottom, columns and rows of the grid of a spacing [m] in a polygon's bounding box."""
    left, bottom = (math.ceil(min(c[axis] for c in corners) / spacing - BORDER) for axis in (0, 1))
    right, top = (math.floor(max(c[axis] for c in corners) / spacing + BORDER) for axis in (0, 1))
    return left, bottom, max(0, right - left + 1), max(0, top - bottom + 1)


def polygon_grid(corners: Corners, spacing: float) -> tuple[int, int, NDArray[np.bool_]]:
    """Left and bottom of a grid, and which of its points (rows, columns) lie in a simple polygon or on its border.

    Points of the grid are whole multiples of spacing [m].
    """
    left, bottom, columns, rows = grid_bounds(corners, spacing)
    points = np.zeros((rows, columns), dtype=np.bool_)
    if rows and columns:
        box = np.array([left, bottom, columns, rows])
        answer_of(grid_points, FIRST_ARENA, rows_of([corners])[0], spacing, box, points.reshape(-1))
    return left, bottom, points


def largest_part(points: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """The largest connected region of the points of a grid (rows, columns); all points if there is none.

    Cells of three or four corners are connected if they share a side. A tip that hangs by one point would flap.
    """
    corners = points[:-1, :-1].astype(np.int8) + points[:-1, 1:] + points[1:, :-1] + points[1:, 1:]
    cells = corners >= 3
    if not cells.any():
        return points
    label = np.arange(cells.size).reshape(cells.shape)
    beside = cells[:, :-1] & cells[:, 1:] & points[:-1, 1:-1] & points[1:, 1:-1]
    above = cells[:-1] & cells[1:] & points[1:-1, :-1] & points[1:-1, 1:]
    first = np.concatenate([label[:, :-1][beside], label[:-1][above]])
    second = np.concatenate([label[:, 1:][beside], label[1:][above]])
    lowest = label.reshape(-1)
    while True:
        # Each group takes the lowest label that it touches; chains of labels are then followed to their ends.
        before = lowest.copy()
        least = np.minimum(lowest[first], lowest[second])
        np.minimum.at(lowest, before[first], least)
        np.minimum.at(lowest, before[second], least)
        while np.any(lowest != lowest[lowest]):
            lowest = lowest[lowest]
        if np.array_equal(lowest, before):
            break
    sizes = np.bincount(lowest[cells.reshape(-1)], minlength=cells.size)
    part = cells & (lowest == np.argmax(sizes)).reshape(cells.shape)
    kept = np.zeros_like(points)
    for held in (kept[:-1, :-1], kept[:-1, 1:], kept[1:, :-1], kept[1:, 1:]):
        held |= part
    return kept & points


def is_simple(corners: Corners) -> bool:
    """Whether all corners differ and no sides touch, except neighbours at their common corner."""
    return _is_simple(tuple((float(x), float(y)) for x, y in corners))


# Cached, since every edit of another body asks for this one again.
@lru_cache(maxsize=64)
def _is_simple(corners: tuple[tuple[float, float], ...]) -> bool:
    return bool(is_simple_loop(rows_of([corners])[0]))


def holds(corners: Corners, point: tuple[float, float]) -> bool:
    """Whether a point, which is not on the border, lies inside a simple polygon."""
    x, y = point
    a = np.array(corners, dtype=np.float64) - np.array([x, y])
    b = np.roll(a, -1, axis=0)
    crossing = (a[:, 1] > 0.0) != (b[:, 1] > 0.0)
    left = (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0] > 0.0) == (b[:, 1] > a[:, 1])
    return bool(np.count_nonzero(crossing & left) % 2)


def loops_touch(loops: Sequence[Corners]) -> bool:
    """Whether a side of a closed line touches one of another."""
    return bool(loops_meet(*rows_of(loops)))


def simplified(corners: Corners, tolerance: float) -> list[tuple[float, float]]:
    """Simplify a closed line drawn by hand: drop corners that change it by at most a tolerance [m]."""
    return _traced(corners, tolerance, 0.0)


def drawn_outline(stroke: Corners, tolerance: float) -> list[tuple[float, float]]:
    """Corners of an outline drawn by hand within a tolerance [m], without an end that runs over its own beginning."""
    return _traced(stroke, tolerance, OVERSHOOT)


def _traced(stroke: Corners, tolerance: float, overshoot: float) -> list[tuple[float, float]]:
    line = rows_of([stroke])[0]
    count, _ = answer_of(trace, FIRST_ARENA, line, tolerance, overshoot)
    return [(x, y) for x, y in line[:count].tolist()]
