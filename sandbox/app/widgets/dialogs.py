"""Dialogs: lines that a person has to see, questions with a typed answer, choices, and long lists to choose from."""

from collections.abc import Callable, Sequence
from functools import partial

import pygame

from sandbox.app.draw.colours import TEXT, WARNING
from sandbox.app.widgets.button import Button
from sandbox.app.widgets.picker import MENU_ROWS
from sandbox.app.widgets.rows import Row, RowList
from sandbox.app.widgets.scroll import BAR_WIDTH, ScrollArea
from sandbox.app.widgets.texts import TextBlock, text_height
from sandbox.app.widgets.ui import Reopen, Ui

# Sizes in layout units; around a box there is at least so much of the window, both sides together.
WIDTH = 560.0
MARGIN, AROUND = 24.0, 16.0
LINE_HEIGHT = 21.0
MOST_LINES = 14
# Characters of a fault that fit on a line of the box.
LINE_CHARACTERS = 74
# Height of a row of a list, of a choice, and of a line to type into; room around buttons for the ring of the keyboard.
ROW_HEIGHT, CHOICE_ROW, FIELD_ROW, RING = 29.0, 42.0, 42.0, 4.0
# Buttons at the bottom; the text of buttons, what they have around it, and what is between columns of them.
BUTTON, BUTTON_WIDTH, BUTTON_TEXT, BUTTON_ROOM, COLUMN_GAP = 34.0, 110.0, 13.0, 24.0, 10.0
HINT_TEXT = 12.0

# A button: its label, and what it does.
Choice = tuple[str, Callable[[], object]]


class Dialog:
    """A modal page with a box in the middle of the window, which has a title and is smaller in a small window.

    width, height: of the box; inside: from margin to margin [layout units]. box: what widgets on it are in. The other
    arguments are those of Sheet.
    """

    def __init__(
        self, ui: Ui, title: str, width: float, height: float, reopen: Reopen,
        close: Callable[[], object] | None = None, *, is_page: bool = False, is_question: bool = False,
    ) -> None:  # fmt: skip
        self._ui = ui
        self.width, self.height = min(width, ui.units[0] - AROUND), min(height, ui.units[1] - AROUND)
        self.inside = self.width - 2 * MARGIN
        self.sheet = ui.open_sheet(close, is_page=is_page, reopen=reopen, is_question=is_question)
        left, top = (ui.units[0] - self.width) / 2, (ui.units[1] - self.height) / 2
        self.box = ui.panel(ui.rect(left, top, self.width, self.height), self.sheet, "dialog")
        ui.label(self.place(MARGIN - 6, 28), title, self.box, "title")

    def place(self, top: float, height: float) -> pygame.Rect:
        """A place from margin to margin, below the top of the box [layout units]."""
        return self._ui.rect(MARGIN, top, self.inside, height)

    def end(self, action: Callable[[], object] | None = None) -> None:
        """Close the page, then carry out the chosen action."""
        self.sheet.remove()
        if action is not None:
            action()

    def add_buttons(self, *choices: Choice, style: str = "primary") -> Button:
        """Add buttons at the bottom, from the right, the first of them in a style; gives that."""
        ui, right = self._ui, self.width - MARGIN
        buttons: list[Button] = []
        for label, action in choices:
            wide = max(BUTTON_WIDTH, _button_width(ui, label))
            place = ui.rect(right - wide, self.height - MARGIN - BUTTON, wide, BUTTON)
            buttons.append(ui.button(place, label, action, self.box, style="" if buttons else style))
            right -= wide + COLUMN_GAP
        return buttons[0]


def _button_width(ui: Ui, label: str) -> float:
    return ui.font(BUTTON_TEXT).size(label)[0] / ui.scale + BUTTON_ROOM


def _inside(ui: Ui) -> int:
    """How wide texts are on a box [pixels]."""
    return ui.px(min(WIDTH, ui.units[0] - AROUND) - 2 * MARGIN)


def show_lines(ui: Ui, title: str, lines: list[str], other: Choice | None = None) -> None:
    """Show lines until they are closed; more than fit are counted; other: what else can be done, on a second button."""
    shown = lines[:MOST_LINES] + ([f"... and {len(lines) - MOST_LINES} more"] if len(lines) > MOST_LINES else [])
    text = "\n".join(shown)
    tall = text_height(text, ui.font(13.0), _inside(ui))
    # What does not fit is scrolled to.
    around = MARGIN * 2 + 84
    dialog = Dialog(
        ui, title, WIDTH, around + 10 + tall / ui.scale, lambda other_ui: show_lines(other_ui, title, lines, other)
    )
    place = dialog.place(MARGIN + 34, dialog.height - around)
    place.width += ui.px(BAR_WIDTH)
    area = ScrollArea(ui, place, dialog.box)
    TextBlock(ui, pygame.Rect(0, 0, _inside(ui), tall), text, area.content, 13.0, TEXT)
    area.set_height(tall)
    others = [] if other is None else [(other[0], partial(dialog.end, other[1]))]
    ui.focus_on(dialog.add_buttons(("Close", dialog.end), *others))


def ask(
    ui: Ui, title: str, hint: str, text: str, verb: str, answer: Callable[[str], str | None],
    other: Choice | None = None, then: Callable[[str], object] | None = None,
) -> None:  # fmt: skip
    """Ask for a line of text, as `fill_in` asks for several."""
    fill_in(ui, title, hint, [("", text)], verb, answer, other, then)


def fill_in(
    ui: Ui, title: str, hint: str, fields: Sequence[tuple[str, str]], verb: str, answer: Callable[..., str | None],
    other: Choice | None = None, then: Callable[..., object] | None = None,
) -> None:  # fmt: skip
    """Ask for lines of text, (label, text) each; answer(*texts) gives None where they are taken.

    answer: what it gives else is what is wrong with them, and the box stays. other: the second button and what it does,
    instead of one that leaves everything as it is, as Escape does. then: called with texts that were taken, once the
    box is closed.
    """

    def accept(_: object = None) -> None:
        texts = [entry.typed.strip() for entry in entries]
        fault = answer(*texts)
        if fault is None:
            dialog.end(None if then is None else partial(then, *texts))
        else:
            note.show_text(fault)

    def reopen(other_ui: Ui) -> None:
        typed = [(label, entry.typed) for (label, _), entry in zip(fields, entries, strict=True)]
        fill_in(other_ui, title, hint, typed, verb, answer, other, then)

    said = text_height(hint, ui.font(HINT_TEXT), _inside(ui)) / ui.scale + 4
    dialog = Dialog(ui, title, WIDTH, 184 + said + len(fields) * FIELD_ROW, reopen)
    TextBlock(ui, dialog.place(MARGIN + 28, said), hint, dialog.box, HINT_TEXT)
    top, entries = MARGIN + 32 + said, []
    for label, text in fields:
        place = dialog.place(top, 34)
        if label:
            place.width //= 2
            ui.label(place, label, dialog.box)
            place = place.move(place.width, 0)
        entries.append(ui.field(place, text, lambda _: True, dialog.box, 400))
        entries[-1].enter = accept
        top += FIELD_ROW
    note = TextBlock(ui, dialog.place(top, 50), "", dialog.box, 12.0, WARNING)
    second, action = other or ("Cancel", None)
    dialog.add_buttons((verb, accept), (second, partial(dialog.end, action)))
    ui.focus_on(entries[0])


def choose(
    ui: Ui, title: str, text: str, choices: Sequence[Choice], columns: int = 1, *, is_question: bool = False
) -> None:
    """Offer choices, (label, what it does) each, the first of them marked; Escape or Cancel leaves all as it is.

    is_question: it stays until it is answered, also where another screen comes.
    """
    beside, widest = _columns_that_fit(ui, [label for label, _ in choices], columns)
    high = -(-len(choices) // beside) * CHOICE_ROW
    lines = 1 + len(text) // LINE_CHARACTERS if text else 0
    around = MARGIN * 2 + 82 + lines * LINE_HEIGHT

    def reopen(other_ui: Ui) -> None:
        choose(other_ui, title, text, choices, columns, is_question=is_question)

    # What does not fit is scrolled to.
    scrolls = around + high > ui.units[1] - AROUND
    dialog = Dialog(ui, title, widest, around + high, reopen, is_question=is_question, is_page=scrolls)
    TextBlock(ui, dialog.place(MARGIN + 32, lines * LINE_HEIGHT + 4), text, dialog.box, 13.0, TEXT)
    top = MARGIN + 40 + lines * LINE_HEIGHT - RING
    place = ui.rect(MARGIN - RING, top, dialog.inside + 2 * RING + BAR_WIDTH, dialog.height - around)
    area, buttons = ScrollArea(ui, place, dialog.box), []
    wide = (dialog.inside - COLUMN_GAP * (beside - 1)) / beside
    for index, (label, action) in enumerate(choices):
        x, y = RING + index % beside * (wide + COLUMN_GAP), RING + index // beside * CHOICE_ROW
        style = "primary" if index == 0 and beside == 1 else ""
        place = ui.rect(x, y, wide, CHOICE_ROW - 8)
        buttons.append(ui.button(place, label, partial(dialog.end, action), area.content, style=style))
    area.set_height(ui.px(high))
    dialog.add_buttons(("Cancel", dialog.end), style="quiet")
    ui.focus_on(buttons[0])


def _columns_that_fit(ui: Ui, labels: Sequence[str], columns: int) -> tuple[int, float]:
    """Columns of buttons with these labels, as many as are asked for or one, and the width of a box for them."""
    longest = max(_button_width(ui, label) for label in labels)
    needed = columns * longest + COLUMN_GAP * (columns - 1) + 2 * MARGIN
    return (columns if needed <= ui.units[0] - AROUND else 1), max(WIDTH, needed if columns > 1 else 0.0)


def choose_row(ui: Ui, title: str, rows: Sequence[Row], take: Callable[[int], object]) -> None:
    """Offer a list of any length, which scrolls; take(index) is called once a row is chosen."""
    around = MARGIN * 2 + 84
    height = around + min(len(rows), MENU_ROWS) * ROW_HEIGHT
    dialog = Dialog(ui, title, WIDTH, height, lambda other_ui: choose_row(other_ui, title, rows, take))
    listed = RowList(
        ui, dialog.place(MARGIN + 34, dialog.height - around), lambda index: dialog.end(partial(take, index)),
        dialog.box, at_once=False,
    )  # fmt: skip
    listed.show_rows(rows, None)
    dialog.add_buttons(("Cancel", dialog.end), style="quiet")
    ui.focus_on(listed)
