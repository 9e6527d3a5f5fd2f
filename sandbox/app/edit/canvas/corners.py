"""Corners of what is selected, and ends of bodies, which are dragged and placed."""

import contextlib
import math

import pygame

from sandbox.app.contracts.application import Editing
from sandbox.app.draw.camera import Camera, Point
from sandbox.app.draw.colours import MUTED
from sandbox.app.edit.canvas.gestures import Gesture
from sandbox.app.edit.canvas.overlay import CORNER, draw_corner
from sandbox.editor.document import Document, EditError
from sandbox.editor.edits.fields import set_field
from sandbox.editor.edits.placing import unweld, weld
from sandbox.editor.edits.terrain import corners_of, form_of, insert_corner, move_corner, piece_of
from sandbox.editor.held_joins import Held
from sandbox.editor.items import Item, chosen_bodies

# Fields of a body that has ends.
_FIELDS = ("start", "end")
# Sizes in layout units: how far off a press still takes a corner; edges shorter than this have no middle to take.
REACH = 9.0
SHORTEST = 34.0
MIDDLE = 3.2


class Corners:
    """Handles of the corners of a piece of terrain, and of the middles of its edges, where new corners begin."""

    def __init__(self, document: Document, item: Item, camera: Camera, scale: float) -> None:
        self.item, self._scale = item, scale
        piece = piece_of(document.level, str(item.key))
        self.points = corners_of(piece)
        self.places = [camera.to_pixels(point) for point in self.points]
        count = len(self.points)
        edges = [(k, (k + 1) % count) for k in range(count if form_of(piece) == "solid" else count - 1)]
        # Middles by the number that a corner there would have.
        self.middles = {
            a + 1: _middle(self.places[a], self.places[b])
            for a, b in edges
            if math.dist(self.places[a], self.places[b]) >= SHORTEST * scale
        }

    def corner_at(self, pixel: Point) -> int | None:
        """Number of the corner at a pixel."""
        return self._nearest(dict(enumerate(self.places)), pixel)

    def middle_at(self, pixel: Point) -> int | None:
        """The number that a corner would have that begins at the middle of an edge at a pixel."""
        return self._nearest(self.middles, pixel)

    def _nearest(self, places: dict[int, Point], pixel: Point) -> int | None:
        near = [number for number, place in places.items() if math.dist(place, pixel) <= REACH * self._scale]
        return min(near, key=lambda number: math.dist(places[number], pixel), default=None)

    def draw(self, surface: pygame.Surface, chosen: int | None) -> None:
        """Draw the corners, and dots between them; chosen: the corner that Delete takes out."""
        for place in self.middles.values():
            pygame.draw.aacircle(surface, MUTED, place, MIDDLE * self._scale, max(1, round(self._scale)))
        for number, place in enumerate(self.places):
            draw_corner(surface, place, self._scale, CORNER, is_chosen=number == chosen)


class Placing(Gesture):
    """A drag of one point of an item to what it snaps to; the item is shown as it would be.

    anchor: what directions are measured from. A kind of it says what it changes, and how that is called.
    """

    def __init__(self, screen: Editing, item: Item, start: Point, anchor: Point, label: str) -> None:
        self._screen, self._item, self._anchor, self._label = screen, item, anchor, label
        self._snap = screen.snapped(start, pygame.KMOD_ALT)
        self._ghost: Document | None = None
        self._moved = False

    def _placed(self, document: Document) -> Document:
        """The document with the point where it is now. Raises EditError."""
        raise NotImplementedError

    def _changed(self, document: Document) -> Document:
        """The document once the drag has ended. Raises EditError."""
        return self._placed(document)

    def to(self, point: Point, modifiers: int) -> None:
        """Move the point to what the pointer snaps to; with Alt, to the pointer."""
        self._moved = True
        self._snap = self._screen.snapped(point, modifiers, self._anchor, frozenset({self._item}))
        try:
            self._ghost = self._placed(self._screen.document)
        except EditError:
            self._ghost = None

    def ghost(self) -> Document | None:
        """The document with the point where it is now."""
        return self._ghost

    def end(self) -> None:
        """Put the point where it is now, as a step of the history."""
        if self._moved:
            self._screen.edit(self._label, self._changed)

    def draw(self, surface: pygame.Surface) -> None:
        """Mark the thing that the point snaps to."""
        self._screen.draw_snap(surface, self._snap)


class CornerMoving(Placing):
    """Moves a corner of terrain, or a new one, to what it snaps to."""

    def __init__(self, screen: Editing, corners: Corners, number: int, *, is_new: bool) -> None:
        start, anchor = corners.points[number % len(corners.points)], corners.points[number - 1]
        super().__init__(screen, corners.item, start, anchor, "Add a corner" if is_new else "Move a corner")
        self._number, self._is_new = number, is_new

    @property
    def measure(self) -> str:
        """Where the corner is [m], in words."""
        x, y = self._snap.point
        return f"{x:.4g}, {y:.4g} m"

    @property
    def chosen(self) -> tuple[Item, int] | None:
        """The piece and the number of the corner, once there is one."""
        return (self._item, self._number) if self._moved or not self._is_new else None

    def _placed(self, document: Document) -> Document:
        change = insert_corner if self._is_new else move_corner
        return change(document, str(self._item.key), self._number, self._snap.point)


class BodyEnds:
    """Handles of the two ends of a body; None of what has no ends: see `of`."""

    def __init__(self, item: Item, points: dict[str, Point], camera: Camera, scale: float) -> None:
        self.item, self.points, self._scale = item, points, scale
        self.places = {name: camera.to_pixels(point) for name, point in points.items()}

    @classmethod
    def of(cls, document: Document, camera: Camera, scale: float) -> "BodyEnds | None":
        """Handles at the ends of the one selected body; None where it has no ends, or its form is kept as a pose."""
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


def _middle(a: Point, b: Point) -> Point:
    return (a[0] + b[0]) / 2, (a[1] + b[1]) / 2
