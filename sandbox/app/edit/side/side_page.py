"""SidePage: a page of the panel at the side; ListHead: a list at its top, with buttons, over what is chosen in it."""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import pygame

from sandbox.app.draw.colours import MUTED
from sandbox.app.widgets.picker import Picker
from sandbox.app.widgets.property_widgets import GAP, ROW
from sandbox.app.widgets.rows import DETAIL_SIZE, INSET, LINE_HEIGHT, PADDING, TEXT_SIZE, Row, RowList
from sandbox.app.widgets.scroll import ScrollArea
from sandbox.app.widgets.texts import wrapped
from sandbox.app.widgets.ui import Ui

# A page that is lower than this has no room for a list beside what is chosen in it [layout units].
ROOM_FOR_LIST = 400.0
# Room below the list and below the buttons [layout units].
BELOW_LIST, BELOW_BUTTONS = 8.0, 12.0
# Lines of what a list says that is empty.
EMPTY_LINES = 3


class SidePage:
    """A page, which is made in a place of its own; that is taken away with all its widgets.

    chosen: the line of its list that is chosen, which the next page of its kind begins with; None: it has no such list.
    """

    chosen: Any = None
    # Whether what is chosen at first goes by the selection, where that is another one than before.
    follows_selection = False

    def refresh(self) -> None:
        """Show the document as it is now; costs nothing where it has not changed."""
        raise NotImplementedError

    def close(self) -> None:
        """End what the page shows outside of its place, such as a box on the sheet."""


class HeadButton(NamedTuple):
    """A button: what it says, also where it is narrow, what it does, and its tip."""

    text: str
    short: str
    do: Callable[[], None]
    tip: str


class ChosenRow(Picker):
    """The chosen row of a list that has no room; it offers the others as a menu. empty: what it says without rows."""

    def __init__(
        self, ui: Ui, rect: pygame.Rect, choose: Callable[[int], None], container: Any = None, *, empty: str = ""
    ) -> None:
        self._empty = empty
        super().__init__(ui, rect, choose, container)

    def show_rows(self, rows: Sequence[Row], chosen: int | None, reveal: bool = False) -> None:
        """Show rows, one of them as chosen, as a list does."""
        self.show_value(rows, Row("") if chosen is None else rows[chosen])

    def press(self) -> None:
        """Open the menu of the rows, where there are any."""
        if self.rows:
            super().press()

    def paint(self, size: tuple[int, int]) -> pygame.Surface:
        """The row and a chevron."""
        ui, row = self.ui, self.shown
        surface = self.paint_box(size)
        left, y, line = ui.px(INSET), ui.px(PADDING), ui.px(LINE_HEIGHT)
        if not self.rows:
            for text in wrapped(self._empty, ui.font(DETAIL_SIZE), size[0] - 2 * left, EMPTY_LINES):
                surface.blit(ui.font(DETAIL_SIZE).render(text, True, MUTED), (left, y))
                y += line
            return surface
        left = row.paint_swatch(ui, surface, left, y)
        widest = size[0] - left - ui.px(24)
        for text, height, colour in ((row.text, TEXT_SIZE, row.colour), (row.detail, DETAIL_SIZE, MUTED)):
            (shown,) = wrapped(text, ui.font(height), widest, 1)
            surface.blit(ui.font(height).render(shown, True, colour), (left, y))
            y += line
        self.paint_chevron(surface)
        return surface


class ListHead:
    """A list that takes a fraction of a place [pixels], then buttons in columns; `area` is the rest, from `top` on.

    On a low page the chosen row stands for the list, and all of the page is in the area: the head scrolls away. choose,
    empty, most_lines: as of a RowList. top [layout units].
    """

    def __init__(
        self, ui: Ui, place: pygame.Rect, fraction: float, columns: int, buttons: Sequence[HeadButton],
        choose: Callable[[int], None], container: Any, *, empty: str = "", most_lines: int = 1,
    ) -> None:  # fmt: skip
        self._ui = ui
        is_low = place.height < ui.px(ROOM_FOR_LIST)
        self.list: RowList | ChosenRow
        if is_low:
            self.area = ScrollArea(ui, place, container)
            container, columns = self.area.content, len(buttons)
            wide, tall = place.width - ui.px(12), ui.px(2 * LINE_HEIGHT + 2 * PADDING)
            self.list = ChosenRow(ui, pygame.Rect(0, 0, wide, tall), choose, container, empty=empty)
        else:
            top = pygame.Rect(place.topleft, (place.width - ui.px(6), round(place.height * fraction)))
            self.list = RowList(ui, top, choose, container, empty=empty, most_lines=most_lines)
        above, gap = self.list.place, ui.px(GAP)
        width = (above.width - (columns - 1) * gap) // columns
        self.buttons = {}
        for number, button in enumerate(buttons):
            row, column = divmod(number, columns)
            left, y = above.left + column * (width + gap), above.bottom + ui.px(BELOW_LIST) + row * ui.px(ROW + GAP)
            at, text = pygame.Rect(left, y, width, ui.px(ROW)), button.short if is_low else button.text
            self.buttons[button.text] = ui.button(at, text, button.do, container, style="segment", tip=button.tip)
        end = at.bottom + ui.px(BELOW_BUTTONS)
        self.top = end / ui.scale if is_low else 0.0
        if not is_low:
            self.area = ScrollArea(ui, pygame.Rect(place.left, end, place.width, place.bottom - end), container)
