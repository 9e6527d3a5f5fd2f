"""The tool of zones: a box or a circle by a drag, a polygon by clicks."""

import math
from dataclasses import dataclass

from sandbox.editor.document import Document, EditError
from sandbox.editor.edits.terrain import add_zone
from sandbox.editor.tools.drawing_bodies import length, rounded, width_and_height
from sandbox.editor.tools.drawing_options import Options, flag_option
from sandbox.editor.tools.drawing_outline import OutlineDrawing
from sandbox.editor.tools.drawing_tool import EditorTool
from sandbox.editor.tools.snap import Snap
from sandbox.level.document.model import ZoneDef
from sandbox.level.format.quantities import Point


@dataclass(frozen=True)
class ZoneOptions(Options):
    """Options of a zone: its shape."""

    circle: bool = flag_option(False, "circle", "A drag draws a circle, from its centre to its rim, in place of a box.")


class ZoneDrawing(OutlineDrawing[ZoneOptions]):
    """A zone: a drag is a box or a circle, clicks are the corners of a polygon."""

    defaults = ZoneOptions()
    start_hint = "Drag a box, or click corner after corner of another shape"

    def __init__(self, options: ZoneOptions | None = None, reach: float = 0.0) -> None:
        super().__init__(options, reach)
        self._drags = False

    @property
    def anchor(self) -> Point | None:
        """Of a polygon its last corner; corners of a box go to the grid at any angle."""
        return None if self._drags or (self._pressed and self._began) else super().anchor

    @property
    def outline(self) -> list[Point]:
        """The corners of a polygon so far; empty for a drag, which has its ghost."""
        return [] if self._drags else super().outline

    @property
    def hint(self) -> str:
        """A line that says what to do next, or during a drag what it makes."""
        if self._drags:
            return "Release at the rim" if self.options.circle else "Release at the opposite corner"
        if not self.points and self.options.circle:
            return "Drag from the centre of the circle to its rim"
        return super().hint

    def move(self, snap: Snap) -> None:
        """Draw a box or a circle by a drag that begins the zone; a later one moves the corner that is pressed."""
        self.pointer = snap
        if not self._pressed:
            return
        if not self._began:
            self.points[-1] = snap
        elif self._drags or math.dist(self.points[0].raw, snap.raw) > self.reach:
            self._drags = True
            self.points = [self.points[0], snap]

    def up(self, snap: Snap) -> None:
        """End a box or a circle."""
        self.pointer, self._pressed = snap, False
        if not self._drags:
            return
        self._drags = False
        self._complete = self._has_size(self.points)
        if not self._complete:
            self.points = []
            self._fault = "drag across, to give it a width and a height"

    def cancel(self) -> None:
        """Give the zone up."""
        super().cancel()
        self._drags = False

    def placed(self, document: Document, points: list[Snap]) -> Document:
        """The document with the zone. Raises EditError."""
        corners = [(rounded(x), rounded(y)) for x, y in (point.point for point in points)]
        if len(corners) > 2:
            fault = self.fault(corners)
            if fault:
                raise EditError(fault)
            return add_zone(document, ZoneDef(id="zone", polygon=tuple(corners)))
        (ax, ay), (bx, by) = corners
        if self.options.circle:
            return add_zone(document, ZoneDef(id="zone", circle=(ax, ay, rounded(math.dist(*corners)))))
        return add_zone(document, ZoneDef(id="zone", box=(min(ax, bx), min(ay, by), max(ax, bx), max(ay, by))))

    def sizes(self, points: list[Snap]) -> str:
        """Width and height, radius, or the number of corners."""
        if len(points) > 2:
            return super().sizes(points)
        return f"radius {length(points):.3g} m" if self.options.circle else width_and_height(points)

    def _so_far(self) -> list[Snap]:
        return list(self.points) if self._drags or self._complete else super()._so_far()

    def _sound(self, points: list[Snap]) -> bool:
        return self._has_size(points) if self._drags or self._complete else super()._sound(points)

    def _has_size(self, points: list[Snap]) -> bool:
        (ax, ay), (bx, by) = points[0].point, points[-1].point
        return (ax, ay) != (bx, by) if self.options.circle else ax != bx and ay != by


ZONE = EditorTool("zone", "Shift+Z", "Zone: a place that rules ask for", ZoneDrawing, "Terrain")
