"""Jellies in the editor: a box from corner to corner, a circle from its centre, a polygon by clicks or by hand.

Circles and polygons are fitted; a box is a grid, which fits it as well.
"""

import math
from dataclasses import dataclass
from typing import Any, ClassVar

from sandbox.editor.document import EditError
from sandbox.editor.kinds.editing import BodyEditing, PlaneMap, mapped_centre
from sandbox.editor.tools.drawing_bodies import BodyDrawing, length, rounded, width_and_height
from sandbox.editor.tools.drawing_options import (
    BodyOptions,
    count_option,
    material_option,
    sag_option,
    whole_mass_option,
)
from sandbox.editor.tools.drawing_outline import OutlineDrawing
from sandbox.editor.tools.drawing_tool import EditorTool
from sandbox.editor.tools.snap import Snap
from sandbox.level.format.quantities import replaced, significant
from sandbox.level.kinds.bodies import expansion
from sandbox.level.kinds.geometry import Loop, fitting_spacing
from sandbox.level.kinds.jelly import BoxShape, CircleShape, JellyDef, PolygonShape

# Cells across the shorter side, and about how many cells the whole of one has at most: a plank of 10 x 0.2 m is two
# cells thick. A large one has as many as a small one: they are as large as it is.
CELLS_ACROSS = 8
JELLY_CELLS = 256
# Particles of a fitted one, about, where a finer mesh is tried; the ghost at the pointer waits for that.
FITTED_MOST = 1_500
# Digits of a spacing that is found so; a person reads it.
SPACING_DIGITS = 3
# Angles this close to a quarter turn [rad] count as one: a box at it can be stretched along its sides.
SQUARE = 1e-9


@dataclass(frozen=True)
class JellyOptions(BodyOptions):
    """A jelly of any shape; cells None: 8 across, fewer where it is long and thin."""

    cells: int | None = count_option("cells", "Cells across the shorter side; empty = 8, fewer in long shapes.", 1)
    particle_mass: float = 0.1
    mass: float | None = whole_mass_option()
    material: str = material_option("jelly")
    # Soft, and yet it stands: on a fine grid its material alone would let it lie flat.
    sag: float | None = sag_option(5.0)


def jelly_spacing(width: float, height: float, cells: int | None) -> float:
    """Spacing [m] of a jelly of that size, of `cells` across its shorter side; None: 8, fewer where it is long."""
    shorter = min(width, height)
    if cells is not None:
        return shorter / cells
    # A long thin jelly is coarser, but one cell thick at least.
    spacing = min(max(shorter / CELLS_ACROSS, math.sqrt(width * height / JELLY_CELLS)), shorter)
    return significant(spacing, SPACING_DIGITS) if spacing > 0.0 else 0.0


def fitted(polygon: Loop, sized: dict[str, Any]) -> dict[str, Any]:
    """Mesh and spacing of a simple polygon: the spacing given, or one as much smaller as triangles need to fit.

    An outline that would need a great many of them is left to a grid.
    """
    spacing = fitting_spacing(polygon, (), sized["spacing"], FITTED_MOST)
    return sized if spacing is None else {"mesh": "fitted", "spacing": spacing}


class JellyDrawing(BodyDrawing[JellyOptions]):
    """Draws a jelly whose grid fits its size."""

    defaults = JellyOptions()
    kind = "jelly"
    counted = "cells"
    step = "Draw jelly"

    def fitting(self, points: list[Snap]) -> int:
        """The number of cells across that is usual."""
        return CELLS_ACROSS

    def sized(self, width: float, height: float) -> dict[str, Any]:
        """The spacing for a width and height [m]. Raises EditError where one is 0."""
        if min(width, height) <= 0.0:
            raise EditError("drag across, to give it a width and a height")
        return {"spacing": jelly_spacing(width, height, self.options.cells)}


class BoxDrawing(JellyDrawing):
    """Draws a box of jelly; its corner snaps to the grid at any angle."""

    anchor = None

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
        return width_and_height(points)


class CircleDrawing(JellyDrawing):
    """A disc of jelly; its centre may be on a particle, its rim has none to join."""

    start_hint = "Drag from the centre to the rim, or click both"
    end_hint = "Click or release at the rim; + and - change the number of cells"

    def joins(self, index: int) -> bool:
        """Whether a point joins a particle: the centre alone is sure to have one."""
        return index == 0

    def fields(self, points: list[Snap]) -> dict[str, Any]:
        """Centre and radius."""
        radius = rounded(length(points))
        spacing = self.sized(2.0 * radius, 2.0 * radius)
        return {"shape": CircleShape(circle=radius), "position": points[0].point, "mesh": "fitted", **spacing}

    def sizes(self, points: list[Snap]) -> str:
        """Radius."""
        return f"radius {length(points):.3g} m"


class PolygonDrawing(OutlineDrawing[JellyOptions], JellyDrawing):
    """A polygon of jelly."""

    def fields(self, points: list[Snap]) -> dict[str, Any]:
        """Fields of the polygon: its corners about the middle of their box."""
        corners = [point.point for point in points]
        fault = self.fault(corners)
        if fault:
            raise EditError(fault)
        (left, right), (bottom, top) = ((min(side), max(side)) for side in zip(*corners, strict=True))
        x, y = rounded((left + right) / 2.0), rounded((bottom + top) / 2.0)
        polygon = tuple((rounded(corner[0] - x), rounded(corner[1] - y)) for corner in corners)
        sized = fitted(polygon, self.sized(right - left, top - bottom))
        return {"shape": PolygonShape(polygon=polygon), "position": (x, y), **sized}


class JellyEditing(BodyEditing[JellyDef]):
    """A jelly whose sides lie along the axes can be stretched, unless it is round."""

    tools: ClassVar = (
        EditorTool("box", "J", "Jelly: a box", BoxDrawing, word="jelly box"),
        EditorTool("circle", "O", "Jelly: a disc", CircleDrawing, word="jelly disc"),
        EditorTool("polygon", "Y", "Jelly: freehand or corner by corner", PolygonDrawing, word="jelly shape"),
    )
    formless = frozenset({"particle_mass", "area"})
    noun = "jelly that is round or turned"

    def can_stretch(self) -> bool:
        """Whether the jelly can be stretched: its sides lie along the axes, and it is not round."""
        if isinstance(self.body.shape, CircleShape):
            return False
        return abs(math.remainder(self.body.angle, math.pi / 2.0)) <= SQUARE

    def with_field(self, field: str, value: Any) -> dict[str, Any]:
        """The fields that change: another mesh weighs as much, a grid has no holes."""
        if field != "mesh" or value == self.body.mesh:
            return {field: value}
        changes = {"mesh": value} if value == "fitted" else {"mesh": value, "holes": ()}
        before, after = (expansion(body).form_count[0] for body in (self.body, replaced(self.body, **changes)))
        # What cannot be meshed is refused by the level's own check.
        return changes | ({"particle_mass": self.body.particle_mass * before / after} if after else {})

    def mapped(self, motion: PlaneMap) -> dict[str, Any]:
        """Place, angle, spacing, shape and holes after a motion."""
        body = self.body
        result = mapped_centre(body, motion) | {"spacing": body.spacing * motion.factor}
        if motion.is_mirror:
            # The shape itself is mirrored in its own frame, so that the grid lies as it did.
            result["angle"] = -body.angle
        across, up = abs(motion.sx), abs(motion.sy)
        if isinstance(body.shape, CircleShape):
            across = up = motion.factor
        if not motion.is_even and round(body.angle / (math.pi / 2.0)) % 2:
            across, up = up, across
        if isinstance(body.shape, BoxShape):
            result["shape"] = BoxShape.model_construct(box=(body.shape.box[0] * across, body.shape.box[1] * up))
        elif isinstance(body.shape, CircleShape):
            result["shape"] = CircleShape.model_construct(circle=body.shape.circle * motion.factor)
        across, up = math.copysign(across, motion.sx), math.copysign(up, motion.sy)
        if isinstance(body.shape, PolygonShape):
            result["shape"] = PolygonShape.model_construct(polygon=_scaled(body.shape.polygon, across, up))
        if body.holes:
            result["holes"] = tuple(_scaled(hole, across, up) for hole in body.holes)
        return result


def _scaled(corners: Loop, across: float, up: float) -> Loop:
    return tuple((x * across, y * up) for x, y in corners)
