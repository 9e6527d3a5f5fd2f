"""Picker: a value that a menu of rows changes; and menus that open over the window."""

from collections.abc import Callable, Sequence
from typing import Any

import pygame

from sandbox.app.draw.colours import FIELD, LINE, MENU, MUTED, TEXT, mixed
from sandbox.app.widgets.rows import LINE_HEIGHT, PADDING, SWATCH, TEXT_SIZE, Row, RowList
from sandbox.app.widgets.styles import BoxLook, box
from sandbox.app.widgets.texts import wrapped
from sandbox.app.widgets.ui import Ui
from sandbox.app.widgets.widget import Pressable

# A menu is no higher than so many rows.
MENU_ROWS = 12


class Picker(Pressable):
    """A value that a menu of rows changes: opens below it, by a click, Enter, Space or an arrow key."""

    is_lit = True

    ui: Ui

    press_keys = (*Pressable.press_keys, pygame.K_DOWN)

    def __init__(self, ui: Ui, rect: pygame.Rect, choose: Callable[[int], object], container: Any = None) -> None:
        super().__init__(ui, rect, container)
        self.rows: Sequence[Row] = ()
        self.shown = Row("")
        self._choose = choose
        self._menu: RowList | None = None

    def show_value(self, rows: Sequence[Row], shown: Row) -> None:
        """Offer rows, and show one row as the value, which need not be among them."""
        if (rows, shown) != (self.rows, self.shown):
            self.rows, self.shown = rows, shown
            self.repaint()

    def paint(self, size: tuple[int, int]) -> pygame.Surface:
        """The value and a chevron."""
        ui = self.ui
        surface = self.paint_box(size)
        left = ui.px(8)
        if self.shown.swatch is not None:
            swatch = ui.px(SWATCH)
            at = pygame.Rect(left, (size[1] - swatch) // 2, swatch, swatch)
            pygame.draw.rect(surface, self.shown.swatch, at, border_radius=ui.px(3))
            left += swatch + ui.px(7)
        text = wrapped(self.shown.text, ui.font(TEXT_SIZE), size[0] - left - ui.px(24), 1)[0]
        picture = ui.font(TEXT_SIZE).render(text, True, self.shown.colour)
        surface.blit(picture, (left, (size[1] - picture.get_height()) // 2))
        self.paint_chevron(surface)
        return surface

    def paint_box(self, size: tuple[int, int]) -> pygame.Surface:
        """The box behind the value and the chevron."""
        back = mixed(FIELD, TEXT, 0.06) if self.hovered and self.rows else FIELD
        return box(size, BoxLook(back, LINE, TEXT), self.ui.px(6), 1).copy()

    def paint_chevron(self, surface: pygame.Surface) -> None:
        """Show at the right that there is a menu."""
        (wide, tall), half = surface.get_size(), self.ui.px(4)
        x, y = wide - self.ui.px(14), tall // 2
        chevron = [(x - half, y - half // 2), (x, y + half // 2), (x + half, y - half // 2)]
        pygame.draw.lines(surface, MUTED, False, chevron, 2)

    def press(self) -> None:
        """Offer the rows."""
        chosen = next((index for index, row in enumerate(self.rows) if row.text == self.shown.text), None)

        def take(index: int) -> None:
            self.ui.focus_on(self)
            self._choose(index)

        self._menu = open_menu(self.ui, self.rect, self.rows, chosen, take)

    @property
    def pointed(self) -> Row | None:
        """The row under the mouse in the menu, or while that is closed the value under it; None: neither is."""
        if self._menu is not None and self._menu.is_there:
            return None if self._menu.pointed is None else self.rows[self._menu.pointed]
        return self.shown if self.hovered else None


class WordPicker(Picker):
    """A picker among words; take(word) is called with the one that is chosen."""

    def __init__(
        self, ui: Ui, rect: pygame.Rect, words: Sequence[str], chosen: str, take: Callable[[str], object],
        container: Any = None,
    ) -> None:  # fmt: skip
        super().__init__(ui, rect, lambda index: take(self.words[index]), container)
        self.offer(words, chosen)

    @property
    def words(self) -> list[str]:
        """The words to choose from."""
        return [row.text for row in self.rows]

    @property
    def chosen(self) -> str:
        """The chosen word."""
        return self.shown.text

    def offer(self, words: Sequence[str], chosen: str) -> None:
        """Show other words to choose from, one of them chosen."""
        self.show_value([Row(word) for word in words], Row(chosen))

    def show_chosen(self, word: str) -> None:
        """Show another of the words."""
        self.show_value(self.rows, Row(word))


def open_menu(
    ui: Ui, below: pygame.Rect, rows: Sequence[Row], chosen: int | None, take: Callable[[int], object]
) -> RowList:
    """Open a menu of rows below a place [pixels], or above it; Escape or a click beside end it."""
    height = _menu_height(ui, rows[:MENU_ROWS])
    down, up = ui.size[1] - below.bottom, below.top
    if height > down and up > down:
        height = min(height, up)
        place = pygame.Rect(below.left, below.top - height, below.width, height)
    else:
        place = pygame.Rect(below.left, below.bottom, below.width, min(height, down))
    return _menu(ui, place, rows, chosen, take)


def open_menu_at(
    ui: Ui, pixel: tuple[float, float], width: int, rows: Sequence[Row], take: Callable[[int], object],
    within: tuple[int, int, int, int],
) -> RowList:  # fmt: skip
    """Open a menu of rows at a place [pixels], or as near to it as a part of the window lets it stand whole.

    within: left, top, width, height [pixels]. Else as `open_menu`.
    """
    room = pygame.Rect(within)
    place = pygame.Rect(round(pixel[0]), round(pixel[1]), width, min(_menu_height(ui, rows), room.height))
    return _menu(ui, place.clamp(room), rows, None, take)


def _menu_height(ui: Ui, rows: Sequence[Row]) -> int:
    return sum((2 if row.detail else 1) * ui.px(LINE_HEIGHT) + 2 * ui.px(PADDING) for row in rows)


def _menu(
    ui: Ui, place: pygame.Rect, rows: Sequence[Row], chosen: int | None, take: Callable[[int], object]
) -> RowList:
    def choose(index: int) -> None:
        sheet.remove()
        take(index)

    sheet = ui.open_sheet(style="clear", is_menu=True)
    menu = RowList(ui, place, choose, sheet, at_once=False, background=MENU)
    menu.show_rows(rows, chosen, reveal=True)
    ui.focus_on(menu)
    return menu
