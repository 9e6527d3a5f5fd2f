"""Header of the gallery: its pages, the line to search in, the sections, and what else can be opened."""

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

from sandbox.app.base.shortcuts import tip_of
from sandbox.app.contracts.application import Application
from sandbox.app.widgets.button import Button
from sandbox.app.widgets.field import Field
from sandbox.app.widgets.ui import Ui

# Sizes in layout units.
MARGIN = 36.0
BUTTON = 32.0
GAP = 8.0
PAGES_WIDTH, SEARCH_WIDTH = 260.0, 240.0
# Narrower windows have two rows and no line of sections.
ROOM_FOR_ONE_ROW = 980.0
NEW_TIP = "A place of your own: ground, walls and parts to play with"
PAGES = (("levels", "Levels"), ("mine", "My levels"), ("recordings", "Replays"))
SEARCH = "Type to search"


class Header:
    """The widgets above the cards; height [layout units]; section: the page that is shown."""

    def __init__(self, ui: Ui, app: Application, section: str, sheet: Any, query: str) -> None:
        self._ui, self._sheet = ui, sheet
        width = ui.units[0]
        self._is_wide = width >= ROOM_FOR_ONE_ROW
        self._sections: dict[str, Button] = {}
        title = "Edit a level" if app.mode == "edit" else "Spring Sandbox"
        ui.label(ui.rect(MARGIN, 20, 230, 36), title, sheet, "display")
        right = width - MARGIN
        right = self._buttons(app, right)
        second = 72.0
        if self._is_wide:
            left = MARGIN + 250
            pages = ui.rect(left, 24, PAGES_WIDTH, BUTTON)
            left = max(right - GAP - SEARCH_WIDTH, left + PAGES_WIDTH + 2 * GAP)
            search = ui.rect(left, 24, right - GAP - left, BUTTON)
            self.height = second + (34 if section == "levels" else 4)
        else:
            pages = ui.rect(MARGIN, second, PAGES_WIDTH, BUTTON)
            left = MARGIN + PAGES_WIDTH + GAP
            search = ui.rect(left, second, width - MARGIN - left, BUTTON)
            self.height = second + BUTTON + 10
        # Ctrl+L opens another page in each mode.
        page, action = ("mine", "recent") if app.mode == "edit" else ("recordings", "recordings")
        tips = {page: tip_of(action, app.mode)}
        choices = [(name, text, tips.get(name, "")) for name, text in PAGES]
        ui.choice(pages, choices, app.open_gallery, sheet).show(section)
        self.search: Field = ui.field(search, query, lambda _: True, sheet, 80, hint=SEARCH)

    def _buttons(self, app: Application, right: float) -> float:
        """New, Open file and Settings, up to the right; where they begin."""
        ui, sheet = self._ui, self._sheet
        documents = app.documents
        new = documents.new_place if app.mode == "edit" else documents.play_new
        buttons = [(58.0, "New", new), (94.0, "Open file", app.files.ask_to_open)]
        left = right - BUTTON - sum(width + GAP for width, _, _ in buttons)
        x = left
        for width, text, action in buttons:
            tip = NEW_TIP if text == "New" else tip_of("open_file" if app.mode == "edit" else "open", app.mode)
            ui.button(ui.rect(x, 24, width, BUTTON), text, action, sheet, tip=tip)
            x += width + GAP
        place = ui.rect(x, 24, BUTTON, BUTTON)
        ui.button(place, "", lambda: app.act("settings"), sheet, icon="settings", tip=tip_of("settings", app.mode))
        return left

    def show_sections(self, titles: Sequence[str], go: Callable[[str], None]) -> None:
        """Offer the sections, where there is room for them."""
        if not self._is_wide or len(titles) < 2:
            return
        ui, x = self._ui, MARGIN
        for title in titles:
            wide = ui.font(12).size(title)[0] / ui.scale + 22
            place = ui.rect(x, 70, wide, 26)
            self._sections[title] = ui.button(place, title, partial(go, title), self._sheet, style="chip")
            x += wide + 4

    def mark(self, title: str) -> None:
        """Mark the section that is seen."""
        for name, button in self._sections.items():
            button.is_selected = name == title
