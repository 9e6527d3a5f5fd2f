"""Webs in the editor."""

from dataclasses import dataclass
from typing import Any, ClassVar

from sandbox.editor.kinds.editing import BodyEditing, PlaneMap, mapped_centre
from sandbox.editor.tools.drawing_bodies import RoundDrawing, fitting_count, length
from sandbox.editor.tools.drawing_options import (
    BodyOptions,
    count_option,
    flag_option,
    material_option,
    whole_mass_option,
)
from sandbox.editor.tools.drawing_tool import EditorTool
from sandbox.editor.tools.snap import Snap
from sandbox.level.kinds.web import WebDef

# The step between two rings is about this long [m], within these numbers of rings.
RING_STEP = 0.25
RINGS = (2, 12)


@dataclass(frozen=True)
class WebOptions(BodyOptions):
    """A web; rings None: rings of about 0.25 m."""

    spokes: int = count_option("spokes", "Number of spokes.", 3, 12)
    rings: int | None = count_option("rings", "Number of rings; empty = about 0.25 m apart.", 1)
    particle_mass: float = 0.1
    mass: float | None = whole_mass_option()
    material: str = material_option("rubber")
    pin_rim: bool = flag_option(True, "pin rim", "Pin the outermost ring.")


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
        return fitting_count(length(points), RING_STEP, *RINGS) if self.options.rings is None else self.options.rings

    def sizes(self, points: list[Snap]) -> str:
        """Radius and numbers of parts."""
        return f"{super().sizes(points)}, {self._rings(points)} rings"


class WebEditing(BodyEditing[WebDef]):
    """A web stays round."""

    tools: ClassVar = (EditorTool("web", "W", "Web", WebDrawing),)
    formless = frozenset({"particle_mass", "pin"})

    def mapped(self, motion: PlaneMap) -> dict[str, Any]:
        """Place, angle and radius after a motion."""
        return mapped_centre(self.body, motion) | {"radius": self.body.radius * motion.factor}
