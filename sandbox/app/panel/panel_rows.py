"""What the panel beside a run is made of: rows, properties in them, sections that fold, and what screens ask of it."""

import re
from collections.abc import Callable, Sequence, Set
from dataclasses import dataclass
from itertools import groupby
from typing import Any, Protocol

import pygame

from sandbox.app.base.shortcuts import hint
from sandbox.app.contracts.application import RunPanel
from sandbox.app.panel.coefficient_pad import CoefficientPad
from sandbox.app.run.playback import Playback
from sandbox.app.widgets.boxes import HEADING_SIZE, FoldHeading
from sandbox.app.widgets.property_widgets import PropertyOwner, PropertyWidgets
from sandbox.app.widgets.slider import SliderState
from sandbox.app.widgets.styles import LABELS
from sandbox.app.widgets.ui import Ui
from sandbox.editor.panel.property import Property, Section

# Sizes in layout units.
PANEL_WIDTH = 292.0
MARGIN = 18.0
INSIDE = PANEL_WIDTH - 2 * MARGIN
TOP = 14.0
ROW = 28.0
ENTRY_WIDTH = 82.0
# A number with its slider, and its title.
SLIDING, NAME_WIDTH = 62.0, 92.0
GAP = 12.0
# Of a heading's row, what is beside its words; the rest is free for what belongs there.
HEADING_ROOM = 34.0
# Of a choice, what its title takes that is beside it, and a button beside its words.
BESIDE, BUTTON_ROOM = 46.0, 14.0
# Narrower windows begin without a panel at their side.
ROOM_FOR_PANEL = 800.0


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
        """A place at a distance below the top of the next row."""
        return self.ui.rect(x, self.y + below, width, height)

    def form(
        self, owner: PropertyOwner, sections: Sequence[Section],
        slider_state: Callable[[Property], SliderState] | None = None,
    ) -> "PanelForm":  # fmt: skip
        """Properties in the next rows, which stay the same ones; slider_state: what their sliders show."""
        made = PanelForm(owner, self)
        made._slider_state = slider_state or made._slider_state
        made.show(sections)
        return made

    def aside(self, row: int) -> pygame.Rect:
        """The place between title and value of one of the next numbers that slide."""
        width = INSIDE - NAME_WIDTH - ENTRY_WIDTH - 12
        return self.place(MARGIN + NAME_WIDTH + 4, 6 + row * SLIDING, width, ROW - 8)

    def section(self, title: str, is_open: bool, toggle: Callable[[], None], build: Callable[[], None]) -> None:
        """Add a heading, and what `build` makes under it, which is seen where the section is open."""
        width = self.ui.font(HEADING_SIZE, True).size(title.upper())[0] / self.ui.scale + HEADING_ROOM
        FoldHeading(self.ui, self.row(18, 8, width=width), title, not is_open, toggle, self.back)
        if is_open:
            build()
        else:
            self.unseen(build)

    def unseen(self, build: Callable[[], None]) -> None:
        """Let `build` make rows that are not seen, and take no room."""
        before, y = len(self.back.children), self.y
        build()
        for element in self.back.children[before:]:
            element.visible = False
        self.y = y


class PanelForm(PropertyWidgets):
    """Properties in rows of a panel: numbers side by side below their titles, choices beside theirs or below them.

    A number that slides has a row of its own, at the right of its title, and the slider below.
    """

    def __init__(self, owner: PropertyOwner, rows: PanelRows) -> None:
        super().__init__(owner, rows.back)
        self._place = rows

    def close(self) -> None:
        """Do nothing: the rows go with the panel."""

    def _lay_out(self, sections: Sequence[Section]) -> None:
        self._y = self._place.y
        for section in sections:
            if section.title:
                self._ui.label(self._rect(MARGIN, INSIDE, 16), section.title, self._holder)
                self._y += 18
            for is_alone, group in groupby(section.properties, lambda each: each.slides or each.about.kind == "choice"):
                if not is_alone:
                    self._add_beside(list(group))
                    continue
                for each in group:
                    (self._add_sliding if each.slides else self._add_row)(each)
        self._place.y = self._y

    def _add_row(self, each: Property) -> None:
        """Add a choice, beside its title where there is room for that."""
        about, font = each.about, self._ui.font(LABELS["muted"].size)
        widest = max(font.size(label)[0] for label in about.labels or about.choices) / self._ui.scale
        is_beside = len(about.choices) * (widest + BUTTON_ROOM) <= INSIDE - BESIDE
        self._add_label(each, self._rect(MARGIN, INSIDE, ROW - 2 if is_beside else 18))
        self._y += 0 if is_beside else 20
        self._tall = ROW - 2
        self._make(each, MARGIN + BESIDE if is_beside else MARGIN, INSIDE - BESIDE if is_beside else INSIDE)
        self._y += ROW + 5

    def _add_sliding(self, each: Property) -> None:
        self._tall = ROW
        self._add_label(each, self._rect(MARGIN, NAME_WIDTH))
        self._make(each, MARGIN + INSIDE - ENTRY_WIDTH, ENTRY_WIDTH)
        self._y += ROW + 4
        self._add_slider(each, self._rect(MARGIN - 8, INSIDE + 16))
        self._y += SLIDING - ROW - 4

    def _add_beside(self, group: Sequence[Property]) -> None:
        width = (INSIDE - GAP * (len(group) - 1)) / len(group)
        places = [MARGIN + number * (width + GAP) for number in range(len(group))]
        for each, x in zip(group, places, strict=True):
            self._add_label(each, self._rect(x, width, 18))
        self._y += 19
        self._tall = ROW
        for each, x in zip(group, places, strict=True):
            self._make(each, x, width)
        self._y += ROW + 6


class SectionRows(Protocol):
    """The rows of a section; playback: the run that they show and change."""

    playback: Playback

    def build(self, rows: PanelRows) -> None:
        """Make the widgets, one row below the other."""
        ...

    def refresh(self, is_look: bool) -> None:
        """Show what the world has now, once a frame. is_look: what takes long is looked at, too."""
        ...


@dataclass(frozen=True)
class PanelSection:
    """A section: its heading, and what makes its rows for a panel.

    words: what a level's hint asks for it by, beside its heading.
    """

    title: str
    make: Callable[[RunPanel], SectionRows]
    words: tuple[str, ...] = ()

    def is_asked_for(self, description: str) -> bool:
        """Whether a level's description speaks of what is in it."""
        said = hint(description)
        return any(re.search(rf"\b{re.escape(word)}\b", said) for word in (self.title, *self.words))


class SidePanel(Protocol):
    """A panel beside a run."""

    playback: Playback
    material: int | None
    pad: CoefficientPad | None

    def refresh(self) -> None:
        """Show the world's present values."""
        ...

    def show_choices(self, strength: str, views: Set[str]) -> None:
        """Show the strength of the hand, and which overlays are seen."""
        ...

    def choose_material(self, material: int | None) -> None:
        """Show and change the springs of a material (index); None = all."""
        ...

    def attach(self, playback: Playback) -> None:
        """Show and change another run of the same level."""
        ...
