"""SettingsPage: the level's name and maker, its first view, and how its time passes."""

from typing import Any

import pygame

from sandbox.app.base.sentences import sentence
from sandbox.app.contracts.application import Editing
from sandbox.app.edit.side.list_head import ROOM_FOR_LIST
from sandbox.app.edit.side.side_page import SidePage
from sandbox.app.widgets.dialogs import ask
from sandbox.app.widgets.form import Form
from sandbox.app.widgets.property_widgets import GAP, ROW
from sandbox.app.widgets.scroll import ScrollArea
from sandbox.editor.document import Document, EditError
from sandbox.editor.edits.fields import set_level_field
from sandbox.editor.edits.materials import set_rate_in_pace
from sandbox.editor.panel.level_properties import level_properties
from sandbox.level.document.model import Level

# Digits after the point of a view [m] that is taken from the camera.
VIEW_DECIMALS = 3
# Height that the buttons take [layout units].
BUTTONS = 2 * ROW + 3 * GAP


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
        """Take a typed rate; what is wrong with it otherwise."""
        if not typed.isdecimal():
            return f"{typed or 'Nothing'!r} is not a whole number of ticks a second."
        try:
            document = set_rate_in_pace(self._screen.document, int(typed))
        except EditError as error:
            return sentence(error)
        self._screen.apply("Tick rate at the same pace", document)
        return None
