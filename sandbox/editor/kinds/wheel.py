"""Wheels in the editor."""

import math
from dataclasses import dataclass
from typing import Any, ClassVar, Generic, TypeVar

from sandbox.editor.kinds.editing import BodyEditing, PlaneMap, mapped_centre
from sandbox.editor.tools.drawing_bodies import RoundDrawing, fitting_count, length, rounded
from sandbox.editor.tools.drawing_options import (
    BodyOptions,
    count_option,
    flag_option,
    mass_option,
    material_option,
    sag_option,
    size_option,
    whole_mass_option,
)
from sandbox.editor.tools.drawing_tool import EditorTool
from sandbox.editor.tools.snap import Snap
from sandbox.level.format.quantities import replaced
from sandbox.level.kinds.wheel import WheelDef

# A piece of rim between two spokes is about this long [m], within these numbers of spokes; fewer roll on corners.
RIM_LENGTH = 0.5
SPOKES = (16, 32)


@dataclass(frozen=True)
class RimOptions(BodyOptions):
    """A wheel of whatever tool; segments None: about 0.5 m of rim each, thickness None: a quarter of the radius."""

    segments: int | None = count_option("spokes", "Number of spokes; empty = about 0.5 m of rim each, at least 16.", 3)
    thickness: float | None = size_option("thickness", "Thickness of the rim; empty = a quarter of the radius.")
    particle_mass: float = 1.0
    mass: float | None = whole_mass_option()
    material: str = material_option("rubber")
    # Round under ten times its weight as well.
    sag: float | None = sag_option(0.15)


AnyRimOptions = TypeVar("AnyRimOptions", bound=RimOptions)


@dataclass(frozen=True)
class WheelOptions(RimOptions):
    """A wheel by itself."""

    hub_mass: float | None = mass_option(None, "hub mass", "Mass of the hub; empty = the same as the others.")
    pin_hub: bool = flag_option(False, "pin hub", "Pin the hub, unless it joins a particle.")


class RimDrawing(RoundDrawing[AnyRimOptions], Generic[AnyRimOptions]):
    """A wheel from its hub to its rim, whatever becomes of its hub."""

    kind = "wheel"

    def fitting(self, points: list[Snap]) -> int:
        """0.5 m of rim to each spoke; an even number, as the box around an odd one is crooked."""
        return 2 * fitting_count(2.0 * math.pi * length(points), 2.0 * RIM_LENGTH, SPOKES[0] // 2, SPOKES[1] // 2)

    def fields(self, points: list[Snap]) -> dict[str, Any]:
        """Place, angle, radius, thickness and number of spokes."""
        thickness = self.options.thickness
        return {
            **self.disc(points),
            "thickness": rounded(length(points) / 4.0) if thickness is None else thickness,
            "segments": self.count(points),
        }


class WheelDrawing(RimDrawing[WheelOptions]):
    """A wheel; its hub may be held, or joins the particle that it is drawn on."""

    defaults = WheelOptions()

    def fields(self, points: list[Snap]) -> dict[str, Any]:
        """A wheel's own fields."""
        held = self.options.pin_hub and points[0].name is None
        return {**super().fields(points), "hub_mass": self.options.hub_mass, "pin": ("hub",) if held else ()}


class WheelEditing(BodyEditing[WheelDef]):
    """A wheel stays round; in a mirror its motor turns the other way."""

    tools: ClassVar = (EditorTool("wheel", "Q", "Wheel with a hub", WheelDrawing),)
    formless = frozenset({"particle_mass", "hub_mass", "pin", "motor", "touches_mount"})

    def mapped(self, motion: PlaneMap) -> dict[str, Any]:
        """Place, angle, radius, thickness and motor after a motion."""
        body = self.body
        sizes = {"radius": body.radius * motion.factor, "thickness": body.thickness * motion.factor}
        motor: dict[str, Any] = {}
        if body.motor is not None and motion.is_mirror:
            motor = {"motor": replaced(body.motor, speed=-body.motor.speed)}
        return mapped_centre(body, motion) | sizes | motor
