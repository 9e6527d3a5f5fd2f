"""Help: the page of all shortcuts."""

from collections.abc import Callable
from functools import partial
from itertools import product
from typing import Any

import pygame

from sandbox.app.base.shortcuts import Mode, Shortcut, shortcuts
from sandbox.app.draw.colours import ACCENT, MUTED, TEXT
from sandbox.app.widgets.dialogs import AROUND, MARGIN, Dialog
from sandbox.app.widgets.scroll import BAR_WIDTH, ScrollArea
from sandbox.app.widgets.ui import Ui
from sandbox.app.widgets.widget import Widget, WindowLayout

# Sizes in layout units.
COLUMN_WIDTH = 500.0
NARROWEST_COLUMN = 400.0
MOST_COLUMNS = 3
ROW = 16.5
HEADING = 27.0
TOP = 56.0
TEXT_SIZE = 12.0
COLUMN_GAP = 16.0


def show_help(ui: Ui, mode: Mode, tour: Callable[[], object]) -> None:
    """Cover the window by the list of a mode's shortcuts, until it is closed; tour: what begins the tour.

    What does not fit into the window is scrolled to.
    """
    width, height = ui.units
    entries = shortcuts(mode)
    most = max(1, min(int((width - 20) // NARROWEST_COLUMN), MOST_COLUMNS))
    # As few columns as the height allows: they are read from top to bottom.
    layouts = [_columns(entries, count) for count in range(1, most + 1)]
    layouts = [layout for layout in layouts if sum(_widths(ui, layout)) <= ui.px(width - AROUND - 2 * MARGIN)][-2:]
    layouts = layouts or [_columns(entries, 1)]
    available = height - AROUND - TOP - MARGIN
    columns = next((layout for layout in layouts if max(map(_height, layout)) <= available), layouts[-1])
    needed = max(map(_height, columns))

    def reopen(other_ui: Ui) -> None:
        show_help(other_ui, mode, tour)

    dialog = Dialog(ui, "Shortcuts", len(columns) * COLUMN_WIDTH, TOP + needed + MARGIN, reopen, is_page=True)
    right, box = dialog.width - MARGIN, dialog.box
    begin_tour = partial(dialog.end, tour)
    ui.button(ui.rect(right - 218, 16, 120, 32), "Take the tour", begin_tour, box, style="quiet")
    button = ui.button(ui.rect(right - 90, 16, 90, 32), "Close", dialog.end, box)
    area = ScrollArea(ui, ui.rect(MARGIN, TOP, dialog.inside + BAR_WIDTH, dialog.height - TOP - 12), box)
    area.set_height(ui.px(needed))
    ShortcutTable(ui, ui.rect(0, 0, dialog.inside, needed), columns, area.content).repaint()
    ui.focus_on(area.bar if area.bar.needed else button)


_HelpColumn = dict[str, list[Shortcut]]


def _columns(entries: tuple[Shortcut, ...], count: int) -> list[_HelpColumn]:
    """The entries by their groups, whole groups side by side in columns as low as can be."""
    groups: _HelpColumn = {}
    for entry in entries:
        groups.setdefault(entry.group, []).append(entry)
    heights = [_height({name: members}) for name, members in groups.items()]
    ways = product(range(count), repeat=len(groups))

    def highest(way: tuple[int, ...]) -> float:
        return max(sum(height for at, height in zip(way, heights, strict=True) if at == k) for k in range(count))

    best = min(ways, key=highest)
    members = list(groups.items())
    return [dict(each for at, each in zip(best, members, strict=True) if at == k) for k in range(count)]


def _height(column: _HelpColumn) -> float:
    return sum(HEADING + ROW * len(entries) for entries in column.values())


def _widths(ui: WindowLayout, columns: list[_HelpColumn]) -> list[int]:
    """How wide [pixels] the texts of each column are, with the gap behind it."""
    bold, plain = ui.font(TEXT_SIZE, True), ui.font(TEXT_SIZE)
    widths = []
    for column in columns:
        entries = [entry for members in column.values() for entry in members]
        keys = max(bold.size(_keys(entry))[0] for entry in entries)
        widths.append(keys + max(plain.size(entry.label)[0] for entry in entries) + ui.px(18 + COLUMN_GAP))
    return widths


def _keys(entry: Shortcut) -> str:
    return " or ".join(entry.keys[:2])


class ShortcutTable(Widget):
    """All shortcuts in columns."""

    def __init__(self, ui: Ui, rect: pygame.Rect, columns: list[_HelpColumn], container: Any) -> None:
        super().__init__(ui, rect, container)
        self.columns = columns

    def paint(self, size: tuple[int, int]) -> pygame.Surface:
        """The whole table."""
        surface = pygame.Surface(size, pygame.SRCALPHA)
        left, widths = 0, _widths(self.ui, self.columns)
        spare = max(0, size[0] - sum(widths)) // len(widths)
        for column, width in zip(self.columns, widths, strict=True):
            self._paint_column(surface, left, column)
            left += width + spare
        return surface

    def _paint_column(self, surface: pygame.Surface, left: int, column: _HelpColumn) -> None:
        ui, y = self.ui, 0.0
        bold, plain = ui.font(TEXT_SIZE, True), ui.font(TEXT_SIZE)
        widest = max(bold.size(_keys(entry))[0] for entries in column.values() for entry in entries)
        for group, entries in column.items():
            surface.blit(ui.font(11, True).render(group.upper(), True, MUTED), (left, ui.px(y + HEADING - 22)))
            y += HEADING
            for entry in entries:
                surface.blit(bold.render(_keys(entry), True, ACCENT), (left, ui.px(y)))
                surface.blit(plain.render(entry.label, True, TEXT), (left + widest + ui.px(18), ui.px(y)))
                y += ROW
