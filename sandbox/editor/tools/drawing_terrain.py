"""The tools of terrain: solid ground, lines, and walls."""

from dataclasses import dataclass
from typing import Any

from sandbox.editor.document import Document, EditError
from sandbox.editor.edits.terrain import add_terrain, set_walls, with_corners
from sandbox.editor.tools.drawing_bodies import direction, rounded
from sandbox.editor.tools.drawing_options import Options, number_option
from sandbox.editor.tools.drawing_outline import HAND_TOLERANCE, OutlineDrawing
from sandbox.editor.tools.drawing_tool import Drawing, EditorTool
from sandbox.editor.tools.snap import Snap
from sandbox.level.document.model import TerrainDef, WallsDef
from sandbox.level.format.limits import BELT_LIMIT, FRICTION_LIMIT
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


class WallsDrawing(Drawing[SurfaceOptions]):
    """Four walls around a box, in place of those that the level has; corners go to the grid at any angle."""

    anchor = None
    defaults = SurfaceOptions()
    start_hint = "Drag from corner to corner of the room, or click both; the page Level removes walls"
    end_hint = "Click or release at the opposite corner"

    def joins(self, index: int) -> bool:
        """False: walls join nothing."""
        return False

    def placed(self, document: Document, points: list[Snap]) -> Document:
        """The document with the walls. Raises EditError."""
        (ax, ay), (bx, by) = (_corner(point) for point in points)
        if ax == bx or ay == by:
            raise EditError("drag across, to give the room a width and a height")
        box = (min(ax, bx), min(ay, by), max(ax, bx), max(ay, by))
        friction, restitution = self.options.friction, self.options.restitution
        return set_walls(document, WallsDef(box=box, friction=friction, restitution=restitution))

    def sizes(self, points: list[Snap]) -> str:
        """Width and height."""
        (ax, ay), (bx, by) = points[0].point, points[1].point
        return f"{abs(bx - ax):.3g} m x {abs(by - ay):.3g} m"


def _corner(point: Snap) -> Point:
    x, y = point.point
    return rounded(x), rounded(y)


GROUND = EditorTool("ground", "D", "Solid ground", GroundDrawing, "Terrain")
LINE = EditorTool("line", "C", "A line with two sides", TerrainLineDrawing, "Terrain")
WALLS = EditorTool("walls", "Shift+D", "Walls around the level", WallsDrawing, "Terrain")
