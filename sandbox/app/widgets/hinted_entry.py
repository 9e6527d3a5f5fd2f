"""HintedEntry: a line to type into whose hint is paler than what is typed."""

from typing import Any

import pygame
from pygame_gui.elements import UITextEntryLine

from sandbox.app.draw.colours import MUTED


class HintedEntry(UITextEntryLine):
    """As of pygame_gui, which gives both the same colour."""

    def _tint(self, is_focused: bool) -> None:
        shape: Any = self.drawable_shape
        if shape is not None:
            shows_hint = not (self.text or is_focused)
            shape.theming["normal_text"] = pygame.Color(*MUTED) if shows_hint else self.text_colour

    def set_text(self, text: str | None) -> None:
        """Show another text."""
        self.text = text or ""
        self._tint(self.is_focused)
        super().set_text(text)

    def rebuild(self) -> None:
        """Draw it again."""
        super().rebuild()
        self._tint(self.is_focused)
        if not self.text and self.placeholder_text and self.drawable_shape is not None:
            self.drawable_shape.set_text(self.placeholder_text)

    def focus(self) -> None:
        """Begin to type."""
        self._tint(True)
        super().focus()

    def unfocus(self) -> None:
        """End typing."""
        self._tint(False)
        super().unfocus()
