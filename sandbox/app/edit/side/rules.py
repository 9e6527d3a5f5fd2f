"""RulesPage: what the level asks and does while it runs, as sentences, the chosen one as a form."""

from collections.abc import Callable, Sequence
from typing import Any

import pygame

from sandbox.app.contracts.application import Editing
from sandbox.app.draw.colours import ACCENT, DANGER, TEXT, Colour
from sandbox.app.edit.side.side_page import SidePage
from sandbox.app.widgets.dialogs import choose
from sandbox.app.widgets.form import Form
from sandbox.app.widgets.property_widgets import GAP, ROW
from sandbox.app.widgets.rows import Row, RowList
from sandbox.app.widgets.scroll import ScrollArea
from sandbox.app.widgets.ui import Ui
from sandbox.editor.edits.rule_edits import Template, delete_rule, duplicate_rule, templates, why_not
from sandbox.editor.forecast import Firing
from sandbox.editor.panel.rule_form import counter_properties, rule_properties
from sandbox.editor.rule_text import rule_text
from sandbox.level.rules.rule import RuleDef

# Times that are named of a rule that fired more often.
TIMES = 3
# Lines that the open rule may take.
LINES = 4
NEVER = "would not fire with what hands did in"
WORKING = "playing the last run again..."
NOTHING = "No rules yet. A rule is a sentence: when the ball is inside the basket, win. Add one."


class _Lines(RowList):
    """Rules as lines. step(by): another rule is to be opened; an arrow at the end of one list goes on in the other."""

    def __init__(
        self, ui: Ui, width: int, choose: Callable[[int], None], step: Callable[[int], None], container: Any
    ) -> None:
        super().__init__(ui, pygame.Rect(0, 0, width, 1), choose, container, empty=NOTHING)
        self._step = step

    def press_key(self, event: pygame.event.Event) -> bool:
        """Up and down open the rule before and after."""
        steps = {pygame.K_UP: -1, pygame.K_DOWN: 1}
        if event.key not in steps:
            return super().press_key(event)
        self._step(steps[event.key])
        return True


class RulesPage(SidePage):
    """All rules as lines, of which one is open: below it stands its form; then counters."""

    def __init__(self, screen: Editing, place: pygame.Rect, container: Any) -> None:
        self._screen, self._ui = screen, screen.ui
        # The rule that is open; -1: none is.
        self.chosen = 0
        self._shown: tuple[object, ...] = ()
        ui, gap = self._ui, self._ui.px(GAP)
        buttons = {
            "Add": (self._ask, "Add a rule: a goal, a way to lose, a score, a key"),
            "Duplicate": (self._duplicate, "Add a copy of the open rule"),
            "Delete": (self._delete, "Delete the open rule"),
        }
        width = (place.width - ui.px(12) - 2 * gap) // len(buttons)
        at = pygame.Rect(place.topleft, (width, ui.px(ROW)))
        self.buttons = {}
        for text, (do, tip) in buttons.items():
            self.buttons[text] = ui.button(at, text, do, container, style="segment", tip=tip)
            at = at.move(width + gap, 0)
        top = at.bottom + gap
        self._area = ScrollArea(ui, pygame.Rect(place.left, top, place.width, place.bottom - top), container)
        wide = self._area.view.rect.width - ui.px(4)
        self.list = _Lines(ui, wide, self._choose, self._step, self._area.content)
        self._rest = _Lines(ui, wide, self._choose_below, self._step, self._area.content)
        self.form, self.tail = Form(screen, self._area), Form(screen, self._area)
        self._end = 0.0

    def refresh(self) -> None:
        """Show the rules as they are now."""
        level, firing = self._screen.document.level, self._screen.watch.firing
        fired = firing if firing is not None and firing.level is level else None
        fresh = (level, self.chosen, fired, fired is not None and fired.is_done)
        if not self._shown or fresh[0] is not self._shown[0] or fresh[1:] != self._shown[1:]:
            is_other = not self._shown or self.chosen != self._shown[1]
            self.chosen = min(self.chosen, len(level.rules) - 1)
            self._shown = (level, self.chosen, *fresh[2:])
            self._show(level.rules, fired)
            if is_other and self.chosen >= 0:
                self._reveal_open()
            for name in ("Duplicate", "Delete"):
                self.buttons[name].is_enabled = self.chosen >= 0
            self._screen.show_rule(self.chosen if self.chosen >= 0 else None)
        self.form.refresh()
        self.tail.refresh()
        if self.form.end != self._end:
            # A part of the form was folded.
            self._place_rest()

    def _show(self, rules: Sequence[RuleDef], fired: Firing | None) -> None:
        """Lay out the lines up to the open rule, its form, and the other lines; without one all above."""
        rows = [_row(rule, fired, number == self.chosen) for number, rule in enumerate(rules)]
        above, least = self.chosen + 1 or len(rows), 0 if rows else self._ui.px(2 * ROW)
        self.list.show_rows(rows[:above], self.chosen if self.chosen >= 0 else None)
        self._rest.show_rows(rows[above:], None)
        self._rest.visible = len(rows) > above
        for lines in (self.list, self._rest):
            lines.resize((lines.place.width, max(lines.height, least, 1)))
        self.form.make_room(self.list.place.height / self._ui.scale + GAP)
        self.form.show(rule_properties(self._screen.document.level, self.chosen))
        self._place_rest()

    def _reveal_open(self) -> None:
        """Bring the open line into the upper half of the page, with its form below it."""
        top = self.list.height - self._ui.px(ROW) * LINES
        if not self._area.offset <= top <= self._area.offset + self._area.view.rect.height / 2:
            self._area.scroll_to(top)

    def _place_rest(self) -> None:
        """Put the lines behind the open rule, and counters, below the form."""
        self._end = self.form.end
        self._rest.move_to((0, self._ui.px(self._end)))
        self.tail.make_room(self._end + self._rest.place.height / self._ui.scale + GAP)
        self.tail.show(counter_properties(self._screen.document.level))

    @property
    def rows(self) -> list[Row]:
        """The lines of all rules."""
        return [*self.list.rows, *self._rest.rows]

    def _choose_below(self, index: int) -> None:
        self._choose(len(self.list.rows) + index)

    def _step(self, by: int) -> None:
        """Open the rule that many lines further."""
        last = len(self._screen.document.level.rules) - 1
        self.chosen = min(max(self.chosen + by, 0), last)
        self._ui.focus_on(self.list, by_hand=True)

    def _duplicate(self) -> None:
        chosen = self.chosen
        if self._screen.edit("Duplicate a rule", lambda document: duplicate_rule(document, chosen)):
            self.chosen = chosen + 1

    def _choose(self, index: int) -> None:
        """Open a rule, or fold the open one."""
        self.chosen = -1 if index == self.chosen else index
        self._ui.focus_on(self.list, by_hand=True)

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


def _row(rule: RuleDef, fired: Firing | None, is_open: bool) -> Row:
    """A line of a rule; of the open one with its name, and when it fires in the run that was played last."""
    times = [] if fired is None else fired.times[rule.id]
    is_known = fired is not None and fired.is_done
    if not is_open:
        aside = "" if fired is None or not is_known else f"{times[0]:.1f} s" if times else "not"
        return Row(rule_text(rule), aside=aside, colour=_colour(rule))
    if fired is None:
        detail = rule.id
    elif not is_known:
        detail = f"{rule.id}: {WORKING}"
    elif fired.fault:
        detail = f"{rule.id}: {fired.fault}"
    elif not times:
        detail = f"{rule.id}: {NEVER} {fired.span}"
    else:
        more = f" and {len(times) - TIMES} more times" if len(times) > TIMES else ""
        detail = f"{rule.id}: fired at {', '.join(f'{time:.1f}' for time in times[:TIMES])} s{more}"
    return Row(rule_text(rule), detail, colour=_colour(rule), lines=LINES)


def _colour(rule: RuleDef) -> Colour:
    if any(action.win is not None for action in rule.then):
        return ACCENT
    return DANGER if any(action.fail is not None for action in rule.then) else TEXT
