"""RangePage: several values of one number, tried at once: where things go with each, and which checks hold."""

from functools import partial
from typing import Any

import pygame

from sandbox.app.base.sentences import sentence
from sandbox.app.contracts.application import Editing
from sandbox.app.draw.colours import DANGER, MUTED, TEXT
from sandbox.app.edit.canvas.trails import MOST, attempt_colour
from sandbox.app.edit.side.side_page import SidePage
from sandbox.app.widgets.property_widgets import GAP, ROW
from sandbox.app.widgets.rows import Row, RowList
from sandbox.app.widgets.texts import TextBlock
from sandbox.editor.document import Document, EditError
from sandbox.editor.panel.typed import number_text, read_integer, read_number
from sandbox.editor.range_trial import Attempt, Number, RangeTrial, between, numbers

CHOOSE = "Choose the number to try. The level runs once for each value, with its checks."
NO_NUMBERS = "There is no number to try here."
LABEL = 92.0
HEAD = 44.0
# What is offered of a number at first: this share of it down and up, or to 1 where it is 0.
SPAN = 0.5
FIRST_COUNT = "7"


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
            self._begin(trial.number, number_text(values[0]), number_text(values[-1]), str(len(values)))

    # Choosing the number.

    def _offer(self) -> None:
        self._container.clear()
        ui, width = self._ui, self._place.width - self._ui.px(6)
        head = pygame.Rect(self._place.topleft, (width, ui.px(HEAD)))
        TextBlock(ui, head, CHOOSE, self._container, 12.0)
        place = pygame.Rect(head.left, head.bottom, width, self._place.height - head.height - ui.px(6))
        self.list = RowList(ui, place, self._take_number, self._container, empty=NO_NUMBERS, at_once=False)
        self._shown = None

    def _take_number(self, index: int) -> None:
        number = self._numbers[index]
        value = number.value
        low, high = (value * (1 - SPAN), value * (1 + SPAN)) if value else (0.0, 1.0)
        self._begin(number, number_text(float(f"{low:.3g}")), number_text(float(f"{high:.3g}")), FIRST_COUNT)

    # Trying it.

    def _begin(self, number: Number, low: str, high: str, count: str) -> None:
        self._container.clear()
        self._number = number
        ui, place, gap, row = self._ui, self._place, self._ui.px(GAP), self._ui.px(ROW)
        width, top = place.width - ui.px(6), place.top
        ui.label(pygame.Rect(place.left, top, width, row), number.title, self._container, "title")
        top += row + gap
        self.fields = {}
        for name, text in (("From", low), ("To", high), ("How many", count)):
            ui.label(pygame.Rect(place.left, top, ui.px(LABEL), row), name, self._container, "muted")
            at = pygame.Rect(place.left + ui.px(LABEL), top, width - ui.px(LABEL), row)
            field = ui.field(at, text, lambda _: True, self._container, 40)
            field.enter = lambda _: self._try()
            self.fields[name] = field
            top += row + gap
        half = (width - gap) // 2
        tip = "Run the level once with each value"
        self._add_button("Try", pygame.Rect(place.left, top, half, row), self._try, tip)
        self._add_button("Another number", pygame.Rect(place.left + half + gap, top, half, row), self._again, "")
        top += row + 2 * gap
        bottom = place.bottom - row - ui.px(6)
        list_place = pygame.Rect(place.left, top, width, bottom - gap - top)
        empty = "For each value the sheet shows where the selection goes."
        self.list = RowList(ui, list_place, self._choose, self._container, empty=empty, most_lines=2)
        self._add_button("Take this value", pygame.Rect(place.left, bottom, half, row), self._take, "")
        self._add_button("Close", pygame.Rect(place.left + half + gap, bottom, half, row), self._leave, "")
        self._shown = None

    def _add_button(self, text: str, place: pygame.Rect, do: Any, tip: str) -> None:
        self._ui.button(place, text, do, self._container, style="segment", tip=tip)

    def _try(self) -> None:
        number, screen = self._number, self._screen
        assert number is not None
        # It is tried in the level as it is now.
        now = next((each for each in numbers(screen.document) if each.title == number.title), number)
        try:
            low, high = (read_number(name, self.fields[name].typed) for name in ("From", "To"))
            count = read_integer("How many", self.fields["How many"].typed)
            values = between(low, high, count, whole=now.about.about.kind == "integer")
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
        if screen.edit(f"{number.title}: {number_text(value)}", partial(_set, number, value)):
            screen.say(f"{number.title} is {number_text(value)} now.")

    def _leave(self) -> None:
        self._screen.turn_to("properties")

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


def _set(number: Number, value: float, document: Document) -> Document:
    return number.set(document, value)


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
