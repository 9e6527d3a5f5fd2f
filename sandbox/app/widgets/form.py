"""Form: a scrolling page of sections of properties, a row each, that shows their values and takes new ones."""

from collections.abc import Sequence
from functools import partial

import pygame

from sandbox.app.widgets.boxes import FoldHeading
from sandbox.app.widgets.property_widgets import GAP, ROW, PropertyOwner, PropertyWidgets
from sandbox.app.widgets.scroll import ScrollArea
from sandbox.app.widgets.texts import TextBlock, wrapped
from sandbox.app.widgets.widget import Widget
from sandbox.editor.panel.property import Property, Section

# Sizes in layout units.
LABEL_WIDTH = 108.0
HEADING = 24.0
SECTION_GAP = 10.0
NOTE_LINES = 3
# Height of what it says without properties.
EMPTY = 120.0
NOTE_LINE = 15.0


class Form(PropertyWidgets):
    """Properties in a scrolled area, which is its owner's; the widgets are made again only when other fields are shown.

    above, below: what is left free there [layout units]. empty: what it says without properties.
    """

    def __init__(
        self, owner: PropertyOwner, area: ScrollArea, above: float = 0.0, below: float = 0.0, empty: str = ""
    ) -> None:
        super().__init__(owner, Widget(owner.ui, pygame.Rect(0, 0, 0, 0), area.content))
        self.area, self._above, self._below, self.empty = area, above, below, empty

    def say_if_empty(self, text: str) -> None:
        """Say something else without properties."""
        if text != self.empty:
            self.empty, self._structure = text, None

    def make_room(self, above: float) -> None:
        """Leave other room free above; what is shown next keeps it."""
        if above != self._above:
            self._above, self._structure = above, None

    @property
    def end(self) -> float:
        """The lower end of the form [layout units]."""
        return self._y + 8.0

    def _lines(self, each: Property) -> int:
        font = self._ui.font(11.0)
        return len(wrapped(each.texts[0], font, self._ui.px(self._inside - LABEL_WIDTH), NOTE_LINES))

    @property
    def _inside(self) -> float:
        return self.area.view.rect.width / self._ui.scale - 2.0

    def _lay_out(self, sections: Sequence[Section]) -> None:
        self._y = self._above
        if not sections and self.empty:
            place = self._ui.rect(0, self._y + 4, self._inside, EMPTY)
            TextBlock(self._ui, place, self.empty, self._holder, 12.5)
            self._y += EMPTY
        for number, section in enumerate(sections):
            self._y += SECTION_GAP if number else 0.0
            self._add_heading(section, is_first=number == 0)
            if not self.is_folded(section):
                for each in section.properties:
                    self._add(each)
        self._holder.resize((self.area.content.place.width, self._ui.px(self.end)))
        self.area.set_height(self._ui.px(self.end + self._below))

    def _add_heading(self, section: Section, is_first: bool) -> None:
        """Add the title of what is shown, or a heading that folds what is below it."""
        ui = self._ui
        if not is_first:
            fold, place = partial(self._fold, section), self._rect(0, self._inside, HEADING - 4)
            heading = FoldHeading(ui, place, section.title, self.is_folded(section), fold, self._holder)
            self._keep(heading, f"fold {section.title}")
            self._y += HEADING
            return
        # What several selected things are may take two lines.
        for line in wrapped(section.title, ui.font(15, True), ui.px(self._inside), 2) if section.title else ():
            ui.label(self._rect(0, self._inside, HEADING - 4), line, self._holder, "title")
            self._y += HEADING

    def _fold(self, section: Section) -> None:
        """Fold a section away, or open it; its owner goes on so."""
        self._ui.blur()
        self._owner.folds[section.title] = not self.is_folded(section)
        self.show(self._sections)
        self._ui.focus_on(self._named[f"fold {section.title}"])

    def _add(self, each: Property) -> None:
        """Make a row: a title, and beside it what shows the value or takes another."""
        ui, width = self._ui, self._inside - LABEL_WIDTH
        self._add_label(each, self._rect(0, LABEL_WIDTH - 4))
        if each.remove is not None:
            width -= ROW + GAP
            place, tip = self._rect(self._inside - ROW, ROW), f"Take {each.about.title} away"
            remove = partial(self._remove, each.field)
            button = ui.button(place, "\u00d7", remove, self._holder, style="segment", tip=tip)
            self.removers[each.field] = self._keep(button, f"{each.field} remove")
        if not each.editable:
            height = max(ROW - 8, self._lines(each) * NOTE_LINE + 2)
            self._notes[each.field] = TextBlock(
                ui, ui.rect(LABEL_WIDTH, self._y + 7, width, height), "", self._holder, 11.5
            )
            self._y += max(ROW, height + 8)
            return
        self._make(each, LABEL_WIDTH, width)
        if each.slides:
            self._y += ROW
            self._add_slider(each, self._rect(-4, self._inside + 8))
        self._y += ROW + GAP
