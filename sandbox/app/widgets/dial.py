"""Dial: an arrow in a circle, which is dragged to where something pulls or blows, and how hard."""

import math
from collections.abc import Callable, Sequence
from typing import Any

import pygame

from sandbox.app.draw.colours import ACCENT, DECADE, FIELD, LINE, MUTED, SURFACE, TEXT, mixed
from sandbox.app.widgets.ui import Ui
from sandbox.app.widgets.widget import Draggable, Pixel

# Painted this many times larger and scaled down: smooth edges.
OVERSAMPLING = 3
# Sizes in layout units: of the room around the circle, and of the knob.
MARGIN, KNOB, HEAD = 3.0, 4.5, 6.0
# A drag so near [part of the radius] to a strength that is marked, and to a way along an axis, takes that.
NEAR = 0.09
# What an arrow key adds, and with Shift held, as parts of the whole.
KEY_STEP, FINE_KEY_STEP = 0.05, 0.005

Vector = tuple[float, float]


class Dial(Draggable):
    """A dial up to a strength `full` at its rim; changed(x, y) is called as it moves, done() at the end of each drag.

    marks: strengths, each drawn as a ring, that a drag takes where it comes near one. What is stronger than `full` is
    shown at the rim.
    """

    def __init__(
        self, ui: Ui, rect: pygame.Rect, full: float, marks: Sequence[float], changed: Callable[[float, float], None],
        done: Callable[[], None], container: Any = None,
    ) -> None:  # fmt: skip
        super().__init__(ui, rect, container)
        self.value: Vector = (0.0, 0.0)
        self._full, self._marks = full, marks
        self._changed, self._done = changed, done

    def show_value(self, value: Vector) -> None:
        """Show another value."""
        if value != self.value:
            self.value = value
            self.repaint()

    @property
    def _radius(self) -> float:
        return min(self.rect.size) / 2 - self.ui.px(MARGIN)

    def pixel_of(self, value: Vector) -> tuple[int, int]:
        """Where in the window the knob is for a value."""
        x, y = self._place_of(value)
        middle = self.rect.center
        return round(middle[0] + x * self._radius), round(middle[1] - y * self._radius)

    def _place_of(self, value: Vector) -> Vector:
        """Where the knob is for a value, in radii from the middle."""
        longest = max(math.hypot(*value), self._full)
        return value[0] / longest, value[1] / longest

    def on_drag(self, at: Pixel) -> None:
        """Set the value under the mouse, or a marked one near it."""
        x, y = ((at[0] - self.rect.centerx) / self._radius, (self.rect.centery - at[1]) / self._radius)
        x, y = (0.0 if abs(along) < NEAR else along for along in (x, y))
        share = min(math.hypot(x, y), 1.0)
        strength = next((mark for mark in self._marks if abs(mark / self._full - share) < NEAR), share * self._full)
        length = math.hypot(x, y)
        self._set((x / length * strength, y / length * strength) if length else (0.0, 0.0))

    def _set(self, value: Vector) -> None:
        digits = 3 - math.floor(math.log10(self._full))
        x, y = (round(along, digits) + 0.0 for along in value)
        self._changed(x, y)

    def on_release(self, at: Pixel) -> None:
        """Call done(): the drag has ended."""
        self._done()

    def press_key(self, event: pygame.event.Event) -> bool:
        """Arrows pull it their way by a step, with Shift by a fine one; Home sets it to nothing."""
        ways = {pygame.K_LEFT: (-1, 0), pygame.K_RIGHT: (1, 0), pygame.K_DOWN: (0, -1), pygame.K_UP: (0, 1)}
        if event.key == pygame.K_HOME:
            self._set((0.0, 0.0))
        elif event.key in ways:
            step = self._full * (FINE_KEY_STEP if event.mod & pygame.KMOD_SHIFT else KEY_STEP)
            x, y = (along + way * step for along, way in zip(self.value, ways[event.key], strict=True))
            # It goes no further than the rim, unless it is there already.
            share = min(1.0, max(self._full, math.hypot(*self.value)) / max(math.hypot(x, y), 1e-12))
            self._set((x * share, y * share))
        else:
            return False
        self._done()
        return True

    def paint(self, size: tuple[int, int]) -> pygame.Surface:
        """The circle, its rings, and an arrow from the middle to the knob."""
        scale = self.ui.scale * OVERSAMPLING
        surface = pygame.Surface((size[0] * OVERSAMPLING, size[1] * OVERSAMPLING), pygame.SRCALPHA)
        middle, radius = surface.get_rect().center, self._radius * OVERSAMPLING
        pygame.draw.circle(surface, FIELD, middle, radius)
        thin = max(1, round(1.2 * scale))
        for mark in self._marks:
            if mark:
                pygame.draw.circle(surface, mixed(LINE, MUTED, 0.4), middle, radius * mark / self._full, thin)
        for dx, dy in ((1, 0), (-1, 0), (0, 1), (0, -1)):
            inner, outer = ((middle[0] + dx * radius * part, middle[1] + dy * radius * part) for part in (0.88, 1.0))
            pygame.draw.line(surface, DECADE, inner, outer, thin)
        pygame.draw.circle(surface, mixed(LINE, MUTED, 0.4), middle, radius, thin)
        x, y = self._place_of(self.value)
        tip = middle[0] + x * radius, middle[1] - y * radius
        if x or y:
            pygame.draw.line(surface, ACCENT, middle, tip, round(2.2 * scale))
            pygame.draw.circle(surface, MUTED, middle, 1.8 * scale)
            self._paint_head(surface, tip, (x, -y), scale)
        else:
            pygame.draw.circle(surface, TEXT, middle, KNOB * scale)
            pygame.draw.circle(surface, SURFACE, middle, 0.55 * KNOB * scale)
        return pygame.transform.smoothscale(surface, size)

    def _paint_head(self, surface: pygame.Surface, tip: Vector, way: Vector, scale: float) -> None:
        turn, head = math.atan2(way[1], way[0]), HEAD * scale
        corners = [
            (tip[0] + head * math.cos(turn + by), tip[1] + head * math.sin(turn + by)) for by in (0.0, 2.3, -2.3)
        ]
        pygame.draw.polygon(surface, ACCENT, corners)
