"""What drawings of bodies have in common: along a line, or from a centre; each joins the particles it is drawn on."""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any, Generic, TypeVar, cast

from pydantic import ValidationError

from sandbox.editor.document import Document, EditError, checked, validated
from sandbox.editor.edits.placing import add_body
from sandbox.editor.edits.weighing import masses_for
from sandbox.editor.tools.drawing_options import BodyOptions, LineOptions
from sandbox.editor.tools.drawing_tool import Drawing
from sandbox.editor.tools.snap import PLACE_DECIMALS, Snap
from sandbox.level.document.messages import worded
from sandbox.level.document.model import HookeMaterial
from sandbox.level.format.limits import DEFAULT_MATERIAL
from sandbox.level.format.quantities import replaced
from sandbox.level.kinds.bodies import KINDS, AnyBody, expansion
from sandbox.level.kinds.body_def import FirmnessDef
from sandbox.physics.keeping.equipment import Firmness
from sandbox.physics.softness.firmness import FirmnessRange, OutOfReach

AnyBodyOptions = TypeVar("AnyBodyOptions", bound=BodyOptions)
AnyLineOptions = TypeVar("AnyLineOptions", bound=LineOptions)

# A particle this near to the point that was asked for stands on it; beyond the rounding of places and angles [m].
SAME_PLACE = 1e-5
ANGLE_DECIMALS = 9


def fitting_count(size: float, part: float, least: int, most: int) -> int:
    """How many parts [m] fit a size [m], within limits: fewer are too coarse to bend, more are asked for by number."""
    return min(max(round(size / part), least), most)


def rounded(value: float) -> float:
    """A length [m] as files hold it."""
    return round(value, PLACE_DECIMALS)


def _angle_of(x: float, y: float) -> float:
    """A direction [rad] as files hold it: of whole degrees where no more than the rounding of places parts it from."""
    degrees = math.degrees(math.atan2(y, x))
    off = math.radians(abs(degrees - round(degrees))) * math.hypot(x, y)
    return round(math.radians(round(degrees) if off < 2.0 * 10.0**-PLACE_DECIMALS else degrees), ANGLE_DECIMALS)


class BodyDrawing(Drawing[AnyBodyOptions], Generic[AnyBodyOptions]):
    """A drawing that adds a body and welds it to the particles that its points are on."""

    kind: str

    def fields(self, points: list[Snap]) -> dict[str, Any]:
        """The body's fields from points and options; its material and particle mass apart."""
        raise NotImplementedError

    def placed(self, document: Document, points: list[Snap]) -> Document:
        """The document with the body. Raises EditError."""
        material = known_material(document, self.options.material)
        own: dict[str, Any] = {"type": self.kind, "id": self.kind, "material": material}
        own["particle_mass"] = self.options.particle_mass
        try:
            body = cast(AnyBody, KINDS[self.kind](**own, **self.fields(points)))
        except ValidationError as error:
            place, text = next(worded([dict(fault) for fault in error.errors()]))
            raise EditError(f"{place.replace('_', ' ')}: {text}") from None
        if self.options.mass is not None:
            body = validated(replaced(body, **masses_for(body, self.options.mass)))
        document = add_body(document, body)
        if self.options.sag is not None:
            document = firm(document, self.options.sag / 100.0)
        return joined(document, [point for index, point in enumerate(points) if self.joins(index)])


def known_material(document: Document, name: str) -> str:
    """The material that a tool keeps from level to level, or the default one where this level has none of that name."""
    return name if name in document.level.materials else DEFAULT_MATERIAL


def firm(document: Document, sag: float) -> Document:
    """Give the body added last that sag, or the nearest that it can have.

    Where its form is not stiff without pins, or its springs are of another law, it stays as it is.
    """
    level, body = document.level, document.level.bodies[-1]
    if isinstance(level.materials.get(body.material), HookeMaterial):
        return document
    reach = FirmnessRange.of(expansion(body).stiff_form, level.settings.gravity, level.settings.tick_rate)
    if reach.lowest_mode == 0.0:
        return document
    try:
        nearest = reach.nearest(Firmness(sag=sag))
    except OutOfReach:
        return document
    body = replaced(body, firmness=FirmnessDef(sag=nearest.sag))
    return replace(document, level=checked(replaced(level, bodies=(*level.bodies[:-1], body))))


def joined(document: Document, points: Sequence[Snap]) -> Document:
    """Weld the body that was added last to the particles that points are on, where it has a particle there."""
    if not points:
        return document
    level, body = document.level, document.level.bodies[-1]
    welds = []
    made = expansion(body)
    names = {index: name for name, index in made.named_particles.items()}
    places = made.form
    for point in points:
        x, y = (places - point.point).T
        distance = x * x + y * y
        nearest = int(distance.argmin())
        if point.name is not None and distance[nearest] <= SAME_PLACE * SAME_PLACE:
            welds.append((point.name, f"{body.id}.{names.get(nearest, nearest)}"))
    return replace(document, level=checked(replaced(level, welds=(*level.welds, *welds)))) if welds else document


def direction(points: list[Snap]) -> str:
    """Length and angle of the line that was drawn, for the person."""
    (ax, ay), (bx, by) = points[0].point, points[1].point
    return f"{math.dist(points[0].point, points[1].point):.3g} m, {math.degrees(math.atan2(by - ay, bx - ax)):.3g}°"


def width_and_height(points: list[Snap]) -> str:
    """Width and height of the box that was drawn, for the person."""
    (ax, ay), (bx, by) = points[0].point, points[1].point
    return f"{abs(bx - ax):.3g} m x {abs(by - ay):.3g} m"


def length(points: list[Snap]) -> float:
    """Distance [m] of the two points of a gesture; 0 before there are two."""
    return math.dist(points[0].point, points[1].point) if len(points) == 2 else 0.0


class LineDrawing(BodyDrawing[AnyLineOptions], Generic[AnyLineOptions]):
    """Draws a body from a start to an end; its pinned ends join nothing."""

    counted = "segments"
    parts = "cells"
    end_hint = "Click or release where it ends; + and - change the number of segments"

    def ends(self, points: list[Snap]) -> dict[str, Any]:
        """Start, end, segments and pins."""
        asked = {"start": self.options.pin_start, "end": self.options.pin_end}
        pins = tuple(end for (end, pinned), at in zip(asked.items(), points, strict=True) if pinned and at.name is None)
        return {
            "start": points[0].point,
            "end": points[1].point,
            "segments": self.count(points),
            "pin": pins,
        }

    def sizes(self, points: list[Snap]) -> str:
        """Length, angle and number of parts."""
        return f"{direction(points)}, {self.count(points)} {self.parts}"


class RoundDrawing(BodyDrawing[AnyBodyOptions], Generic[AnyBodyOptions]):
    """A round body from its centre to a point of its rim, where its first spoke points."""

    counted = "segments"
    parts = "spokes"
    start_hint = "Drag from the centre to the rim, or click both"
    end_hint = "Click or release at the rim; + and - change the number of segments"

    def disc(self, points: list[Snap]) -> dict[str, Any]:
        """Place, angle and radius."""
        (x, y), (rim_x, rim_y) = points[0].point, points[1].point
        return {
            "position": (x, y),
            "angle": _angle_of(rim_x - x, rim_y - y),
            "radius": rounded(length(points)),
        }

    def sizes(self, points: list[Snap]) -> str:
        """Radius and number of parts."""
        return f"radius {length(points):.3g} m, {self.count(points)} {self.parts}"
