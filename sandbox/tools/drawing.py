"""Drawing: a closed stroke becomes a body of a material, which the tool meshes; the command says every particle."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import numpy as np

from sandbox.level.format.quantities import significant
from sandbox.level.kinds.geometry import drawn_outline, rows_of
from sandbox.physics.analysis.query import shown_particles
from sandbox.physics.arena import answer_of
from sandbox.physics.meshing import fitting
from sandbox.physics.snapshot import Snapshot
from sandbox.session.commands import AddBody
from sandbox.tools.clearance import covered, lift, passable
from sandbox.tools.dropping import COLOURS, DENSITY, in_pace
from sandbox.tools.tool import NOTHING, Loop, PlacedTool, PlayTool, PointerEvent, Response, Submission

# An outline drawn by hand is simplified by up to this part of the pick radius.
HAND_TOLERANCE = 0.12
# Radius of particles, as a share of the spacing, and at most [m].
SKIN, THICKEST = 0.15, 0.05
# Significant digits of a mass.
DIGITS = 6

# What people are told of an outline that the mesher refuses, by its code.
REFUSALS = (
    "",
    "Draw a larger outline: press, draw around, and let go.",
    "The outline crosses or touches itself. Draw it without.",
    "This outline is too fine for triangles to fit in. Draw it simpler, or wider where it is thin.",
)
NO_ROOM = "There is no room for it here. Draw it where it is free."


@dataclass(frozen=True)
class PartMaterial:
    """The material of a drawn body: its name; Cs and Cd; mass of a square metre [kg/m^2]; a file's further fields."""

    name: str
    stiffness: float
    damping: float
    density: float = DENSITY
    more: dict[str, Any] = field(default_factory=dict)


MATERIALS = {
    material.name: material
    for material in (
        PartMaterial("jelly", 0.75, 0.7, more={"look": {"skin": "jelly", "face": True}}),
        PartMaterial("wood", 0.995, 0.995, more={"friction": 0.6, "look": {"skin": "wood"}}),
        PartMaterial(
            "steel", 1.0, 1.0, 5.0 * DENSITY, {"friction": 0.3, "look": {"skin": "plain", "colour": "#8E99A8"}}
        ),
    )
}


class Unfit(ValueError):
    """An outline that no body can have; its text is a sentence for the person."""


def meshed(corners: Loop, material: PartMaterial, colour: str) -> AddBody:
    """The command that adds a body inside an outline [m]. Raises Unfit."""
    code, arena = answer_of(fitting.fill_outline, fitting.USUAL_ARENA, rows_of([corners])[0])
    if code != fitting.FITS:
        raise Unfit(REFUSALS[code])
    mesh = fitting.found_in(arena)
    count = len(mesh.places)
    name = f"drawn {material.name}"
    body = {
        "type": "mesh",
        "id": material.name,
        "particles": mesh.places.tolist(),
        "masses": [significant(material.density * mesh.area / count, DIGITS)] * count,
        "springs": mesh.pairs.tolist(),
        "triangles": mesh.triangles.tolist(),
        "particle_radius": significant(min(SKIN * mesh.spacing, THICKEST), DIGITS),
        "material": name,
        **material.more,
        "look": material.more["look"] | ({"colour": colour} if material.name == "jelly" else {}),
    }
    return AddBody(body, materials={name: {"stiffness": material.stiffness, "damping": material.damping}})


class StrokeTool(PlacedTool):
    """Draw a body of a material, by its name: a press, a stroke around it, a release. Jellies take colours in turn."""

    adds = True

    def __init__(self, new_gesture: Callable[[], int], material: str) -> None:
        super().__init__(new_gesture)
        self._material = MATERIALS[material]
        self._stroke: Loop = []
        self._is_drawing = False
        self.count = 0

    def handle(self, event: PointerEvent, snapshot: Snapshot) -> Response:
        """Begin a stroke, continue it, or make a body of it."""
        self.place = event.position
        if event.kind == "down" and event.button == 1:
            self._stroke, self._is_drawing, self._refusal = [event.position], True, ""
        if not self._is_drawing:
            return NOTHING
        if event.kind == "move" and math.dist(self._stroke[-1], event.position) > HAND_TOLERANCE * event.pick_radius:
            self._stroke.append(event.position)
        if event.kind != "up" or event.button != 1:
            return NOTHING
        self._is_drawing = False
        try:
            command = self._made(event.pick_radius, snapshot)
        except Unfit as refusal:
            self._refusal = str(refusal)
            return NOTHING
        self._stroke, self.count = [], self.count + 1
        return Response((Submission(command, self._new_gesture()),))

    def _made(self, reach: float, snapshot: Snapshot) -> AddBody:
        """The command for the stroke. Raises Unfit."""
        corners = drawn_outline(self._stroke, HAND_TOLERANCE * reach)
        code = fitting.outline_fault(rows_of([corners])[0], reach * reach)
        if code != fitting.FITS:
            raise Unfit(REFUSALS[code])
        colour = COLOURS[self.count % len(COLOURS)]
        made = meshed(corners, self._material, colour)
        if self.touches:
            made = self._laid(corners, made, colour, snapshot)
        command = in_pace(made, snapshot.settings.tick_rate)
        assert isinstance(command, AddBody)
        return command

    def _laid(self, corners: Loop, made: AddBody, colour: str, snapshot: Snapshot) -> AddBody:
        """A drawn body before the things that it covers, which it passes; out of the ground and of what is not to be
        passed. Raises Unfit.
        """
        assert made.body is not None
        inside = np.array(made.body["particles"])[np.array(made.body["triangles"])].mean(axis=1)
        below = covered(corners, inside, snapshot)
        passed = [slot for owner in below for slot in passable(snapshot, owner)]
        kept = set(below) - set(snapshot.owner[passed].tolist())
        by = lift([[*corners, corners[0]]], snapshot, shown_particles(snapshot) & np.isin(snapshot.owner, list(kept)))
        if by is None:
            raise Unfit(NO_ROOM)
        if by > 0.0:
            made = meshed([(x, y + by) for x, y in corners], self._material, colour)
        return replace(made, passes=tuple(passed))

    @property
    def ghost(self) -> list[Loop]:
        """The stroke [m], and the way that closes it."""
        return [[*self._stroke, self._stroke[0]]] if len(self._stroke) > 1 else []

    @property
    def fits(self) -> bool:
        """Whether the last stroke became a body."""
        return not self._refusal

    def cancel(self) -> Response:
        """Give the stroke up."""
        self._stroke, self._is_drawing, self.place = [], False, None
        return super().cancel()


_LINES = {
    "jelly": ("Shift+1", "Draw a jelly: press, draw around"),
    "wood": ("Shift+2", "Draw something of wood"),
    "steel": ("Shift+3", "Draw something of steel"),
}
DRAWN = tuple(
    PlayTool(f"draw_{name}", (key,), label, "Parts", partial(StrokeTool, material=name), "add")
    for name, (key, label) in _LINES.items()
)
