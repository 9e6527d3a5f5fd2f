"""BarTitle: the name of a level in a bar, on one line, or on two of smaller letters where it is long."""

from typing import Any

import pygame

from sandbox.app.draw.colours import TEXT
from sandbox.app.widgets.layout import WindowLayout
from sandbox.app.widgets.texts import line_height, wrapped
from sandbox.app.widgets.widget import Widget

# Size of letters on one line, and on two [layout units].
LARGE, SMALL = 15.0, 12.0


class BarTitle(Widget):
    """A name; lines: what is seen of it; what is not is in its tooltip."""

    def __init__(self, ui: WindowLayout, rect: pygame.Rect, container: Any = None) -> None:
        super().__init__(ui, rect, container)
        self.text, self.lines = "", [""]
        self._size = LARGE

    def show_text(self, text: str) -> None:
        """Show a name."""
        if text == self.text:
            return
        self.text = text
        widest = self.rect.width
        self._size = LARGE if self.ui.font(LARGE, True).size(text)[0] <= widest else SMALL
        font = self.ui.font(self._size, True)
        self.lines = wrapped(text, font, widest, 1 if self._size == LARGE else 2)
        fits = max(font.size(line)[0] for line in self.lines) <= widest
        is_whole = fits and " ".join(self.lines) == " ".join(text.split())
        self.tip = "" if is_whole else text
        self.repaint()

    def paint(self, size: tuple[int, int]) -> pygame.Surface:
        """Paint the lines of the name, in the middle of the height."""
        surface = pygame.Surface(size, pygame.SRCALPHA)
        font = self.ui.font(self._size, True)
        high = line_height(font)
        y = (size[1] - high * len(self.lines)) // 2
        for line in self.lines:
            surface.blit(font.render(line, True, TEXT), (0, y))
            y += high
        return surface
