"""RowList: a list of rows of which one is chosen, of any length; and menus that open over the window."""

from bisect import bisect_right
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import pygame

from sandbox.app.draw.colours import ACCENT, CHOSEN, FIELD, LINE, MENU, MUTED, TEXT, Colour, mixed
from sandbox.app.widgets.painted import ENTER_KEYS, Lit, Painted, Pressable, wrapped
from sandbox.app.widgets.scroll import WHEEL_STEP
from sandbox.app.widgets.ui import Ui

# Sizes in layout units.
LINE_HEIGHT = 17.0
PADDING = 6.0
INSET = 10.0
SWATCH = 11.0
INDENT = 14.0
TEXT_SIZE, DETAIL_SIZE = 12.5, 11.0
MENU_ROWS = 12


@dataclass(frozen=True)
class Row:
    """A row: text, lines in grey below it, a spot of colour before it, the colour of the text.

    aside: words in grey at the right, in the line of the text, which is cut to leave them room; indent: steps.
    """

    text: str
    detail: str = ""
    swatch: Colour | None = None
    colour: Colour = TEXT
    aside: str = ""
    indent: int = 0


# Shortest thumb, and how far from the right a press takes it [layout units].
SHORTEST_THUMB, THUMB_REACH = 20.0, 12.0


class RowList(Painted):
    """Rows to choose from; choose(index) is called by a click, Enter or Space; only what is seen is painted.

    empty: what it says without rows. at_once: arrow keys choose as they go. most_lines: of a row's text, and of what is
    below it, which wrap.
    """

    def __init__(
        self,
        ui: Ui,
        rect: pygame.Rect,
        choose: Callable[[int], None],
        container: Any = None,
        *,
        empty: str = "",
        at_once: bool = True,
        most_lines: int = 1,
        background: Colour = FIELD,
    ) -> None:
        super().__init__(ui, rect, container)
        self.rows: Sequence[Row] = ()
        self.chosen: int | None = None
        self.also: frozenset[int] = frozenset()
        self._choose, self.empty, self._at_once = choose, empty, at_once
        self._most_lines, self._background = most_lines, background
        # Of each row: its lines, and those below in grey.
        self._lines: list[tuple[list[str], list[str]]] = []
        self._tops: list[int] = [0]
        self._offset = 0.0
        self._pointed: int | None = None
        self._cursor: int | None = None
        self._grip: float | None = None
        ui.add(self)
        self.repaint()

    def show_rows(
        self, rows: Sequence[Row], chosen: int | None, reveal: bool = False, also: frozenset[int] = frozenset()
    ) -> None:
        """Show rows, one of them as chosen; reveal: scroll to it where it has changed; also: others that are chosen."""
        self.also = also
        if rows != self.rows:
            self.rows = rows
            self._lay_out()
        if chosen != self.chosen:
            self.chosen = self._cursor = chosen
            if chosen is not None and reveal:
                self._reveal(chosen)
        self._scroll_to(self._offset)

    def _lay_out(self) -> None:
        ui = self.ui
        font, inset = ui.font(TEXT_SIZE), ui.px(INSET)
        self._lines, self._tops = [], [0]
        for row in self.rows:
            left = inset + (ui.px(SWATCH + 8) if row.swatch is not None else 0) + row.indent * ui.px(INDENT)
            widest = self.rect.width - left - inset
            aside = ui.font(DETAIL_SIZE).size(row.aside)[0] + ui.px(8) if row.aside else 0
            lines = wrapped(row.text, font, max(widest - aside, widest // 3), self._most_lines)
            details = wrapped(row.detail, ui.font(DETAIL_SIZE), widest, self._most_lines) if row.detail else []
            self._lines.append((lines, details))
            count = len(lines) + len(details)
            self._tops.append(self._tops[-1] + count * ui.px(LINE_HEIGHT) + 2 * ui.px(PADDING))

    @property
    def pointed(self) -> int | None:
        """The row under the pointer."""
        return self._pointed if self._pointed is not None and self._pointed < len(self.rows) else None

    # Where things are.

    def _row_at(self, pos: tuple[int, int]) -> int | None:
        x, y = self.ui.manager.calculate_scaled_mouse_position(pos)
        if not self.hover_point(x, y):
            return None
        index = bisect_right(self._tops, y - self.rect.top + self._offset) - 1
        return index if 0 <= index < len(self.rows) else None

    def _scroll_to(self, offset: float) -> None:
        self._offset = min(max(offset, 0.0), max(0.0, float(self._tops[-1] - self.rect.height)))
        self.repaint()

    def _reveal(self, index: int) -> None:
        if self._tops[index] < self._offset:
            self._scroll_to(self._tops[index])
        elif self._tops[index + 1] > self._offset + self.rect.height:
            self._scroll_to(self._tops[index + 1] - self.rect.height)

    # What mouse and keys do.

    def process_event(self, event: pygame.event.Event) -> bool:
        """Choose by a click, scroll by the wheel and by the thumb."""
        if event.type == pygame.MOUSEMOTION and self._grip is not None:
            self._drag_thumb(event.pos)
            return True
        if event.type == pygame.MOUSEBUTTONUP and event.button == 1 and self._grip is not None:
            self._grip = None
            return True
        if event.type == pygame.MOUSEBUTTONDOWN and event.button == 1 and self._is_at_thumb(event.pos):
            y = self.ui.manager.calculate_scaled_mouse_position(event.pos)[1] - self.rect.top
            top, tall = self._thumb()
            self._grip = y - top if top <= y <= top + tall else tall / 2
            self._drag_thumb(event.pos)
            return True
        if event.type == pygame.MOUSEMOTION:
            hovered = self._row_at(event.pos)
            if hovered != self._pointed:
                self._pointed = hovered
                self.repaint()
        elif event.type == pygame.MOUSEBUTTONDOWN and event.button == 1:
            index = self._row_at(event.pos)
            if index is not None:
                self._cursor = index
                self._choose(index)
            return self.hover_point(*self.ui.manager.calculate_scaled_mouse_position(event.pos))
        elif event.type == pygame.MOUSEWHEEL and self.hover_point(*self.ui.manager.get_mouse_position()):
            self._scroll_to(self._offset - (event.precise_y or event.y) * self.ui.px(WHEEL_STEP))
            return True
        return False

    def _thumb(self) -> tuple[float, int]:
        """Top and height of the thumb [pixels]."""
        height = self.rect.height
        tall = max(height * height // max(self._tops[-1], 1), self.ui.px(SHORTEST_THUMB))
        return (height - tall) * self._offset / max(self._tops[-1] - height, 1), tall

    def _is_at_thumb(self, pos: tuple[int, int]) -> bool:
        x, y = self.ui.manager.calculate_scaled_mouse_position(pos)
        needed = self._tops[-1] > self.rect.height
        return bool(needed and self.hover_point(x, y) and x >= self.rect.right - self.ui.px(THUMB_REACH))

    def _drag_thumb(self, pos: tuple[int, int]) -> None:
        assert self._grip is not None
        y = self.ui.manager.calculate_scaled_mouse_position(pos)[1] - self.rect.top
        room = max(self.rect.height - self._thumb()[1], 1)
        self._scroll_to((y - self._grip) / room * (self._tops[-1] - self.rect.height))

    def press_key(self, event: pygame.event.Event) -> bool:
        """Arrows go from row to row, Page keys by a page, Home and End to the ends; Enter and Space choose."""
        if not self.rows:
            return False
        here, last = self._cursor, len(self.rows) - 1
        if event.key in (*ENTER_KEYS, pygame.K_SPACE):
            if here is not None:
                self._choose(min(here, last))
            return True
        page = max(1, round(self.rect.height / self.ui.px(LINE_HEIGHT + 2 * PADDING)) - 1)
        steps = {pygame.K_UP: -1, pygame.K_DOWN: 1, pygame.K_PAGEUP: -page, pygame.K_PAGEDOWN: page}
        ends = {pygame.K_HOME: 0, pygame.K_END: last}
        if event.key in steps:
            here = 0 if here is None else min(max(here + steps[event.key], 0), last)
        elif event.key in ends:
            here = ends[event.key]
        else:
            return False
        self._cursor = here
        self._reveal(here)
        self.repaint()
        if self._at_once:
            self._choose(here)
        return True

    # Painting.

    def paint(self, size: tuple[int, int]) -> pygame.Surface:
        """The rows that are seen, and a thumb where there are more."""
        ui = self.ui
        surface = pygame.Surface(size, pygame.SRCALPHA)
        pygame.draw.rect(surface, self._background, surface.get_rect(), border_radius=ui.px(6))
        if not self.rows:
            for number, line in enumerate(wrapped(self.empty, ui.font(12), size[0] - 2 * ui.px(INSET), 6)):
                at = (ui.px(INSET), ui.px(PADDING + 2) + number * ui.px(LINE_HEIGHT))
                surface.blit(ui.font(12).render(line, True, MUTED), at)
        first = max(bisect_right(self._tops, self._offset) - 1, 0)
        for index in range(first, len(self.rows)):
            if self._tops[index] - self._offset > size[1]:
                break
            self._paint_row(surface, index, self._tops[index] - round(self._offset))
        if self._tops[-1] > size[1]:
            top, tall = self._thumb()
            place = pygame.Rect(size[0] - ui.px(6), round(top), ui.px(4), tall)
            pygame.draw.rect(surface, mixed(LINE, MUTED, 0.35), place, border_radius=ui.px(2))
        pygame.draw.rect(surface, LINE, surface.get_rect(), 1, border_radius=ui.px(6))
        return surface

    def _paint_row(self, surface: pygame.Surface, index: int, top: int) -> None:
        ui, row = self.ui, self.rows[index]
        place = pygame.Rect(0, top, surface.get_width(), self._tops[index + 1] - self._tops[index])
        inner = place.inflate(-ui.px(6), -ui.px(2))
        is_chosen = index == self.chosen or index in self.also
        if is_chosen:
            pygame.draw.rect(surface, CHOSEN, inner, border_radius=ui.px(5))
        elif index == self._pointed:
            pygame.draw.rect(surface, mixed(self._background, TEXT, 0.08), inner, border_radius=ui.px(5))
        if index == self._cursor and not is_chosen:
            pygame.draw.rect(surface, ACCENT, inner, 1, border_radius=ui.px(5))
        left, line, y = ui.px(INSET) + row.indent * ui.px(INDENT), ui.px(LINE_HEIGHT), top + ui.px(PADDING)
        if row.swatch is not None:
            swatch = ui.px(SWATCH)
            at = pygame.Rect(left, y + (line - swatch) // 2, swatch, swatch)
            pygame.draw.rect(surface, row.swatch, at, border_radius=ui.px(3))
            left += swatch + ui.px(8)
        if row.aside:
            picture = ui.font(DETAIL_SIZE).render(row.aside, True, MUTED)
            surface.blit(picture, (place.right - ui.px(INSET) - picture.get_width(), y + ui.px(1)))
        for texts, size, colour in zip(self._lines[index], (TEXT_SIZE, DETAIL_SIZE), (row.colour, MUTED), strict=True):
            for text in texts:
                surface.blit(ui.font(size).render(text, True, colour), (left, y))
                y += line


class Picker(Lit, Pressable):
    """A value that a menu of rows changes: opens below it, by a click, Enter, Space or an arrow key."""

    ui: Ui

    press_keys = (*Pressable.press_keys, pygame.K_DOWN)

    def __init__(self, ui: Ui, rect: pygame.Rect, choose: Callable[[int], None], container: Any = None) -> None:
        super().__init__(ui, rect, container)
        self.rows: Sequence[Row] = ()
        self.shown = Row("")
        self._choose = choose
        ui.add(self)
        self.repaint()

    def show_value(self, rows: Sequence[Row], shown: Row) -> None:
        """Offer rows, and show one row as the value, which need not be among them."""
        if (rows, shown) != (self.rows, self.shown):
            self.rows, self.shown = rows, shown
            self.repaint()

    def paint(self, size: tuple[int, int]) -> pygame.Surface:
        """The value and a chevron."""
        ui = self.ui
        surface = pygame.Surface(size, pygame.SRCALPHA)
        place = surface.get_rect()
        back = mixed(FIELD, TEXT, 0.06) if self.hovered else FIELD
        pygame.draw.rect(surface, back, place, border_radius=ui.px(6))
        pygame.draw.rect(surface, LINE, place, 1, border_radius=ui.px(6))
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

        open_menu(self.ui, self.rect, self.rows, chosen, take)


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
    ui: Ui, pixel: tuple[float, float], width: int, rows: Sequence[Row], take: Callable[[int], object]
) -> RowList:
    """Open a menu of rows at a place [pixels], or as near to it as the window lets it stand whole; as `open_menu`."""
    height = min(_menu_height(ui, rows), ui.size[1])
    left, top = min(round(pixel[0]), ui.size[0] - width), min(round(pixel[1]), ui.size[1] - height)
    return _menu(ui, pygame.Rect(max(left, 0), top, width, height), rows, None, take)


def _menu_height(ui: Ui, rows: Sequence[Row]) -> int:
    return sum((2 if row.detail else 1) * ui.px(LINE_HEIGHT) + 2 * ui.px(PADDING) for row in rows)


def _menu(
    ui: Ui, place: pygame.Rect, rows: Sequence[Row], chosen: int | None, take: Callable[[int], object]
) -> RowList:
    def close() -> None:
        ui.close_sheet(sheet)

    def choose(index: int) -> None:
        close()
        take(index)

    sheet = ui.open_sheet(close, "@clear")
    _Beside(ui, pygame.Rect((0, 0), ui.size), close, sheet)
    menu = RowList(ui, place, choose, sheet, at_once=False, background=MENU)
    menu.show_rows(rows, chosen, reveal=True)
    ui.focus_on(menu)
    return menu


class _Beside(Painted):
    """What lies around a menu: a click there closes it."""

    def __init__(self, ui: Ui, rect: pygame.Rect, close: Callable[[], None], container: Any) -> None:
        super().__init__(ui, rect, container)
        self._close = close
        self.repaint()

    def paint(self, size: tuple[int, int]) -> pygame.Surface:
        """Nothing."""
        return pygame.Surface(size, pygame.SRCALPHA)

    def process_event(self, event: pygame.event.Event) -> bool:
        """Close on any press of a button; the wheel is none."""
        if event.type == pygame.MOUSEBUTTONDOWN and event.button in (1, 2, 3):
            self._close()
            return True
        return False
