"""RangePage: several values of one number, tried at once: where things go with each, and which checks hold."""

from functools import partial
from typing import Any

import pygame

from sandbox.app.base.sentences import sentence
from sandbox.app.contracts.application import Editing
from sandbox.app.draw.colours import DANGER, MUTED, TEXT
from sandbox.app.edit.canvas.trails import MOST, attempt_colour
from sandbox.app.edit.side.side_page import ChosenRow, HeadButton, ListHead, SidePage
from sandbox.app.widgets.field import Field
from sandbox.app.widgets.form import Form
from sandbox.app.widgets.property_widgets import OwnValues
from sandbox.app.widgets.rows import Row, RowList
from sandbox.app.widgets.texts import TextBlock
from sandbox.editor.document import Document, EditError
from sandbox.editor.panel.field_info import FieldInfo
from sandbox.editor.panel.property import Property, Section
from sandbox.editor.panel.typed import number_text
from sandbox.editor.range_trial import MOST_VALUES, Attempt, Number, RangeTrial, between, numbers
from sandbox.level.format.quantities import significant

CHOOSE = "Choose the number to try. The level runs once for each value, with its checks."
NO_NUMBERS = "There is no number to try here."
HEAD = 44.0
# What is offered of a number at first: this share of it down and up, or to 1 where it is 0.
SPAN = 0.5
FIRST_COUNT, DIGITS = 7, 3
RANGE = (
    FieldInfo("number", "From", tooltip="The first value."),
    FieldInfo("number", "To", tooltip="The last value."),
    FieldInfo("integer", "How many", "", 2, MOST_VALUES, tooltip="Values from one to the other, at even distances."),
)
# Part of the page that the list of values takes.
LIST_PART = 0.5


class RangePage(SidePage):
    """The numbers to choose from, and once one is chosen the range, and what came of each value."""

    def __init__(self, screen: Editing, place: pygame.Rect, container: Any) -> None:
        self._screen, self._ui, self._place, self._container = screen, screen.ui, place, container
        self._numbers: list[Number] = []
        self._number: Number | None = None
        self._chosen: int | None = None
        self._shown: object = None
        trial = screen.watch.range_trial
        if trial is None:
            self._offer()
        else:
            values = [attempt.value for attempt in trial.attempts]
            self._begin(trial.number, values[0], values[-1], len(values))

    # Choosing the number.

    def _offer(self) -> None:
        self._container.clear()
        ui, width = self._ui, self._place.width - self._ui.px(6)
        head = pygame.Rect(self._place.topleft, (width, ui.px(HEAD)))
        TextBlock(ui, head, CHOOSE, self._container, 12.0)
        place = pygame.Rect(head.left, head.bottom, width, self._place.height - head.height - ui.px(6))
        self.list: RowList | ChosenRow = RowList(
            ui, place, self._take_number, self._container, empty=NO_NUMBERS, at_once=False
        )
        self._shown = None

    def _take_number(self, index: int) -> None:
        number = self._numbers[index]
        value = number.value
        low, high = (value * (1 - SPAN), value * (1 + SPAN)) if value else (0.0, 1.0)
        self._begin(number, significant(low, DIGITS), significant(high, DIGITS), FIRST_COUNT)
        self._ui.focus_on(self.form.fields["From"][0])

    # Trying it.

    def _begin(self, number: Number, low: float, high: float, count: int) -> None:
        self._container.clear()
        self._number, self._range = number, {"From": low, "To": high, "How many": count}
        buttons = (
            HeadButton("Try", "Try", self._try, "Run the level once with each value"),
            HeadButton("Another number", "Other", self._again, ""),
            HeadButton("Take this value", "Take", self._take, ""),
            HeadButton("Close", "Close", lambda: self._screen.turn_to("properties"), ""),
        )
        empty = "For each value the sheet shows where the selection goes."
        head = ListHead(
            self._ui, self._place, LIST_PART, 2, buttons, self._choose, self._container, empty=empty, most_lines=2
        )
        self.list, self.buttons, self.area = head.list, head.buttons, head.area
        self.form = Form(OwnValues(self._screen), head.area, head.top)
        self._show_range()
        for (field,) in self.form.fields.values():
            field.enter = partial(self._enter, field)
        self._shown = None

    def _show_range(self) -> None:
        assert self._number is not None
        found = [
            Property(about.title, about, self._range[about.title], partial(self._put, about.title)) for about in RANGE
        ]
        self.form.show([Section(self._number.title, tuple(found))])

    def _put(self, name: str, document: Document, value: float) -> None:
        self._range[name] = value
        self._show_range()

    def _enter(self, field: Field, text: str) -> None:
        if field.commit(text):
            self._try()

    def _try(self) -> None:
        number, screen = self._number, self._screen
        assert number is not None
        # It is tried in the level as it is now.
        now = next((each for each in numbers(screen.document) if each.title == number.title), number)
        try:
            low, high, count = self._range.values()
            values = between(low, high, int(count), whole=now.about.about.kind == "integer")
        except EditError as error:
            screen.say(sentence(error))
            return
        self._chosen = None
        screen.watch.range_trial = RangeTrial(screen.document, now, values)
        screen.show_attempt(None)

    def _again(self) -> None:
        self._screen.watch.range_trial = None
        self._number = None
        self._offer()

    def _choose(self, index: int) -> None:
        self._chosen = index
        self._shown = None
        self._screen.show_attempt(index)

    def _take(self) -> None:
        trial, screen = self._screen.watch.range_trial, self._screen
        if trial is None or self._chosen is None:
            screen.say("Choose a value above first.")
            return
        value, number = trial.attempts[self._chosen].value, trial.number
        if screen.edit(f"{number.title}: {number_text(value)}", lambda document: number.set(document, value)):
            screen.say(f"{number.title} is {number_text(value)} now.")

    # Showing.

    def refresh(self) -> None:
        """Show the numbers that there are, or what has come of the values so far."""
        if self._number is None:
            if self._screen.document is not self._shown:
                self._shown = self._screen.document
                self._numbers = numbers(self._screen.document)
                rows = [Row(number.title, aside=number_text(number.value)) for number in self._numbers]
                self.list.show_rows(rows, None)
            return
        self.form.refresh()
        trial = self._screen.watch.range_trial
        done = None if trial is None else (trial, trial.done, self._chosen)
        if done != self._shown or done is None:
            self._shown = done
            attempts = [] if trial is None else trial.attempts
            rows = [self._row(trial, number) for number in range(len(attempts))]  # type: ignore[arg-type]
            self.list.show_rows(rows, self._chosen)

    def _row(self, trial: RangeTrial, number: int) -> Row:
        attempt, count = trial.attempts[number], len(trial.attempts)
        colour, text = attempt_colour(number, count), number_text(attempt.value)
        if number >= trial.done:
            return Row(text, swatch=colour, colour=MUTED, aside="running" if number == trial.done else "")
        if attempt.fault:
            return Row(text, attempt.fault, colour, DANGER, "not possible")
        return Row(text, _way_text(attempt, trial.document), colour, TEXT, _checks_text(attempt))


def _checks_text(attempt: Attempt) -> str:
    count = len(attempt.results)
    if not count:
        return ""
    return f"{count - attempt.failed} of {count} checks hold" if count > 1 else "fails" if attempt.failed else "holds"


def _way_text(attempt: Attempt, document: Document) -> str:
    """Where the first thing that was selected got to, from its beginning."""
    lines = [] if attempt.trail is None else attempt.trail.lines(document.selection, MOST)
    if not lines:
        return "" if attempt.trail is None else attempt.trail.fault
    way = lines[0] - lines[0][0]
    return f"goes {way[-1, 0]:+.3g} m, at most {way[:, 1].max():.3g} m up"
