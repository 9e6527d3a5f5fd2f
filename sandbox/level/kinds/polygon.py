"""Polygons: whether one is simple, and which points of a square grid lie inside."""

import math
from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.geometry.segment import distances_from_segments, doubled_areas

Corners = Sequence[tuple[float, float]] | NDArray[np.float64]

# At most this part of a stroke's corners is left out at its end, where a hand ran over what it began with.
OVERSHOOT = 0.2
# Grid points this close to the border, in units of the spacing, count as on it: beyond rounding, below what is seen.
BORDER = 1e-9


def grid_bounds(corners: Corners, spacing: float) -> tuple[int, int, int, int]:
    """Left, bottom, columns and rows of the grid of a spacing [m] in a polygon's bounding box."""
    left, bottom = (math.ceil(min(c[axis] for c in corners) / spacing - BORDER) for axis in (0, 1))
    right, top = (math.floor(max(c[axis] for c in corners) / spacing + BORDER) for axis in (0, 1))
    return left, bottom, max(0, right - left + 1), max(0, top - bottom + 1)


def polygon_grid(corners: Corners, spacing: float) -> tuple[int, int, NDArray[np.bool_]]:
    """Left and bottom of a grid, and which of its points (rows, columns) lie in a simple polygon or on its border.

    Points of the grid are whole multiples of spacing [m]. A row is inside between its first and second crossing of the
    border, its third and fourth, and so on. Each side also marks the points on it.
    """
    left, bottom, columns, rows = grid_bounds(corners, spacing)
    if not rows or not columns:
        return left, bottom, np.zeros((rows, columns), dtype=np.bool_)
    start = np.array(corners, dtype=np.float64) / spacing - np.array([left, bottom], dtype=np.float64)
    end = np.roll(start, -1, axis=0)
    edges = np.zeros((rows, columns + 1), dtype=np.int64)
    crossed_rows, crossed_at = [], []
    for (ax, ay), (bx, by) in zip(start.tolist(), end.tolist(), strict=True):
        if ay > by:
            ax, ay, bx, by = bx, by, ax, ay
        first, last = max(0, math.ceil(ay - BORDER)), min(rows - 1, math.floor(by + BORDER))
        if first > last:
            continue
        row = np.arange(first, last + 1)
        x = ax + (bx - ax) * (np.clip(row, ay, by) - ay) / (by - ay) if by > ay else np.full(len(row), ax)
        level = by - ay <= BORDER
        _mark(edges, row, min(ax, bx) if level else x, max(ax, bx) if level else x)
        # Half-open, so that a corner between two sides counts once and every row is crossed an even number of times.
        crossing = (row >= ay) & (row < by)
        crossed_rows.append(row[crossing])
        crossed_at.append(x[crossing])
    if crossed_rows:
        row, x = np.concatenate(crossed_rows), np.concatenate(crossed_at)
        order = np.lexsort((x, row))
        row, x = row[order], x[order]
        _mark(edges, row[0::2], x[0::2], x[1::2])
    return left, bottom, np.cumsum(edges[:, :-1], axis=1) > 0


def _mark(edges: NDArray[np.int64], row: NDArray[np.int64], start: object, end: object) -> None:
    columns = edges.shape[1] - 1
    first = np.broadcast_to(np.clip(np.ceil(np.asarray(start) - BORDER), 0, columns), row.shape).astype(np.int64)
    beyond = np.broadcast_to(np.clip(np.floor(np.asarray(end) + BORDER) + 1, 0, columns), row.shape).astype(np.int64)
    holds = beyond > first
    np.add.at(edges, (row[holds], first[holds]), 1)
    np.add.at(edges, (row[holds], beyond[holds]), -1)


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
    a = np.array(corners, dtype=np.float64)
    b = np.roll(a, -1, axis=0)
    count = len(a)
    for side in range(count):
        others = np.arange(side + 1, count)
        adjacent_after = others == side + 1
        adjacent_before = (others == count - 1) & (side == 0)
        far = others[~(adjacent_after | adjacent_before)]
        if np.any(_touch(a[side], b[side], a[far], b[far])):
            return False
        after = (side + 1) % count
        if _folds_back(a[side], b[side], b[after]):
            return False
    return True


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
    sides = [(np.array(loop, dtype=np.float64), np.roll(np.array(loop), -1, axis=0)) for loop in loops]
    return any(
        bool(np.any(_touch(a, b, *others)))
        for number, (starts, ends) in enumerate(sides)
        for others in sides[:number]
        for a, b in zip(starts, ends, strict=True)
    )


def _side_of(p: NDArray[np.float64], q: NDArray[np.float64], r: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.sign(doubled_areas(p, q, r))


def _touch(
    a: NDArray[np.float64], b: NDArray[np.float64], c: NDArray[np.float64], d: NDArray[np.float64]
) -> NDArray[np.bool_]:
    """Whether the segment a b (2,) has a point in common with each of the segments c d (k, 2)."""
    boxes_meet = np.all((np.minimum(a, b) <= np.maximum(c, d)) & (np.minimum(c, d) <= np.maximum(a, b)), axis=-1)
    across = _side_of(a, b, c) * _side_of(a, b, d) <= 0
    back = _side_of(c, d, a) * _side_of(c, d, b) <= 0
    return np.asarray(boxes_meet & across & back)


def _folds_back(p: NDArray[np.float64], q: NDArray[np.float64], r: NDArray[np.float64]) -> bool:
    if np.array_equal(p, q):
        return True
    along = (q - p) * (r - q)
    return bool(_side_of(p, q, r) == 0 and along[0] + along[1] < 0)


def simplified(corners: Corners, tolerance: float) -> list[tuple[float, float]]:
    """Simplify a closed line drawn by hand: drop corners that change it by at most a tolerance [m].

    Two far corners stay. Each way between them becomes a chord, or is split at the corner farthest from the chord
    (Ramer 1972; Douglas and Peucker 1973). Repeated corners go first.
    """
    given = [corner for index, corner in enumerate(corners) if corner != corners[index - 1]]
    if len(given) < 3:
        return given
    points = np.array([*given, given[0]], dtype=np.float64)
    far = int(np.argmax(np.sum((points - points[0]) ** 2, axis=1)))
    kept = {0, far}
    ways = [(0, far), (far, len(given))]
    while ways:
        first, last = ways.pop()
        between = points[first + 1 : last]
        if not len(between):
            continue
        distance = distances_from_segments(between, points[first], points[last])
        worst = int(np.argmax(distance))
        if distance[worst] > tolerance:
            middle = first + 1 + worst
            kept.add(middle)
            ways += [(first, middle), (middle, last)]
    return [given[index] for index in sorted(kept)]


def drawn_outline(stroke: Corners, tolerance: float) -> list[tuple[float, float]]:
    """Corners of an outline drawn by hand within a tolerance [m], without an end that runs over its own beginning."""
    corners = simplified(stroke, tolerance)
    kept = (corners[: len(corners) - left_out] for left_out in range(int(OVERSHOOT * len(corners)) + 1))
    return next((outline for outline in kept if is_simple(outline)), corners)
