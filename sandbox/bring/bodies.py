"""Jellies of solid shapes: even meshes of a bounded number of particles, whatever the outline."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from sandbox.bring.shapes import Region, polygons_of
from sandbox.bring.sketch import LeftOut
from sandbox.level.format.limits import CORNER_LIMIT, POLYGON_WORK_LIMIT
from sandbox.level.format.look import BodyLook
from sandbox.level.format.quantities import significant
from sandbox.level.kinds.bodies import expansion
from sandbox.level.kinds.body_def import FirmnessDef
from sandbox.level.kinds.fitting import fitting_spacing
from sandbox.level.kinds.jelly import JellyDef, PolygonShape
from sandbox.level.kinds.polygon import is_simple, loops_touch
from sandbox.physics.meshing.sampling import ROW

if TYPE_CHECKING:
    from shapely import Polygon

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
# Mass of a square metre [kg], and digits of a place: a tenth of a millimetre.
DENSITY, PLACE_DIGITS = 20.0, 4
# Digits of a spacing.
DIGITS = 3
SOFT = FirmnessDef(sag=0.1)

Loop = tuple[tuple[float, float], ...]


@dataclass(frozen=True)
class Making:
    """How jellies are made: how firm, and what a square metre of them weighs [kg]."""

    firmness: FirmnessDef = SOFT
    density: float = DENSITY


def jellies(shapes: Sequence[Region], names: Sequence[str], left_out: LeftOut, making: Making) -> list[JellyDef]:
    """A jelly of each shape [m], the largest first; what no mesh fits is counted."""
    kept = shapes[:BODY_LIMIT]
    if len(kept) < len(shapes):
        left_out.add(f"outline that is smaller than the {BODY_LIMIT} largest", len(shapes) - len(kept))
    spacing = common_spacing([shape.polygon.area for shape in kept])
    made: list[JellyDef] = []
    corners = work = 0
    for shape, name in zip(kept, names, strict=False):
        body = jelly(shape, name, spacing, making)
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


def common_spacing(areas: Sequence[float], particles: int = ALL_PARTICLES) -> float:
    """The spacing [m] at which jellies of these areas [m^2] have that many particles, and none too many."""
    if not areas:
        return 1.0
    return math.sqrt(max(sum(areas) / particles, max(areas) / MOST_PARTICLES) / ROW)


def jelly(shape: Region, name: str, spacing: float, making: Making) -> JellyDef | None:
    """A jelly of one shape [m], with a finer mesh and fewer details than drawn where that is needed, or None."""
    polygon = shape.polygon
    spacing = min(spacing, math.sqrt(polygon.area / (ROW * FEWEST_PARTICLES)))
    for worn in WORN:
        rounded = _worn(polygon, worn * spacing, COARSE * spacing)
        if rounded is None:
            continue
        outline, holes, centre = _loops(rounded)
        if not _is_sound(outline, holes):
            continue
        most = FINE * max(FEWEST_PARTICLES, rounded.area / (ROW * spacing * spacing))
        found = fitting_spacing(outline, holes, significant(spacing, DIGITS), most)
        if found is not None:
            mass = making.density * ROW * found * found
            look = BodyLook(colour=shape.colour) if shape.colour else None
            return JellyDef(
                type="jelly", id=name, shape=PolygonShape(polygon=outline), holes=holes, position=centre,
                mesh="fitted", spacing=found, particle_mass=max(1e-6, significant(mass, DIGITS)),
                firmness=making.firmness, particle_radius=_radius(found), look=look,
            )  # fmt: skip
    return None


def _radius(spacing: float) -> float | None:
    """Radius of particles [m] where the usual one is large beside the mesh."""
    fitting = significant(spacing / 8.0, DIGITS)
    return fitting if fitting < 0.05 else None


def _worn(polygon: "Polygon", by: float, tolerance: float) -> "Polygon | None":
    """The largest part of a region whose gaps, then whose tips, narrower than twice `by` are gone; simplified."""
    import shapely

    shaped: Any = polygon
    if by > 0.0:
        shaped = polygon.buffer(by, quad_segs=2).buffer(-2.0 * by, quad_segs=2).buffer(by, quad_segs=2)
    parts = polygons_of(shapely.simplify(shaped, tolerance))
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


def _is_sound(outline: Loop, holes: tuple[Loop, ...]) -> bool:
    loops = [outline, *holes]
    if any(len(loop) < 3 or len(loop) > 1_000 or not is_simple(loop) for loop in loops):
        return False
    return sum(map(len, loops)) <= 2_000 and not loops_touch(loops)
