"""PropertiesPage and SettingsPage: what can be changed of the selection, and of the level as a whole."""

from dataclasses import replace
from typing import Any

import pygame

from sandbox.app.base.sentences import sentence
from sandbox.app.contracts.application import Editing
from sandbox.app.edit.side.side_page import ROOM_FOR_LIST, SidePage
from sandbox.app.widgets.dialogs import ask
from sandbox.app.widgets.form import Form
from sandbox.app.widgets.property_widgets import GAP, ROW
from sandbox.app.widgets.scroll import ScrollArea
from sandbox.editor.document import Document, EditError
from sandbox.editor.edits.fields import set_level_field
from sandbox.editor.edits.materials import set_rate_in_pace
from sandbox.editor.panel.field_info import FieldInfo
from sandbox.editor.panel.level_properties import level_properties
from sandbox.editor.panel.properties import properties
from sandbox.editor.panel.property import Property, Section, found_sections
from sandbox.level.document.model import Level

NOTHING = (
    "Nothing is selected. Click something on the sheet, or draw it. What is about the whole level is on the page Level."
)
FIND = "Find a field"
MEASURED = FieldInfo(
    "text", "In play",
    tooltip="How soft play says that it is: the word and the sag that it measures as it stands or hangs here. "
    "The sag above is that of the body where it stands, held by nothing.",
)  # fmt: skip
NOT_FOUND = "No field matches these words."
# Digits after the point of a view [m] that is taken from the camera.
VIEW_DECIMALS = 3
# Height that the buttons take [layout units].
BUTTONS = 2 * ROW + 3 * GAP


class PropertiesPage(SidePage):
    """The properties of what is selected, under a line to find some of them."""

    def __init__(self, screen: Editing, place: pygame.Rect, container: Any) -> None:
        self._screen, ui = screen, screen.ui
        row, gap = ui.px(ROW), ui.px(GAP)
        line = pygame.Rect(place.topleft, (place.width - ui.px(6), row))
        self.search = ui.field(line, "", lambda _: True, container, 80, hint=FIND)
        below = pygame.Rect(place.left, place.top + row + gap, place.width, place.height - row - gap)
        self._area = ScrollArea(ui, below, container)
        self.form = Form(screen, self._area, above=6.0)
        self._shown: Document | None = None
        self._query = self._softness = ""

    def refresh(self) -> None:
        """Show the selection as it is now."""
        document, query, softness = self._screen.document, self.search.typed.strip(), self._measured()
        if document is not self._shown or (query, softness) != (self._query, self._softness):
            if document.selection != (self._shown or document).selection and query == self._query:
                # Something else is selected: it is shown whole.
                query = ""
                self.search.typed = ""
            self._shown, self._query, self._softness = document, query, softness
            sections = _sections(document, softness)
            is_found = bool(query or document.selection)
            self.form.say_if_empty(NOT_FOUND if is_found else NOTHING)
            self.form.show(found_sections(sections, query) if query else sections if is_found else ())
        self.form.refresh()

    def _measured(self) -> str:
        """The measured softness of the selected body, in words; "" of anything else."""
        chosen = list(self._screen.document.selection)
        if len(chosen) != 1 or chosen[0].kind != "body" or "firmness" not in self.form.properties:
            return ""
        return self._screen.watch.softness_of(str(chosen[0].key))


def _sections(document: Document, softness: str) -> tuple[Section, ...]:
    if not document.selection:
        return level_properties(document)
    sections = properties(document)
    if not softness:
        return sections
    measured = Property("firmness.measured", MEASURED, softness)
    return tuple(replace(each, properties=_with_measured(each.properties, measured)) for each in sections)


def _with_measured(found: tuple[Property, ...], measured: Property) -> tuple[Property, ...]:
    """Properties with what play measures below the sag, where that is among them."""
    at = next((place + 1 for place, each in enumerate(found) if each.field == "firmness.sag"), None)
    return found if at is None else (*found[:at], measured, *found[at:])


class SettingsPage(SidePage):
    """Settings of the level as a whole."""

    def __init__(self, screen: Editing, place: pygame.Rect, container: Any) -> None:
        self._screen, self._ui = screen, screen.ui
        # On a low page the buttons are below the last row, and scroll with it.
        is_low = place.height < self._ui.px(ROOM_FOR_LIST)
        height = self._ui.px(BUTTONS)
        upper = pygame.Rect(place.topleft, (place.width, place.height - (0 if is_low else height)))
        self._area = ScrollArea(self._ui, upper, container)
        self.form = Form(screen, self._area, below=BUTTONS if is_low else 0.0)
        corner, holder = ((0, 0), self._area.content) if is_low else (upper.bottomleft, container)
        self._foot = self._ui.area(pygame.Rect(corner, (place.width - self._ui.px(12), height)), holder)
        self._moves_foot = is_low
        self._add_buttons()
        self._shown: Level | None = None

    def _add_buttons(self) -> None:
        gap, tall, wide = self._ui.px(GAP), self._ui.px(ROW), self._foot.rect.width
        row = pygame.Rect(0, gap, wide, tall)
        tip = "Change the tick rate and adapt Cs and Cd, so that springs move as they do now"
        self.pace = self._ui.button(
            row, "Tick rate, at the same pace…", self._ask_rate, self._foot, style="segment", tip=tip
        )
        row = pygame.Rect(0, row.bottom + gap, (wide - gap) // 2, tall)
        tip = "The level opens with what you see now"
        self.from_camera = self._ui.button(row, "View from here", self._take_view, self._foot, style="segment", tip=tip)
        row = row.move(row.width + gap, 0)
        tip = "The level opens with everything in view"
        self.no_view = self._ui.button(row, "View: everything", self._drop_view, self._foot, style="segment", tip=tip)

    def refresh(self) -> None:
        """Show the level as it is now."""
        document = self._screen.document
        if document.level is not self._shown:
            self._shown = document.level
            self.form.show(level_properties(document))
            if self._moves_foot:
                self._foot.move_to((0, self._ui.px(self.form.end)))
        self.form.refresh()

    def _take_view(self) -> None:
        camera = self._screen.camera
        left, top, width, height = camera.viewport
        (x0, y1), (x1, y0) = camera.to_world((left, top)), camera.to_world((left + width, top + height))
        view = tuple(round(value, VIEW_DECIMALS) + 0.0 for value in (x0, y0, x1, y1))
        self._set_view(view)

    def _drop_view(self) -> None:
        self._set_view(None)

    def _set_view(self, view: tuple[float, ...] | None) -> None:
        def with_view(document: Document) -> Document:
            return set_level_field(document, "view", view)

        self._screen.edit("View", with_view)

    def _ask_rate(self) -> None:
        """Ask for another tick rate at which springs move as they do now."""
        rate = self._screen.document.level.settings.tick_rate
        hint = "Ticks a second. Each spring keeps its frequency and damping ratio; muscles keep their time."
        title = "Another tick rate, the same behaviour"
        ask(self._ui, title, hint, str(rate), "Change", self._take_rate)

    def _take_rate(self, typed: str) -> str | None:
        """Take a typed rate; else the line that says what is wrong with it."""
        if not typed.isdecimal():
            return f"{typed or 'Nothing'!r} is not a whole number of ticks a second."
        try:
            document = set_rate_in_pace(self._screen.document, int(typed))
        except EditError as error:
            return sentence(error)
        self._screen.apply("Tick rate at the same pace", document)
        return None
