"""PartPage: the catalogue while a level is played: a part that is chosen is in hand, to be dropped and thrown."""

from collections.abc import Callable, Iterator

from sandbox.app.base.sentences import sentence
from sandbox.app.base.shortcuts import hint
from sandbox.app.base.slice_queue import SliceQueue
from sandbox.app.contracts.screen import Pixel
from sandbox.app.draw.colours import MUTED, TEXT, WARNING, Colour
from sandbox.app.parts.part_card import PartCard, card_places, fill_card
from sandbox.app.widgets.dialogs import MARGIN, Dialog
from sandbox.app.widgets.scroll import BAR_WIDTH, ScrollArea
from sandbox.app.widgets.texts import TextBlock
from sandbox.app.widgets.ui import Ui
from sandbox.editor.document import EditError
from sandbox.editor.edits.joining import joining_commands
from sandbox.editor.storage.part_files import PartFile, catalogue
from sandbox.level.assembly.level_world import LevelWorld
from sandbox.level.document.model import Level

# Sizes in layout units.
WIDTH, HEIGHT = 690.0, 620.0
GAP = 10.0
# Cards are this wide at least; on a page that is lower than this they are smaller.
LEAST_CARD, LEAST_OF_LOW, LOW = 130.0, 82.0, 420.0
TOP, BOTTOM = 56.0, 66.0
HEADING, LINE = 28.0, 22.0
# Wall time [s] of a frame that cards are filled in.
FILL_BUDGET = 0.008
NOTHING_OWN = "Select something in the editor and press Ctrl+K. It then appears here as a part."
HINT = "Click a part, then click to drop it, or drag to throw it."


Take = Callable[[Level, bool], object]


class PartPage:
    """A modal page; what cannot join the world is pale, and says why where it is pointed at.

    take: called with the part that is chosen, and whether by a key. reopen: opens the page again, scrolled to an offset
    [pixels]. last_taken: the part that Enter takes; else the first one that can be had.
    """

    def __init__(
        self, ui: Ui, world: LevelWorld, take: Take, reopen: Callable[[float], object], offset: float = 0.0,
        last_taken: Level | None = None,
    ) -> None:  # fmt: skip
        self._ui, self._world, self._take = ui, world, take
        dialog = Dialog(ui, "Parts", WIDTH, HEIGHT, lambda _: reopen(self.area.offset), is_page=True)
        self.sheet, box, height = dialog.sheet, dialog.box, dialog.height
        self._width = dialog.inside - BAR_WIDTH
        least = LEAST_CARD if height >= LOW else LEAST_OF_LOW
        self._columns = max(2, int((self._width + GAP) // (least + GAP)))
        self.area = ScrollArea(ui, dialog.place(TOP, height - TOP - BOTTOM), box)
        self.cards: list[PartCard] = []
        self._unfilled = SliceQueue()
        found = catalogue()
        sections = [("Your own", [part for part in found if part.is_own])]
        # What can be had at once comes first.
        sections.insert(bool(sections[0][1]), ("Ready", [part for part in found if not part.is_own]))
        y = -GAP
        for title, parts in sections:
            y = self._add_section(title, parts, y + GAP)
        self.area.set_height(ui.px(y))
        self.area.scroll_to(offset)
        self._note = TextBlock(ui, ui.rect(MARGIN, height - BOTTOM + 12, self._width - 110, BOTTOM - 18), "", box, 12.0)
        dialog.add_buttons(("Close", dialog.end))
        possible = (card for card in self.cards if not refusal(card.part, world))
        last = (card for card in self.cards if last_taken is not None and card.part.level is last_taken)
        ui.focus_on(next(last, None) or next(possible, self.cards[0]))

    def _add_section(self, title: str, parts: list[PartFile], y: float) -> float:
        """Make cards under a heading from a place [layout units] on; gives their end."""
        ui, content = self._ui, self.area.content
        TextBlock(ui, ui.rect(3, y, self._width, HEADING), title, content, 14.0, TEXT, is_bold=True)
        y += HEADING
        if not parts:
            TextBlock(ui, ui.rect(3, y, self._width, LINE), NOTHING_OWN, content, 12.0)
            return y + LINE
        places, end = card_places(ui, len(parts), self._columns, self._width, y, GAP)
        for place, part in zip(places, parts, strict=True):
            card = PartCard(ui, place, part, self, content, self._columns)
            self.cards.append(card)
            self._unfilled.add(self._fill(card))
        return end

    def _fill(self, card: PartCard) -> Iterator[bool]:
        yield True
        card.refusal = refusal(card.part, self._world)
        yield from fill_card(card)

    # A frame.

    @property
    def moves(self) -> bool:
        """Whether cards are still filled in."""
        return self.sheet.is_there and len(self._unfilled) > 0

    def update(self) -> None:
        """Go on filling cards, and say what is pointed at."""
        if not self.sheet.is_there:
            return
        self._unfilled.go_on(FILL_BUDGET)
        hovered = (card for card in self.cards if card.hovered)
        focused = (card for card in self.cards if self._ui.focus is card)
        card = next(hovered, None) or next(focused, None)
        text, colour = (HINT, MUTED) if card is None else _said_of(card)
        if (text, colour) != (self._note.text, self._note.colour):
            self._note.colour = colour
            self._note.show_text(text)

    # What the cards ask.

    def take(self, part: PartFile, by_key: bool) -> None:
        """Have a part in hand, and close the page; not where it cannot join."""
        if part.level is not None and not refusal(part, self._world):
            self.sheet.remove()
            self._take(part.level, by_key)

    def carry(self, pixel: Pixel) -> None:
        """Do nothing: no part is dragged off this page."""

    def drop(self, pixel: Pixel) -> None:
        """Do nothing: no part is dragged off this page."""


def refusal(part: PartFile, world: LevelWorld) -> str:
    """Why a part cannot join a world, in one line; empty where it can."""
    if part.level is None:
        return part.fault
    try:
        joining_commands(part.level, world, (0.0, 0.0))
    except EditError as error:
        return sentence(error)
    return ""


def _said_of(card: PartCard) -> tuple[str, Colour]:
    """The line about a part, and its colour."""
    level = card.part.level
    if card.refusal or level is None:
        return card.refusal or card.part.fault, WARNING
    return f"{card.part.name}. {hint(level.description) or HINT}", MUTED
