"""Rings in the editor."""

import math
from dataclasses import dataclass
from typing import Any, ClassVar

from sandbox.editor.kinds.editing import BodyEditing, PlaneMap, mapped_centre
from sandbox.editor.tools.drawing_bodies import RoundDrawing, fitting_count, length
from sandbox.editor.tools.drawing_options import (
    BodyOptions,
    count_option,
    material_option,
    number_option,
    sag_option,
    whole_mass_option,
)
from sandbox.editor.tools.drawing_tool import EditorTool
from sandbox.editor.tools.snap import Snap
from sandbox.level.format.limits import INFLATION_LIMIT
from sandbox.level.kinds.body_def import BendingDef
from sandbox.level.kinds.ring import RingDef

# A part is about this long [m], within these numbers.
PART_LENGTH = 0.25
PARTS = (8, 60)


@dataclass(frozen=True)
class RingOptions(BodyOptions):
    """A ring; segments None: about 0.25 m each."""

    segments: int | None = count_option("segments", "Number of segments; empty = about 0.25 m each.", 3)
    inflation: float | None = number_option(
        1.2, "inflation", "Air inside: the area it tries to have, times its own; empty = no air.",
        high=INFLATION_LIMIT, empty="no air",
    )  # fmt: skip
    particle_mass: float = 0.1
    mass: float | None = whole_mass_option()
    material: str = material_option("rubber")
    sag: float | None = sag_option(5.0)


class RingDrawing(RoundDrawing[RingOptions]):
    """A ring with air inside; of what it is drawn on it joins only what is on its rim."""

    defaults = RingOptions()
    kind = "ring"
    parts = "segments"

    def joins(self, index: int) -> bool:
        """False: a ring has no particle in its centre to join."""
        return index == 1

    def fitting(self, points: list[Snap]) -> int:
        """Number of segments of about 0.25 m that fit."""
        return fitting_count(2.0 * math.pi * length(points), PART_LENGTH, *PARTS)

    def fields(self, points: list[Snap]) -> dict[str, Any]:
        """A ring's own fields."""
        ring = {**self.disc(points), "segments": self.count(points), "inflation": self.options.inflation}
        # Without bending a ring has no firmness, and lies down as far as its air lets it.
        return ring if self.options.sag is None else ring | {"bending": BendingDef()}


class RingEditing(BodyEditing[RingDef]):
    """A ring stays round."""

    tools: ClassVar = (EditorTool("ring", "Shift+O", "Ring with air inside: a balloon", RingDrawing),)
    formless = frozenset({"particle_mass", "inflation", "bending"})

    def mapped(self, motion: PlaneMap) -> dict[str, Any]:
        """Place, angle and radius after a motion."""
        return mapped_centre(self.body, motion) | {"radius": self.body.radius * motion.factor}
