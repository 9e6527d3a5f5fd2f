"""Gestures: what a drag on the sheet does to the selection: moves, copies, scales, turns, selects; and its handles."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import pygame

from sandbox.app.contracts.application import Editing
from sandbox.app.draw.camera import Box, Camera, Point
from sandbox.app.draw.colours import ACCENT, BACKGROUND
from sandbox.editor.document import Document, EditError
from sandbox.editor.edits.copying import duplicate
from sandbox.editor.edits.moving import move, rotate, scale
from sandbox.editor.edits.names import owner_of
from sandbox.editor.edits.placing import weld
from sandbox.editor.held_joins import with_joins_held
from sandbox.editor.items import Selection, definitions, items_of
from sandbox.editor.pick import Mode, combined, items_in_box, items_in_lasso
from sandbox.editor.tools.snap import PLACE_DECIMALS, Snap, snap

# Sizes in layout units: side of a square, how far off a press still takes it, how far the knob stands above the box.
SIDE = 8.0
REACH = 9.0
KNOB = 26.0
# The box keeps this distance from what it holds; nearer, its handles lie over particles.
PADDING = 14.0
# A turn snaps to whole multiples of this [degrees].
TURN_STEP = 15.0
# What is scaled keeps at least this part of its size, and its side.
SMALLEST_FACTOR = 1e-3
# Names of the squares: which side of the box they lie on, x to the right, y up.
SIDES = {
    "left": (-1, 0), "right": (1, 0), "bottom": (0, -1), "top": (0, 1), "bottom left": (-1, -1),
    "bottom right": (1, -1), "top left": (-1, 1), "top right": (1, 1),
}  # fmt: skip
# Points of a lasso are at least this far apart [layout units].
LASSO_STEP = 4.0


@dataclass(frozen=True)
class Scaling:
    """The scaling of a selection: factors about a point [m]."""

    x: float
    y: float
    centre: Point

    @property
    def matrix(self) -> np.ndarray:
        """The map (2, 3) of the scaling."""
        (x, y), (cx, cy) = (self.x, self.y), self.centre
        return np.array([[x, 0.0, cx - x * cx], [0.0, y, cy - y * cy]])


@dataclass(frozen=True)
class Turn:
    """The turn of a selection: an angle [rad], counter-clockwise, about a point [m]."""

    angle: float
    centre: Point

    @property
    def matrix(self) -> np.ndarray:
        """The map (2, 3) of the turn."""
        c, s, (x, y) = math.cos(self.angle), math.sin(self.angle), self.centre
        return np.array([[c, -s, x - c * x + s * y], [s, c, y - s * x - c * y]])


class Handles:
    """The handles of a box [m] as a camera shows it; uneven: whether its sides can be scaled apart.

    is_line: whether it is about a line from end to end, which its ends alone make longer.
    """

    def __init__(self, box: Box, camera: Camera, scale: float, uneven: bool, is_line: bool = False) -> None:
        self.box, self._camera, self._scale = box, camera, scale
        left, bottom, right, top = box
        (x0, y0), (x1, y1) = camera.to_pixels((left, top)), camera.to_pixels((right, bottom))
        pad = PADDING * scale
        self.frame = (x0 - pad, y0 - pad, x1 + pad, y1 + pad)
        sides = {} if is_line else SIDES
        names = [name for name, (x, y) in sides.items() if self._fits(x, y) and (uneven or (x and y))]
        self.places = {name: self._place(*SIDES[name]) for name in names}
        self.knob = ((self.frame[0] + self.frame[2]) / 2, self.frame[1] - KNOB * scale)

    def _fits(self, x: int, y: int) -> bool:
        """Whether scaling on that side means anything: a level rope has no height."""
        left, bottom, right, top = self.box
        return (not x or right > left) and (not y or top > bottom)

    def _place(self, x: int, y: int) -> Point:
        left, top, right, bottom = self.frame
        return (left + right) / 2 + x * (right - left) / 2, (top + bottom) / 2 - y * (bottom - top) / 2

    def at(self, pixel: Point) -> str | None:
        """Name of the handle at a pixel; "turn" is the knob."""
        reach = REACH * self._scale
        places = {"turn": self.knob, **self.places}
        near = [name for name, place in places.items() if math.dist(place, pixel) <= reach]
        return min(near, key=lambda name: math.dist(places[name], pixel), default=None)

    def scaling(self, name: str, start: Point, now: Point, even: bool, about_centre: bool) -> Scaling:
        """The scaling by a drag of a square from one point [m] to another; even: both sides alike."""
        left, bottom, right, top = self.box
        sx, sy = SIDES[name]
        middle = ((left + right) / 2, (bottom + top) / 2)
        fixed = middle if about_centre else (left if sx > 0 else right, bottom if sy > 0 else top)
        fixed = (fixed[0] if sx else middle[0], fixed[1] if sy else middle[1])
        corner = (right if sx > 0 else left, top if sy > 0 else bottom)
        dx, dy = now[0] - start[0], now[1] - start[1]
        fx = _factor(corner[0] - fixed[0], dx) if sx else 1.0
        fy = _factor(corner[1] - fixed[1], dy) if sy else 1.0
        if even:
            factor = max(fx, fy, key=lambda value: abs(value - 1.0))
            fx = fy = factor
        return Scaling(fx, fy, fixed)

    def turn(self, start: Point, now: Point, free: bool) -> Turn:
        """The turn by a drag of the knob from one point [m] to another; free: not only round angles."""
        left, bottom, right, top = self.box
        x, y = (left + right) / 2, (bottom + top) / 2
        angle = math.atan2(now[1] - y, now[0] - x) - math.atan2(start[1] - y, start[0] - x)
        angle = math.remainder(angle, math.tau)
        if not free:
            angle = math.radians(round(math.degrees(angle) / TURN_STEP) * TURN_STEP)
        return Turn(angle, (x, y))

    def draw(self, surface: pygame.Surface) -> None:
        """Draw box, squares and knob."""
        left, top, right, bottom = (round(value) for value in self.frame)
        pygame.draw.rect(surface, ACCENT, (left, top, right - left, bottom - top), 1)
        pygame.draw.aaline(surface, ACCENT, ((left + right) / 2, top), self.knob)
        side = round(SIDE * self._scale)
        for x, y in self.places.values():
            square = pygame.Rect(0, 0, side, side)
            square.center = (round(x), round(y))
            pygame.draw.rect(surface, BACKGROUND, square.inflate(2, 2))
            pygame.draw.rect(surface, ACCENT, square)
        pygame.draw.aacircle(surface, BACKGROUND, self.knob, side * 0.75)
        pygame.draw.aacircle(surface, ACCENT, self.knob, side * 0.6)


def _factor(extent: float, change: float) -> float:
    return max((extent + change) / extent, SMALLEST_FACTOR) if extent else 1.0


class Gesture:
    """A drag of the select tool; transform (2, 3): what it does to the selection so far, None = nothing."""

    transform: np.ndarray | None = None

    @property
    def measure(self) -> str:
        """Length, angle or factors of the drag so far, in words."""
        return ""

    def to(self, point: Point, modifiers: int) -> None:
        """Follow the pointer to a point [m]."""
        raise NotImplementedError

    def end(self) -> None:
        """Make the edit or the selection, as the pointer is released."""
        raise NotImplementedError

    def ghost(self) -> Document | None:
        """The document as it would be if the drag ended now, where the transform does not say it."""
        return None

    def draw(self, surface: pygame.Surface) -> None:
        """Draw what the gesture shows besides the moved selection."""


def pick_mode(modifiers: int, click: bool) -> Mode:
    """How Shift and Ctrl join what is picked to what is selected already."""
    shift, ctrl = modifiers & pygame.KMOD_SHIFT, modifiers & (pygame.KMOD_CTRL | pygame.KMOD_META)
    if ctrl:
        return "toggle" if click and not shift else "subtract"
    return "add" if shift else "replace"


class Moving(Gesture):
    """Moves the selection, drawn by one of its particles to what it snaps to; an end that comes onto one is joined."""

    def __init__(self, screen: Editing, start: Point) -> None:
        self._screen, self._start = screen, start
        self._snap = Snap(start)
        others = frozenset(screen.scene.items) - screen.document.selection
        self._taken = snap(screen.scene, start, screen.reach, skip=others)
        self._anchor = self._taken.point
        self._by = (0.0, 0.0)
        self._held: Document | None = None
        chosen = {str(item.key) for item in screen.document.selection if item.kind != "spring"}
        owners = [{owner_of(name) in chosen for name in pair} for pair in screen.document.level.welds]
        self._crosses = any(len(sides) == 2 for sides in owners)

    @property
    def measure(self) -> str:
        """How far the selection was dragged [m], in words."""
        dx, dy = self._by
        return f"{dx:+.4g}, {dy:+.4g} m"

    def to(self, point: Point, modifiers: int) -> None:
        """Drag the selection to a point [m]; Shift keeps to round directions, Alt snaps to nothing."""
        target = (self._anchor[0] + point[0] - self._start[0], self._anchor[1] + point[1] - self._start[1])
        along = self._anchor if modifiers & pygame.KMOD_SHIFT else None
        self._snap = self._screen.snapped(target, modifiers, along, self._screen.document.selection)
        if self._snap.kind == "grid" and self._taken.kind != "end":
            self._by = self._steps(target)
            self._snap = replace(self._snap, point=(self._anchor[0] + self._by[0], self._anchor[1] + self._by[1]))
        else:
            self._by = (self._snap.point[0] - self._anchor[0], self._snap.point[1] - self._anchor[1])
        self._held = self._with_joins() if self._crosses else None
        self.transform = (
            None if self._held is not None else np.array([[1.0, 0.0, self._by[0]], [0.0, 1.0, self._by[1]]])
        )

    def _with_joins(self) -> Document | None:
        """The document as it would be where joins change more than the selection, with all that moves selected."""
        before = self._screen.document
        try:
            moved = move(before, *self._by)
            held = with_joins_held(before.level, moved).document.level
        except EditError:
            return None
        if held is moved.level:
            return None
        pairs = zip(items_of(held), definitions(held), definitions(before.level), strict=True)
        return Document(held, frozenset(item for item, now, was in pairs if now is not was))

    def ghost(self) -> Document | None:
        """The document as it would be, where the selection alone cannot show it."""
        return self._held

    def _steps(self, target: Point) -> Point:
        """The way in whole steps of the grid, for what is not taken by an end: what stands on the grid stays on it."""
        grid = self._screen.grid
        dx, dy = (round((to - start) / grid) * grid for to, start in zip(target, self._anchor, strict=True))
        return round(dx, PLACE_DECIMALS) + 0.0, round(dy, PLACE_DECIMALS) + 0.0

    def end(self) -> None:
        """Move the selection, and join an end that came onto a particle to it."""
        if self._by != (0.0, 0.0):
            self._screen.edit("Move", self._moved)

    def _moved(self, document: Document) -> Document:
        moved = move(document, *self._by)
        own, target = self._taken.name, self._snap.name
        if own is None or target is None or "end" not in (self._taken.kind, self._snap.kind):
            return moved
        try:
            return weld(moved, target, own)
        except EditError as error:
            self._screen.say(f"Not joined: {error}")
            return moved

    def draw(self, surface: pygame.Surface) -> None:
        """Mark the thing that the selection snaps to."""
        self._screen.draw_snap(surface, self._snap)


class Copying(Moving):
    """Drags a copy of the selection away; the selection itself stays where it is."""

    def __init__(self, screen: Editing, start: Point) -> None:
        super().__init__(screen, start)
        # A copy is joined to nothing but itself.
        self._crosses = False
        self._copy: tuple[Point, Document | None] = ((0.0, 0.0), None)

    @property
    def measure(self) -> str:
        """How far the copy was dragged [m], in words."""
        return f"copy {super().measure}"

    def to(self, point: Point, modifiers: int) -> None:
        """Drag the copy to a point [m], as a move does."""
        super().to(point, modifiers)
        self.transform = None

    def ghost(self) -> Document | None:
        """The document with the copy."""
        if self._copy[0] != self._by:
            try:
                self._copy = self._by, duplicate(self._screen.document, *self._by)
            except EditError:
                self._copy = self._by, None
        return self._copy[1]

    def end(self) -> None:
        """Put the copy where it was dragged to."""
        if self._by != (0.0, 0.0):
            self._screen.edit("Duplicate", lambda document: duplicate(document, *self._by))


class Transforming(Gesture):
    """Scales or turns the selection by one of its handles."""

    def __init__(self, screen: Editing, handles: Handles, name: str, start: Point, even: bool) -> None:
        self._screen, self._handles, self._name, self._start, self._even = screen, handles, name, start, even
        self._change: Scaling | Turn | None = None

    @property
    def measure(self) -> str:
        """The angle or the factors of the drag so far, in words."""
        change = self._change
        if isinstance(change, Turn):
            return f"{math.degrees(change.angle):+.4g}°"
        if isinstance(change, Scaling):
            return f"{change.x:.4g}" if change.x == change.y else f"{change.x:.4g} x {change.y:.4g}"
        return ""

    def to(self, point: Point, modifiers: int) -> None:
        """Drag the handle to a point [m]; Shift keeps the sides' ratio, Ctrl the middle; Alt turns freely."""
        alt, shift = modifiers & pygame.KMOD_ALT, modifiers & pygame.KMOD_SHIFT
        if self._name == "turn":
            self._change = self._handles.turn(self._start, point, bool(alt))
        else:
            place = self._screen.snapped(point, modifiers).point if self._screen.snaps_pointer(modifiers) else point
            about_centre = bool(modifiers & pygame.KMOD_CTRL)
            self._change = self._handles.scaling(
                self._name, self._start, place, self._even or bool(shift), about_centre
            )
        self.transform = self._change.matrix

    def end(self) -> None:
        """Scale or turn the selection as the handle was dragged."""
        change = self._change
        if isinstance(change, Turn) and change.angle:
            self._screen.edit("Turn", lambda document: rotate(document, change.angle, change.centre))
        elif isinstance(change, Scaling) and (change.x, change.y) != (1.0, 1.0):
            self._screen.edit("Scale", lambda document: scale(document, change.x, change.y, change.centre))


class Boxing(Gesture):
    """Selects what lies in a box; taken: what picking items takes, with the whole of their groups."""

    def __init__(self, screen: Editing, start: Point, taken: Callable[[Selection], Selection]) -> None:
        self._screen, self._start, self._end, self._modifiers, self._taken = screen, start, start, 0, taken

    def to(self, point: Point, modifiers: int) -> None:
        """Drag the other corner of the box to a point [m]."""
        self._end, self._modifiers = point, modifiers

    def end(self) -> None:
        """Select what lies inside the box."""
        screen = self._screen
        found = self._taken(items_in_box(screen.scene, (*self._start, *self._end), screen.visibility.closed))
        screen.select(combined(screen.document.selection, found, pick_mode(self._modifiers, False)))

    def draw(self, surface: pygame.Surface) -> None:
        """Draw the box."""
        (x0, y0), (x1, y1) = map(self._screen.camera.to_pixels, (self._start, self._end))
        box = pygame.Rect(round(min(x0, x1)), round(min(y0, y1)), round(abs(x1 - x0)), round(abs(y1 - y0)))
        shade = pygame.Surface(box.size, pygame.SRCALPHA)
        shade.fill((*ACCENT, 28))
        surface.blit(shade, box)
        pygame.draw.rect(surface, ACCENT, box, 1)


class Lassoing(Gesture):
    """Selects what lies inside a freehand line; taken: as of a box."""

    def __init__(self, screen: Editing, start: Point, taken: Callable[[Selection], Selection]) -> None:
        self._screen, self._line, self._modifiers, self._taken = screen, [start], 0, taken

    def to(self, point: Point, modifiers: int) -> None:
        """Go on with the line to a point [m]."""
        self._modifiers = modifiers
        step = LASSO_STEP * self._screen.scale / self._screen.camera.zoom
        if math.dist(point, self._line[-1]) >= step:
            self._line.append(point)

    def end(self) -> None:
        """Select what lies inside the line."""
        screen = self._screen
        found = self._taken(items_in_lasso(screen.scene, self._line, screen.visibility.closed))
        screen.select(combined(screen.document.selection, found, pick_mode(self._modifiers, False)))

    def draw(self, surface: pygame.Surface) -> None:
        """Draw the line, closed by a straight one."""
        points = [self._screen.camera.to_pixels(point) for point in self._line]
        if len(points) > 2:
            pygame.draw.aalines(surface, ACCENT, True, points)
