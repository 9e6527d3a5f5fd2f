"""FoldHeading: the heading of a section that can be folded away, with a mark that says whether it is."""

from collections.abc import Callable
from typing import Any

import pygame

from sandbox.app.draw.colours import MUTED, TEXT
from sandbox.app.widgets.ui import Ui
from sandbox.app.widgets.widget import Pressable

# Sizes in layout units.
TEXT_SIZE, MARK = 11.0, 3.5


class FoldHeading(Pressable):
    """A heading; toggle() is called by a click or key."""

    is_lit = True

    def __init__(
        self, ui: Ui, rect: pygame.Rect, text: str, is_folded: bool, toggle: Callable[[], None], container: Any = None
    ) -> None:
        super().__init__(ui, rect, container)
        self.text, self.is_folded, self._toggle = text, is_folded, toggle

    def press(self) -> None:
        """Fold the section, or unfold it."""
        self._toggle()

    def paint(self, size: tuple[int, int]) -> pygame.Surface:
        """A mark that points down where it is open, to the right where it is folded, and the words."""
        surface = pygame.Surface(size, pygame.SRCALPHA)
        colour = TEXT if self.hovered else MUTED
        k, middle = self.ui.px(MARK), size[1] / 2
        x = self.ui.px(1) + k
        if self.is_folded:
            corners = [(x - k / 2, middle - k), (x + k / 2, middle), (x - k / 2, middle + k)]
        else:
            corners = [(x - k, middle - k / 2), (x, middle + k / 2), (x + k, middle - k / 2)]
        pygame.draw.lines(surface, colour, False, corners, max(1, self.ui.px(1.5)))
        words = self.ui.font(TEXT_SIZE, True).render(self.text.upper(), True, colour)
        surface.blit(words, words.get_rect(midleft=(x + k + self.ui.px(6), middle)))
        return surface
