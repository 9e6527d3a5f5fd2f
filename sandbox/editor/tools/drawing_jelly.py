"""Drawings of jelly: a box from corner to corner, a circle from its centre, a polygon by clicks or by hand."""

from typing import Any

from sandbox.editor.document import EditError
from sandbox.editor.tools.drawing_bodies import BodyDrawing, length, rounded
from sandbox.editor.tools.drawing_options import JellyOptions
from sandbox.editor.tools.drawing_outline import OutlineDrawing
from sandbox.editor.tools.sizing import CELLS_ACROSS, jelly_spacing
from sandbox.editor.tools.snap import Snap
from sandbox.level.kinds.jelly import BoxShape, CircleShape, PolygonShape


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


class PolygonDrawing(OutlineDrawing[JellyOptions], JellyDrawing):
    """A polygon of jelly."""

    def fields(self, points: list[Snap]) -> dict[str, Any]:
        """Corners about the middle of their box."""
        corners = [point.point for point in points]
        fault = self.fault(corners)
        if fault:
            raise EditError(fault)
        (left, right), (bottom, top) = ((min(side), max(side)) for side in zip(*corners, strict=True))
        x, y = rounded((left + right) / 2.0), rounded((bottom + top) / 2.0)
        polygon = tuple((rounded(corner[0] - x), rounded(corner[1] - y)) for corner in corners)
        spacing = self.sized(right - left, top - bottom)
        return {"shape": PolygonShape(polygon=polygon), "position": (x, y), **spacing}
