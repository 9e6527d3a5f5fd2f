"""PartCard: a part of the catalogue with its picture; a click takes it up, a drag carries it to the sheet."""

from collections.abc import Iterator
from contextlib import suppress
from typing import Any, Protocol

import pygame

from sandbox.app.contracts.screen import Pixel
from sandbox.app.draw.colours import ACCENT, BACKGROUND, DANGER, LINE, MUTED, SURFACE, TEXT, mixed, shown_theme
from sandbox.app.draw.picture_cache import draw_in_slices, find_picture, forget_old_pictures, keep_picture, kept_picture
from sandbox.app.draw.picture_cache import picture_key as key_of_level
from sandbox.app.widgets.texts import wrapped
from sandbox.app.widgets.ui import Ui
from sandbox.app.widgets.widget import ENTER_KEYS, Widget
from sandbox.editor.storage.part_files import PartFile
from sandbox.level.format.level_error import LevelError
from sandbox.level.reading.files import read_bytes
from sandbox.physics import jit

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


class Hands(Protocol):
    """What takes a part from its card; cards: all of them, in their order."""

    cards: "list[PartCard]"

    def take(self, part: PartFile, by_key: bool) -> None:
        """Take the part up; by_key: whether a key did it."""
        ...

    def carry(self, pixel: Pixel) -> None:
        """Show the part at a pixel while the button is held."""
        ...

    def drop(self, pixel: Pixel) -> None:
        """Let the part go at a pixel."""
        ...


class PartCard(Widget):
    """One part; it shows its name once `is_read` is set, and a frame while it `is_taken`; columns: of such cards.

    refusal: why it cannot be had here; then it is pale.
    """

    is_focusable = is_lit = True

    def __init__(self, ui: Ui, rect: pygame.Rect, part: PartFile, hands: Hands, container: Any, columns: int) -> None:
        super().__init__(ui, rect, container)
        self.part, self._hands, self._columns = part, hands, columns
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
        """Show whether it is in hand."""
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
        pygame.draw.rect(card, rim, card.get_rect(), max(1, ui.px(width)), border_radius=corner)
        # Pictures have corners of their own.
        mask = pygame.Surface(size, pygame.SRCALPHA)
        pygame.draw.rect(mask, (255, 255, 255), mask.get_rect(), border_radius=corner)
        card.blit(mask, (0, 0), special_flags=pygame.BLEND_RGBA_MIN)
        return card

    def _paint_fault(self, card: pygame.Surface, place: pygame.Rect) -> None:
        font, y = self.ui.font(FAULT_SIZE), place.top + self.ui.px(5)
        for line in wrapped(self.part.fault, font, place.width - self.ui.px(14), FAULT_LINES):
            card.blit(font.render(line, True, DANGER), (place.left + self.ui.px(7), y))
            y += font.get_linesize()

    def press_key(self, event: pygame.event.Event) -> bool:
        """Take it up by a key, or go to another card."""
        if event.key in (*ENTER_KEYS, pygame.K_SPACE):
            self._hands.take(self.part, by_key=True)
            return True
        if event.key in STEPS:
            (across, down), cards = STEPS[event.key], self._hands.cards
            index = cards.index(self) + across + down * self._columns
            if 0 <= index < len(cards):
                self.ui.focus_on(cards[index])
            return True
        return False

    def on_press(self, at: Pixel, clicks: int) -> bool:
        """Take it up by the mouse."""
        self._hands.take(self.part, by_key=False)
        return True

    def on_drag(self, at: Pixel) -> None:
        """Carry it."""
        self._hands.carry(at)

    def on_release(self, at: Pixel) -> None:
        """Let it go."""
        self._hands.drop(at)


def card_places(ui: Ui, count: int, columns: int, room: float, y: float, gap: float) -> tuple[list[pygame.Rect], float]:
    """Where this many cards lie [pixels] in a room so wide, from y on, and where they end [layout units]."""
    width = (room - 6 - gap * (columns - 1)) / columns
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
        with suppress(OSError):
            keep_picture(picture, kept_picture(key, theme))
            forget_old_pictures(kept_picture(key, theme).parent)
