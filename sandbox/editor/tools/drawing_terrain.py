"""The tools of terrain: solid ground, lines, walls, and water."""

from dataclasses import dataclass
from typing import Any, ClassVar

from sandbox.editor.document import Document, EditError
from sandbox.editor.edits.terrain import add_terrain, add_zone, set_walls, with_corners
from sandbox.editor.tools.drawing_bodies import direction, rounded, width_and_height
from sandbox.editor.tools.drawing_options import AnyOptions, Options, number_option
from sandbox.editor.tools.drawing_outline import HAND_TOLERANCE, OutlineDrawing
from sandbox.editor.tools.drawing_tool import Drawing, EditorTool
from sandbox.editor.tools.snap import Snap
from sandbox.level.document.model import TerrainDef, WallsDef, WaterDef, ZoneDef
from sandbox.level.format.limits import BELT_LIMIT, FRICTION_LIMIT, WATER_DENSITY_LIMIT
from sandbox.level.format.quantities import Point
from sandbox.level.kinds.geometry import simplified


def _surface(title: str, text: str, most: float) -> Any:
    return number_option(None, title, text, high=most, empty="level's")


@dataclass(frozen=True)
class SurfaceOptions(Options):
    """Terrain or walls; None: friction and restitution of the level's contacts."""

    friction: float | None = _surface("friction", "Friction of its surface; empty = the level's.", FRICTION_LIMIT)
    restitution: float | None = _surface("bounce", "How much speed a bounce keeps; empty = the level's.", 1.0)


@dataclass(frozen=True)
class GroundOptions(SurfaceOptions):
    """Options of terrain: its surface may run like a belt."""

    belt: float = number_option(
        0.0, "belt", "How fast its surface runs to the right of who stands on it.", "m/s", -BELT_LIMIT, BELT_LIMIT
    )


class GroundDrawing(OutlineDrawing[GroundOptions]):
    """A solid piece of terrain."""

    defaults = GroundOptions()

    def placed(self, document: Document, points: list[Snap]) -> Document:
        """The document with the piece. Raises EditError."""
        corners = [_corner(point) for point in points]
        fault = self.fault(corners)
        if fault:
            raise EditError(fault)
        return add_terrain(document, with_corners(self._piece("ground"), corners, "solid"))

    def _piece(self, name: str) -> TerrainDef:
        chosen = self.options
        return TerrainDef(id=name, friction=chosen.friction, restitution=chosen.restitution, belt=chosen.belt)


class TerrainLineDrawing(GroundDrawing):
    """A line of terrain, with two sides; a click on its first corner makes a loop of it."""

    start_hint = "Click corner after corner, or draw the line in one stroke"
    end_hint = "Click the next corner; a double click or Enter ends the line, Backspace takes one back"
    fewest = 2

    def placed(self, document: Document, points: list[Snap]) -> Document:
        """The document with the line. Raises EditError."""
        return add_terrain(document, with_corners(self._piece("line"), [_corner(point) for point in points], "line"))

    def sizes(self, points: list[Snap]) -> str:
        """Length and angle of the last stretch, and the number of corners."""
        return f"{direction(points[-2:])}, {len(points)} corners"

    def fault(self, corners: list[Point]) -> str:
        """A line needs two corners."""
        return "a line needs two corners or more" if len(corners) < self.fewest else ""

    def tidied(self, stroke: list[Point]) -> list[Point]:
        """Corners of a line drawn by hand, to its very end."""
        corners = simplified(stroke, HAND_TOLERANCE * self.reach)
        return corners if corners[-1] == stroke[-1] else [*corners, stroke[-1]]

    def close_round(self) -> bool:
        """End the line where it began."""
        self.points.append(self.points[0])
        return self.close()


class UprightDrawing(Drawing[AnyOptions]):
    """An upright box, which joins nothing; corners go to the grid at any angle."""

    anchor = None
    end_hint = "Click or release at the opposite corner"
    noun: ClassVar[str] = ""
    joins_particles = False

    def box(self, points: list[Snap]) -> tuple[float, float, float, float]:
        """Left, bottom, right, top [m]. Raises EditError for a box without a size."""
        (ax, ay), (bx, by) = (_corner(point) for point in points)
        if ax == bx or ay == by:
            raise EditError(f"drag across, to give the {self.noun} a width and a height")
        return min(ax, bx), min(ay, by), max(ax, bx), max(ay, by)

    def sizes(self, points: list[Snap]) -> str:
        """Width and height."""
        return width_and_height(points)


class WallsDrawing(UprightDrawing[SurfaceOptions]):
    """Four walls around a box, in place of those that the level has."""

    defaults = SurfaceOptions()
    start_hint = "Drag from corner to corner of the room, or click both; the page Level removes walls"
    noun = "room"

    def placed(self, document: Document, points: list[Snap]) -> Document:
        """The document with the walls. Raises EditError."""
        friction, restitution = self.options.friction, self.options.restitution
        return set_walls(document, WallsDef(box=self.box(points), friction=friction, restitution=restitution))


@dataclass(frozen=True)
class WaterOptions(Options):
    """Options of water: its density."""

    density: float = number_option(
        WaterDef().density, "density", "Mass of a square metre of the water. What has less floats; a Density among the "
        "properties of a body says what it has.", "kg/m²", 1e-3, WATER_DENSITY_LIMIT,
    )  # fmt: skip


class WaterDrawing(UprightDrawing[WaterOptions]):
    """A zone of water: its upper side is the surface."""

    defaults = WaterOptions()
    start_hint = "Drag from corner to corner of the water, or click both; its upper side is the surface"
    noun = "water"

    def placed(self, document: Document, points: list[Snap]) -> Document:
        """The document with the water. Raises EditError."""
        water = WaterDef(density=self.options.density)
        return add_zone(document, ZoneDef(id="water", box=self.box(points), water=water))


def _corner(point: Snap) -> Point:
    x, y = point.point
    return rounded(x), rounded(y)


GROUND = EditorTool("ground", "D", "Solid ground", GroundDrawing, "Terrain")
LINE = EditorTool("line", "C", "A line with two sides", TerrainLineDrawing, "Terrain")
WALLS = EditorTool("walls", "Shift+D", "Walls around the level", WallsDrawing, "Terrain")
WATER = EditorTool("water", "Shift+C", "Water: it lifts what is lighter", WaterDrawing, "Terrain")
