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
from sandbox.editor.panel.field_info import FieldInfo
from sandbox.editor.panel.level_properties import level_properties
from sandbox.editor.panel.properties import properties
from sandbox.editor.panel.property import Property, Section, found_sections

OF_LEVEL = "Nothing is selected: the level"
FIND = "Find a field"
MEASURED = FieldInfo(
    "text", "In play",
    tooltip="How soft play says that it is: the word and the sag that it measures as it stands or hangs here. "
    "The sag above is that of a body as high as wide; a flat one gives way less.",
)  # fmt: skip
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
        self._wanted = self._softness = ""

    def refresh(self) -> None:
        """Show the selection as it is now."""
        document, wanted, softness = self._screen.document, self.search.typed.strip(), self._measured()
        if document is not self._shown or (wanted, softness) != (self._wanted, self._softness):
            if document.selection != (self._shown or document).selection and wanted == self._wanted:
                # Something else is selected: it is shown whole.
                wanted = ""
                self.search.typed = ""
            self._shown, self._wanted, self._softness = document, wanted, softness
            sections = _sections(document, softness)
            self.form.show(found_sections(sections, wanted) if wanted else sections)
        self.form.refresh()

    def _measured(self) -> str:
        """How soft play says that the selected body is; "" of anything else."""
        chosen = list(self._screen.document.selection)
        if len(chosen) != 1 or chosen[0].kind != "body" or "firmness" not in self.form.properties:
            return ""
        return self._screen.watch.softness_of(str(chosen[0].key))


def _sections(document: Document, softness: str) -> tuple[Section, ...]:
    if not document.selection:
        first, *rest = level_properties(document)
        return (replace(first, title=OF_LEVEL), *rest)
    sections = properties(document)
    if not softness:
        return sections
    measured = Property("firmness.measured", MEASURED, softness)
    return tuple(replace(each, properties=_with_measured(each.properties, measured)) for each in sections)


def _with_measured(found: tuple[Property, ...], measured: Property) -> tuple[Property, ...]:
    """Properties with what play measures below the sag, where that is among them."""
    at = next((place + 1 for place, each in enumerate(found) if each.field == "firmness.sag"), None)
    return found if at is None else (*found[:at], measured, *found[at:])
