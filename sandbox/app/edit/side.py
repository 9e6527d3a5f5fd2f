"""Side: the panel at the right of the editor."""

from typing import TYPE_CHECKING

import pygame

from sandbox.app.widgets import Ui

if TYPE_CHECKING:
    from sandbox.app.edit.screen import EditScreen


class Side:
    """The panel in a rectangle of pixels."""

    def __init__(self, ui: Ui, screen: "EditScreen", place: pygame.Rect) -> None:
        self.screen = screen
        self.back = ui.panel(place)

    def refresh(self) -> None:
        """Show what is so now."""

    def scroll(self, notches: float) -> None:
        """Move what it shows by notches of the wheel."""

    def close(self) -> None:
        """Take it away."""
        self.back.kill()
