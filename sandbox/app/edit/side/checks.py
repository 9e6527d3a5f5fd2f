"""ChecksPage: what the level promises of its own run, and whether it holds."""

import threading
from typing import Any

import pygame

from sandbox.app.contracts.application import Editing
from sandbox.app.draw.colours import ACCENT, DANGER, DISABLED
from sandbox.app.edit.side.side_page import HeadButton, ListHead, SidePage
from sandbox.app.edit.side.solution_strip import STRIP, SolutionStrip
from sandbox.app.widgets.form import Form
from sandbox.app.widgets.rows import Row
from sandbox.editor.document import Document
from sandbox.editor.panel.check_form import add_check, check_properties, delete_check
from sandbox.level.checks import METRICS, CheckDef, CheckResult, held_text, promise_text, time_text, value_text
from sandbox.level.document.model import Level
from sandbox.level.format.level_error import LevelError
from sandbox.level.plan.actuators import driving_keys
from sandbox.session.check_run import checks_as_they_end
from sandbox.session.level_edits import runs_alike

# Part of the page that the list takes.
LIST_PART = 0.38
# Digits of what a check measured, as long as they show why it fails.
SHOWN_DIGITS = 4
NOTHING = "No checks yet. A check runs the level and says whether the car is past x = 12 after 8 s, for example."


class Trial:
    """Runs a level's checks in a thread of its own; `results` fills up as they are decided."""

    def __init__(self, level: Level) -> None:
        self.level = level
        self.results: dict[CheckDef, CheckResult] = {}
        self.fault: str | None = None
        self.is_stopped = False
        self._thread = threading.Thread(target=self._work, name="checks", daemon=True)
        self._thread.start()

    @property
    def is_running(self) -> bool:
        """Whether results of checks are still to come."""
        return self._thread.is_alive()

    def wait(self) -> None:
        """Wait until all runs have ended."""
        self._thread.join()

    def _work(self) -> None:
        try:
            for found in checks_as_they_end(self.level):
                if self.is_stopped:
                    return
                if found is not None:
                    self.results = {**self.results, found[1].check: found[1]}
        except LevelError as error:
            self.fault = error.faults[0]
        except (ArithmeticError, MemoryError) as error:
            self.fault = f"the level cannot be run: {error}"


class ChecksPage(SidePage):
    """The checks as a list, the chosen one as a form."""

    def __init__(self, screen: Editing, place: pygame.Rect, container: Any) -> None:
        self._screen, self._ui = screen, screen.ui
        self.trial: Trial | None = None
        self.chosen = 0
        self._shown: tuple[object, ...] = ()
        buttons = (
            HeadButton("Add", "Add", self._add, "Add a check"),
            HeadButton("Delete", "Delete", self._delete, "Delete the chosen check"),
            HeadButton("Run now", "Run now", self._run, "Run the level from its beginning and measure"),
        )
        self._head = ListHead(
            self._ui, place, LIST_PART, len(buttons), buttons, self._choose, container, empty=NOTHING, most_lines=2
        )
        self.list, self.buttons = self._head.list, list(self._head.buttons.values())
        area, top = self._head.area, self._head.top
        # A level that nobody can win has no solution.
        strip = STRIP if screen.document.level.has_goal else 0.0
        place = pygame.Rect(0, self._ui.px(top), area.view.rect.width - self._ui.px(2), self._ui.px(strip))
        self.solution = SolutionStrip(screen, place, area.content) if strip else None
        self.form = Form(screen, area, top + strip)

    def refresh(self) -> None:
        """Show the checks and their results as they are now."""
        document, trial = self._screen.document, self.trial
        if trial is not None and not runs_alike(trial.level, document.level):
            trial.is_stopped = True
            trial = self.trial = None
        results = {} if trial is None else trial.results
        is_running = trial is not None and trial.is_running
        fresh = (document.level.checks, document.selection, self.chosen, results, is_running)
        if fresh != self._shown:
            self._shown = fresh
            self._show(document, results, is_running)
            if trial is not None and trial.fault is not None and not is_running:
                self._screen.say(trial.fault)
        self.form.refresh()
        if self.solution is not None:
            self.solution.refresh()

    def _show(self, document: Document, results: dict[CheckDef, CheckResult], is_running: bool) -> None:
        checks = document.level.checks
        self.chosen = min(max(self.chosen, 0), max(len(checks) - 1, 0))
        has_keys = bool(driving_keys(document.level))
        rows = [_row(check, results.get(check), is_running, has_keys) for check in checks]
        self.list.show_rows(rows, self.chosen if checks else None, reveal=True)
        for button in self.buttons[1:]:
            button.is_enabled = bool(checks)
        self.buttons[2].show_text("Running" if is_running else "Run now")
        self.form.show(check_properties(document, self.chosen))
        self._screen.show_box(checks[self.chosen].box if checks else None)

    def _choose(self, index: int) -> None:
        self.chosen = index

    def _add(self) -> None:
        if self._screen.edit("Add a check", add_check):
            self.chosen = len(self._screen.document.level.checks) - 1

    def _delete(self) -> None:
        chosen = self.chosen
        self._screen.edit("Delete a check", lambda document: delete_check(document, chosen))

    def _run(self) -> None:
        if self.trial is None or not self.trial.is_running:
            self.trial = Trial(self._screen.document.level)

    def close(self) -> None:
        """Take the page away."""
        if self.trial is not None:
            self.trial.is_stopped = True
        self._screen.show_box(None)


def _row(check: CheckDef, result: CheckResult | None, is_running: bool, has_keys: bool) -> Row:
    promise = f"{promise_text(check)}, {time_text(check)}"
    if check.hold:
        promise += f", while {held_text(check)} is held"
    elif has_keys and result is not None and not result.passed:
        promise += ". Nobody pressed a key: hold one in the check"
    if result is None:
        return Row(check.name, f"running: {promise}" if is_running else promise, DISABLED)
    value = value_text(check, result.value, SHOWN_DIGITS)
    verdict = f"{'holds' if result.passed else 'fails'} with {value} {METRICS[check.metric].unit}".rstrip()
    return Row(check.name, f"{verdict}: {promise}", ACCENT if result.passed else DANGER)
