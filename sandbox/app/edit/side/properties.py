"""PropertiesPage: what can be changed of the selection; of nothing selected, of the level."""

from dataclasses import replace
from typing import Any

import pygame

from sandbox.app.contracts.application import Editing
from sandbox.app.edit.side.side_page import SidePage
from sandbox.app.widgets.form import Form
from sandbox.app.widgets.property_widgets import GAP, ROW
from sandbox.app.widgets.scroll import ScrollArea
from sandbox.editor.document import Document
from sandbox.editor.panel.level_properties import level_properties
from sandbox.editor.panel.properties import properties
from sandbox.editor.panel.property import Section, found_sections

OF_LEVEL = "Nothing is selected: the level"
FIND = "Find a field"
NOT_FOUND = "No field matches these words."


class PropertiesPage(SidePage):
    """The properties of what is selected, under a line to find some of them."""

    def __init__(self, screen: Editing, place: pygame.Rect, container: Any) -> None:
        self._screen, ui = screen, screen.ui
        row, gap = ui.px(ROW), ui.px(GAP)
        line = pygame.Rect(place.topleft, (place.width - ui.px(6), row))
        self.search = ui.field(line, "", lambda _: True, container, 80, hint=FIND)
        below = pygame.Rect(place.left, place.top + row + gap, place.width, place.height - row - gap)
        self._area = ScrollArea(ui, below, container)
        self.form = Form(screen, self._area, above=6.0, empty=NOT_FOUND)
        self._shown: Document | None = None
        self._wanted = ""

    def refresh(self) -> None:
        """Show the selection as it is now."""
        document, wanted = self._screen.document, self.search.typed.strip()
        if document is not self._shown or wanted != self._wanted:
            if document.selection != (self._shown or document).selection and wanted == self._wanted:
                # Something else is selected: it is shown whole.
                wanted = ""
                self.search.typed = ""
            self._shown, self._wanted = document, wanted
            sections = _sections(document)
            self.form.show(found_sections(sections, wanted) if wanted else sections)
        self.form.refresh()


def _sections(document: Document) -> tuple[Section, ...]:
    if document.selection:
        return properties(document)
    first, *rest = level_properties(document)
    return (replace(first, title=OF_LEVEL), *rest)
