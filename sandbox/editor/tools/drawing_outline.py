"""Drawings of outlines: a click for each corner, or one stroke by hand."""

import math
from typing import Generic

from sandbox.editor.tools.drawing_options import AnyOptions
from sandbox.editor.tools.drawing_tool import Drawing
from sandbox.editor.tools.snap import Snap
from sandbox.level.format.quantities import Point
from sandbox.level.kinds.geometry import drawn_outline, is_simple

# A line drawn by hand is simplified by up to this part of the reach: what a person cannot see.
HAND_TOLERANCE = 0.5


class OutlineDrawing(Drawing[AnyOptions], Generic[AnyOptions]):
    """A closed outline: a click for each corner, or a press and one stroke around it.

    A click on the first corner, a second one on the last, Enter, or the end of the stroke closes it.
    """

    start_hint = "Click corner after corner, or draw the outline in one stroke"
    end_hint = "Click the next corner; the first one, a double click or Enter closes it, Backspace takes one back"
    fewest = 3
    has_outline = True
    # Corners have no particles of their own.
    joins_particles = False

    def __init__(self, options: AnyOptions | None = None, reach: float = 0.0) -> None:
        super().__init__(options, reach)
        self.freehand = False

    def down(self, snap: Snap) -> None:
        """Set a corner, or end the outline by a click on its first or last one."""
        self.pointer, self._pressed, self._fault = snap, True, ""
        self._began = not self.points
        if self._closes(snap):
            self._pressed = False
            self.close_round()
        elif self._began or self._apart(self.points[-1], snap) > 0.0:
            self.points.append(snap)
        elif len(self.points) >= self.fewest:
            self._pressed = False
            self.close()

    def move(self, snap: Snap) -> None:
        """Draw the outline by a stroke that begins it; later ones move the corner that is pressed."""
        self.pointer = snap
        if not self._pressed:
            return
        if not self._began:
            self.points[-1] = snap
        elif math.dist(self.points[-1].raw, snap.raw) > self.reach:
            # A hand is freer than a grid.
            self.freehand = True
            self.points[0] = Snap(self.points[0].raw)
            self.points.append(Snap(snap.raw))

    def up(self, snap: Snap) -> None:
        """End the outline, if it was a stroke by hand."""
        self.pointer, self._pressed = snap, False
        if not self.freehand:
            return
        self.freehand = False
        self.points = [Snap(corner) for corner in self.tidied([point.point for point in self.points])]
        if not self.close():
            self.points = []

    def finish(self) -> None:
        """End the outline."""
        if self.points:
            self.close()

    def cancel(self) -> None:
        """Give the outline up."""
        super().cancel()
        self.freehand = False

    def sizes(self, points: list[Snap]) -> str:
        """Number of corners."""
        return f"{len(points)} corners"

    def close(self) -> bool:
        """End the outline with the corners so far, where it is sound; whether it is."""
        self._fault = self.fault([point.point for point in self.points])
        self._complete = not self._fault
        return self._complete

    def fault_of_outline(self) -> str:
        """The fault of the outline so far, in a few words; empty if there is none."""
        return self.fault([point.point for point in self.points]).partition(";")[0]

    def close_round(self) -> bool:
        """End the outline by a click on its first corner; whether it is sound."""
        return self.close()

    def fault(self, corners: list[Point]) -> str:
        """The fault of an outline, for the person; empty if there is none."""
        if len(corners) < 3:
            return "an outline needs three corners or more"
        if not is_simple(corners):
            return "the outline touches or crosses itself; draw it without, Backspace takes the last corner back"
        return ""

    def tidied(self, stroke: list[Point]) -> list[Point]:
        """Corners of an outline drawn by hand, without an end that runs over its own beginning."""
        return drawn_outline(stroke, HAND_TOLERANCE * self.reach)

    def _so_far(self) -> list[Snap]:
        pointer = self.pointer
        if pointer is None or self._complete or (self.points and pointer.point == self.points[-1].point):
            return list(self.points)
        return list(self.points) if self._closes(pointer) else [*self.points, pointer]

    def _closes(self, snap: Snap) -> bool:
        """Whether a click here is one on the first corner."""
        near = min(math.dist(self.points[0].point, place) for place in (snap.point, snap.raw)) if self.points else 0.0
        return len(self.points) >= 3 and near <= self.reach

    def _sound(self, points: list[Snap]) -> bool:
        return len(points) >= self.fewest
