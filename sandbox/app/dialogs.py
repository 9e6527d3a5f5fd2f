"""Dialogs: lines that a person has to see, and a question with a typed answer."""

from collections.abc import Callable
from typing import Any

from sandbox.app.colours import TEXT, WARNING
from sandbox.app.painted import TextBlock
from sandbox.app.widgets import Ui

# Sizes in layout units.
WIDTH = 560.0
MARGIN = 24.0
LINE_HEIGHT = 21.0
MOST_LINES = 14
# Characters of a fault that fit on a line of the box.
LINE_CHARACTERS = 74


def _box(ui: Ui, height: float, close: Callable[[], None]) -> tuple[Any, Any, float]:
    """A modal box in the middle: the sheet, the box and its width in layout units."""
    width, tall = ui.units
    box_width = min(WIDTH, width - 40)
    sheet = ui.open_sheet(close)
    box = ui.panel(ui.rect((width - box_width) / 2, max((tall - height) / 2, 10), box_width, height), sheet, "@dialog")
    return sheet, box, box_width


def show_lines(ui: Ui, title: str, lines: list[str]) -> None:
    """Show lines until they are closed; more than fit are counted."""
    shown = lines[:MOST_LINES] + ([f"... and {len(lines) - MOST_LINES} more"] if len(lines) > MOST_LINES else [])
    rows = sum(1 + len(line) // LINE_CHARACTERS for line in shown)
    height = min(MARGIN * 2 + 40 + rows * LINE_HEIGHT + 60, ui.units[1] - 20)

    def close() -> None:
        ui.close_sheet(sheet)

    sheet, box, width = _box(ui, height, close)
    ui.label(ui.rect(MARGIN, MARGIN - 6, width - 2 * MARGIN, 28), title, box, "@title")
    place = ui.rect(MARGIN, MARGIN + 34, width - 2 * MARGIN, height - MARGIN * 2 - 84)
    TextBlock(ui, place, "\n".join(shown), box, 13.0, TEXT)
    button = ui.button(
        ui.rect(width - MARGIN - 110, height - MARGIN - 34, 110, 34), "Close", close, box, style="@primary"
    )
    ui.focus_on(button)


def ask(
    ui: Ui,
    title: str,
    hint: str,
    text: str,
    verb: str,
    answer: Callable[[str], str | None],
    other: tuple[str, Callable[[], None]] | None = None,
) -> None:
    """Ask for a line of text; answer gives None where it is taken, else what is wrong with it, and the box stays.

    other: the second button and what it does, instead of one that leaves everything as it is, as Escape does.
    """
    height = 246.0

    def close() -> None:
        ui.close_sheet(sheet)

    def do_other() -> None:
        close()
        if other is not None:
            other[1]()

    def accept() -> None:
        take(field.entry.get_text())

    def take(typed: str) -> bool:
        fault = answer(typed.strip())
        if fault is None:
            ui.close_sheet(sheet)
            return True
        note.show_text(fault)
        return False

    sheet, box, width = _box(ui, height, close)
    inside = width - 2 * MARGIN
    ui.label(ui.rect(MARGIN, MARGIN - 6, inside, 28), title, box, "@title")
    ui.label(ui.rect(MARGIN, MARGIN + 26, inside, 20), hint, box, "@muted")
    field = ui.field(ui.rect(MARGIN, MARGIN + 52, inside, 34), text, lambda _: True, box, 400)
    field.enter = take
    note = TextBlock(ui, ui.rect(MARGIN, MARGIN + 94, inside, 50), "", box, 12.0, WARNING)
    bottom = height - MARGIN - 34
    ui.button(ui.rect(width - MARGIN - 110, bottom, 110, 34), verb, accept, box, style="@primary")
    ui.button(ui.rect(width - MARGIN - 230, bottom, 110, 34), other[0] if other else "Cancel", do_other, box)
    ui.focus_on(field.entry)
