"""Help: the page of all shortcuts."""

from typing import Any

import pygame

from sandbox.app.colours import ACCENT, MUTED, TEXT
from sandbox.app.painted import Painted
from sandbox.app.shortcuts import GROUPS, SHORTCUTS, Shortcut
from sandbox.app.widgets import Ui

# Sizes in layout units.
COLUMN_WIDTH = 480.0
NARROWEST_COLUMN = 420.0
ROW = 22.0
HEADING = 34.0
TOP = 62.0
MARGIN = 28.0
# Groups by column, in windows that are wide enough for two.
COLUMNS = (("Tools", "View"), ("Time", "Files", "Keyboard"))


def show_help(ui: Ui) -> None:
    """Cover the window by the list of all shortcuts, until it is closed."""
    width, height = ui.units
    columns = COLUMNS if width >= 2 * NARROWEST_COLUMN + 20 else (GROUPS,)
    box_width = min(len(columns) * COLUMN_WIDTH, width - 16)
    box_height = min(TOP + max(_height(groups) for groups in columns) + MARGIN, height - 16)

    def close() -> None:
        ui.close_sheet(sheet)

    sheet = ui.open_sheet(close, is_page=True)
    place = ui.rect((width - box_width) / 2, (height - box_height) / 2, box_width, box_height)
    box = ui.panel(place, sheet, "@dialog")
    ui.label(ui.rect(MARGIN, 18, 300, 28), "Shortcuts", box, "@title")
    button = ui.button(ui.rect(box_width - MARGIN - 90, 16, 90, 32), "Close", close, box)
    ShortcutTable(ui, ui.rect(MARGIN, TOP, box_width - 2 * MARGIN, box_height - TOP - 12), columns, box).repaint()
    ui.focus_on(button)


def _height(groups: tuple[str, ...]) -> float:
    return sum(HEADING + ROW * sum(entry.group == group for entry in SHORTCUTS) for group in groups)


def _keys(entry: Shortcut) -> str:
    return " or ".join(entry.keys[:2])


class ShortcutTable(Painted):
    """All shortcuts in columns; rows move closer together where the window is low."""

    def __init__(self, ui: Ui, rect: pygame.Rect, columns: tuple[tuple[str, ...], ...], container: Any) -> None:
        super().__init__(ui, rect, container)
        self.columns = columns

    def paint(self, size: tuple[int, int]) -> pygame.Surface:
        """The whole table."""
        surface = pygame.Surface(size, pygame.SRCALPHA)
        tallest = max(_height(groups) for groups in self.columns)
        row = min(1.0, size[1] / self.ui.px(tallest))
        for index, groups in enumerate(self.columns):
            self._paint_column(surface, index * size[0] // len(self.columns), groups, row)
        return surface

    def _paint_column(self, surface: pygame.Surface, left: int, groups: tuple[str, ...], squeeze: float) -> None:
        ui, y = self.ui, 0.0
        size = 12.5 * max(squeeze, 0.7)
        shown = [entry for entry in SHORTCUTS if entry.group in groups]
        widest = max(ui.font(size, True).size(_keys(entry))[0] for entry in shown)
        for group in groups:
            heading = ui.font(11 * max(squeeze, 0.7), True).render(group.upper(), True, MUTED)
            surface.blit(heading, (left, ui.px(y + (HEADING - 22) * squeeze)))
            y += HEADING * squeeze
            for entry in (entry for entry in SHORTCUTS if entry.group == group):
                keys = ui.font(size, True).render(_keys(entry), True, ACCENT)
                surface.blit(keys, (left, ui.px(y)))
                label = ui.font(size).render(entry.label, True, TEXT)
                surface.blit(label, (left + widest + ui.px(18), ui.px(y)))
                y += ROW * squeeze
