"""RowList: a list of rows of which one is chosen, of any length."""

from bisect import bisect_right
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import pygame

from sandbox.app.draw.colours import ACCENT, CHOSEN, FIELD, LINE, MUTED, TEXT, Colour, mixed
from sandbox.app.widgets.scroll import BAR_WIDTH, WHEEL_STEP, ScrollBar
from sandbox.app.widgets.texts import shortened, wrapped
from sandbox.app.widgets.ui import Ui
from sandbox.app.widgets.widget import ENTER_KEYS, Pixel, Widget, WindowLayout

# Sizes in layout units.
LINE_HEIGHT = 17.0
PADDING = 6.0
INSET = 10.0
SWATCH = 11.0
INDENT = 14.0
TEXT_SIZE, DETAIL_SIZE = 12.5, 11.0


@dataclass(frozen=True)
class Row:
    """A row: text, lines in grey below it, a spot of colour before it, the colour of the text.

    aside: words in grey at the right, in the line of the text, which is cut to leave them room; indent: steps.
    lines: how many its texts may take; 0: as many as those of its list. keeps_end: it is cut in its middle.
    """

    text: str
    detail: str = ""
    swatch: Colour | None = None
    colour: Colour = TEXT
    aside: str = ""
    indent: int = 0
    lines: int = 0
    keeps_end: bool = False

    def paint_swatch(self, ui: WindowLayout, surface: pygame.Surface, left: int, top: int) -> int:
        """Paint the spot of colour in the first line; where what follows it begins."""
        if self.swatch is None:
            return left
        side = ui.px(SWATCH)
        place = pygame.Rect(left, top + (ui.px(LINE_HEIGHT) - side) // 2, side, side)
        pygame.draw.rect(surface, self.swatch, place, border_radius=ui.px(3))
        return left + side + ui.px(8)


class RowList(Widget):
    """Rows to choose from; choose(index) is called by a click, Enter or Space; only what is seen is painted.

    empty: what it says without rows. at_once: arrow keys choose as they go. most_lines: of a row's text, and of what is
    below it, which wrap.
    """

    is_focusable = True

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
        wide = ui.px(BAR_WIDTH)
        place = pygame.Rect(self.rect.width - wide, ui.px(2), wide, self.rect.height - 2 * ui.px(2))
        self._bar = ScrollBar(ui, place, self._scroll_to, self)
        # Arrow keys scroll the list.
        self._bar.is_focusable = False

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
            most = row.lines or self._most_lines
            wide = max(widest - aside, widest // 3)
            lines = [shortened(row.text, font, wide, True)] if row.keeps_end else wrapped(row.text, font, wide, most)
            details = wrapped(row.detail, ui.font(DETAIL_SIZE), widest, most) if row.detail else []
            self._lines.append((lines, details))
            count = len(lines) + len(details)
            self._tops.append(self._tops[-1] + count * ui.px(LINE_HEIGHT) + 2 * ui.px(PADDING))

    @property
    def height(self) -> int:
        """What all rows take [pixels]."""
        return self._tops[-1]

    @property
    def pointed(self) -> int | None:
        """The row under the pointer."""
        return self._pointed if self._pointed is not None and self._pointed < len(self.rows) else None

    # Where things are.

    def _row_at(self, at: Pixel) -> int | None:
        index = bisect_right(self._tops, at[1] - self.rect.top + self._offset) - 1
        return index if self.rect.collidepoint(at) and 0 <= index < len(self.rows) else None

    def _scroll_to(self, offset: float) -> None:
        self._offset = min(max(offset, 0.0), max(0.0, float(self._tops[-1] - self.rect.height)))
        self._bar.show_place(self._offset, self._tops[-1], self.rect.height)
        self.repaint()

    def _reveal(self, index: int) -> None:
        if self._tops[index] < self._offset:
            self._scroll_to(self._tops[index])
        elif self._tops[index + 1] > self._offset + self.rect.height:
            self._scroll_to(self._tops[index + 1] - self.rect.height)

    # What mouse and keys do.

    def on_press(self, at: Pixel, clicks: int) -> bool:
        """Choose the row that is clicked."""
        index = self._row_at(at)
        if index is not None:
            self._cursor = index
            self._choose(index)
        return True

    def on_move(self, at: Pixel) -> None:
        """Mark the row under the mouse."""
        self._point_to(self._row_at(at))

    def on_hover(self) -> None:
        """Mark none while the mouse is elsewhere."""
        if not self.hovered:
            self._point_to(None)

    def _point_to(self, row: int | None) -> None:
        if row != self._pointed:
            self._pointed = row
            self.repaint()

    def on_wheel(self, notches: float) -> bool:
        """Scroll the list, where it is longer than its place."""
        self._scroll_to(self._offset - notches * self.ui.px(WHEEL_STEP))
        return self._bar.needed

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
        """The rows that are seen."""
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
        left = row.paint_swatch(ui, surface, left, y)
        if row.aside:
            picture = ui.font(DETAIL_SIZE).render(row.aside, True, MUTED)
            surface.blit(picture, (place.right - ui.px(INSET) - picture.get_width(), y + ui.px(1)))
        for texts, size, colour in zip(self._lines[index], (TEXT_SIZE, DETAIL_SIZE), (row.colour, MUTED), strict=True):
            for text in texts:
                surface.blit(ui.font(size).render(text, True, colour), (left, y))
                y += line
