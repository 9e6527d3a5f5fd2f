"""Help: the page of all shortcuts."""

from sandbox.app.shortcuts import GROUPS, SHORTCUTS
from sandbox.app.widgets import Ui

# Sizes in layout units.
COLUMN_WIDTH = 452.0
KEYS_WIDTH = 128.0
ROW = 22.0
HEADING = 32.0
TOP = 62.0
MARGIN = 28.0
# Groups by column, in windows that are wide enough for two.
COLUMNS = (("Tools", "View"), ("Time", "Files", "Keyboard"))


def show_help(ui: Ui) -> None:
    """Cover the window by the list of all shortcuts, until it is closed."""
    width, height = ui.units
    two = width >= 2 * COLUMN_WIDTH
    columns = COLUMNS if two else (GROUPS,)
    tallest = max(_height(groups) for groups in columns)
    box_width = min(len(columns) * COLUMN_WIDTH + MARGIN, width - 16)
    box_height = min(TOP + tallest + MARGIN, height - 16)
    squeeze = min(1.0, (box_height - TOP - 12) / tallest)

    def close() -> None:
        ui.close_sheet(sheet)

    sheet = ui.open_sheet(close)
    place = ui.rect((width - box_width) / 2, (height - box_height) / 2, box_width, box_height)
    box = ui.panel(place, sheet, "@dialog")
    ui.label(ui.rect(MARGIN, 18, 300, 28), "Shortcuts", box, "@title")
    button = ui.button(ui.rect(box_width - MARGIN - 90, 16, 90, 32), "Close", close, box)
    for index, groups in enumerate(columns):
        _column(ui, box, MARGIN + index * (box_width - MARGIN) / len(columns), groups, squeeze)
    ui.focus_on(button)


def _height(groups: tuple[str, ...]) -> float:
    return sum(HEADING + ROW * sum(entry.group == group for entry in SHORTCUTS) for group in groups)


def _column(ui: Ui, box: object, left: float, groups: tuple[str, ...], squeeze: float) -> None:
    y = TOP
    for group in groups:
        ui.label(ui.rect(left, y + 8 * squeeze, 200, 18), group.upper(), box, "@heading")
        y += HEADING * squeeze
        for entry in (entry for entry in SHORTCUTS if entry.group == group):
            keys = " or ".join(entry.keys[:2])
            ui.label(ui.rect(left, y, KEYS_WIDTH, ROW * squeeze), keys, box, "@key")
            ui.label(ui.rect(left + KEYS_WIDTH + 14, y, 310, ROW * squeeze), entry.label, box, "@muted")
            y += ROW * squeeze
