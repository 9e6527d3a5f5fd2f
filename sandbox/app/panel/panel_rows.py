"""PanelRows: where the next row of a panel goes, lines to type into with their titles, and sections that fold."""

from collections.abc import Callable
from typing import Any

import pygame

from sandbox.app.widgets.boxes import HEADING_SIZE, FoldHeading
from sandbox.app.widgets.field import Field
from sandbox.app.widgets.ui import Ui

# Sizes in layout units.
PANEL_WIDTH = 292.0
MARGIN = 18.0
INSIDE = PANEL_WIDTH - 2 * MARGIN
TOP = 14.0
ROW = 28.0
ENTRY_WIDTH = 82.0
GAP = 12.0
# Of a heading's row, what is beside its words; the rest is free for what belongs there.
HEADING_ROOM = 34.0


class PanelRows:
    """Rows in a container of widgets, from its top down."""

    def __init__(self, ui: Ui, back: Any) -> None:
        self.ui, self.back = ui, back
        self.y = TOP

    def row(self, height: float, gap: float = 0.0, x: float = MARGIN, width: float = INSIDE) -> pygame.Rect:
        """The next row, and the gap after it."""
        place = self.place(x, 0.0, width, height)
        self.y += height + gap
        return place

    def place(self, x: float, below: float, width: float, height: float) -> pygame.Rect:
        """A place so far below the top of the next row."""
        return self.ui.rect(x, self.y + below, width, height)

    def named_field(self, text: str, tip: str, commit: Callable[[str], bool]) -> Field:
        """A label at the left and a line to type into at the right, on a row of their own."""
        self.ui.label(self.place(MARGIN, 0, INSIDE - ENTRY_WIDTH - 8, ROW), text, self.back)
        return self._field(self.row(ROW, 4, MARGIN + INSIDE - ENTRY_WIDTH, ENTRY_WIDTH), tip, commit)

    def beside(self, *fields: tuple[str, str, Callable[[str], bool]]) -> list[Field]:
        """Lines to type into, side by side, each with its title and its tip."""
        width, made = (INSIDE - GAP * (len(fields) - 1)) / len(fields), []
        for index, (text, tip, commit) in enumerate(fields):
            x = MARGIN + index * (width + GAP)
            self.ui.label(self.place(x, 0, width, 18), text, self.back, "muted")
            made.append(self._field(self.place(x, 19, width, ROW), tip, commit))
        self.row(19 + ROW, 6)
        return made

    def _field(self, place: pygame.Rect, tip: str, commit: Callable[[str], bool]) -> Field:
        made = self.ui.field(place, "", commit, self.back, 24)
        made.tip = tip
        return made

    def section(self, title: str, is_open: bool, toggle: Callable[[], None], build: Callable[[], None]) -> None:
        """A heading, and what `build` makes under it, which is seen where the section is open."""
        width = self.ui.font(HEADING_SIZE, True).size(title.upper())[0] / self.ui.scale + HEADING_ROOM
        FoldHeading(self.ui, self.row(18, 8, width=width), title, not is_open, toggle, self.back)
        before, y = len(self.back.children), self.y
        build()
        if not is_open:
            for element in self.back.children[before:]:
                element.visible = False
            self.y = y
