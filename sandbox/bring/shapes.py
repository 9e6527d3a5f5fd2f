"""Solid shapes of a drawing: what its outlines fill, united where they overlap."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from sandbox.bring.sketch import POINT_LIMIT, FilledShape, Ring, Rule, Sketch, Unreadable, bounds

if TYPE_CHECKING:
    from shapely import Polygon

# Where sides meet more often than this, uniting takes more than seconds.
MEETING_LIMIT = 60_000
# Pairs of sides that are looked at whether they meet.
NEAR_LIMIT = 2_000_000
# Faces of a path that crosses itself, times its points.
WINDING_LIMIT = 200_000_000
# Of the size of a drawing: what is not seen; outlines are simplified by it before anything else.
UNSEEN = 1.0 / 4000.0
_CHUNK = 500


@dataclass(frozen=True)
class Region:
    """A connected region, and what its largest part is called and painted."""

    polygon: "Polygon"
    colour: str | None
    name: str


def solid_shapes(drawing: Sketch) -> list[Region]:
    """The connected regions that the outlines fill, the largest first. Raises Unreadable."""
    import shapely

    box = bounds(drawing.points())
    if box is None:
        return []
    size = max(box[2] - box[0], box[3] - box[1])
    unseen = max(size * UNSEEN, drawing.tolerance)
    outlines = [(outline, _simplified(outline, unseen)) for outline in drawing.outlines]
    rings = [ring for _, kept in outlines for ring in kept]
    if sum(map(len, rings)) > POINT_LIMIT:
        raise Unreadable(f"has more than {POINT_LIMIT:,} points; simplify it")
    _check_meetings(rings)
    parts: list[tuple[Any, FilledShape]] = []
    for outline, kept in outlines:
        found = _filled(kept, outline.rule)
        if found.area > 0.0:
            parts.append((found, outline))
    united = shapely.unary_union([found for found, _ in parts])
    regions = [region for region in polygons_of(united) if region.area > 0.0]
    return sorted(_named(regions, parts), key=lambda shape: -shape.polygon.area)


def polygons_of(geometry: Any) -> list["Polygon"]:
    """The polygons in a geometry."""
    return [
        part for part in getattr(geometry, "geoms", [geometry]) if part.geom_type == "Polygon" and not part.is_empty
    ]


def _simplified(outline: FilledShape, unseen: float) -> list[Ring]:
    import shapely

    kept = []
    for ring in outline.rings:
        if len(ring) < 3:
            continue
        line = shapely.LineString(np.concatenate([ring, ring[:1]]))
        ring = shapely.get_coordinates(shapely.simplify(line, unseen, preserve_topology=False))[:-1]
        if len(ring) > 2:
            kept.append(ring)
    return kept


def _check_meetings(rings: Sequence[Ring]) -> None:
    """Raise Unreadable where sides of rings meet too often."""
    import shapely

    if not rings:
        return
    ends = np.concatenate([np.stack([ring, np.roll(ring, -1, axis=0)], axis=1) for ring in rings])
    sides = shapely.linestrings(ends)
    tree = shapely.STRtree(sides)
    near = met = 0
    for first in range(0, len(sides), _CHUNK):
        one, other = tree.query(sides[first : first + _CHUNK])
        near += len(one)
        if near <= NEAR_LIMIT:
            met += int(np.count_nonzero(shapely.intersects(sides[one + first], sides[other])))
        if near > NEAR_LIMIT or met > 2 * MEETING_LIMIT + 8 * len(sides):
            raise Unreadable("has too many sides that cross or lie on each other; unite its shapes, or simplify it")


def _filled(rings: Sequence[Ring], rule: Rule) -> Any:
    """What rings fill by a rule."""
    import shapely

    if not rings:
        return shapely.Polygon()
    if len(rings) == 1:
        whole = shapely.Polygon(rings[0])
        if whole.is_valid:
            return whole
    noded = shapely.unary_union([shapely.LinearRing(ring) for ring in rings])
    faces = np.array(polygons_of(shapely.polygonize([noded])), dtype=object)
    if not len(faces):
        return shapely.Polygon()
    if len(faces) * sum(map(len, rings)) > WINDING_LIMIT:
        raise Unreadable("has a path that crosses itself too often; simplify it")
    wound = _windings(shapely.get_coordinates(shapely.point_on_surface(faces)), rings)
    inside = wound % 2 != 0 if rule == "evenodd" else wound != 0
    return shapely.unary_union(faces[inside])


def _windings(places: NDArray[np.float64], rings: Iterable[Ring]) -> NDArray[np.int64]:
    """How often rings go around each of some places (n, 2), counter-clockwise."""
    total = np.zeros(len(places), dtype=np.int64)
    for ring in rings:
        a, b = ring[:, None], np.roll(ring, -1, axis=0)[:, None]
        for first in range(0, len(places), _CHUNK):
            p = places[first : first + _CHUNK]
            cross = (b[..., 0] - a[..., 0]) * (p[:, 1] - a[..., 1]) - (b[..., 1] - a[..., 1]) * (p[:, 0] - a[..., 0])
            rises = (a[..., 1] <= p[:, 1]) & (b[..., 1] > p[:, 1]) & (cross > 0.0)
            falls = (a[..., 1] > p[:, 1]) & (b[..., 1] <= p[:, 1]) & (cross < 0.0)
            total[first : first + _CHUNK] += rises.sum(axis=0) - falls.sum(axis=0)
    return total


def _named(regions: Sequence["Polygon"], parts: Sequence[tuple[Any, FilledShape]]) -> list[Region]:
    """Each region with the name and colour of the largest part in it."""
    import shapely

    if not regions:
        return []
    tree = shapely.STRtree(regions)
    largest: dict[int, tuple[float, FilledShape]] = {}
    for geometry, outline in parts:
        for piece in polygons_of(geometry):
            found = tree.query(piece.representative_point(), predicate="within")
            for index in found.tolist():
                if piece.area > largest.get(index, (-math.inf,))[0]:
                    largest[index] = piece.area, outline
    shapes = []
    for index, region in enumerate(regions):
        part = largest[index][1] if index in largest else None
        shapes.append(Region(region, part.colour if part else None, part.name if part else ""))
    return shapes


def without_holes(polygon: "Polygon") -> list["Polygon"]:
    """A region cut upright through each of its holes, so that its pieces have none."""
    import shapely

    done, waiting = [], [polygon]
    while waiting:
        piece = waiting.pop()
        if not piece.interiors:
            done.append(piece)
            continue
        x = shapely.Polygon(piece.interiors[0]).representative_point().x
        left, bottom, right, top = piece.bounds
        for half in (shapely.box(left, bottom, x, top), shapely.box(x, bottom, right, top)):
            waiting += polygons_of(shapely.intersection(piece, half))
    return done
