"""RangeSlider: which part of the last seconds is kept, between two knobs, or one moment of them."""

from collections.abc import Callable
from typing import Any

import pygame

from sandbox.app.draw.colours import ACCENT, DISABLED, LINE, TEXT, Colour
from sandbox.app.widgets.ui import Ui
from sandbox.app.widgets.widget import Pixel, Widget

# Shortest part that can be kept [s], and a step of the keyboard, with Ctrl a fine one.
SHORTEST = 0.5
KEY_STEP, FINE_KEY_STEP = 0.5, 0.1
# Painted this many times larger and scaled down: smooth edges.
OVERSAMPLING = 3
MARGIN = 10.0


class RangeSlider(Widget):
    """Knobs at start and end [s] on a line from 0 to `length`; changed(start, end) is called as they move.

    moment: there is one knob, at the end.
    """

    is_focusable = True

    def __init__(
        self, ui: Ui, rect: pygame.Rect, length: float, changed: Callable[[float, float], None], container: Any = None
    ) -> None:
        super().__init__(ui, rect, container)
        self.length, self._changed = max(length, 1e-3), changed
        self.start, self.end, self.moment = 0.0, self.length, False
        self._held = "end"

    def show_range(self, start: float, end: float, moment: bool) -> None:
        """Show the range that is kept."""
        self.start, self.end, self.moment = start, end, moment
        self.repaint()

    def pixel_of(self, seconds: float) -> int:
        """Horizontal window position of a moment."""
        margin = self.ui.px(MARGIN)
        return round(self.rect.left + margin + seconds / self.length * (self.rect.width - 2 * margin))

    def on_press(self, at: Pixel, clicks: int) -> bool:
        """Take the nearer knob."""
        seconds = self._seconds_at(at)
        is_start = not self.moment and abs(seconds - self.start) < abs(seconds - self.end)
        self._held = "start" if is_start else "end"
        self._move(self._held, seconds)
        return True

    def on_drag(self, at: Pixel) -> None:
        """Move the knob that was taken."""
        self._move(self._held, self._seconds_at(at))

    def press_key(self, event: pygame.event.Event) -> bool:
        """Left and right move the start, with Shift the end; with Ctrl by less."""
        step = FINE_KEY_STEP if event.mod & (pygame.KMOD_CTRL | pygame.KMOD_META) else KEY_STEP
        by = {pygame.K_LEFT: -step, pygame.K_RIGHT: step}.get(event.key)
        if by is None:
            return False
        knob = "end" if self.moment or event.mod & pygame.KMOD_SHIFT else "start"
        self._move(knob, (self.end if knob == "end" else self.start) + by)
        return True

    def _seconds_at(self, at: Pixel) -> float:
        margin = self.ui.px(MARGIN)
        return (at[0] - self.rect.left - margin) / max(1, self.rect.width - 2 * margin) * self.length

    def _move(self, knob: str, to: float) -> None:
        # A knob that is moved against the other stops before it.
        shortest = 0.0 if self.moment else min(SHORTEST, self.length)
        low, high = (0.0, self.end - shortest) if knob == "start" else (self.start + shortest, self.length)
        low = 0.0 if self.moment else low
        to = round(min(max(to, low), high), 2)
        start, end = (to, self.end) if knob == "start" else (self.start, to)
        self._changed(min(start, end), end)

    def paint(self, size: tuple[int, int]) -> pygame.Surface:
        """A track with the part that is kept, a mark for each second, and the knobs."""
        scale = self.ui.scale * OVERSAMPLING
        surface = pygame.Surface((size[0] * OVERSAMPLING, size[1] * OVERSAMPLING), pygame.SRCALPHA)
        margin, middle = MARGIN * scale, surface.get_height() * 0.42
        length, thick = surface.get_width() - 2 * margin, 4 * scale

        def x_of(seconds: float) -> float:
            return margin + seconds / self.length * length

        def bar(start: float, end: float, colour: Colour) -> None:
            place = pygame.Rect(x_of(start), middle - thick / 2, max(x_of(end) - x_of(start), 1), thick)
            pygame.draw.rect(surface, colour, place, border_radius=round(thick / 2))

        second = self.length
        while second >= 0.0:
            x = x_of(second)
            pygame.draw.line(surface, DISABLED, (x, middle + 8 * scale), (x, middle + 12 * scale), round(1.5 * scale))
            second -= 1.0
        bar(0.0, self.length, LINE)
        if not self.moment:
            bar(self.start, self.end, ACCENT)
        for knob in (self.end,) if self.moment else (self.start, self.end):
            pygame.draw.circle(surface, TEXT, (x_of(knob), middle), 8 * scale)
            pygame.draw.circle(surface, ACCENT, (x_of(knob), middle), 5 * scale)
        return pygame.transform.smoothscale(surface, size)
