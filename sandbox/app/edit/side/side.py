"""Side: the panel at the right of the editor, a page at a time."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pygame

from sandbox.app.contracts.application import Editing
from sandbox.app.edit.side.catalogue import CataloguePage
from sandbox.app.edit.side.checks import ChecksPage
from sandbox.app.edit.side.materials import MaterialsPage
from sandbox.app.edit.side.objects import FindingsPage, HistoryPage, ObjectsPage
from sandbox.app.edit.side.properties import PropertiesPage, SettingsPage
from sandbox.app.edit.side.range_page import RangePage
from sandbox.app.edit.side.rules import RulesPage
from sandbox.app.edit.side.side_page import SidePage
from sandbox.app.widgets.button import Button
from sandbox.app.widgets.ui import Ui

# Sizes in layout units.
MARGIN = 14.0
GAP = 4.0
# Height of a tab and room above and below them; a panel that is lower than this has less.
LOW = 400.0
TAB, TOP, BELOW = 26.0, 10.0, 8.0
LOW_TAB, LOW_TOP, LOW_BELOW = 22.0, 4.0, 4.0


PAGES: dict[str, tuple[str, str, Callable[[Editing, pygame.Rect, Any], SidePage]]] = {
    "properties": ("Properties", "What is selected", PropertiesPage),
    "objects": ("Objects", "Everything in the level: find, hide, lock, rename, reorder", ObjectsPage),
    "materials": ("Materials", "Cs, Cd and looks of the materials", MaterialsPage),
    "parts": ("Parts", "Ready parts and your own, to put on the sheet", CataloguePage),
    "level": ("Level", "Name, author, view, time and solver", SettingsPage),
    "checks": ("Checks", "What must be true when the level runs", ChecksPage),
    "rules": ("Rules", "Goals, scores and what happens when: what the level asks and does", RulesPage),
    "history": ("History", "All steps; click one to go back to it", HistoryPage),
    "findings": ("Findings", "Problems that you may have overlooked", FindingsPage),
}
# Pages without a tab: an action shows them.
UNLISTED: dict[str, Callable[[Editing, pygame.Rect, Any], SidePage]] = {"range": RangePage}
COLUMNS = 3


class Side:
    """The panel in a place [pixels]; `tab` is the page that is shown."""

    def __init__(self, ui: Ui, screen: Editing, place: pygame.Rect, tab: str) -> None:
        self._ui, self._screen, self.tab = ui, screen, tab
        self.back = ui.panel(place)
        names = list(PAGES)
        width = place.width / ui.scale - 2 * MARGIN
        is_low = place.height < ui.px(LOW)
        tall, top, below = (LOW_TAB, LOW_TOP, LOW_BELOW) if is_low else (TAB, TOP, BELOW)
        self._rows = []
        for first in range(0, len(names), COLUMNS):
            options = [(name, PAGES[name][0], PAGES[name][1]) for name in names[first : first + COLUMNS]]
            self._rows.append(ui.choice(ui.rect(MARGIN, top, width, tall), options, self._choose_tab, self.back))
            top += tall + GAP
        top += below
        self._place = ui.rect(MARGIN, top, width + 6, place.height / ui.scale - top - 6)
        self.page: SidePage = self._made()

    def _choose_tab(self, tab: str) -> None:
        """Show a page that was clicked; Enter takes the part that is marked on that of parts."""
        self.choose(tab)
        if tab == "parts":
            self.focus()

    def choose(self, tab: str) -> None:
        """Show another page."""
        if tab != self.tab:
            if self.tab in UNLISTED:
                # What it shows on the sheet goes with it.
                self._screen.watch.range_trial = None
            self._drop_page()
            self.tab = tab
            self.page = self._made()

    def turn_page(self, by: int) -> None:
        """Show the page that many tabs further, and give its tab the keyboard."""
        names = list(PAGES)
        here = names.index(self.tab) if self.tab in names else 0
        self.choose(names[(here + by) % len(names)])
        self._ui.focus_on(self._tab_button(self.tab))

    def focus(self, path: Path | None = None) -> None:
        """Give the page of parts the keyboard, and show the part of a file on it; that of objects its search."""
        if isinstance(self.page, CataloguePage):
            self.page.focus(path)
        elif isinstance(self.page, ObjectsPage):
            self._ui.focus_on(self.page.search)

    def ask_name(self) -> None:
        """Ask for another name of what is selected, on the page of objects."""
        if isinstance(self.page, ObjectsPage):
            self.page.ask_name()

    def _tab_button(self, tab: str) -> Button:
        return next(row.buttons[tab] for row in self._rows if tab in row.buttons)

    def _made(self) -> SidePage:
        for row in self._rows:
            row.show(self.tab if self.tab in row.buttons else "")
        make = UNLISTED[self.tab] if self.tab in UNLISTED else PAGES[self.tab][2]
        self._holder = self._ui.area(self._place, self.back)
        page = make(self._screen, pygame.Rect((0, 0), self._place.size), self._holder)
        selection, chosen = self._screen.chosen_on_pages.get(self.tab, (frozenset(), None))
        if chosen is not None and (not page.follows_selection or selection == self._screen.document.selection):
            page.chosen = chosen
        page.refresh()
        return page

    def _drop_page(self) -> None:
        if self._ui.typing:
            # What is being typed counts.
            self._ui.blur()
        if self.page.chosen is not None:
            self._screen.chosen_on_pages[self.tab] = self._screen.document.selection, self.page.chosen
        self.page.close()
        self._holder.remove()

    def refresh(self) -> None:
        """Show the document as it is now."""
        self.page.refresh()
        self._count_findings()

    @property
    def moves(self) -> bool:
        """Whether pictures of parts are still to come."""
        return isinstance(self.page, CataloguePage) and self.page.moves

    def _count_findings(self) -> None:
        count = len(self._screen.watch.findings)
        button = self._tab_button("findings")
        button.show_text(f"Findings {count}" if count else "Findings")

    def close(self) -> None:
        """Take the text that is being typed, and remove the panel."""
        self._drop_page()
        self.back.remove()
