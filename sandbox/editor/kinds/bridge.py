"""Bridges in the editor, and the drawing that they share with girders."""

from dataclasses import dataclass
from typing import Any, ClassVar

from sandbox.editor.kinds.editing import BodyEditing, PlaneMap
from sandbox.editor.tools.drawing_bodies import LineDrawing, fitting_count, length, rounded
from sandbox.editor.tools.drawing_options import (
    LineOptions,
    count_option,
    flag_option,
    material_option,
    size_option,
    whole_mass_option,
)
from sandbox.editor.tools.drawing_tool import EditorTool
from sandbox.editor.tools.snap import Snap
from sandbox.level.kinds.bridge import BridgeDef

# A cell is about this long [m], within these numbers.
CELL_LENGTH = 0.5
CELLS = (2, 40)


@dataclass(frozen=True)
class TrussOptions(LineOptions):
    """A bridge or a girder; segments None: cells of about 0.5 m, height None: as fits the cells."""

    segments: int | None = count_option("cells", "Number of cells; empty = cells of about 0.5 m.", 1)
    height: float | None = size_option("height", "Height; empty = square or equilateral cells.")
    particle_mass: float = 1.0
    mass: float | None = whole_mass_option()
    material: str = material_option("steel")
    pin_start: bool = flag_option(True, "pin start", "Pin the start, unless it joins a particle.")
    pin_end: bool = flag_option(True, "pin end", "Pin the end, unless it joins a particle.")


class BridgeDrawing(LineDrawing[TrussOptions]):
    """Draws a bridge along its top row."""

    defaults = TrussOptions()
    kind = "bridge"
    start_hint = "Drag along the top of the bridge, or click both ends"
    # Height of a cell that fits, in cell lengths.
    proportion: ClassVar[float] = 1.0

    def fitting(self, points: list[Snap]) -> int:
        """Number of cells of about 0.5 m that fit."""
        return fitting_count(length(points), CELL_LENGTH, *CELLS)

    def fields(self, points: list[Snap]) -> dict[str, Any]:
        """The ends, and a height that fits the cells where none is set."""
        height = self.options.height
        if height is None:
            height = rounded(self.proportion * length(points) / self.count(points))
        return {**self.ends(points), "height": height}


class BridgeEditing(BodyEditing[BridgeDef]):
    """A bridge's bottom row stays straight below, however it is turned."""

    tools: ClassVar = (EditorTool("bridge", "B", "Bridge", BridgeDrawing),)
    formless = frozenset({"particle_mass", "pin"})
    # Its height is a field of its own.
    stretches = True

    def lies_askew(self, motion: PlaneMap) -> bool:
        """Whether a motion turns it: its bottom row then starts no longer straight below."""
        return motion.angle != 0.0

    def mapped(self, motion: PlaneMap) -> dict[str, Any]:
        """The ends of what becomes the top row, and the height, after a motion."""
        body = self.body
        drop = -body.height if motion.sy < 0.0 else 0.0
        start, end = ((x, y + drop) for x, y in (body.start, body.end))
        return {"start": motion.point(start), "end": motion.point(end), "height": body.height * abs(motion.sy)}
