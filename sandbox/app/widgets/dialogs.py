"""Dialogs: lines that a person has to see, questions with a typed answer, choices, and long lists to choose from."""

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import pygame

from sandbox.app.draw.colours import TEXT, WARNING
from sandbox.app.widgets.picker import MENU_ROWS
from sandbox.app.widgets.rows import Row, RowList
from sandbox.app.widgets.scroll import BAR_WIDTH, ScrollArea
from sandbox.app.widgets.texts import TextBlock, text_height
from sandbox.app.widgets.ui import Reopen, Ui

# Sizes in layout units.
WIDTH = 560.0
MARGIN = 24.0
LINE_HEIGHT = 21.0
MOST_LINES = 14
# Characters of a fault that fit on a line of the box.
LINE_CHARACTERS = 74
# Height of a row of a list, and of a choice; room around buttons for the ring of the keyboard.
ROW_HEIGHT, CHOICE_ROW, RING = 29.0, 42.0, 4.0
# The text of buttons, what they have around it, and what is between columns of them.
BUTTON_TEXT, BUTTON_ROOM, COLUMN_GAP = 13.0, 24.0, 10.0
HINT_TEXT = 12.0

# A button: its label, and what it does.
Choice = tuple[str, Callable[[], object]]


def _box(
    ui: Ui, title: str, height: float, reopen: Reopen, is_question: bool = False,
    widest: float = WIDTH, *, is_page: bool = False,
) -> tuple[Any, Any, float]:  # fmt: skip
    """A modal box with a title in the middle: the sheet, the box and its width in layout units."""
    width, tall = ui.units
    box_width = min(widest, width - 40)
    sheet = ui.open_sheet(reopen=reopen, is_question=is_question, is_page=is_page)
    box = ui.panel(ui.rect((width - box_width) / 2, max((tall - height) / 2, 10), box_width, height), sheet, "dialog")
    ui.label(ui.rect(MARGIN, MARGIN - 6, box_width - 2 * MARGIN, 28), title, box, "title")
    return sheet, box, box_width


def show_lines(ui: Ui, title: str, lines: list[str], other: Choice | None = None) -> None:
    """Show lines until they are closed; more than fit are counted; other: what else can be done, on a second button."""
    shown = lines[:MOST_LINES] + ([f"... and {len(lines) - MOST_LINES} more"] if len(lines) > MOST_LINES else [])
    inside, text = ui.px(min(WIDTH, ui.units[0] - 40) - 2 * MARGIN), "\n".join(shown)
    tall = text_height(text, ui.font(13.0), inside)
    # What does not fit is scrolled to.
    height = min(MARGIN * 2 + 94 + tall / ui.scale, ui.units[1] - 20)

    def do_other() -> None:
        sheet.remove()
        if other is not None:
            other[1]()

    def reopen(other_ui: Ui) -> None:
        show_lines(other_ui, title, lines, other)

    sheet, box, width = _box(ui, title, height, reopen)
    place = ui.rect(MARGIN, MARGIN + 34, width - 2 * MARGIN + BAR_WIDTH, height - MARGIN * 2 - 84)
    area = ScrollArea(ui, place, box)
    TextBlock(ui, pygame.Rect(0, 0, inside, tall), text, area.content, 13.0, TEXT)
    area.set_height(tall)
    bottom = height - MARGIN - 34
    button = ui.button(ui.rect(width - MARGIN - 110, bottom, 110, 34), "Close", sheet.remove, box, style="primary")
    if other is not None:
        ui.button(ui.rect(width - MARGIN - 310, bottom, 190, 34), other[0], do_other, box)
    ui.focus_on(button)


def _hint_height(ui: Ui, hint: str) -> float:
    """How high a hint is in a box [layout units]."""
    inside = ui.px(min(WIDTH, ui.units[0] - 40) - 2 * MARGIN)
    return text_height(hint, ui.font(HINT_TEXT), inside) / ui.scale + 4


def ask(
    ui: Ui,
    title: str,
    hint: str,
    text: str,
    verb: str,
    answer: Callable[[str], str | None],
    other: tuple[str, Callable[[], None]] | None = None,
    then: Callable[[str], object] | None = None,
) -> None:
    """Ask for a line of text; answer gives None where it is taken, else what is wrong with it, and the box stays.

    other: the second button and what it does, instead of one that leaves everything as it is, as Escape does.
    then: what is done with a text that was taken, once the box is closed.
    """
    said = _hint_height(ui, hint)
    height = 226.0 + said

    def do_other() -> None:
        sheet.remove()
        if other is not None:
            other[1]()

    def accept() -> None:
        take(field.typed)

    def take(typed: str) -> bool:
        fault = answer(typed.strip())
        if fault is None:
            sheet.remove()
            if then is not None:
                then(typed.strip())
            return True
        note.show_text(fault)
        return False

    def reopen(other_ui: Ui) -> None:
        ask(other_ui, title, hint, field.typed, verb, answer, other, then)

    sheet, box, width = _box(ui, title, height, reopen)
    inside = width - 2 * MARGIN
    TextBlock(ui, ui.rect(MARGIN, MARGIN + 28, inside, said), hint, box, HINT_TEXT)
    top = MARGIN + 32 + said
    field = ui.field(ui.rect(MARGIN, top, inside, 34), text, lambda _: True, box, 400)
    field.enter = take
    note = TextBlock(ui, ui.rect(MARGIN, top + 42, inside, 50), "", box, 12.0, WARNING)
    bottom = height - MARGIN - 34
    ui.button(ui.rect(width - MARGIN - 110, bottom, 110, 34), verb, accept, box, style="primary")
    ui.button(ui.rect(width - MARGIN - 230, bottom, 110, 34), other[0] if other else "Cancel", do_other, box)
    ui.focus_on(field)


def choose(
    ui: Ui, title: str, text: str, choices: Sequence[Choice], columns: int = 1, *, is_question: bool = False
) -> None:
    """Offer choices, (label, what it does) each, the first of them marked; Escape or Cancel leaves all as it is.

    is_question: it stays until it is answered, also where another screen comes.
    """
    columns, widest = _columns_that_fit(ui, [label for label, _ in choices], columns)
    rows = -(-len(choices) // columns)
    lines = 1 + len(text) // LINE_CHARACTERS if text else 0
    around = MARGIN * 2 + 38 + lines * LINE_HEIGHT + 44
    # What does not fit is scrolled to.
    tall = min(rows * CHOICE_ROW, ui.units[1] - 20 - around)
    height = around + tall

    def do(action: Callable[[], object]) -> None:
        sheet.remove()
        action()

    def reopen(other_ui: Ui) -> None:
        choose(other_ui, title, text, choices, columns, is_question=is_question)

    scrolls = tall < rows * CHOICE_ROW
    sheet, box, width = _box(ui, title, height, reopen, is_question, widest, is_page=scrolls)
    inside = width - 2 * MARGIN
    TextBlock(ui, ui.rect(MARGIN, MARGIN + 32, inside, lines * LINE_HEIGHT + 4), text, box, 13.0, TEXT)
    place = ui.rect(MARGIN - RING, MARGIN + 40 + lines * LINE_HEIGHT - RING, inside + 2 * RING + BAR_WIDTH, tall)
    area, buttons = ScrollArea(ui, place, box), []
    wide = (inside - COLUMN_GAP * (columns - 1)) / columns
    for index, (label, action) in enumerate(choices):
        x, y = RING + index % columns * (wide + COLUMN_GAP), RING + index // columns * CHOICE_ROW
        style = "primary" if index == 0 and columns == 1 else ""
        place = ui.rect(x, y, wide, CHOICE_ROW - 8)
        buttons.append(ui.button(place, label, partial(do, action), area.content, style=style))
    area.set_height(ui.px(rows * CHOICE_ROW))
    ui.button(ui.rect(width - MARGIN - 110, height - MARGIN - 34, 110, 34), "Cancel", sheet.remove, box, style="quiet")
    ui.focus_on(buttons[0])


def _columns_that_fit(ui: Ui, labels: Sequence[str], columns: int) -> tuple[int, float]:
    """Columns of buttons with these labels, as many as are asked for or one, and the width of a box for them."""
    longest = max(ui.font(BUTTON_TEXT).size(label)[0] for label in labels) / ui.scale + BUTTON_ROOM
    needed = columns * longest + COLUMN_GAP * (columns - 1) + 2 * MARGIN
    return (columns if needed <= ui.units[0] - 40 else 1), max(WIDTH, needed if columns > 1 else 0.0)


def choose_row(ui: Ui, title: str, rows: Sequence[Row], take: Callable[[int], object]) -> None:
    """Offer a list of any length, which scrolls; take(index) is called once a row is chosen."""
    tall = min(min(len(rows), MENU_ROWS) * ROW_HEIGHT, ui.units[1] - 20 - 2 * MARGIN - 84)
    height = MARGIN * 2 + 84 + tall

    def do(index: int) -> None:
        sheet.remove()
        take(index)

    def reopen(other_ui: Ui) -> None:
        choose_row(other_ui, title, rows, take)

    sheet, box, width = _box(ui, title, height, reopen)
    listed = RowList(ui, ui.rect(MARGIN, MARGIN + 34, width - 2 * MARGIN, tall), do, box, at_once=False)
    listed.show_rows(rows, None)
    ui.button(ui.rect(width - MARGIN - 110, height - MARGIN - 34, 110, 34), "Cancel", sheet.remove, box, style="quiet")
    ui.focus_on(listed)


def fill_in(
    ui: Ui,
    title: str,
    hint: str,
    fields: Sequence[tuple[str, str]],
    verb: str,
    answer: Callable[[list[str]], str | None],
) -> None:
    """Ask for several lines, (label, text) each; answer gives None where they are taken, else what is wrong."""
    said = _hint_height(ui, hint)
    height = MARGIN * 2 + 42 + said + len(fields) * 42 + 78

    def accept(_: object = None) -> None:
        fault = answer([entry.typed.strip() for entry in entries])
        if fault is None:
            sheet.remove()
        else:
            note.show_text(fault)

    def reopen(other_ui: Ui) -> None:
        typed = [(label, entry.typed) for (label, _), entry in zip(fields, entries, strict=True)]
        fill_in(other_ui, title, hint, typed, verb, answer)

    sheet, box, width = _box(ui, title, height, reopen)
    inside = width - 2 * MARGIN
    TextBlock(ui, ui.rect(MARGIN, MARGIN + 28, inside, said), hint, box, HINT_TEXT)
    entries = []
    for index, (label, text) in enumerate(fields):
        top = MARGIN + 36 + said + index * 42
        ui.label(ui.rect(MARGIN, top, inside * 0.5, 34), label, box)
        entry = ui.field(ui.rect(MARGIN + inside * 0.5, top, inside * 0.5, 34), text, lambda _: True, box, 40)
        entry.enter = accept
        entries.append(entry)
    note = TextBlock(ui, ui.rect(MARGIN, height - MARGIN - 74, inside, 34), "", box, 12.0, WARNING)
    bottom = height - MARGIN - 34
    ui.button(ui.rect(width - MARGIN - 110, bottom, 110, 34), verb, accept, box, style="primary")
    ui.button(ui.rect(width - MARGIN - 230, bottom, 110, 34), "Cancel", sheet.remove, box)
    ui.focus_on(entries[0])
