"""ResponseCurve: how one spring of some Cs and Cd comes to rest, drawn over ticks and seconds."""

from typing import Any

import numpy as np
import pygame

from sandbox.app.draw.colours import ACCENT, DECADE, FIELD, MUTED, TEXT
from sandbox.app.panel.readings import motion_words
from sandbox.app.widgets.ui import Ui
from sandbox.app.widgets.widget import Widget
from sandbox.physics.softness.body_motion import SpringMotion, errors_of, motion_of

# Longest time that is looked at, and those that the curve may show [ticks].
LONGEST = 960
LENGTHS = (12, 30, 60, 120, 240, 480, LONGEST)
# Up to this many ticks each has a dot.
MOST_DOTS = 60
# Sizes in layout units.
TEXT_SIZE, TOP, BOTTOM, SIDE = 10.5, 17.0, 15.0, 4.0


class ResponseCurve(Widget):
    """The curve of one spring; it is worked out again where Cs, Cd or the tick rate change."""

    def __init__(self, ui: Ui, rect: pygame.Rect, container: Any = None) -> None:
        super().__init__(ui, rect, container)
        self._of: tuple[float, float, int] | None = None
        self.words = ""
        self.motion: SpringMotion | None = None
        self.errors = errors_of(0.0, 0.0, 1)

    def show_spring(self, pair: tuple[float, float], tick_rate: int) -> None:
        """Show the spring of Cs and Cd."""
        of = (*pair, tick_rate)
        if of != self._of:
            self._of, self.words, self.errors = of, "", errors_of(*pair, LONGEST)
            self.motion = motion_of(*pair, 1.0 / tick_rate)
            self.repaint()

    def show_none(self, words: str) -> None:
        """Say in its place why there is no one spring to be shown."""
        if words != self.words:
            self._of, self.words = None, words
            self.repaint()

    def paint(self, size: tuple[int, int]) -> pygame.Surface:
        """The curve, the line of rest, and when it comes there."""
        surface = pygame.Surface(size, pygame.SRCALPHA)
        px, font = self.ui.px, self.ui.font(TEXT_SIZE)
        inside = pygame.Rect(px(SIDE), px(TOP), size[0] - 2 * px(SIDE), size[1] - px(TOP + BOTTOM))
        pygame.draw.rect(surface, FIELD, inside, border_radius=px(4))
        if self._of is None or self.motion is None:
            text = font.render(self.words, True, MUTED)
            surface.blit(text, text.get_rect(center=inside.center))
            return surface
        rate, rest = self._of[2], self.motion.rest * self._of[2]
        shown = next((length for length in LENGTHS if rest <= 0.8 * length), LONGEST)
        title = font.render("One spring, let go", True, MUTED)
        surface.blit(title, (inside.left, 0))
        verdict = font.render(motion_words(self.motion), True, TEXT)
        surface.blit(verdict, verdict.get_rect(topright=(inside.right, 0)))
        for tick, label in ((0, "0"), (shown // 2, ""), (shown, f"{shown} ticks = {shown / rate:.3g} s")):
            x = inside.left + tick / shown * (inside.width - 1)
            pygame.draw.line(surface, DECADE, (x, inside.bottom - px(3)), (x, inside.bottom - 1))
            picture = font.render(label, True, MUTED)
            place = picture.get_rect(midtop=(x, inside.bottom))
            surface.blit(picture, place.clamp(pygame.Rect(inside.left, place.top, inside.width, place.height)))
        errors = self.errors[: shown + 1]
        lowest = min(-0.15, float(errors.min()) * 1.15)
        across = inside.left + np.arange(len(errors)) / shown * (inside.width - 1)
        down = inside.bottom - 1 - (errors - lowest) / (1.1 - lowest) * (inside.height - 2)
        zero = inside.bottom - 1 + lowest / (1.1 - lowest) * (inside.height - 2)
        pygame.draw.line(surface, DECADE, (inside.left, zero), (inside.right - 1, zero))
        points = np.stack([across, down], axis=1)
        pygame.draw.aalines(surface, ACCENT, False, points.tolist())
        if self.ui.scale >= 1.5:
            pygame.draw.aalines(surface, ACCENT, False, np.add(points, (0.0, 1.0)).tolist())
        if shown <= MOST_DOTS:
            for point in points.tolist():
                pygame.draw.aacircle(surface, ACCENT, point, max(1.5, 1.7 * self.ui.scale))
        return surface
