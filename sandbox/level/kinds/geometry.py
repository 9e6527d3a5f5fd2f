"""Geometry of several kinds: rows, chains and rings; polygons on a grid; meshes that fill an outline."""

import math
from collections.abc import Sequence
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sandbox.level.format.limits import POLYGON_WORK_LIMIT, SPACING_RANGE
from sandbox.physics.arena import FIRST_ARENA, answer_of
from sandbox.physics.arrays import FloatRows, Slots
from sandbox.physics.geometry.segment import lengths
from sandbox.physics.meshing import fitting
from sandbox.physics.meshing.fitting import OVERSHOOT
from sandbox.physics.meshing.loops import BORDER, grid_points, is_simple_loop, loops_meet, trace

Points = NDArray[np.float64]
Pairs = NDArray[np.int64]

Corners = Sequence[tuple[float, float]] | NDArray[np.float64]

# Sine and cosine are rounded to this many decimals, so that different libraries of mathematics build the same bits.
TRIGONOMETRY_DECIMALS = 12


def distances(points: Points, pairs: Pairs) -> Points:
    """Distance [m] (m,) of the two particles of each pair."""
    return lengths(points[pairs[:, 1]] - points[pairs[:, 0]])


def pair_keys(pairs: Pairs) -> Pairs:
    """A number for each pair (..., 2) of particles, in whatever order."""
    low, high = pairs.min(axis=-1), pairs.max(axis=-1)
    return np.asarray(low << 32 | high)


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


Loop = tuple[tuple[float, float], ...]
# Corners [m] in order, or the radius [m] of a circle about [0, 0].
Outline = Loop | float

# A disc of this many rings is beyond every limit.
RING_LIMIT = 1e4


class FittedMesh(NamedTuple):
    """Places [m] (n, 2), those on borders first; triangles (t, 3), counter-clockwise, and their sides (m, 2)."""

    places: Points
    triangles: Pairs
    pairs: Pairs


class TooCoarse(ValueError):
    """The spacing is too large for an outline: sides would touch, or triangles would be slivers."""


def disc_rings(radius: Any, spacing: float) -> int:
    """Number of rings of particles of a disc, around its centre."""
    return max(1, round(min(radius / spacing, RING_LIMIT)))


def disc_counts(rings: int) -> tuple[int, int]:
    """Particles and springs of a disc of that many rings."""
    return 1 + 3 * rings * (rings + 1), 3 * rings * (3 * rings + 1)


def corners_of(outline: Outline, spacing: float) -> Loop:
    """Corners [m] of an outline; for a circle, the corners of its mesh."""
    if isinstance(outline, tuple):
        return outline
    return tuple((x, y) for x, y in (outline * spokes(0.0, 6 * disc_rings(outline, spacing))).tolist())


def disc_mesh(radius: float, rings: int) -> FittedMesh:
    """The mesh of a disc: ring k around the centre has 6 k particles; from the border inwards."""
    firsts = [disc_counts(rings)[0] - disc_counts(ring)[0] for ring in range(rings + 1)]
    places = [radius * (ring / rings) * spokes(0.0, 6 * ring) for ring in range(rings, 0, -1)]
    triangles = []
    for ring in range(rings, 0, -1):
        outer, inner = firsts[ring], firsts[ring - 1]
        for sector in range(6):
            for step in range(ring):
                a = outer + sector * ring + step
                b = outer + (sector * ring + step + 1) % (6 * ring)
                within = max(6 * (ring - 1), 1)
                c = inner + (sector * (ring - 1) + step) % within
                triangles.append((a, b, c))
                if step < ring - 1:
                    triangles.append((b, inner + (sector * (ring - 1) + step + 1) % within, c))
    made = np.array(triangles, dtype=np.int64)
    return FittedMesh(np.concatenate([*places, np.zeros((1, 2))]), made, _sides_of(made))


def _sides_of(triangles: Pairs) -> Pairs:
    """Pairs (m, 2) of corners of triangles, each once, the lower first, in order."""
    sides = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    return np.unique(np.sort(sides, axis=1), axis=0)


@lru_cache(maxsize=32)
def fitted_mesh(outline: Outline, holes: tuple[Loop, ...], spacing: float) -> FittedMesh:
    """The mesh of a simple outline [m] with separate holes inside it. Raises TooCoarse."""
    if not isinstance(outline, tuple) and not holes:
        return disc_mesh(outline, disc_rings(outline, spacing))
    loops = rows_of([corners_of(outline, spacing), *holes])
    # The corners of a circle are particles already.
    is_sampled = isinstance(outline, tuple)
    code, arena = answer_of(fitting.mesh_loops, fitting.USUAL_ARENA, *loops, spacing, is_sampled)
    if code != fitting.FITS:
        raise TooCoarse
    found = fitting.found_in(arena)
    return FittedMesh(found.places, found.triangles, found.pairs)


def fitting_spacing(
    outline: Outline,
    holes: tuple[Loop, ...],
    spacing: float,
    most: float = POLYGON_WORK_LIMIT / fitting.PARTICLE_WORK,
) -> float | None:
    """The spacing [m], or the first smaller one that fits; None if that takes more than `most` particles."""
    for tries in range(fitting.TRIES):
        finer = fitting.finer_spacing(spacing, tries)
        if fitted_work(outline, holes, finer) > most * fitting.PARTICLE_WORK or finer < SPACING_RANGE[0]:
            return None
        try:
            fitted_mesh(outline, holes, finer)
        except TooCoarse:
            continue
        return finer
    return None


def fitted_work(outline: Outline, holes: tuple[Loop, ...], spacing: float) -> int:
    """An estimate of the work for the mesh of an outline [m] with holes, in the unit of the limit of polygons."""
    loops: list[Corners] = [corners_of(outline, spacing), *holes]
    return int(fitting.mesh_work(*rows_of(loops), spacing))
