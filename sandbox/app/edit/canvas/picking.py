"""PickTool: a particle, a body or a box is picked on the sheet for a field, in place of typing it."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pygame

from sandbox.app.contracts.application import Editing
from sandbox.app.draw.camera import Box, Point
from sandbox.app.edit.canvas.overlay import draw_box
from sandbox.editor.document import Document
from sandbox.editor.items import Item
from sandbox.editor.panel.field_info import Pick
from sandbox.editor.pick import items_at
from sandbox.editor.tools.snap import PLACE_DECIMALS, Snap, snap

_HINTS = {
    "particle": "Click the particle you mean; Escape cancels",
    "body": "Click the body you mean; Escape cancels",
    "zone": "Click the zone you mean; Escape cancels",
    "mover": "Click the body or loose particle you mean; Escape cancels",
    "thing": "Click the thing you mean; Escape cancels",
    "box": "Drag the box from corner to corner; Escape cancels",
}


# What of several things at a point counts, by the kind of the pick, and how many are looked at.
_KINDS = {
    "body": ("body",), "zone": ("zone",), "mover": ("body", "particle"), "thing": ("body", "particle", "terrain"),
}  # fmt: skip
_NAMES = {"mover": "body or loose particle"}
MOST_UNDER = 20


class PickTool:
    """Waits for a pick of a kind, and gives it to `then`; is_over: it has been given, or given up."""

    transform: np.ndarray | None = None

    def __init__(self, screen: Editing, kind: Pick, then: Callable[[Any], object]) -> None:
        self._screen, self._kind, self._then = screen, kind, then
        self._start: Point | None = None
        self._at: Point | None = None
        self._snap: Snap | None = None
        self.hovered: Item | None = None
        self.is_over = False

    @property
    def hint(self) -> str:
        """A line that says what to click."""
        return _HINTS[self._kind]

    @property
    def measure(self) -> str:
        """The name of the particle or body under the pointer, or the size of the box."""
        if self._kind == "box":
            box = self._box
            return "" if box is None else f"{box[2] - box[0]:.3g} m x {box[3] - box[1]:.3g} m"
        return str(self._found(self._at) or "") if self._at is not None else ""

    @property
    def _box(self) -> Box | None:
        if self._start is None or self._at is None:
            return None
        (x0, x1), (y0, y1) = (sorted(pair) for pair in zip(self._start, self._at, strict=True))
        left, bottom, right, top = (round(each, PLACE_DECIMALS) + 0.0 for each in (x0, y0, x1, y1))
        return left, bottom, right, top

    def _found(self, point: Point) -> str | None:
        """The name of the particle or body at a point; None where none is."""
        screen = self._screen
        if self._kind == "particle":
            self._snap = snap(screen.scene, point, screen.reach, skip=screen.visibility.hidden)
            return self._snap.name
        under = items_at(screen.scene, point, screen.reach, screen.visibility.hidden, MOST_UNDER)
        self.hovered = next((item for item in under if item.kind in _KINDS[self._kind]), None)
        return str(self.hovered.key) if self.hovered is not None else None

    def down(self, point: Point, modifiers: int, clicks: int) -> None:
        """Pick the particle or body at a point [m], or begin the box there."""
        self._at = point
        if self._kind == "box":
            self._start = self._at = self._screen.snapped(point, modifiers).point
            return
        found = self._found(point)
        if found is None:
            self._screen.say(f"There is no {_NAMES.get(self._kind, self._kind)} there.")
            return
        self.is_over = True
        self._then(found)

    def move(self, point: Point, modifiers: int) -> None:
        """Drag the other corner of the box."""
        self._at = self._screen.snapped(point, modifiers).point if self._kind == "box" else point

    def up(self, point: Point, modifiers: int) -> None:
        """Pick the box; a click alone makes none."""
        box, self._start = self._box, None
        if self._kind == "box" and box is not None and box[0] < box[2] and box[1] < box[3]:
            self.is_over = True
            self._then(box)

    def hover(self, point: Point | None, modifiers: int) -> None:
        """Mark the thing that a click would take."""
        self._at = point

    def cancel(self) -> bool:
        """Drop the box; whether there was one."""
        self.is_over = True
        return True

    def ghost(self) -> Document | None:
        """None: picking adds nothing to the level."""
        return None

    def draw(self, surface: pygame.Surface) -> None:
        """Draw the box so far, and mark the particle that a click would pick."""
        box = self._box
        if box is not None:
            draw_box(surface, self._screen.camera, box)
        if self._snap is not None and self._snap.name is not None:
            self._screen.draw_snap(surface, self._snap)
