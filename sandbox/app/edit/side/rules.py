"""RulesPage: what the level asks and does while it runs, as sentences, the chosen one as a form."""

from typing import Any

import pygame

from sandbox.app.contracts.application import Editing
from sandbox.app.draw.colours import ACCENT, DANGER, TEXT, Colour
from sandbox.app.edit.side.side_page import HeadButton, ListHead, SidePage
from sandbox.app.widgets.dialogs import choose
from sandbox.app.widgets.form import Form
from sandbox.app.widgets.rows import Row
from sandbox.editor.edits.rule_edits import Template, delete_rule, templates, why_not
from sandbox.editor.forecast import Firing
from sandbox.editor.panel.rule_form import rule_properties
from sandbox.editor.rule_text import rule_text
from sandbox.level.rules.rule import RuleDef

# Part of the page that the list takes.
LIST_PART = 0.3
# Times that are named of a rule that fired more often.
TIMES = 3
NOTHING = "No rules yet. A rule is a sentence: when the ball is inside the basket, win. Add one."


class RulesPage(SidePage):
    """The rules as a list, the chosen one as a form, then counters and the line that says the goal."""

    def __init__(self, screen: Editing, place: pygame.Rect, container: Any) -> None:
        self._screen, self._ui = screen, screen.ui
        self.chosen = 0
        self._shown: tuple[object, ...] = ()
        buttons = (
            HeadButton("Add", "Add", self._ask, "Add a rule: a goal, a way to lose, a score, a key"),
            HeadButton("Delete", "Delete", self._delete, "Delete the chosen rule"),
        )
        self._head = ListHead(
            self._ui, place, LIST_PART, len(buttons), buttons, self._choose, container, empty=NOTHING, most_lines=2
        )
        self.list, self.buttons = self._head.list, self._head.buttons
        self.form = Form(screen, self._head.area, self._head.top)

    def refresh(self) -> None:
        """Show the rules as they are now."""
        level, firing = self._screen.document.level, self._screen.watch.firing
        fired = firing if firing is not None and firing.is_done and firing.level is level else None
        fresh = (level, self.chosen, fired)
        if not self._shown or fresh[0] is not self._shown[0] or fresh[1:] != self._shown[1:]:
            self._shown = fresh
            self.chosen = min(max(self.chosen, 0), max(len(level.rules) - 1, 0))
            rows = [Row(rule_text(rule), _detail(rule, fired), colour=_colour(rule)) for rule in level.rules]
            self.list.show_rows(rows, self.chosen if rows else None, reveal=True)
            self.buttons["Delete"].is_enabled = bool(rows)
            self.form.show(rule_properties(self._screen.document, self.chosen))
            self._screen.show_rule(self.chosen if rows else None)
        self.form.refresh()

    def _choose(self, index: int) -> None:
        self.chosen = index

    def _ask(self) -> None:
        """Open the menu of ready rules, filled in with names of the level."""
        found = templates(self._screen.document)
        choices = [(each.text, lambda each=each: self._add(each)) for each in found if each.edit is not None]
        choose(self._ui, "Add a rule", why_not(self._screen.document), choices)

    def _add(self, template: Template) -> None:
        if template.edit is not None and self._screen.edit("Add a rule", template.edit):
            self.chosen = len(self._screen.document.level.rules) - 1

    def _delete(self) -> None:
        chosen = self.chosen
        self._screen.edit("Delete a rule", lambda document: delete_rule(document, chosen))

    def close(self) -> None:
        """Take the page away."""
        self._screen.show_rule(None)


def _detail(rule: RuleDef, fired: Firing | None) -> str:
    """The name of a rule, and when it fires in the run that was played last."""
    if fired is None:
        return rule.id
    if fired.fault:
        return f"{rule.id}: {fired.fault}"
    times = fired.times[rule.id]
    if not times:
        return f"{rule.id}: did not fire in the last run"
    more = f" and {len(times) - TIMES} more times" if len(times) > TIMES else ""
    return f"{rule.id}: fired at {', '.join(f'{time:.1f}' for time in times[:TIMES])} s{more}"


def _colour(rule: RuleDef) -> Colour:
    if any(action.win is not None for action in rule.then):
        return ACCENT
    return DANGER if any(action.fail is not None for action in rule.then) else TEXT
