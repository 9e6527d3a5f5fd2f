"""Ropes in the editor."""

from dataclasses import dataclass
from typing import Any, ClassVar

from sandbox.editor.kinds.editing import BodyEditing, PlaneMap, stretch
from sandbox.editor.tools.drawing_bodies import LineDrawing, fitting_count, length, rounded
from sandbox.editor.tools.drawing_options import (
    LineOptions,
    count_option,
    flag_option,
    mass_option,
    material_option,
    number_option,
    whole_mass_option,
)
from sandbox.editor.tools.drawing_tool import EditorTool
from sandbox.editor.tools.snap import Snap
from sandbox.level.kinds.rope import RopeDef

# A link is about this long [m], within these numbers. Shorter: finer, and slower to play.
LINK_LENGTH = 0.25
LINKS = (4, 60)
# Slack: how much longer it is than the way from end to end, as a part of that.
SLACK_RANGE = (-0.5, 4.0)


@dataclass(frozen=True)
class RopeOptions(LineOptions):
    """A rope; segments None: of about 0.25 m each."""

    segments: int | None = count_option("segments", "Number of segments; empty = segments of about 0.25 m.", 1)
    slack: float = number_option(
        0.0, "slack", "How much longer it is than the distance of its ends, 0.1 = 10 %.", "", *SLACK_RANGE
    )
    particle_mass: float = 1.0
    mass: float | None = whole_mass_option()
    end_mass: float | None = mass_option(None, "end mass", "Mass of the last particle; empty = the same as the others.")
    material: str = material_option("steel")
    pin_start: bool = flag_option(True, "pin start", "Pin the start, unless it joins a particle.")
    pin_end: bool = flag_option(False, "pin end", "Pin the end, unless it joins a particle.")


class RopeDrawing(LineDrawing[RopeOptions]):
    """Draws a rope; slack makes it longer than the distance of its ends."""

    defaults = RopeOptions()
    kind = "rope"
    parts = "segments"
    start_hint = "Drag from the rope's start to its end, or click both"

    def fitting(self, points: list[Snap]) -> int:
        """Number of segments of about 0.25 m that fit."""
        return fitting_count(length(points), LINK_LENGTH, *LINKS)

    def fields(self, points: list[Snap]) -> dict[str, Any]:
        """A rope's own fields."""
        rest = None
        if self.options.slack != 0.0:
            rest = rounded((1.0 + self.options.slack) * length(points) / self.count(points))
        return {**self.ends(points), "end_mass": self.options.end_mass, "rest_length": rest}


class RopeEditing(BodyEditing[RopeDef]):
    """Edits a rope, which is placed by its ends."""

    tools: ClassVar = (EditorTool("rope", "R", "Rope", RopeDrawing),)
    formless = frozenset({"particle_mass", "end_mass", "rest_length", "pin", "bending"})
    stretches = True

    def mapped(self, motion: PlaneMap) -> dict[str, Any]:
        """The ends, and the length of the links, after a motion."""
        body = self.body
        ends = {"start": motion.point(body.start), "end": motion.point(body.end)}
        if body.rest_length is None:
            return ends
        return ends | {"rest_length": body.rest_length * stretch(body.start, body.end, motion)}

    def with_field(self, field: str, value: Any) -> dict[str, Any]:
        """The fields that change: another number of links keeps the whole length."""
        body = self.body
        if field == "segments" and body.rest_length is not None:
            return {field: value, "rest_length": body.rest_length * body.segments / value}
        return {field: value}
