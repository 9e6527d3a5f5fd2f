"""PropertiesPage: what can be changed of the selection."""

from typing import Any

import pygame

from sandbox.app.contracts.editing import Editing
from sandbox.app.edit.side.form import Form
from sandbox.app.widgets.scroll import ScrollArea
from sandbox.editor.document import Document
from sandbox.editor.panel.properties import properties

NOTHING = "Nothing is selected. Click a part, or draw a box around several, to see and change what they are made of."


class PropertiesPage:
    """The properties of what is selected."""

    def __init__(self, screen: Editing, place: pygame.Rect, container: Any) -> None:
        self._screen = screen
        self._area = ScrollArea(screen.ui, place, container)
        self.form = Form(screen, self._area, empty=NOTHING)
        self._shown: Document | None = None

    def refresh(self) -> None:
        """Show the selection as it is now."""
        if self._screen.document is not self._shown:
            self._shown = self._screen.document
            self.form.show(properties(self._shown))
        self.form.refresh()

    def close(self) -> None:
        """Take the page away."""
        self.form.close()
        self._area.kill()
