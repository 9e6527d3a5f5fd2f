"""The catalogue of parts: its page while a level is played, and cards with pictures; a click takes a part up."""

from collections.abc import Callable, Iterator
from typing import Any, Protocol

import pygame

from sandbox.app.base.loop import SliceQueue
from sandbox.app.base.sentences import sentence
from sandbox.app.base.shortcuts import hint
from sandbox.app.contracts.screen import Pixel
from sandbox.app.draw.colours import (
    ACCENT,
    BACKGROUND,
    DANGER,
    LINE,
    MUTED,
    SURFACE,
    TEXT,
    WARNING,
    Colour,
    mixed,
    shown_theme,
)
from sandbox.app.draw.picture_cache import draw_in_slices, find_picture, keep_for_later, kept_picture
from sandbox.app.draw.picture_cache import picture_key as key_of_level
from sandbox.app.widgets.dialogs import MARGIN, Dialog
from sandbox.app.widgets.scroll import BAR_WIDTH, ScrollArea
from sandbox.app.widgets.styles import put_rim
from sandbox.app.widgets.texts import TextBlock, wrapped
from sandbox.app.widgets.ui import Ui
from sandbox.app.widgets.widget import ENTER_KEYS, Widget
from sandbox.editor.document import EditError
from sandbox.editor.edits.joining import joining_commands
from sandbox.editor.storage.level_file import PartFile, catalogue
from sandbox.level.assembly.build_world import LevelWorld
from sandbox.level.document.model import Level
from sandbox.level.format.level_error import LevelError
from sandbox.level.reading.files import read_bytes
from sandbox.physics import jit

# Sizes in layout units.
WIDTH, HEIGHT = 690.0, 620.0
GAP = 10.0
# Cards are this wide at least; on a page that is lower than this they are smaller.
LEAST_CARD, LEAST_OF_LOW, LOW = 130.0, 82.0, 420.0
TOP, BOTTOM = 56.0, 66.0
HEADING, _LINE_HEIGHT = 28.0, 22.0
# Wall time [s] of a frame that cards are filled in.
FILL_BUDGET = 0.008
NOTHING_OWN = "Select something in the editor and press Ctrl+K. It then appears here as a part."
HINT = "Click a part, then click to drop it, or drag to throw it."


Take = Callable[[Level, bool], object]

# Sizes in layout units.
PICTURE_RATIO = 9 / 16
NAME_HEIGHT = 24.0
CORNER = 7.0
TEXT_SIZE, FAULT_SIZE = 12.0, 10.5
FAULT_LINES = 4
# A narrower card has smaller letters.
ROOM_FOR_NAME, SMALL_TEXT = 100.0, 11.0
# How much of the picture is veiled of a part that cannot be had here, of 255.
VEIL = 165
# How much of the accent the ground of a part that is taken has.
TAKEN = 0.3
# Arrow keys: cards to the right, and rows down.
STEPS = {pygame.K_LEFT: (-1, 0), pygame.K_RIGHT: (1, 0), pygame.K_UP: (0, -1), pygame.K_DOWN: (0, 1)}


class DropTarget(Protocol):
    """The screen that a part is dragged to from its card; cards: all of them, in their order."""

    cards: "list[PartCard]"

    def take(self, part: PartFile, by_key: bool) -> None:
        """Take the part up; by_key: whether a key did it."""
        ...

    def carry(self, pixel: Pixel) -> None:
        """Show the part at a pixel while the button is held."""
        ...

    def drop(self, pixel: Pixel) -> None:
        """Drop the part at a pixel."""
        ...


class PartCard(Widget):
    """One part; it shows its name once `is_read` is set, and a frame while it `is_taken`; columns: of such cards.

    refusal: why it cannot be had here; then it is pale.
    """

    is_focusable = is_lit = True

    def __init__(
        self, ui: Ui, rect: pygame.Rect, part: PartFile, target: DropTarget, container: Any, columns: int
    ) -> None:
        super().__init__(ui, rect, container)
        self.part, self._target, self._columns = part, target, columns
        self.picture: pygame.Surface | None = None
        self.is_read = self.is_taken = False
        self.refusal = ""

    @property
    def picture_size(self) -> tuple[int, int]:
        """Size of the place for a picture [pixels]."""
        return self.rect.width - 2, self.rect.height - self.ui.px(NAME_HEIGHT)

    def show(self, picture: pygame.Surface | None = None) -> None:
        """Show the name, and a picture of the size that there is for it."""
        self.is_read, self.picture = True, picture or self.picture
        self.repaint()

    def mark(self, is_taken: bool) -> None:
        """Show whether the part is in hand."""
        if is_taken != self.is_taken:
            self.is_taken = is_taken
            self.repaint()

    def paint(self, size: tuple[int, int]) -> pygame.Surface:
        """Picture and name, or what is wrong with the file."""
        ui, corner = self.ui, self.ui.px(CORNER)
        card = pygame.Surface(size, pygame.SRCALPHA)
        # What is taken is filled; the keyboard and the mouse light the rim alone.
        ground = mixed(SURFACE, ACCENT, TAKEN) if self.is_taken else SURFACE
        pygame.draw.rect(card, ground, card.get_rect(), border_radius=corner)
        place = pygame.Rect(1, 1, *self.picture_size)
        pygame.draw.rect(card, BACKGROUND, place, border_top_left_radius=corner, border_top_right_radius=corner)
        is_broken = self.is_read and self.part.level is None
        if self.picture is not None:
            card.blit(self.picture, self.picture.get_rect(center=place.center))
            if self.refusal:
                veil = pygame.Surface(place.size)
                veil.fill(BACKGROUND)
                veil.set_alpha(VEIL)
                card.blit(veil, place)
        elif is_broken:
            self._paint_fault(card, place)
        if self.is_read:
            font = ui.font(TEXT_SIZE if size[0] >= ui.px(ROOM_FOR_NAME) else SMALL_TEXT, self.is_taken)
            name = wrapped(self.part.name, font, size[0] - ui.px(12), 1)[0]
            text = font.render(name, True, DANGER if is_broken else MUTED if self.refusal else TEXT)
            middle = place.bottom + (size[1] - place.bottom) // 2
            card.blit(text, text.get_rect(midleft=(ui.px(8), middle)))
        is_lit = self.is_taken or self.hovered or self.focused
        rim, width = (ACCENT, 2.0 if self.is_taken else 1.2) if is_lit else (LINE, 1.2)
        put_rim(card, rim, max(1, ui.px(width)), corner)
        return card

    def _paint_fault(self, card: pygame.Surface, place: pygame.Rect) -> None:
        font, y = self.ui.font(FAULT_SIZE), place.top + self.ui.px(5)
        for line in wrapped(self.part.fault, font, place.width - self.ui.px(14), FAULT_LINES):
            card.blit(font.render(line, True, DANGER), (place.left + self.ui.px(7), y))
            y += font.get_linesize()

    def press_key(self, event: pygame.event.Event) -> bool:
        """Take the part in hand by a key, or go to another card."""
        if event.key in (*ENTER_KEYS, pygame.K_SPACE):
            self._target.take(self.part, by_key=True)
            return True
        if event.key in STEPS:
            (across, down), cards = STEPS[event.key], self._target.cards
            index = cards.index(self) + across + down * self._columns
            if 0 <= index < len(cards):
                self.ui.focus_on(cards[index])
            return True
        return False

    def on_press(self, at: Pixel, clicks: int) -> bool:
        """Take the part in hand."""
        self._target.take(self.part, by_key=False)
        return True

    def on_drag(self, at: Pixel) -> None:
        """Carry the part."""
        self._target.carry(at)

    def on_release(self, at: Pixel) -> None:
        """Drop the part."""
        self._target.drop(at)


def card_places(ui: Ui, count: int, columns: int, wide: float, y: float, gap: float) -> tuple[list[pygame.Rect], float]:
    """Where this many cards lie [pixels] in a room so wide, from y on, and where they end [layout units]."""
    width = (wide - 6 - gap * (columns - 1)) / columns
    height = width * PICTURE_RATIO + NAME_HEIGHT
    cells = (divmod(index, columns) for index in range(count))
    places = [ui.rect(3 + across * (width + gap), y + row * (height + gap), width, height) for row, across in cells]
    return places, y + -(-count // columns) * (height + gap)


def fill_card(card: PartCard) -> Iterator[bool]:
    """Read a card's part and draw its picture, a slice at each turn."""
    level, theme = card.part.level, shown_theme()
    card.show()
    yield True
    if level is None:
        return
    try:
        # A level of the same content is drawn after it has moved, and kept by another key.
        key = key_of_level(b"part " + read_bytes(card.part.path))
    except LevelError:
        return
    picture = find_picture(card.part.path, key, card.picture_size, theme)
    if picture is not None:
        card.show(picture)
        return
    picture = yield from draw_in_slices(level, theme, 0.0)
    card.show(pygame.transform.smoothscale(picture, card.picture_size))
    if jit.COMPILED:
        keep_for_later(picture, kept_picture(key, theme))


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
            TextBlock(ui, ui.rect(3, y, self._width, _LINE_HEIGHT), NOTHING_OWN, content, 12.0)
            return y + _LINE_HEIGHT
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
        """Go on filling cards, and describe the one under the pointer."""
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
        """Take a part in hand, and close the page; not where it cannot join."""
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
