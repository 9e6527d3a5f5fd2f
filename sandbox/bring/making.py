"""Makes a level of a drawing: jellies or ground, in metres, its middle at x = 0 and its lowest point at y = 0."""

from collections.abc import Sequence

import numpy as np

from sandbox.bring.bodies import Making, jellies
from sandbox.bring.shapes import Region, solid_shapes, without_holes
from sandbox.bring.sketch import FilledShape, Kind, LeftOut, OpenLine, Sketch, Unreadable, bounds
from sandbox.level.document.model import ContactsDef, Level, TerrainDef
from sandbox.level.format.limits import FORMAT, TERRAIN_LIMIT, TEXT_LIMIT, VERSION
from sandbox.level.format.quantities import replaced
from sandbox.level.kinds.bodies import expansion
from sandbox.level.kinds.polygon import is_simple

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
PLACE_DIGITS = 4
NOTHING = "has no outline to bring in"
# The ground under jellies [m]: how far it reaches beyond them, and how deep.
FLOOR_REACH, FLOOR_DEPTH = 10.0, 2.0
_FORBIDDEN = str.maketrans({".": " ", ":": " ", ",": " "})


def level_of_drawing(drawing: Sketch, kind: Kind, width: float | None, name: str) -> Level:
    """A level of what a drawing holds. Raises Unreadable where that is nothing, or too much."""
    placed = _in_metres(drawing, width)
    if kind == "jelly":
        _thicken(placed)
    shapes = solid_shapes(placed)
    made = Level(format=FORMAT, version=VERSION, name=name, contacts=ContactsDef())
    if kind == "jelly":
        bodies = jellies(shapes, names_of(shapes, name), placed.left_out, Making())
        made = replaced(made, bodies=tuple(bodies))
    else:
        made = replaced(made, terrain=tuple(ground_of(shapes, placed.lines, name, placed.left_out)))
    check_found(made, placed.left_out)
    return made


def check_found(level: Level, left_out: LeftOut) -> None:
    """Raise Unreadable where nothing has come in."""
    if not level.bodies and not level.terrain:
        words = left_out.words()
        raise Unreadable(NOTHING + (f"; it has {', '.join(words)}" if words else ""))


def with_floor(level: Level) -> Level:
    """A level of jellies alone with ground under them, so that they do not fall out of sight."""
    if level.terrain or not level.bodies:
        return level
    reach = FLOOR_REACH + max(abs(x) for x in _extent(level))
    corners = ((-reach, -FLOOR_DEPTH), (reach, -FLOOR_DEPTH), (reach, 0.0), (-reach, 0.0))
    taken = {body.id for body in level.bodies}
    name = next(name for name in ("ground", "floor", "ground below") if name not in taken)
    return replaced(level, terrain=(TerrainDef(id=name, polygon=corners),))


def names_of(shapes: Sequence[Region], base: str) -> list[str]:
    """An id for each shape: its own name where it has one, else that of the file, with numbers from 2."""
    taken: set[str] = set()
    return [free_name(shape.name or base, base, taken) for shape in shapes]


def free_name(wanted: str, base: str, taken: set[str]) -> str:
    """An id made of a name, different from all that are taken, which grow by it."""
    plain = tidy(wanted) or tidy(base) or "shape"
    name, number = plain, 2
    while name in taken:
        name, number = f"{plain} {number}", number + 1
    taken.add(name)
    return name


def tidy(text: str) -> str:
    """A text as an id may be, shortened; "" where nothing of it may."""
    kept = "".join(char if char.isprintable() else " " for char in text[: 4 * TEXT_LIMIT].translate(_FORBIDDEN))
    return " ".join(kept.split()).lstrip("+ ")[:60].strip()


def _in_metres(drawing: Sketch, width: float | None) -> Sketch:
    box = bounds(drawing.points())
    if box is None:
        words = drawing.left_out.words()
        raise Unreadable(NOTHING + (f"; it has {', '.join(words)}" if words else ""))
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
    origin, factor = np.array([(left + right) / 2.0, bottom]), scale
    for outline in drawing.outlines:
        rings = tuple((ring - origin) * factor for ring in outline.rings)
        moved.outlines.append(FilledShape(rings, outline.rule, outline.colour, outline.name))
    for line in drawing.lines:
        moved.lines.append(OpenLine((line.points - origin) * factor, line.width * factor, line.colour, line.name))
    return moved


def _thicken(drawing: Sketch) -> None:
    """Make outlines of lines that are drawn thick; thin ones are counted."""
    import shapely

    box = bounds(drawing.points())
    assert box is not None
    thin = THIN * max(box[2] - box[0], box[3] - box[1])
    for line in drawing.lines:
        if line.width < thin or len(line.points) > 2_000:
            drawing.left_out.add("open line too thin for a jelly")
            continue
        around = shapely.LineString(line.points).buffer(line.width / 2.0, quad_segs=4)
        rings = (around.exterior, *around.interiors)
        points = tuple(shapely.get_coordinates(ring)[:-1] for ring in rings)
        drawing.outlines.append(FilledShape(points, "evenodd", line.colour, line.name))


def ground_of(shapes: Sequence[Region], lines: Sequence[OpenLine], base: str, left_out: LeftOut) -> list[TerrainDef]:
    """Polygons of shapes and lines of lines, simplified until a level holds them."""
    import shapely

    size = _size(shapes, lines)
    tolerance = GROUND_TOLERANCE * size
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
            for part in without_holes(shapely.Polygon(simple.exterior, kept)):
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


def _rounded(corners: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    """Corners to a tenth of a millimetre, none twice in a row."""
    places = [(round(x, PLACE_DIGITS), round(y, PLACE_DIGITS)) for x, y, *_ in corners]
    return [place for k, place in enumerate(places) if k == 0 or place != places[k - 1]]


def _size(shapes: Sequence[Region], lines: Sequence[OpenLine]) -> float:
    rings = [np.array(shape.polygon.exterior.coords) for shape in shapes] + [line.points for line in lines]
    left, bottom, right, top = bounds(rings) or (0.0, 0.0, 1.0, 1.0)
    return max(right - left, top - bottom)


def _extent(level: Level) -> list[float]:
    """Places [m] of all particles of bodies, left or right of the middle."""
    return [x for body in level.bodies for x in expansion(body).position[:, 0].tolist()]
