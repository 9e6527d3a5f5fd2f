"""Makes a level of a drawing: jellies or ground, in metres, its middle at x = 0 and its lowest point at y = 0.

What its outlines fill, united where they overlap, are regions. Of each there is ground without holes, or a jelly: an
even mesh of a bounded number of particles, whatever the outline.
"""

import math
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from sandbox.bring.picture import cut_out
from sandbox.bring.sketch import (
    POINT_LIMIT,
    FilledShape,
    Kind,
    LeftOut,
    OpenLine,
    Pixels,
    Ring,
    Rule,
    Sketch,
    Unreadable,
    bounds,
)
from sandbox.level.document.model import ContactsDef, Level, TerrainDef
from sandbox.level.format.limits import CORNER_LIMIT, FORMAT, POLYGON_WORK_LIMIT, TERRAIN_LIMIT, TEXT_LIMIT, VERSION
from sandbox.level.format.look import BodyLook
from sandbox.level.format.picture import Picture
from sandbox.level.format.quantities import replaced, significant
from sandbox.level.kinds.bodies import expansion
from sandbox.level.kinds.body_def import FirmnessDef
from sandbox.level.kinds.geometry import fitting_spacing, is_simple, loops_touch
from sandbox.level.kinds.jelly import JellyDef, PolygonShape
from sandbox.physics.meshing.loops import ROW

if TYPE_CHECKING:
    from shapely import Polygon

_FORBIDDEN = str.maketrans({".": " ", ":": " ", ",": " "})

# Width [m] of what has no metres, unless told otherwise.
USUAL_WIDTH = 10.0
# What came in is no wider and no higher than this [m].
LARGEST = 10_000.0
# Corners of all ground: as many as a level holds, with some left for what is drawn beside it.
GROUND_CORNERS = 3_000
PIECES = TERRAIN_LIMIT - 100
# Regions that become ground: boxes alone bring no more corners than these.
REGIONS = 700
# How far ground is simplified first and how much more at each try, of its size; nothing is seen of the first.
GROUND_TOLERANCE, COARSER, TRIES = 1.0 / 1500.0, 1.6, 12
# Lines thinner than this, of the drawing's size, are no jelly.
THIN = 0.01
# Digits of a place: a tenth of a millimetre.
PLACE_DIGITS = 4
# What is said of a drawing of which nothing came in.
NOTHING = "has no outline to bring in"
# The ground under jellies [m]: how far it reaches beyond them, and how deep.
FLOOR_REACH, FLOOR_DEPTH = 10.0, 2.0
# Jellies at most.
BODY_LIMIT = 60
# Corners of all jellies, and the work of their meshes, of what a level may have.
MOST_CORNERS, MOST_WORK = CORNER_LIMIT - 500, POLYGON_WORK_LIMIT // 2
# Particles of all jellies, of one, and at least.
ALL_PARTICLES, MOST_PARTICLES, FEWEST_PARTICLES = 1_600, 500, 24
# A mesh may have so many times the particles that its area asks for, where its outline is fine.
FINE = 3.0
# How far details are worn away where no mesh fits, of the spacing.
WORN = (0.0, 0.1, 0.25, 0.5)
# How far an outline is simplified, of the spacing.
COARSE = 0.08
# Mass of a square metre [kg].
DENSITY = 20.0
# Digits of a spacing.
DIGITS = 3
SOFT = FirmnessDef(sag=0.1)
Loop = tuple[tuple[float, float], ...]
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


def level_of_drawing(drawing: Sketch, kind: Kind, width: float | None, name: str) -> Level:
    """A level of what a drawing holds. Raises Unreadable where that is nothing, or too much."""
    placed = _in_metres(drawing, width)
    if kind == "jelly":
        _thicken(placed)
    shapes = solid_shapes(placed)
    made = Level(format=FORMAT, version=VERSION, name=name, contacts=ContactsDef())
    if kind == "jelly":
        taken: set[str] = set()
        names = [free_name(shape.name or name, name, taken) for shape in shapes]
        bodies = _jellies(shapes, names, placed.left_out)
        made = replaced(made, bodies=tuple(bodies if placed.picture is None else _wearing(bodies, placed.picture)))
    else:
        if placed.picture is not None:
            placed.left_out.add("picture inside the outline")
        made = replaced(made, terrain=tuple(ground_of(shapes, placed.lines, name, placed.left_out)))
    check_found(made.bodies or made.terrain, placed.left_out)
    return made


def _in_metres(drawing: Sketch, width: float | None) -> Sketch:
    box = bounds(drawing.points())
    check_found(box, drawing.left_out)
    assert box is not None
    left, bottom, right, top = box
    across, up = right - left, top - bottom
    size = max(across, up)
    if size <= 0.0:
        raise Unreadable(f"{NOTHING}: all of its points are one")
    usual = 1.0 / drawing.metre if drawing.metre else USUAL_WIDTH / size
    scale = usual if width is None else width / (across or up)
    if size * scale > LARGEST:
        raise Unreadable(f"would be {size * scale:,.0f} m large; at most {LARGEST:,.0f} m: give it a smaller width")
    moved = Sketch(drawing.usual, left_out=drawing.left_out, tolerance=drawing.tolerance * scale)
    origin = np.array([(left + right) / 2.0, bottom])
    if drawing.picture is not None:
        pixels, (x, y), size = drawing.picture.pixels, drawing.picture.corner, drawing.picture.size
        moved.picture = Pixels(pixels, ((x - origin[0]) * scale, (y - origin[1]) * scale), size * scale)
    for outline in drawing.outlines:
        rings = tuple((ring - origin) * scale for ring in outline.rings)
        moved.outlines.append(FilledShape(rings, outline.rule, outline.colour, outline.name))
    for line in drawing.lines:
        moved.lines.append(OpenLine((line.points - origin) * scale, line.width * scale, line.colour, line.name))
    return moved


def _thicken(drawing: Sketch) -> None:
    """Make outlines of lines that are drawn thick; thin ones are counted."""
    import shapely

    box = bounds(drawing.points())
    assert box is not None
    thin = THIN * max(box[2] - box[0], box[3] - box[1])
    for line in drawing.lines:
        if line.width < thin or len(line.points) > 2_000:
            drawing.left_out.add("open line too thin for a jelly (as ground it comes in)")
            continue
        around = shapely.LineString(line.points).buffer(line.width / 2.0, quad_segs=4)
        rings = (around.exterior, *around.interiors)
        points = tuple(shapely.get_coordinates(ring)[:-1] for ring in rings)
        drawing.outlines.append(FilledShape(points, "evenodd", line.colour, line.name))


def check_found(found: object, left_out: LeftOut) -> None:
    """Raise Unreadable where nothing has come in."""
    if not found:
        words = left_out.words()
        raise Unreadable(NOTHING + (f"; it has {', '.join(words)}" if words else ""))


def with_floor(level: Level) -> Level:
    """A level of jellies alone with ground under them, so that they do not fall out of sight."""
    if level.terrain or not level.bodies:
        return level
    reach = FLOOR_REACH + max(abs(x) for body in level.bodies for x in expansion(body).position[:, 0].tolist())
    corners = ((-reach, -FLOOR_DEPTH), (reach, -FLOOR_DEPTH), (reach, 0.0), (-reach, 0.0))
    taken = {body.id for body in level.bodies}
    name = next(name for name in ("ground", "floor", "ground below") if name not in taken)
    return replaced(level, terrain=(TerrainDef(id=name, polygon=corners),))


def free_name(asked: str, base: str, taken: set[str]) -> str:
    """An id made of a name, different from all that are taken, which grow by it."""
    plain = tidy(asked) or tidy(base) or "shape"
    name, number = plain, 2
    while name in taken:
        name, number = f"{plain} {number}", number + 1
    taken.add(name)
    return name


def tidy(text: str) -> str:
    """A text as an id may be, shortened; "" where nothing of it may."""
    kept = "".join(char if char.isprintable() else " " for char in text[: 4 * TEXT_LIMIT].translate(_FORBIDDEN))
    return " ".join(kept.split()).lstrip("+ ")[:60].strip()


def ground_of(shapes: Sequence[Region], lines: Sequence[OpenLine], base: str, left_out: LeftOut) -> list[TerrainDef]:
    """Polygons of shapes and lines of lines, simplified until a level holds them."""
    import shapely

    rings = [np.array(shape.polygon.exterior.coords) for shape in shapes] + [line.points for line in lines]
    left, bottom, right, top = bounds(rings) or (0.0, 0.0, 1.0, 1.0)
    tolerance = GROUND_TOLERANCE * max(right - left, top - bottom)
    pieces: list[tuple[str, str, list[tuple[float, float]]]] = []
    if len(shapes) > REGIONS:
        left_out.add(f"outline that is smaller than the {REGIONS} largest", len(shapes) - REGIONS)
        shapes = shapes[:REGIONS]
    for _ in range(TRIES):
        pieces, lost = [], 0
        least = (2.0 * tolerance) ** 2
        for shape in shapes:
            simple = shapely.simplify(shape.polygon, tolerance)
            kept = [ring for ring in simple.interiors if shapely.Polygon(ring).area > least]
            for part in _without_holes(shapely.Polygon(simple.exterior, kept)):
                corners = _rounded(list(part.exterior.coords)[:-1])
                if part.area > least and len(corners) > 2 and is_simple(corners):
                    pieces.append(("polygon", shape.name, corners))
                else:
                    lost += 1
        for line in lines:
            way = shapely.simplify(shapely.LineString(line.points), tolerance)
            corners = _rounded(list(way.coords))
            if len(corners) > 1:
                pieces.append(("polyline", line.name, corners))
            else:
                lost += 1
        if len(pieces) <= PIECES and sum(len(corners) for _, _, corners in pieces) <= GROUND_CORNERS:
            if lost:
                left_out.add("speck", lost)
            break
        tolerance *= COARSER
    else:
        raise Unreadable(f"needs more than {PIECES} pieces of ground or {GROUND_CORNERS:,} corners; simplify it")
    taken: set[str] = set()
    made = []
    for key, own, corners in pieces:
        way, solid = (tuple(corners) if key == form else None for form in ("polyline", "polygon"))
        made.append(TerrainDef(id=free_name(own or base, base, taken), polyline=way, polygon=solid))
    return made


def _without_holes(polygon: "Polygon") -> list["Polygon"]:
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
            waiting += _polygons_of(shapely.intersection(piece, half))
    return done


def _rounded(corners: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    """Corners to a tenth of a millimetre, none twice in a row."""
    places = [(round(x, PLACE_DIGITS), round(y, PLACE_DIGITS)) for x, y, *_ in corners]
    return [place for k, place in enumerate(places) if k == 0 or place != places[k - 1]]


def _jellies(shapes: Sequence[Region], names: Sequence[str], left_out: LeftOut) -> list[JellyDef]:
    """A jelly of each shape [m], the largest first; what no mesh fits is counted."""
    kept = shapes[:BODY_LIMIT]
    if len(kept) < len(shapes):
        left_out.add(f"outline that is smaller than the {BODY_LIMIT} largest", len(shapes) - len(kept))
    spacing = common_spacing([shape.polygon.area for shape in kept])
    made: list[JellyDef] = []
    corners = work = 0
    for shape, name in zip(kept, names, strict=False):
        body = jelly(shape, name, spacing)
        if body is None:
            left_out.add("outline too fine for a mesh")
            continue
        more, harder = expansion(body).polygon_work
        if corners + more > MOST_CORNERS or work + harder > MOST_WORK:
            left_out.add("outline too much for one level")
            continue
        corners, work = corners + more, work + harder
        made.append(body)
    return made


def _wearing(bodies: Sequence[JellyDef], picture: Pixels) -> list[JellyDef]:
    """Jellies that wear the part of a picture that they are the outline of."""
    made = []
    for body in bodies:
        box = bounds([expansion(body).position])
        assert box is not None
        name = re.sub(r"[^\w]+", "-", body.id.casefold()).strip("-_") or "body"
        worn = Picture(f"{name}-skin.png", cut_out(picture, box))
        made.append(replaced(body, look=BodyLook(**(body.look or BodyLook()).__dict__ | {"picture": worn})))
    return made


def common_spacing(areas: Sequence[float], particles: int = ALL_PARTICLES) -> float:
    """The spacing [m] at which jellies of these areas [m^2] have that many particles, and none too many."""
    if not areas:
        return 1.0
    return math.sqrt(max(sum(areas) / particles, max(areas) / MOST_PARTICLES) / ROW)


def jelly(shape: Region, name: str, spacing: float, firmness: FirmnessDef = SOFT) -> JellyDef | None:
    """A jelly of one shape [m], with a finer mesh and fewer details than drawn where that is needed, or None."""
    polygon = shape.polygon
    spacing = min(spacing, math.sqrt(polygon.area / (ROW * FEWEST_PARTICLES)))
    for worn in WORN:
        rounded = _worn(polygon, worn * spacing, COARSE * spacing)
        if rounded is None:
            continue
        outline, holes, centre = _loops(rounded)
        loops = [outline, *holes]
        if any(not 3 <= len(loop) <= 1_000 or not is_simple(loop) for loop in loops):
            continue
        if sum(map(len, loops)) > 2_000 or loops_touch(loops):
            continue
        most = FINE * max(FEWEST_PARTICLES, rounded.area / (ROW * spacing * spacing))
        found = fitting_spacing(outline, holes, significant(spacing, DIGITS), most)
        if found is not None:
            look = BodyLook(colour=shape.colour) if shape.colour else None
            # The usual radius of particles is large beside a fine mesh.
            radius = significant(found / 8.0, DIGITS)
            made = JellyDef(
                type="jelly", id=name, shape=PolygonShape(polygon=outline), holes=holes, position=centre, mesh="fitted",
                spacing=found, firmness=firmness, particle_radius=radius if radius < 0.05 else None, look=look,
            )  # fmt: skip
            mass = DENSITY * rounded.area / len(expansion(made).mass)
            return replaced(made, particle_mass=max(1e-6, significant(mass, DIGITS)))
    return None


def _worn(polygon: "Polygon", by: float, tolerance: float) -> "Polygon | None":
    """The largest part of a region whose gaps, then whose tips, narrower than twice `by` are gone; simplified."""
    import shapely

    shaped: Any = polygon
    if by > 0.0:
        shaped = polygon.buffer(by, quad_segs=2).buffer(-2.0 * by, quad_segs=2).buffer(by, quad_segs=2)
    parts = _polygons_of(shapely.simplify(shaped, tolerance))
    largest = max(parts, key=lambda part: part.area, default=None)
    if largest is None:
        return None
    kept = [ring for ring in largest.interiors if shapely.Polygon(ring).area > (4.0 * tolerance) ** 2]
    return shapely.Polygon(largest.exterior, kept)


def _loops(polygon: "Polygon") -> tuple[Loop, tuple[Loop, ...], tuple[float, float]]:
    """Corners of outline and holes about the centre of mass, and that."""
    at = polygon.centroid
    x, y = round(at.x, PLACE_DIGITS), round(at.y, PLACE_DIGITS)

    def loop(ring: Any) -> Loop:
        return tuple((round(a - x, PLACE_DIGITS), round(b - y, PLACE_DIGITS)) for a, b in list(ring.coords)[:-1])

    return loop(polygon.exterior), tuple(loop(ring) for ring in polygon.interiors), (x, y)


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
    regions = [region for region in _polygons_of(united) if region.area > 0.0]
    return sorted(_named(regions, parts), key=lambda shape: -shape.polygon.area)


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
    """The region that rings fill by a fill rule."""
    import shapely

    if not rings:
        return shapely.Polygon()
    if len(rings) == 1:
        whole = shapely.Polygon(rings[0])
        if whole.is_valid:
            return whole
    noded = shapely.unary_union([shapely.LinearRing(ring) for ring in rings])
    faces = np.array(_polygons_of(shapely.polygonize([noded])), dtype=object)
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
        for piece in _polygons_of(geometry):
            found = tree.query(piece.representative_point(), predicate="within")
            for index in found.tolist():
                if piece.area > largest.get(index, (-math.inf,))[0]:
                    largest[index] = piece.area, outline
    shapes = []
    for index, region in enumerate(regions):
        part = largest[index][1] if index in largest else None
        shapes.append(Region(region, part.colour if part else None, part.name if part else ""))
    return shapes


def _polygons_of(geometry: Any) -> list["Polygon"]:
    """The polygons in a geometry."""
    return [
        part for part in getattr(geometry, "geoms", [geometry]) if part.geom_type == "Polygon" and not part.is_empty
    ]
