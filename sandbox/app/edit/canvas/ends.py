"""Ends of the body that is selected: handles that drag one end of a rope, a bridge or a girder alone."""

import contextlib
import math

import pygame

from sandbox.app.contracts.application import Editing
from sandbox.app.draw.camera import Camera, Point
from sandbox.app.edit.canvas.corners import REACH, Placing
from sandbox.app.edit.canvas.overlay import CORNER, draw_corner
from sandbox.editor.document import Document, EditError
from sandbox.editor.edits.fields import set_field
from sandbox.editor.edits.placing import unweld, weld
from sandbox.editor.held_joins import Held
from sandbox.editor.items import Item, chosen_bodies

# Fields of a body that has ends.
_FIELDS = ("start", "end")


class BodyEnds:
    """Handles of the two ends of a body; None of what has no ends: see `of`."""

    def __init__(self, item: Item, points: dict[str, Point], camera: Camera, scale: float) -> None:
        self.item, self.points, self._scale = item, points, scale
        self.places = {name: camera.to_pixels(point) for name, point in points.items()}

    @classmethod
    def of(cls, document: Document, camera: Camera, scale: float) -> "BodyEnds | None":
        """Those of the body that alone is selected; None where it has no ends, or its form is kept as a pose."""
        selection = document.selection
        only = next(iter(selection)) if len(selection) == 1 else None
        if only is None or only.kind != "body":
            return None
        body = chosen_bodies(document.level, selection)[0]
        if body.pose is not None or any(name not in body.__dict__ for name in _FIELDS):
            return None
        return cls(only, {name: body.__dict__[name] for name in _FIELDS}, camera, scale)

    def at(self, pixel: Point) -> str | None:
        """The end at a pixel."""
        near = [name for name, place in self.places.items() if math.dist(place, pixel) <= REACH * self._scale]
        return min(near, key=lambda name: math.dist(self.places[name], pixel), default=None)

    def draw(self, surface: pygame.Surface) -> None:
        """Draw both handles."""
        for place in self.places.values():
            draw_corner(surface, place, self._scale, CORNER, is_chosen=False)


class EndMoving(Placing):
    """Moves one end of a body to what it snaps to, off what it was joined to, and joins it to the particle there."""

    def __init__(self, screen: Editing, ends: BodyEnds, field: str) -> None:
        other = ends.points["start" if field == "end" else "end"]
        super().__init__(screen, ends.item, ends.points[field], other, f"Move the {field}")
        self._field = field

    @property
    def measure(self) -> str:
        """Length and angle of the body, in words."""
        dx, dy = self._snap.point[0] - self._anchor[0], self._snap.point[1] - self._anchor[1]
        return f"{math.hypot(dx, dy):.3g} m, {math.degrees(math.atan2(dy, dx)):.3g}°"

    def _placed(self, document: Document) -> Document:
        return set_field(document, frozenset({self._item}), self._field, self._snap.point)

    def _changed(self, document: Document) -> Document:
        own, joined = f"{self._item.key}.{self._field}", document.level.welds
        with contextlib.suppress(EditError):  # it may be joined to nothing
            document = unweld(document, own)
        gone = tuple(pair for pair in joined if pair not in document.level.welds)
        document = self._placed(document)
        if self._snap.name is None:
            if gone:
                self._screen.say(Held(document, gone).notice)
            return document
        try:
            return weld(document, self._snap.name, own)
        except EditError as error:
            self._screen.say(f"Not joined: {error}")
            return document
