"""LogSlider: a coefficient on a logarithmic scale from 1e-5 to 1, with the mark up to which it is proven stable."""

import math
from collections.abc import Callable
from typing import Any

import pygame

from sandbox.app.draw.colours import ACCENT, DECADE, LINE, MUTED, SURFACE, TEXT, WARNING, Colour, mixed
from sandbox.app.widgets.painted import Draggable
from sandbox.app.widgets.ui import Ui

# Exponents of the smallest and largest value on the scale.
LOWEST, HIGHEST = -5.0, 0.0
# Part of the scale that an arrow key moves, and with Shift held.
KEY_STEP, FINE_KEY_STEP = 0.02, 0.004
# Painted this many times larger and scaled down: smooth edges.
OVERSAMPLING = 3
MARGIN = 9.0


def fraction_of(value: float) -> float:
    """Where on the scale (0..1) a value lies; values below the scale, 0 among them, lie at its start."""
    if value <= 10.0**LOWEST:
        return 0.0
    return min((math.log10(value) - LOWEST) / (HIGHEST - LOWEST), 1.0)


def value_at(fraction: float) -> float:
    """The value at a place on the scale, in three significant digits."""
    exponent = LOWEST + min(max(fraction, 0.0), 1.0) * (HIGHEST - LOWEST)
    return float(f"{10.0**exponent:.3g}")


class LogSlider(Draggable):
    """A slider; changed(value) is called as it moves and done() at the end of each drag or key press."""

    def __init__(
        self,
        ui: Ui,
        rect: pygame.Rect,
        changed: Callable[[float], None],
        done: Callable[[], None],
        container: Any = None,
    ) -> None:
        super().__init__(ui, rect, container)
        self.value = 0.5
        self.limit: float | None = None
        self.mixed = False
        self.enabled = True
        self._changed, self._done = changed, done
        ui.add(self)
        self.repaint()

    def show_value(self, value: float, limit: float | None, is_mixed: bool, enabled: bool) -> None:
        """Show a value, its limit (None = none is proven) and whether the springs differ."""
        fresh = (value, limit, is_mixed, enabled)
        if fresh != (self.value, self.limit, self.mixed, self.enabled):
            self.value, self.limit, self.mixed, self.enabled = fresh
            self.repaint()

    def pixel_of(self, value: float) -> int:
        """Horizontal window position of a value."""
        margin = self.ui.px(MARGIN)
        return round(self.rect.left + margin + fraction_of(value) * (self.rect.width - 2 * margin))

    def can_drag(self) -> bool:
        """Whether there is anything to set."""
        return self.enabled

    def end_drag(self) -> None:
        """What is set counts."""
        self._done()

    def press_key(self, event: pygame.event.Event) -> bool:
        """Left and right move by a step, with Shift by a fine one; Home and End go to the ends."""
        step = FINE_KEY_STEP if event.mod & pygame.KMOD_SHIFT else KEY_STEP
        here = fraction_of(self.value)
        targets = {
            pygame.K_LEFT: here - step,
            pygame.K_RIGHT: here + step,
            pygame.K_DOWN: here - step,
            pygame.K_UP: here + step,
            pygame.K_HOME: 0.0,
            pygame.K_END: 1.0,
        }
        if event.key not in targets or not self.enabled:
            return False
        self._changed(value_at(targets[event.key]))
        self._done()
        return True

    def follow(self, pos: tuple[int, int]) -> None:
        """Set what lies under the mouse."""
        x = self.ui.manager.calculate_scaled_mouse_position(pos)[0]
        margin = self.ui.px(MARGIN)
        fraction = (x - self.rect.left - margin) / max(1, self.rect.width - 2 * margin)
        self._changed(value_at(fraction))

    def paint(self, size: tuple[int, int]) -> pygame.Surface:
        """Track, decades, the part beyond the limit in amber, mark and knob."""
        scale = self.ui.scale * OVERSAMPLING
        width, height = size[0] * OVERSAMPLING, size[1] * OVERSAMPLING
        surface = pygame.Surface((width, height), pygame.SRCALPHA)
        margin, middle = MARGIN * scale, height * 0.5
        length = width - 2 * margin
        thick = 4 * scale

        def bar(start: float, end: float, colour: Colour) -> None:
            place = pygame.Rect(margin + start * length, middle - thick / 2, max((end - start) * length, 1), thick)
            pygame.draw.rect(surface, colour, place, border_radius=round(thick / 2))

        accent = ACCENT if self.enabled else LINE
        for decade in range(6):
            x = margin + decade / 5 * length
            pygame.draw.line(
                surface, DECADE, (x, middle + 7 * scale), (x, middle + 10 * scale), max(1, round(1.3 * scale))
            )
        bar(0.0, 1.0, LINE)
        limited = self.limit is not None and self.limit < 1.0
        limit = fraction_of(self.limit) if self.limit is not None else 1.0
        if limited:
            bar(limit, 1.0, mixed(LINE, WARNING, 0.45))
        here = fraction_of(self.value)
        if not self.mixed:
            bar(0.0, here, accent)
            if limited and here > limit:
                bar(limit, here, WARNING)
        if limited:
            self._paint_mark(surface, margin + limit * length, middle, scale)
        knob = (margin + here * length, middle)
        pygame.draw.circle(surface, TEXT if self.enabled else MUTED, knob, 7 * scale)
        inside = WARNING if limited and here > limit else accent
        pygame.draw.circle(surface, SURFACE if self.mixed else inside, knob, 4 * scale)
        return pygame.transform.smoothscale(surface, size)

    def _paint_mark(self, surface: pygame.Surface, x: float, middle: float, scale: float) -> None:
        tip, top = middle - 4 * scale, middle - 12 * scale
        pygame.draw.polygon(surface, WARNING, [(x - 4.5 * scale, top), (x + 4.5 * scale, top), (x, tip)])
        pygame.draw.line(surface, WARNING, (x, tip), (x, middle + 6 * scale), max(1, round(1.5 * scale)))
