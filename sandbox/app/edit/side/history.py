"""HistoryPage: every step with its label; a click goes there."""

from typing import Any

import pygame

from sandbox.app.contracts.application import Editing
from sandbox.app.draw.colours import DISABLED, TEXT
from sandbox.app.edit.side.side_page import SidePage
from sandbox.app.widgets.rows import Row, RowList
from sandbox.editor.document import Document


class HistoryPage(SidePage):
    """The steps of the history, the present one marked, those that were undone in grey below it."""

    def __init__(self, screen: Editing, place: pygame.Rect, container: Any) -> None:
        self._screen = screen
        self._ui = screen.ui
        self.list = RowList(screen.ui, place, self._go, container)
        self._shown: Document | None = None

    def refresh(self) -> None:
        """Show the steps as they are now."""
        history = self._screen.history
        if history.document is self._shown:
            return
        self._shown = history.document
        rows = [
            Row(label or "Edit", colour=TEXT if index <= history.index else DISABLED, aside=subject)
            for index, (label, subject) in enumerate(zip(history.labels, history.subjects, strict=True))
        ]
        self.list.show_rows(rows, history.index, reveal=True)

    def _go(self, index: int) -> None:
        if index != self._screen.history.index:
            self._screen.step_to(index)
