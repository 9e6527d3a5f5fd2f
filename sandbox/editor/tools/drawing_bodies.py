"""Drawings of bodies from point to point: rope, bridge, girder, web, wheel; each joins the particles it is drawn on."""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any, Generic, TypeVar, cast

from pydantic import ValidationError

from sandbox.editor.document import Document, EditError, checked
from sandbox.editor.edits.placing import add_body
from sandbox.editor.tools.drawing_options import (
    JellyOptions,
    RingOptions,
    RopeOptions,
    TrussOptions,
    WebOptions,
    WheelOptions,
)
from sandbox.editor.tools.drawing_tool import Drawing
from sandbox.editor.tools.sizing import links, ring_parts, rings, truss_cells, wheel_spokes
from sandbox.editor.tools.snap import PLACE_DECIMALS, Snap
from sandbox.level.format.limits import DEFAULT_MATERIAL
from sandbox.level.format.messages import worded
from sandbox.level.format.quantities import replaced
from sandbox.level.kinds.bodies import KINDS, AnyBody, expansion

BodyOptions = TypeVar(
    "BodyOptions", bound=RopeOptions | TrussOptions | WebOptions | WheelOptions | RingOptions | JellyOptions
)
LineOptions = TypeVar("LineOptions", bound=RopeOptions | TrussOptions)
RoundOptions = TypeVar("RoundOptions", bound=WebOptions | WheelOptions | RingOptions)

# A particle this near to the point that was asked for stands on it; beyond the rounding of places and angles [m].
SAME_PLACE = 1e-5
# An equilateral cell of a girder is so high, in cell lengths.
EQUILATERAL = math.sqrt(3.0) / 2.0
ANGLE_DECIMALS = 9


def rounded(value: float) -> float:
    """A length [m] as files hold it."""
    return round(value, PLACE_DECIMALS)


class BodyDrawing(Drawing[BodyOptions], Generic[BodyOptions]):
    """A drawing that adds a body and welds it to the particles that its points are on."""

    kind: str

    def fields(self, points: list[Snap]) -> dict[str, Any]:
        """What the points and options say of the body; its material and particle mass apart."""
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
        return joined(add_body(document, body), [point for index, point in enumerate(points) if self.joins(index)])


def known_material(document: Document, name: str) -> str:
    """The material that a tool keeps from level to level, or the default one where this level has none of that name."""
    return name if name in document.level.materials else DEFAULT_MATERIAL


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


def length(points: list[Snap]) -> float:
    """Distance [m] of the two points of a gesture; 0 before there are two."""
    return math.dist(points[0].point, points[1].point) if len(points) == 2 else 0.0


class LineDrawing(BodyDrawing[LineOptions], Generic[LineOptions]):
    """A body from a start to an end, held where it should be and joins nothing."""

    counted = "segments"
    parts = "cells"
    end_hint = "Click or release where it ends; + and - change the number of parts"

    def ends(self, points: list[Snap]) -> dict[str, Any]:
        """Start, end, segments and pins."""
        asked = {"start": self.options.pin_start, "end": self.options.pin_end}
        pins = tuple(end for (end, wanted), at in zip(asked.items(), points, strict=True) if wanted and at.name is None)
        return {
            "start": points[0].point,
            "end": points[1].point,
            "segments": self.segments(points),
            "pin": pins,
        }

    def segments(self, points: list[Snap]) -> int:
        """How many parts it has."""
        return self.fitting(points) if self.options.segments is None else self.options.segments

    def sizes(self, points: list[Snap]) -> str:
        """Length, angle and number of parts."""
        return f"{direction(points)}, {self.segments(points)} {self.parts}"


class RopeDrawing(LineDrawing[RopeOptions]):
    """A rope; slack makes it longer than the way from end to end."""

    defaults = RopeOptions()
    kind = "rope"
    parts = "links"
    start_hint = "Drag from the rope's start to its end, or click both"

    def fitting(self, points: list[Snap]) -> int:
        """Links of about 0.25 m."""
        return links(length(points))

    def fields(self, points: list[Snap]) -> dict[str, Any]:
        """A rope's own fields."""
        rest = None
        if self.options.slack != 0.0:
            rest = rounded((1.0 + self.options.slack) * length(points) / self.segments(points))
        return {**self.ends(points), "end_mass": self.options.end_mass, "rest_length": rest}


class BridgeDrawing(LineDrawing[TrussOptions]):
    """A bridge along its top row."""

    defaults = TrussOptions()
    kind = "bridge"
    start_hint = "Drag along the top of the bridge, or click both ends"

    def fitting(self, points: list[Snap]) -> int:
        """Cells of about 0.5 m."""
        return truss_cells(length(points))

    def fields(self, points: list[Snap]) -> dict[str, Any]:
        """A bridge's own fields."""
        height = self.options.height
        if height is None:
            height = rounded(length(points) / self.segments(points))
        return {**self.ends(points), "height": height}


class GirderDrawing(BridgeDrawing):
    """A girder along its first row; the second lies to the right of the way."""

    kind = "girder"
    start_hint = "Drag along the girder, or click both ends"

    def fields(self, points: list[Snap]) -> dict[str, Any]:
        """A girder's own fields."""
        height = self.options.height
        if height is None:
            height = rounded(EQUILATERAL * length(points) / self.segments(points))
        return {**self.ends(points), "height": height}


class RoundDrawing(BodyDrawing[RoundOptions], Generic[RoundOptions]):
    """A round body from its centre to a point of its rim, where its first spoke points."""

    start_hint = "Drag from the centre to the rim, or click both"
    end_hint = "Click or release at the rim; + and - change the number of parts"

    def disc(self, points: list[Snap]) -> dict[str, Any]:
        """Place, angle and radius."""
        (x, y), (rim_x, rim_y) = points[0].point, points[1].point
        return {
            "position": (x, y),
            "angle": round(math.atan2(rim_y - y, rim_x - x), ANGLE_DECIMALS),
            "radius": rounded(length(points)),
        }


class WebDrawing(RoundDrawing[WebOptions]):
    """A web."""

    defaults = WebOptions()
    kind = "web"
    counted = "spokes"

    def fields(self, points: list[Snap]) -> dict[str, Any]:
        """A web's own fields."""
        pin = ("rim",) if self.options.pin_rim else ()
        return {**self.disc(points), "spokes": self.options.spokes, "rings": self._rings(points), "pin": pin}

    def _rings(self, points: list[Snap]) -> int:
        return rings(length(points)) if self.options.rings is None else self.options.rings

    def sizes(self, points: list[Snap]) -> str:
        """Radius and numbers of parts."""
        return f"radius {length(points):.3g} m, {self.options.spokes} spokes, {self._rings(points)} rings"


class WheelDrawing(RoundDrawing[WheelOptions]):
    """A wheel; its hub may be held, or joins the particle that it is drawn on."""

    defaults = WheelOptions()
    kind = "wheel"
    counted = "segments"

    def fitting(self, points: list[Snap]) -> int:
        """About 0.5 m of rim to each spoke."""
        return wheel_spokes(length(points))

    def fields(self, points: list[Snap]) -> dict[str, Any]:
        """A wheel's own fields."""
        thickness = self.options.thickness
        return {
            **self.disc(points),
            "thickness": rounded(length(points) / 4.0) if thickness is None else thickness,
            "segments": self._spokes(points),
            "hub_mass": self.options.hub_mass,
            "pin": ("hub",) if self.options.pin_hub and points[0].name is None else (),
        }

    def _spokes(self, points: list[Snap]) -> int:
        return self.fitting(points) if self.options.segments is None else self.options.segments

    def sizes(self, points: list[Snap]) -> str:
        """Radius and number of spokes."""
        return f"radius {length(points):.3g} m, {self._spokes(points)} spokes"


class RingDrawing(RoundDrawing[RingOptions]):
    """A ring with air inside; of what it is drawn on it joins only what is on its rim."""

    defaults = RingOptions()
    kind = "ring"
    counted = "segments"

    def joins(self, index: int) -> bool:
        """There is no particle in its centre."""
        return index == 1

    def fitting(self, points: list[Snap]) -> int:
        """Parts of about 0.25 m."""
        return ring_parts(length(points))

    def fields(self, points: list[Snap]) -> dict[str, Any]:
        """A ring's own fields."""
        return {**self.disc(points), "segments": self._parts(points), "inflation": self.options.inflation}

    def _parts(self, points: list[Snap]) -> int:
        return self.fitting(points) if self.options.segments is None else self.options.segments

    def sizes(self, points: list[Snap]) -> str:
        """Radius and number of parts."""
        return f"radius {length(points):.3g} m, {self._parts(points)} parts"
