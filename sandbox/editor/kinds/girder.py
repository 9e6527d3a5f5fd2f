"""Girders in the editor."""

import math
from typing import Any, ClassVar

from sandbox.editor.kinds.bridge import BridgeDrawing
from sandbox.editor.kinds.editing import BodyEditing, PlaneMap
from sandbox.editor.tools.drawing_tool import EditorTool
from sandbox.level.kinds.girder import GirderDef


class GirderDrawing(BridgeDrawing):
    """A girder along its first row; the second lies to the right of the way."""

    kind = "girder"
    start_hint = "Drag along the girder, or click both ends"
    # Cells are equilateral.
    proportion = math.sqrt(3.0) / 2.0


class GirderEditing(BodyEditing[GirderDef]):
    """A girder's second row lies on the right of the first; in a mirror its ends change places."""

    tools: ClassVar = (EditorTool("girder", "G", "Girder", GirderDrawing),)
    formless = frozenset({"particle_mass", "pin"})
    # Upright and level ones can be stretched.
    noun = "slanting girder"

    def can_stretch(self) -> bool:
        """Whether the girder can be stretched: it lies along an axis."""
        return self.body.start[0] == self.body.end[0] or self.body.start[1] == self.body.end[1]

    def mapped(self, motion: PlaneMap) -> dict[str, Any]:
        """Ends, height and pins after a motion."""
        body = self.body
        start, end = motion.point(body.start), motion.point(body.end)
        if motion.is_mirror:
            start, end = end, start
        across = motion.factor if motion.is_even else abs(motion.sy if body.start[1] == body.end[1] else motion.sx)
        pins = {"start": "end", "end": "start"} if motion.is_mirror else {}
        pin = tuple(pins.get(name, name) for name in body.pin)
        return {"start": start, "end": end, "height": body.height * across, "pin": pin}
