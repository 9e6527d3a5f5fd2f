"""Fitted meshes: particles at equal distances on an outline, even triangles inside, and empty holes."""

import math
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sandbox.level.format.limits import POLYGON_WORK_LIMIT, SPACING_RANGE
from sandbox.level.kinds.geometry import Pairs, Points, spokes
from sandbox.level.kinds.polygon import Corners, is_simple, loops_touch, polygon_grid
from sandbox.level.kinds.triangulation import Triangulation
from sandbox.physics.geometry.polygon import signed_area
from sandbox.physics.geometry.segment import lengths

Loop = tuple[tuple[float, float], ...]
# Corners [m] in order, or the radius [m] of a circle about [0, 0].
Outline = Loop | float

# Triangulated are whole multiples of this part of the spacing; products of four of them stay small.
GRAIN = 1.0 / 65536.0
# Cosine of the turn from which on a corner is kept: 20 degrees. No regular polygon turns by just this.
KEPT_COSINE = 0.94
# Rows of the lattice inside are this far apart, and what is nearer to the border than its share is left out.
ROW = math.sqrt(0.75)
CLEARANCE = 0.6
# Cotangents of the smallest angle that a triangle may have: 20 degrees; of an outline with sharper corners than twice
# that, half its sharpest, and never below 5 degrees, where a triangle is little more than a line.
LEAST_ANGLE, SLIVER = 2.7475, 11.43
# A disc of this many rings is beyond every limit.
RING_LIMIT = 1e4
# Work of a mesh in units of the limit of polygons: for each particle, and for each pair of sides of the border.
PARTICLE_WORK, PAIR_WORK = 200.0, 0.25
# What is too coarse is tried so much finer, so often; each to this many digits.
FINER, TRIES, DIGITS = 0.8, 16, 3


class FittedMesh(NamedTuple):
    """Places [m] (n, 2), those on borders first; triangles (t, 3) and border sides (b, 2), counter-clockwise."""

    places: Points
    triangles: Pairs
    sides: Pairs
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
    border = np.arange(6 * rings, dtype=np.int64)
    sides = np.stack([border, np.roll(border, -1)], axis=1)
    made = np.array(triangles, dtype=np.int64)
    return FittedMesh(np.concatenate([*places, np.zeros((1, 2))]), made, sides, _sides_of(made))


def _sides_of(triangles: Pairs) -> Pairs:
    """Pairs (m, 2) of corners of triangles, each once, the lower first, in order."""
    sides = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    return np.unique(np.sort(sides, axis=1), axis=0)


@lru_cache(maxsize=32)
def fitted_mesh(outline: Outline, holes: tuple[Loop, ...], spacing: float) -> FittedMesh:
    """The mesh of a simple outline [m] with separate holes inside it. Raises TooCoarse."""
    if not isinstance(outline, tuple):
        if not holes:
            return disc_mesh(outline, disc_rings(outline, spacing))
        border = np.array(corners_of(outline, spacing)), 0.0
    else:
        border = _sampled(outline, spacing, True)
    sampled = [border, *(_sampled(hole, spacing, False) for hole in holes)]
    mesh = _meshed([places for places, _ in sampled], spacing)
    if _sharpest(mesh) > min(max(LEAST_ANGLE, *(sharp for _, sharp in sampled)), SLIVER):
        raise TooCoarse
    return mesh


def fitting_spacing(
    outline: Outline, holes: tuple[Loop, ...], spacing: float, most: float = POLYGON_WORK_LIMIT / PARTICLE_WORK
) -> float | None:
    """The spacing [m], or the first smaller one that fits; None if that takes more than `most` particles."""
    finer = spacing
    for tries in range(TRIES):
        if fitted_work(outline, holes, finer) > most * PARTICLE_WORK or finer < SPACING_RANGE[0]:
            return None
        try:
            fitted_mesh(outline, holes, finer)
        except TooCoarse:
            finer = float(f"{spacing * FINER ** (tries + 1):.{DIGITS}g}")
            continue
        return finer
    return None


def fitted_work(outline: Outline, holes: tuple[Loop, ...], spacing: float) -> int:
    """An estimate of the work for the mesh of an outline [m] with holes, in the unit of the limit of polygons."""
    loops = (corners_of(outline, spacing), *holes)
    border = sum(float(np.sum(lengths(np.diff(np.array([*loop, loop[0]]), axis=0)))) for loop in loops) / spacing
    corners = np.array(loops[0], dtype=np.float64)
    area = abs(signed_area(corners, np.roll(corners, -1, axis=0)))
    particles = area / (ROW * spacing * spacing) + border / 2.0
    width, height = (np.max(corners, axis=0) - np.min(corners, axis=0)).tolist()
    # The lattice is looked through in a slanted box.
    box = (width + height) * height / (ROW * spacing * spacing)
    return math.ceil(min(PARTICLE_WORK * particles + PAIR_WORK * border * border + box, 1e12))


def _sharpest(mesh: FittedMesh) -> float:
    """Cotangent of the smallest angle of all triangles."""
    corners = mesh.places[mesh.triangles]
    largest = 0.0
    for k in range(3):
        u, w = corners[:, (k + 1) % 3] - corners[:, k], corners[:, (k + 2) % 3] - corners[:, k]
        along, across = u[:, 0] * w[:, 0] + u[:, 1] * w[:, 1], u[:, 0] * w[:, 1] - u[:, 1] * w[:, 0]
        if not np.all(across > 0.0):
            return math.inf
        largest = max(largest, float(np.max(along / across)))
    return largest


class _Way:
    """A closed outline [m] (n, 2) as a way along it: from its first corner, counter-clockwise or against it."""

    def __init__(self, loop: Corners, counter_clockwise: bool) -> None:
        corners = np.array(loop, dtype=np.float64)
        after = np.roll(corners, -1, axis=0)
        doubled = np.cumsum(corners[:, 0] * after[:, 1] - corners[:, 1] * after[:, 0])[-1]
        if (doubled > 0.0) != counter_clockwise:
            corners = np.concatenate([corners[:1], corners[:0:-1]])
        self.corners = corners
        self.sides = np.roll(corners, -1, axis=0) - corners
        self.reach = lengths(self.sides)
        self.start = np.concatenate([np.zeros(1), np.cumsum(self.reach)])

    @property
    def length(self) -> float:
        """Length of the whole way [m]."""
        return float(self.start[-1])

    def at(self, along: NDArray[np.float64]) -> Points:
        """Places [m] (k, 2) at distances [m] along it, at most once around either way."""
        length = self.start[-1]
        along = np.where(along < 0.0, along + length, np.where(along >= length, along - length, along))
        side = np.clip(np.searchsorted(self.start, along, side="right") - 1, 0, len(self.corners) - 1)
        share = np.clip((along - self.start[side]) / self.reach[side], 0.0, 1.0)
        return np.asarray(self.corners[side] + share[:, None] * self.sides[side])


def _sampled(loop: Loop, spacing: float, counter_clockwise: bool) -> tuple[Points, float]:
    """Places (k, 2) on an outline, on its corners and evenly between them, and the cotangent of half its sharpest."""
    way = _Way(loop, counter_clockwise)
    window = min(spacing / 2.0, way.length / 8.0)
    along = way.start[:-1]
    back, ahead = way.corners - way.at(along - window), way.at(along + window) - way.corners
    both = lengths(back) * lengths(ahead)
    cosine = (back[:, 0] * ahead[:, 0] + back[:, 1] * ahead[:, 1]) / both
    kept: list[int] = []
    for corner in np.argsort(cosine, kind="stable").tolist():
        if cosine[corner] > KEPT_COSINE:
            break
        apart = [abs(float(along[corner] - along[other])) for other in kept]
        if all(min(each, way.length - each) >= spacing / 2.0 for each in apart):
            kept.append(corner)
    kept.sort()
    starts = [float(along[corner]) for corner in kept] or [0.0]
    ends = [*starts[1:], starts[0] + way.length]
    places = []
    for start, end in zip(starts, ends, strict=True):
        parts = max(1, round((end - start) / spacing))
        places.append(start + (end - start) * np.arange(parts, dtype=np.float64) / parts)
    # Corners that stick out alone bound the angles inside. The border has what is filled on its left.
    crossed = (back[:, 0] * ahead[:, 1] - back[:, 1] * ahead[:, 0]) / both
    sharp = [corner for corner in kept if crossed[corner] > 0.0]
    # The angle inside is half a turn less that of the way: the cotangent of half of it is (1 - cosine) / sine of that.
    halves = [float((1.0 - cosine[corner]) / crossed[corner]) for corner in sharp]
    result = way.at(np.concatenate(places))
    # Corners stand where they are, to the bit.
    firsts = np.cumsum([0, *map(len, places)])[:-1]
    if kept:
        result[firsts] = way.corners[kept]
    return result, max(halves, default=0.0)


def _meshed(loops: list[Points], spacing: float) -> FittedMesh:
    if any(len(loop) < 3 for loop in loops):
        raise TooCoarse
    border = np.concatenate(loops)
    scale = 1.0 / (spacing * GRAIN)
    whole = [np.rint(loop * scale) for loop in loops]
    if not all(is_simple(loop) for loop in whole) or loops_touch(whole):
        raise TooCoarse
    inner = np.rint(_lattice(loops, spacing) * scale)
    sites = np.concatenate([*whole, inner]).astype(np.int64)
    net = Triangulation([(x, y) for x, y in sites.tolist()])
    sides, first = [], 0
    for loop in loops:
        numbers = np.arange(first, first + len(loop), dtype=np.int64)
        sides.append(np.stack([numbers, np.roll(numbers, -1)], axis=1))
        first += len(loop)
    borders = np.concatenate(sides)
    try:
        for a, b in borders.tolist():
            net.force(a, b)
    except ValueError:
        raise TooCoarse from None
    net.inside([(a, b) for a, b in borders.tolist()])
    net.even_out(len(border))
    places = np.concatenate([border, np.array(net.sites[len(border) :], dtype=np.float64).reshape(-1, 2) / scale])
    triangles = np.array(net.triangles(), dtype=np.int64)
    return FittedMesh(places, triangles, borders, _sides_of(triangles))


def _lattice(loops: list[Points], spacing: float) -> Points:
    """Points [m] (k, 2) of a lattice of even triangles about [0, 0] well inside, row by row from the bottom left."""
    # In units of its two directions, along x and 60 degrees from there, the lattice is all whole numbers.
    slanted = []
    for loop in loops:
        up = loop[:, 1] / (spacing * ROW)
        slanted.append(np.stack([loop[:, 0] / spacing - up / 2.0, up], axis=1))
    left, bottom, points = polygon_grid(slanted[0], 1.0)
    for hole in slanted[1:]:
        hole_left, hole_bottom, held = polygon_grid(hole, 1.0)
        row, column = np.nonzero(held)
        points[row + hole_bottom - bottom, column + hole_left - left] = False
    for loop, flat in zip(loops, slanted, strict=True):
        _clear(points, left, bottom, loop / spacing, flat)
    row, column = np.nonzero(points)
    up = (bottom + row).astype(np.float64)
    return np.stack([(left + column + up / 2.0) * spacing, up * ROW * spacing], axis=1)


def _clear(points: NDArray[np.bool_], left: int, bottom: int, loop: Points, flat: Points) -> None:
    """Take out points near the sides of a loop, which is given in spacings (b, 2) and in lattice units (b, 2)."""
    rows, columns = points.shape
    low = np.floor(np.minimum(flat, np.roll(flat, -1, axis=0)) - 1.1)
    high = np.maximum(flat, np.roll(flat, -1, axis=0)) + 1.1
    across, up = (np.arange(int(np.ceil(np.max((high - low)[:, axis]))) + 1, dtype=np.float64) for axis in (0, 1))
    v = low[:, 1, None, None] + up[None, :, None]
    u = low[:, 0, None, None] + across[None, None, :]
    x, y = u + v / 2.0, v * ROW + 0.0 * u
    side = np.roll(loop, -1, axis=0) - loop
    side_x, side_y = side[:, 0, None, None], side[:, 1, None, None]
    x, y = x - loop[:, 0, None, None], y - loop[:, 1, None, None]
    share = np.clip((x * side_x + y * side_y) / (side_x * side_x + side_y * side_y), 0.0, 1.0)
    x, y = x - share * side_x, y - share * side_y
    near = x * x + y * y < CLEARANCE * CLEARANCE
    column = (u - left + 0.0 * v).astype(np.int64)
    row = (v - bottom + 0.0 * u).astype(np.int64)
    near &= (row >= 0) & (row < rows) & (column >= 0) & (column < columns)
    points[row[near], column[near]] = False
