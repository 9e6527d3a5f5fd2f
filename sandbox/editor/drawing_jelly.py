"""Drawings of jelly: a box from corner to corner, a circle from its centre, a polygon by clicks or by hand."""

import math
from typing import Any

from sandbox.editor.document import EditError
from sandbox.editor.drawing_bodies import BodyDrawing, length, rounded
from sandbox.editor.drawing_options import JellyOptions
from sandbox.editor.sizing import CELLS_ACROSS, jelly_spacing
from sandbox.editor.snap import Point, Snap
from sandbox.level.bodies import BoxShape, CircleShape, PolygonShape
from sandbox.level.polygon import is_simple, simplified

# A line drawn by hand is simplified by up to this part of the reach: what a person cannot see.
HAND_TOLERANCE = 0.5
# At most this part of its corners is left out at the end, where a hand ran over what it began with.
OVERSHOOT = 0.2


class JellyDrawing(BodyDrawing[JellyOptions]):
    """A jelly whose grid fits its size."""

    defaults = JellyOptions()
    kind = "jelly"
    counted = "cells"

    def fitting(self, points: list[Snap]) -> int:
        """8 cells across."""
        return CELLS_ACROSS

    def sized(self, width: float, height: float) -> dict[str, Any]:
        """The spacing for a width and height [m]. Raises EditError where one is 0."""
        if min(width, height) <= 0.0:
            raise EditError("drag across, to give it a width and a height")
        return {"spacing": jelly_spacing(width, height, self.options.cells)}


class BoxDrawing(JellyDrawing):
    """A box of jelly."""

    start_hint = "Drag from corner to corner, or click both"
    end_hint = "Click or release at the opposite corner; + and - change the number of cells"

    def fields(self, points: list[Snap]) -> dict[str, Any]:
        """Centre and size."""
        (ax, ay), (bx, by) = points[0].point, points[1].point
        box = rounded(abs(bx - ax)), rounded(abs(by - ay))
        spacing = self.sized(*box)
        return {"shape": BoxShape(box=box), "position": ((ax + bx) / 2.0, (ay + by) / 2.0), **spacing}

    def sizes(self, points: list[Snap]) -> str:
        """Width and height."""
        (ax, ay), (bx, by) = points[0].point, points[1].point
        return f"{abs(bx - ax):.3g} m x {abs(by - ay):.3g} m"


class CircleDrawing(JellyDrawing):
    """A disc of jelly; its centre may be on a particle, its rim has none to join."""

    start_hint = "Drag from the centre to the rim, or click both"
    end_hint = "Click or release at the rim; + and - change the number of cells"

    def joins(self, index: int) -> bool:
        """Only the centre is sure to have a particle."""
        return index == 0

    def fields(self, points: list[Snap]) -> dict[str, Any]:
        """Centre and radius."""
        radius = rounded(length(points))
        spacing = self.sized(2.0 * radius, 2.0 * radius)
        return {"shape": CircleShape(circle=radius), "position": points[0].point, **spacing}

    def sizes(self, points: list[Snap]) -> str:
        """Radius."""
        return f"radius {length(points):.3g} m"


class PolygonDrawing(JellyDrawing):
    """A polygon of jelly: a click for each corner, or a press and one stroke around it.

    A click on the first corner, Enter, or the end of the stroke closes it.
    """

    start_hint = "Click corner after corner, or draw the outline in one stroke"
    end_hint = "Click the next corner; the first one or Enter closes it, Backspace takes one back"

    def __init__(self, options: JellyOptions | None = None, reach: float = 0.0) -> None:
        super().__init__(options, reach)
        self.freehand = False

    def joins(self, index: int) -> bool:
        """Corners have no particles of their own."""
        return False

    def down(self, snap: Snap) -> None:
        """A corner, or the click on the first one that closes the outline."""
        self.pointer, self._pressed, self._fault = snap, True, ""
        self._began = not self.points
        if self._closes(snap):
            self._pressed = False
            self._close()
        elif self._began or self._apart(self.points[-1], snap) > 0.0:
            self.points.append(snap)

    def move(self, snap: Snap) -> None:
        """A stroke that begins the outline draws it; later ones move the corner that is pressed."""
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
        """The end of a stroke closes the outline."""
        self.pointer, self._pressed = snap, False
        if not self.freehand:
            return
        self.freehand = False
        corners = simplified([point.point for point in self.points], HAND_TOLERANCE * self.reach)
        self.points = [Snap(corner) for corner in _without_overshoot(corners)]
        if not self._close():
            self.points = []

    def finish(self) -> None:
        """Close the outline."""
        if self.points:
            self._close()

    def cancel(self) -> None:
        """Give up what is under way."""
        super().cancel()
        self.freehand = False

    def fields(self, points: list[Snap]) -> dict[str, Any]:
        """Corners about the middle of their box."""
        corners = [point.point for point in points]
        fault = _fault(corners)
        if fault:
            raise EditError(fault)
        (left, right), (bottom, top) = ((min(side), max(side)) for side in zip(*corners, strict=True))
        x, y = rounded((left + right) / 2.0), rounded((bottom + top) / 2.0)
        polygon = tuple((rounded(corner[0] - x), rounded(corner[1] - y)) for corner in corners)
        spacing = self.sized(right - left, top - bottom)
        return {"shape": PolygonShape(polygon=polygon), "position": (x, y), **spacing}

    def sizes(self, points: list[Snap]) -> str:
        """Number of corners."""
        return f"{len(points)} corners"

    def _close(self) -> bool:
        self._fault = _fault([point.point for point in self.points])
        self._complete = not self._fault
        return self._complete

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
        return len(points) >= 3


def _without_overshoot(corners: list[Point]) -> list[Point]:
    """An outline drawn by hand, without an end that runs over its own beginning."""
    kept = (corners[: len(corners) - left_out] for left_out in range(int(OVERSHOOT * len(corners)) + 1))
    return next((outline for outline in kept if is_simple(outline)), corners)


def _fault(corners: list[Point]) -> str:
    """What is wrong with an outline, for the person; empty if nothing is."""
    if len(corners) < 3:
        return "an outline needs three corners or more"
    if not is_simple(corners):
        return "the outline touches or crosses itself; draw it without, Backspace takes the last corner back"
    return ""
