"""Where the particles of a body stand and which of them springs join, in generation order.

Every function gives positions [m] (n, 2) and pairs of indices (m, 2), of the body's own form: before its cuts and its
pose. Counts come first and cost nothing: `form_count` tells how many particles and springs a form has before anything
of that size is allocated, and `count` how many are left of it.
"""

import math

import numpy as np
from numpy.typing import NDArray

from sandbox.level.format.limits import PARTICLE_LIMIT
from sandbox.level.kinds.bodies import (
    AnyBody,
    BoxShape,
    BridgeDef,
    CircleShape,
    GirderDef,
    JellyDef,
    MeshDef,
    RingDef,
    RopeDef,
    WebDef,
    WheelDef,
)
from sandbox.level.kinds.polygon import largest_part, polygon_grid

Points = NDArray[np.float64]
Pairs = NDArray[np.int64]

# Grid points this close to a border, in units of the spacing, count as on it: beyond rounding, below what is seen.
BORDER = 1e-9
# Sine and cosine are rounded to this many decimals, so that different libraries of mathematics build the same bits.
TRIGONOMETRY_DECIMALS = 12


def count(body: AnyBody) -> tuple[int, int]:
    """Particles and springs that a body expands to; a jelly beyond the particle limit may be counted short of it."""
    particles, springs = form_count(body)
    return particles, springs - len({number for number in body.cut if number < springs})


def form_count(body: AnyBody) -> tuple[int, int]:
    """Particles and springs of a body's form, those that are cut included; else as `count`."""
    match body:
        case RopeDef():
            return body.segments + 1, body.segments
        case BridgeDef():
            return 2 * (body.segments + 1), 5 * body.segments + 1
        case GirderDef():
            return 2 * body.segments + 1, 4 * body.segments - 1
        case WebDef():
            return 1 + body.spokes * body.rings, 2 * body.spokes * body.rings
        case WheelDef():
            return 1 + 2 * body.segments, 6 * body.segments
        case RingDef():
            return body.segments, body.segments
        case MeshDef():
            return len(body.particles), len(body.springs)
        case JellyDef():
            return _count_jelly(body)


def expand(body: AnyBody) -> tuple[Points, Pairs]:
    """Positions [m] (n, 2) and pairs (m, 2) of a body's form, in generation order."""
    match body:
        case RopeDef():
            return _row(body.start, body.end, body.segments), _chain(body.segments)
        case BridgeDef():
            return _bridge(body)
        case GirderDef():
            return _girder(body)
        case WebDef():
            return _web(body)
        case WheelDef():
            return _wheel(body)
        case RingDef():
            centre = np.array(body.position, dtype=np.float64)
            return centre + body.radius * _spokes(body.angle, body.segments), _ring(0, body.segments)
        case MeshDef():
            pairs = np.array(body.springs, dtype=np.int64).reshape(-1, 2)
            return np.array(body.particles, dtype=np.float64).reshape(-1, 2), pairs
        case JellyDef():
            return _jelly(body)


def distances(points: Points, pairs: Pairs) -> Points:
    """Distance [m] (m,) of the two particles of each pair."""
    apart = points[pairs[:, 1]] - points[pairs[:, 0]]
    return np.asarray(np.sqrt(apart[:, 0] * apart[:, 0] + apart[:, 1] * apart[:, 1]))


def box_grid(body: JellyDef) -> tuple[int, int]:
    """Columns and rows of a box of jelly."""
    assert isinstance(body.shape, BoxShape)
    width, height = body.shape.box
    return round(width / body.spacing) + 1, round(height / body.spacing) + 1


def turn(angle: float) -> tuple[float, float]:
    """Cosine and sine of an angle [rad], rounded."""
    return round(math.cos(angle), TRIGONOMETRY_DECIMALS), round(math.sin(angle), TRIGONOMETRY_DECIMALS)


def _row(start: tuple[float, float], end: tuple[float, float], segments: int) -> Points:
    steps = np.arange(segments + 1, dtype=np.float64)
    x = start[0] + (end[0] - start[0]) * steps / segments
    y = start[1] + (end[1] - start[1]) * steps / segments
    row = np.stack([x, y], axis=1)
    row[-1] = end
    return row


def _chain(segments: int) -> Pairs:
    first = np.arange(segments, dtype=np.int64)
    return np.stack([first, first + 1], axis=1)


def _bridge(body: BridgeDef) -> tuple[Points, Pairs]:
    nodes = body.segments + 1
    top = _row(body.start, body.end, body.segments)
    bottom = top - np.array([0.0, body.height])
    chords = _chain(body.segments)
    post = np.arange(nodes, dtype=np.int64)
    posts = np.stack([post, post + nodes], axis=1)
    cell = np.arange(body.segments, dtype=np.int64)
    falling = np.stack([cell, cell + nodes + 1], axis=1)
    rising = np.stack([cell + nodes, cell + 1], axis=1)
    diagonals = np.stack([falling, rising], axis=1).reshape(-1, 2)
    return np.concatenate([top, bottom]), np.concatenate([chords, chords + nodes, posts, diagonals])


def girder_offset(body: GirderDef) -> tuple[float, float]:
    """How far [m] a girder's second row lies to the right of its first; start and end must be apart."""
    across, up = body.end[0] - body.start[0], body.end[1] - body.start[1]
    length = math.sqrt(across * across + up * up)
    return body.height * (up / length), -body.height * (across / length)


def _girder(body: GirderDef) -> tuple[Points, Pairs]:
    nodes = body.segments + 1
    first = _row(body.start, body.end, body.segments)
    second = (first[:-1] + first[1:]) / 2.0 + np.array(girder_offset(body))
    cell = np.arange(body.segments, dtype=np.int64)
    zigzag = np.stack([np.stack([cell, cell + nodes], axis=1), np.stack([cell + nodes, cell + 1], axis=1)], axis=1)
    chords = np.concatenate([_chain(body.segments), _chain(body.segments - 1) + nodes])
    return np.concatenate([first, second]), np.concatenate([chords, zigzag.reshape(-1, 2)])


def _spokes(angle: float, spokes: int) -> Points:
    """Unit vectors (spokes, 2) all round, counter-clockwise from an angle [rad] on."""
    return np.array([turn(angle + math.tau * spoke / spokes) for spoke in range(spokes)])


def _ring(first: int, size: int) -> Pairs:
    """Pairs of neighbours in a ring of that many particles, which begins at an index."""
    spoke = np.arange(size, dtype=np.int64)
    return first + np.stack([spoke, (spoke + 1) % size], axis=1)


def _web(body: WebDef) -> tuple[Points, Pairs]:
    centre = np.array([body.position], dtype=np.float64)
    radii = body.radius * np.arange(1, body.rings + 1, dtype=np.float64) / body.rings
    rings = centre + (radii[:, None, None] * _spokes(body.angle, body.spokes)).reshape(-1, 2)
    outer = np.arange(1, len(rings) + 1, dtype=np.int64)
    radial = np.stack([np.maximum(outer - body.spokes, 0), outer], axis=1)
    chords = [_ring(1 + ring * body.spokes, body.spokes) for ring in range(body.rings)]
    return np.concatenate([centre, rings]), np.concatenate([radial, *chords])


def _wheel(body: WheelDef) -> tuple[Points, Pairs]:
    hub = np.array([body.position], dtype=np.float64)
    spokes = _spokes(body.angle, body.segments)
    points = np.concatenate([hub, hub + (body.radius - body.thickness) * spokes, hub + body.radius * spokes])
    inner = np.arange(1, body.segments + 1, dtype=np.int64)
    outer = inner + body.segments
    first, second = _ring(1, body.segments), _ring(1 + body.segments, body.segments)
    diagonals = np.stack([np.stack([inner, second[:, 1]], axis=1), np.stack([outer, first[:, 1]], axis=1)], axis=1)
    spring_rows = [np.stack([np.zeros_like(inner), inner], axis=1), first, second, np.stack([inner, outer], axis=1)]
    return points, np.concatenate([*spring_rows, diagonals.reshape(-1, 2)])


def _reach(shape: CircleShape, spacing: float) -> int:
    return math.floor(shape.circle / spacing + BORDER)


def jelly_cells(body: JellyDef) -> NDArray[np.bool_]:
    """Which points of the grid over a circle or polygon belong to the jelly (rows, columns), from the bottom left."""
    if isinstance(body.shape, CircleShape):
        reach = _reach(body.shape, body.spacing)
        steps = np.arange(-reach, reach + 1, dtype=np.float64)
        ratio = body.shape.circle / body.spacing + BORDER
        return largest_part(steps[:, None] * steps[:, None] + steps[None, :] * steps[None, :] <= ratio * ratio)
    assert not isinstance(body.shape, BoxShape)
    return largest_part(polygon_grid(body.shape.polygon, body.spacing)[2])


def jelly_triangles(body: JellyDef) -> Pairs:
    """Triangles (t, 3) of a jelly's particles, counter-clockwise: two of each cell of its grid, one of three corners.

    Cells are cut along one diagonal and the other in turns, as a chessboard is coloured: no way of shearing is easier.
    """
    cells = np.ones(box_grid(body)[::-1], dtype=np.bool_) if isinstance(body.shape, BoxShape) else jelly_cells(body)
    numbers = _numbers(cells)
    corners = np.stack([numbers[:-1, :-1], numbers[:-1, 1:], numbers[1:, 1:], numbers[1:, :-1]], axis=-1)
    row, column = np.indices(corners.shape[:2])
    corners = corners.reshape(-1, 4)
    missing = corners < 0
    # A missing corner is cut off; of whole cells the first or the second.
    cut = np.where(missing.any(axis=1), np.argmax(missing, axis=1), ((row + column) % 2).reshape(-1))
    ahead = cut[:, None] + np.array([1, 2, 3])
    inner = np.take_along_axis(corners, ahead % 4, axis=1)
    outer = np.take_along_axis(corners, (cut[:, None] + np.array([3, 4, 5])) % 4, axis=1)
    both = np.stack([inner, outer], axis=1).reshape(-1, 3)
    return both[(both >= 0).all(axis=1)]


def _count_jelly(body: JellyDef) -> tuple[int, int]:
    if isinstance(body.shape, BoxShape):
        columns, rows = box_grid(body)
        across, up = columns - 1, rows - 1
        return columns * rows, across * rows + columns * up + 2 * across * up
    if isinstance(body.shape, CircleShape) and _reach(body.shape, body.spacing) ** 2 > PARTICLE_LIMIT:
        return 2 * PARTICLE_LIMIT, 0
    return count_cells(jelly_cells(body))


def count_cells(cells: NDArray[np.bool_]) -> tuple[int, int]:
    """Particles and springs of a jelly on the points of a grid (rows, columns) that are set."""
    return int(np.count_nonzero(cells)), len(_neighbours(_numbers(cells)))


def _numbers(cells: NDArray[np.bool_]) -> Pairs:
    numbers = np.full(cells.shape, -1, dtype=np.int64)
    numbers[cells] = np.arange(np.count_nonzero(cells))
    return numbers


def _neighbours(numbers: Pairs) -> Pairs:
    """Pairs of a grid of indices (rows, columns), -1 = none: all right, all up, then per cell both diagonals."""
    right = np.stack([numbers[:, :-1], numbers[:, 1:]], axis=-1).reshape(-1, 2)
    up = np.stack([numbers[:-1], numbers[1:]], axis=-1).reshape(-1, 2)
    rising = np.stack([numbers[:-1, :-1], numbers[1:, 1:]], axis=-1)
    falling = np.stack([numbers[:-1, 1:], numbers[1:, :-1]], axis=-1)
    diagonals = np.stack([rising, falling], axis=-2).reshape(-1, 2)
    pairs = np.concatenate([right, up, diagonals])
    return pairs[(pairs[:, 0] >= 0) & (pairs[:, 1] >= 0)]


def _stretched(size: float, points: int) -> Points:
    if points == 1:
        return np.zeros(1)
    return size * np.arange(points, dtype=np.float64) / (points - 1) - size / 2.0


def _jelly(body: JellyDef) -> tuple[Points, Pairs]:
    if isinstance(body.shape, BoxShape):
        columns, rows = box_grid(body)
        across, up = _stretched(body.shape.box[0], columns), _stretched(body.shape.box[1], rows)
        cells = np.ones((rows, columns), dtype=np.bool_)
    else:
        left, bottom = 0, 0
        if isinstance(body.shape, CircleShape):
            left = bottom = -_reach(body.shape, body.spacing)
        else:
            left, bottom, _ = polygon_grid(body.shape.polygon, body.spacing)
        cells = jelly_cells(body)
        across = (left + np.arange(cells.shape[1], dtype=np.float64)) * body.spacing
        up = (bottom + np.arange(cells.shape[0], dtype=np.float64)) * body.spacing
    row, column = np.nonzero(cells)
    return _placed(across[column], up[row], body), _neighbours(_numbers(cells))


def _placed(x: Points, y: Points, body: JellyDef) -> Points:
    cosine, sine = turn(body.angle)
    return np.stack([body.position[0] + (x * cosine - y * sine), body.position[1] + (x * sine + y * cosine)], axis=1)
