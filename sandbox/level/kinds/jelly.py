"""Jelly: a soft body inside a box, a circle or a polygon, on a square grid or fitted to its outline."""

import math
from collections.abc import Iterator
from functools import cached_property, lru_cache
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Discriminator, Field, Tag

from sandbox.level.format.level_error import Fault, shown
from sandbox.level.format.limits import COORDINATE_LIMIT, CORNER_LIMIT, PARTICLE_LIMIT
from sandbox.level.format.quantities import Angle, Description, Mass, Point, Size, Spacing, unit
from sandbox.level.kinds.body_def import BodyDef
from sandbox.level.kinds.expansion import NO_HULL, NO_POLYGONS, Expansion, directed_sides, edges_of, outline_of
from sandbox.level.kinds.geometry import (
    BORDER,
    FittedMesh,
    Loop,
    Pairs,
    Points,
    TooCoarse,
    corners_of,
    disc_counts,
    disc_rings,
    fitted_mesh,
    fitted_work,
    fitting_spacing,
    grid_bounds,
    holds,
    is_simple,
    largest_part,
    loops_touch,
    polygon_grid,
    turn,
)


class BoxShape(Description):
    """A rectangle about the jelly's centre."""

    box: tuple[Size, Size] = Field(description="Width and height.", json_schema_extra=unit("m"))


class CircleShape(Description):
    """A disc about the jelly's centre."""

    circle: Size = Field(description="Radius.")


class PolygonShape(Description):
    """A simple polygon, corners relative to the jelly's centre."""

    polygon: tuple[Point, ...] = Field(
        min_length=3,
        description="Corners in order, relative to the jelly's position. Sides may not touch or cross.",
    )


SHAPES: dict[str, type[Description]] = {"box": BoxShape, "circle": CircleShape, "polygon": PolygonShape}


def _shape_of(value: Any) -> str | None:
    if isinstance(value, dict):
        return next((name for name in SHAPES if name in value), None)
    return next((name for name in SHAPES if hasattr(value, name)), None)


Shape = Annotated[
    Annotated[BoxShape, Tag("box")] | Annotated[CircleShape, Tag("circle")] | Annotated[PolygonShape, Tag("polygon")],
    Discriminator(_shape_of),
]


class JellyDef(BodyDef):
    """A soft body: particles on a square grid inside a shape, each joined to its eight neighbours, or fitted to it."""

    type: Literal["jelly"] = Field(description="Kind of body.")
    shape: Shape = Field(description='`{"box": [w, h]}`, `{"circle": radius}` or `{"polygon": [[x, y], ...]}`.')
    position: Point = Field(default=(0.0, 0.0), description="Place of the centre, the shape's own [0, 0].")
    angle: Angle = Field(default=0.0, description="Turn about the centre, counter-clockwise.")
    mesh: Literal["grid", "fitted"] = Field(
        default="grid",
        description='"grid": a square grid. "fitted": particles evenly on the outline, even triangles inside.',
    )
    holes: tuple[Annotated[tuple[Point, ...], Field(min_length=3)], ...] = Field(
        default=(),
        max_length=CORNER_LIMIT,
        description='Holes of a "fitted" mesh, each the corners of a polygon inside the shape, relative to the '
        "jelly's position; none touches another or the outline.",
        json_schema_extra=unit("m"),
    )
    spacing: Spacing = Field(description="Distance between neighbours in the mesh. A box stretches its grid to fit.")
    particle_mass: Mass = Field(default=1.0, description="Mass of each particle.")
    area: bool = Field(
        default=True,
        description="Whether its triangles keep their areas, with Cs and Cd of its material. Then it recovers after it "
        "was crushed or turned inside out. With a Hooke material they never do.",
    )


class Jelly(Expansion[JellyDef]):
    """The points of a grid inside a shape, or a fitted mesh."""

    model = JellyDef
    size_path = ("spacing",)
    alternatives = SHAPES
    plural = "jellies"
    generation = """\
- Jelly, box: `round(width / spacing) + 1` columns, and rows likewise, stretched to fit the box; row by row from the
  bottom left. A single column or row stands in the middle.
- Jelly, circle and polygon: the points at whole multiples of `spacing` from the shape's own [0, 0] that lie inside the
  shape or on its border; row by row from the bottom left.
- Springs of a jelly on a grid: all rightward ones, all upward ones, then per cell the diagonal that rises to the right
  and the other one; each where both ends exist. `angle` turns the shape afterwards.
- Jelly, fitted: first the outline, counter-clockwise from its first fixed corner, of a circle from the right; then each
  hole, clockwise; then the inside. A corner is fixed if the outline turns by 20 degrees or more from half a spacing
  before it to half a spacing after it. Of two fixed corners nearer than half a spacing, the sharper one stays. Between
  fixed corners particles stand on the outline at equal distances, as near to `spacing` as a whole number allows.
- Jelly, fitted circle without holes: `round(radius / spacing)` rings, at least 1; ring k has 6 k particles. From the
  border inwards, each ring counter-clockwise from the right; the centre last.
- Jelly, fitted, any other: inside are the points of a lattice of even triangles around the shape's own [0, 0], row by
  row from the bottom left. The program moves points a little if that makes triangles more even. The triangles are
  Delaunay's. No angle is below 20 degrees, or half the sharpest corner of the outline if that is less, and none is
  below 5. If the spacing is too large for that, the program refuses the file and names a spacing that fits.
- Springs of a fitted jelly: the sides of its triangles, by their lower particles, then by their higher ones."""

    @property
    def polygon_work(self) -> tuple[int, int]:
        """Corners, and the work of filling: columns and sides of each row, or the triangles of a fitted mesh."""
        shape = self.body.shape
        if self._is_fitted:
            corners = len(shape.polygon) if isinstance(shape, PolygonShape) else 0
            work = 0 if self._is_disc else fitted_work(self._outline, self.body.holes, self.body.spacing)
            return corners + sum(map(len, self.body.holes)), work
        if not isinstance(shape, PolygonShape):
            return 0, 0
        _, _, columns, rows = grid_bounds(shape.polygon, self.body.spacing)
        return len(shape.polygon), rows * (columns + len(shape.polygon))

    @cached_property
    def form_count(self) -> tuple[int, int]:
        """Numbers of points and springs; for a circle beyond the limit, any number above the limit."""
        if self._is_disc:
            return disc_counts(disc_rings(self._outline, self.body.spacing))
        if self._is_fitted:
            return (0, 0) if self._fitted is None else (len(self._fitted.places), len(self._fitted.pairs))
        if isinstance(self.body.shape, BoxShape):
            columns, rows = self._box_grid()
            across, up = columns - 1, rows - 1
            return columns * rows, across * rows + columns * up + 2 * across * up
        if isinstance(self.body.shape, CircleShape) and self._reach() ** 2 > PARTICLE_LIMIT:
            return 2 * PARTICLE_LIMIT, 0
        cells = self._grid[2]
        springs = sum(int(np.count_nonzero(cells[a] & cells[b])) for a, b in _NEIGHBOURS)
        return int(np.count_nonzero(cells)), springs

    @cached_property
    def local_form(self) -> tuple[Points, Pairs]:
        body = self.body
        if self._fitted is not None:
            x, y = self._fitted.places.T
            return _turned(x, y, body.angle), self._fitted.pairs
        left, bottom, cells = self._grid
        if isinstance(body.shape, BoxShape):
            columns, rows = self._box_grid()
            across, up = _stretched(body.shape.box[0], columns), _stretched(body.shape.box[1], rows)
        else:
            across = (left + np.arange(cells.shape[1], dtype=np.float64)) * body.spacing
            up = (bottom + np.arange(cells.shape[0], dtype=np.float64)) * body.spacing
        row, column = np.nonzero(cells)
        return _turned(across[column], up[row], body.angle), _neighbours(self._numbers)

    @property
    def edges(self) -> NDArray[np.int8]:
        """Kind of edge (m,): a side of only one square or triangle of the mesh is solid."""
        count = self.form_count[0]
        sides = _sides(self._numbers, count) if self._fitted is None else directed_sides(self._fitted.triangles, count)
        return edges_of(self.pairs, *sides, count)

    def polygons(self) -> Pairs:
        """Triangles (t, 3), counter-clockwise: of the fitted mesh, or of each grid cell, which has two or one.

        The diagonals that cut cells alternate like the colours of a chessboard, so it is equally stiff against shear
        either way.
        """
        if not self.body.area:
            return NO_POLYGONS
        if self._fitted is not None:
            return self._fitted.triangles
        corners = _corners(self._numbers)
        row, column = np.indices(corners.shape[:2])
        corners = corners.reshape(-1, 4)
        missing = corners < 0
        # A cell of three corners has one triangle, a whole cell two.
        cut = np.where(missing.any(axis=1), np.argmax(missing, axis=1), ((row + column) % 2).reshape(-1))
        ahead = cut[:, None] + np.array([1, 2, 3])
        inner = np.take_along_axis(corners, ahead % 4, axis=1)
        outer = np.take_along_axis(corners, (cut[:, None] + np.array([3, 4, 5])) % 4, axis=1)
        both = np.stack([inner, outer], axis=1).reshape(-1, 3)
        return both[(both >= 0).all(axis=1)]

    def hull(self) -> Pairs:
        """The jelly's outline, unless one of its springs is cut."""
        return NO_HULL if self.body.cut else outline_of(self.edges)

    def faults(self, path: str) -> Iterator[Fault]:
        """Faults of a shape that crosses itself, leaves the world, or has no point of the grid inside."""
        outline = list(self.outline_faults(path))
        yield from outline
        if self.form_count[0] or (self._is_fitted and outline):
            return
        if not self._is_fitted:
            yield f"{path}.spacing", "no point of the grid lies inside the polygon; make it smaller"
            return
        finer = fitting_spacing(self._outline, self.body.holes, self.body.spacing)
        advice = "draw it simpler" if finer is None else f"{shown(finer)} would do"
        yield f"{path}.spacing", f"{shown(self.body.spacing)} is too coarse for triangles to fit the outline; {advice}"

    def outline_faults(self, path: str) -> Iterator[Fault]:
        """Faults of a shape that crosses itself or leaves the world, and of holes that touch or leave the shape."""
        shape = self.body.shape
        if isinstance(shape, PolygonShape) and not is_simple(shape.polygon):
            yield f"{path}.shape.polygon", _NOT_SIMPLE
        elif self.body.holes and not self._is_fitted:
            yield f"{path}.holes", 'need "mesh": "fitted"; a grid has none'
        else:
            yield from self._hole_faults(path)
        if self._farthest() > COORDINATE_LIMIT:
            yield f"{path}.position", f"takes the shape beyond the limit {COORDINATE_LIMIT:.15g}"

    def _hole_faults(self, path: str) -> Iterator[Fault]:
        holes = self.body.holes
        for index, hole in enumerate(holes):
            place = f"{path}.holes.{index}"
            if not is_simple(hole):
                yield place, _NOT_SIMPLE
            elif loops_touch([hole, self._corners]) or not holds(self._corners, hole[0]):
                yield place, "does not lie inside the outline; move it in, or take it out"
            else:
                for other, before in enumerate(holes[:index]):
                    if loops_touch([hole, before]) or holds(before, hole[0]) or holds(hole, before[0]):
                        yield place, f"touches hole {other} or overlaps it; move them apart, or make them one"
                        break

    @property
    def _is_fitted(self) -> bool:
        return self.body.mesh == "fitted"

    @property
    def _is_disc(self) -> bool:
        """Whether the jelly is a disc, which is meshed in rings."""
        return self._is_fitted and isinstance(self.body.shape, CircleShape) and not self.body.holes

    @property
    def _outline(self) -> Loop | float:
        """Corners of the shape, or the radius of a circle."""
        shape = self.body.shape
        if isinstance(shape, CircleShape):
            return shape.circle
        if isinstance(shape, PolygonShape):
            return shape.polygon
        x, y = shape.box[0] / 2.0, shape.box[1] / 2.0
        return (-x, -y), (x, -y), (x, y), (-x, y)

    @cached_property
    def _corners(self) -> Loop:
        """Corners of the outline, of a circle those that its mesh has on it."""
        return corners_of(self._outline, self.body.spacing)

    @cached_property
    def _fitted(self) -> FittedMesh | None:
        """The fitted mesh; None if it has a grid, or if no mesh fits."""
        if not self._is_fitted or any(True for _ in self.outline_faults("")):
            return None
        try:
            return fitted_mesh(self._outline, self.body.holes, self.body.spacing)
        except TooCoarse:
            return None

    @cached_property
    def _grid(self) -> tuple[int, int, NDArray[np.bool_]]:
        """Left and bottom of the grid over the shape, and which of its points (rows, columns) belong to the shape."""
        body, shape = self.body, self.body.shape
        if isinstance(shape, BoxShape):
            return 0, 0, np.ones(self._box_grid()[::-1], dtype=np.bool_)
        return _grid_in(shape.circle if isinstance(shape, CircleShape) else shape.polygon, body.spacing)

    @cached_property
    def _numbers(self) -> Pairs:
        """Index of the particle on each point of the grid (rows, columns); -1 = none."""
        cells = self._grid[2]
        numbers = np.full(cells.shape, -1, dtype=np.int64)
        numbers[cells] = np.arange(np.count_nonzero(cells))
        return numbers

    def _box_grid(self) -> tuple[int, int]:
        """Columns and rows of a box."""
        assert isinstance(self.body.shape, BoxShape)
        width, height = self.body.shape.box
        return round(width / self.body.spacing) + 1, round(height / self.body.spacing) + 1

    def _reach(self) -> int:
        """Points of the grid on either side of the centre of a circle."""
        assert isinstance(self.body.shape, CircleShape)
        return _reach(self.body.shape.circle, self.body.spacing)

    def _farthest(self) -> float:
        """Largest absolute coordinate [m] of the outline."""
        body, shape = self.body, self.body.shape
        if isinstance(shape, CircleShape):
            return max(map(abs, body.position)) + shape.circle
        if isinstance(shape, BoxShape):
            x, y = shape.box[0] / 2, shape.box[1] / 2
            corners: tuple[tuple[float, float], ...] = ((x, y), (-x, y), (-x, -y), (x, -y))
        else:
            corners = shape.polygon
        cosine, sine = turn(body.angle)
        across, up = body.position
        return max(max(abs(across + x * cosine - y * sine), abs(up + x * sine + y * cosine)) for x, y in corners)


def _reach(radius: float, spacing: float) -> int:
    return math.floor(radius / spacing + BORDER)


# Cached, since every edit of another body checks this one again.
@lru_cache(maxsize=64)
def _grid_in(outline: tuple[Point, ...] | float, spacing: float) -> tuple[int, int, NDArray[np.bool_]]:
    """Left and bottom of a grid, and which of its points (rows, columns) lie in a polygon or a circle [m]."""
    if isinstance(outline, float | int):
        reach = _reach(outline, spacing)
        steps = np.arange(-reach, reach + 1, dtype=np.float64)
        ratio = outline / spacing + BORDER
        left, bottom, points = -reach, -reach, steps[:, None] * steps[:, None] + steps * steps <= ratio * ratio
    else:
        left, bottom, points = polygon_grid(outline, spacing)
    inside = largest_part(points)
    inside.setflags(write=False)
    return left, bottom, inside


_NOT_SIMPLE = "its sides touch or cross, or a corner comes twice; draw it without"
_ALL, _FIRST, _LAST = slice(None), slice(None, -1), slice(1, None)
# Both ends of the springs of a grid [rows, columns]: to the right, upward, rising to the right, and falling.
_NEIGHBOURS = (
    ((_ALL, _FIRST), (_ALL, _LAST)),
    ((_FIRST, _ALL), (_LAST, _ALL)),
    ((_FIRST, _FIRST), (_LAST, _LAST)),
    ((_FIRST, _LAST), (_LAST, _FIRST)),
)


def _neighbours(numbers: Pairs) -> Pairs:
    """Pairs of a grid of indices (rows, columns; -1 = none): rightward, upward, then both diagonals of each cell."""
    right, up, rising, falling = (np.stack([numbers[a], numbers[b]], axis=-1) for a, b in _NEIGHBOURS)
    diagonals = np.stack([rising, falling], axis=-2)
    pairs = np.concatenate([part.reshape(-1, 2) for part in (right, up, diagonals)])
    return pairs[(pairs[:, 0] >= 0) & (pairs[:, 1] >= 0)]


def _corners(numbers: Pairs) -> Pairs:
    """Corners of each cell of a grid (rows, columns, 4), counter-clockwise from the bottom left, -1 = none."""
    return np.stack([numbers[:-1, :-1], numbers[:-1, 1:], numbers[1:, 1:], numbers[1:, :-1]], axis=-1)


def _sides(numbers: Pairs, count: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Keys a n + b of the sides from a to b of squares and triangles, counter-clockwise, and of diagonals."""
    corners = _corners(numbers).reshape(-1, 4)
    present = corners >= 0
    full = corners[present.all(axis=1)]
    sides = [full[:, [k, (k + 1) % 4]] for k in range(4)]
    for missing in range(4):
        three = corners[(present.sum(axis=1) == 3) & ~present[:, missing]]
        around = [(missing + k) % 4 for k in (1, 2, 3)]
        sides += [three[:, [around[k], around[(k + 1) % 3]]] for k in range(3)]
    directed = np.concatenate(sides)
    inner = np.concatenate([full[:, [0, 2]], full[:, [1, 3]]])
    return directed[:, 0] * count + directed[:, 1], inner[:, 0] * count + inner[:, 1]


def _turned(x: NDArray[np.float64], y: NDArray[np.float64], angle: float) -> Points:
    cosine, sine = turn(angle)
    return np.stack([x * cosine - y * sine, x * sine + y * cosine], axis=1)


def _stretched(size: float, points: int) -> Points:
    if points == 1:
        return np.zeros(1)
    return size * np.arange(points, dtype=np.float64) / (points - 1) - size / 2.0
