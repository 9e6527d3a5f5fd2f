"""LimitGauge: how far a number may go: a logarithmic track with a knob, and where it becomes too much."""

import math
from typing import Any

import pygame

from sandbox.app.draw.colours import ACCENT, DANGER, DECADE, LINE, MUTED, SURFACE, TEXT, mixed
from sandbox.app.widgets.ui import Ui
from sandbox.app.widgets.widget import Widget

# Sizes in layout units.
TEXT_SIZE, TRACK, KNOB, SIDE = 11.5, 5.0, 6.0, 8.0


class LimitGauge(Widget):
    """A track from low to high; beyond its limit it is hatched."""

    def __init__(self, ui: Ui, rect: pygame.Rect, low: float, high: float, container: Any = None) -> None:
        super().__init__(ui, rect, container)
        self._low, self._high = low, high
        self._shown: tuple[float, float, str, str] = (low, high, "", "")

    def show_value(self, value: float, limit: float, text: str, limit_text: str) -> None:
        """Show a value and its limit, with what stands above at the left and at the right."""
        if (value, limit, text, limit_text) != self._shown:
            self._shown = (value, limit, text, limit_text)
            self.repaint()

    def _share(self, value: float) -> float:
        share = math.log(max(value, self._low) / self._low) / math.log(self._high / self._low)
        return min(max(share, 0.0), 1.0)

    def paint(self, size: tuple[int, int]) -> pygame.Surface:
        """Track, limit and knob, the words above."""
        surface = pygame.Surface(size, pygame.SRCALPHA)
        px, font = self.ui.px, self.ui.font(TEXT_SIZE)
        value, limit, text, limit_text = self._shown
        is_beyond = value > limit
        left = self.ui.font(TEXT_SIZE, True).render(text, True, DANGER if is_beyond else TEXT)
        right = font.render(limit_text, True, MUTED)
        surface.blit(left, (0, 0))
        surface.blit(right, right.get_rect(topright=(size[0], 0)))
        start, length, middle = px(SIDE), size[0] - 2 * px(SIDE), size[1] - px(KNOB + 3)
        end = start + self._share(limit) * length
        thick = px(TRACK)
        pygame.draw.rect(surface, LINE, (start, middle - thick // 2, length, thick), border_radius=max(1, thick // 2))
        if limit < self._high:
            beyond = pygame.Rect(round(end), middle - thick // 2, round(start + length - end), thick)
            pygame.draw.rect(surface, mixed(SURFACE, DANGER, 0.35), beyond)
            for x in range(beyond.left, beyond.right, max(3, px(4))):
                pygame.draw.line(surface, DANGER, (x, beyond.bottom - 1), (min(x + thick, beyond.right), beyond.top))
        pygame.draw.line(surface, MUTED, (end, middle - px(7)), (end, middle + px(6)), max(1, px(1.5)))
        pygame.draw.line(surface, DECADE, (start, middle - px(3)), (start, middle + px(3)))
        at = (start + self._share(value) * length, middle)
        pygame.draw.aacircle(surface, TEXT, at, px(KNOB))
        pygame.draw.aacircle(surface, DANGER if is_beyond else ACCENT, at, px(KNOB - 2.5))
        return surface
