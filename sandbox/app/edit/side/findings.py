"""FindingsPage: what the linter has found; a click selects it and shows where it is, a button mends what it can."""

from typing import Any

import pygame

from sandbox.app.contracts.application import Editing
from sandbox.app.draw.colours import ACCENT, DANGER, MUTED, WARNING, Colour
from sandbox.app.edit.side.side_page import SidePage
from sandbox.app.widgets.property_widgets import GAP, ROW
from sandbox.app.widgets.rows import Row, RowList
from sandbox.editor.items import items_of
from sandbox.editor.lint.finding import SEVERITIES, Finding, Remedy

COLOURS: dict[str, Colour] = {"error": DANGER, "warning": WARNING, "hint": ACCENT}
NOTHING = "No problems found."
LINES = 6
# Width of the button that ignores a finding [layout units].
IGNORE_WIDTH = 72.0
NO_REMEDY = "Choose a finding to see it"


class FindingsPage(SidePage):
    """Findings, the gravest first."""

    def __init__(self, screen: Editing, place: pygame.Rect, container: Any) -> None:
        self._screen = screen
        self._ui = screen.ui
        ui, below = screen.ui, screen.ui.px(ROW + 2 * GAP)
        upper = pygame.Rect(place.topleft, (place.width - ui.px(6), place.height - below))
        self.list = RowList(ui, upper, self._show, container, empty=NOTHING, at_once=False, most_lines=LINES)
        gap, top, tall = ui.px(GAP), place.bottom - ui.px(ROW + 4), ui.px(ROW)
        narrow = ui.px(IGNORE_WIDTH)
        row = pygame.Rect(place.left, top, upper.width - narrow - gap, tall)
        self.mend = ui.button(row, "", self._mend, container, style="segment", tip="Fix the finding chosen above")
        row = pygame.Rect(row.right + gap, top, narrow, tall)
        tip = "Do not show the chosen finding again while this level is open"
        self.ignore = ui.button(row, "Ignore", self._ignore, container, style="segment", tip=tip)
        self._chosen: Finding | None = None
        self._offer(None)
        self.findings: list[Finding] = []
        self._shown: object = None

    def refresh(self) -> None:
        """Show what has been found by now."""
        found = self._screen.watch.findings
        if found is self._shown:
            return
        self._shown = found
        grades = list(SEVERITIES)
        self.findings = sorted(found, key=lambda finding: grades.index(finding.severity))
        rows = [Row(each.text, each.severity, COLOURS[each.severity]) for each in self.findings]
        if self._screen.watch.ignored:
            rows.append(Row(f"{self._screen.watch.ignored} ignored: show them again", colour=MUTED))
        self.list.show_rows(rows, None)
        self._offer(None)

    def _show(self, index: int) -> None:
        if index == len(self.findings):
            self._screen.watch.show_ignored()
            return
        screen, finding = self._screen, self.findings[index]
        self._chosen = finding
        known = finding.items.intersection(items_of(screen.document.level))
        if known:
            screen.select(known)
        if finding.place is not None:
            screen.show(finding.place)
        self.list.show_rows(self.list.rows, index)
        self._offer(finding.remedy)

    def _offer(self, remedy: Remedy | None) -> None:
        """Let the button mend the chosen finding, where an edit can."""
        self._remedy = remedy
        self.mend.show_text(NO_REMEDY if remedy is None else remedy.label)
        self.mend.is_enabled = remedy is not None

    def _ignore(self) -> None:
        if self._chosen is not None:
            self._screen.watch.ignore(self._chosen)
            self._chosen = None

    def _mend(self) -> None:
        if self._remedy is not None:
            self._screen.edit(self._remedy.label, self._remedy.edit)
