"""FindingsPage: what the linter has found; a click selects it and shows where it is."""

from typing import TYPE_CHECKING, Any

import pygame

from sandbox.app.colours import ACCENT, DANGER, WARNING, Colour
from sandbox.app.edit.rows import Row, RowList
from sandbox.editor.finding import Finding
from sandbox.editor.items import items_of

if TYPE_CHECKING:
    from sandbox.app.edit.screen import EditScreen

SEVERITIES: dict[str, Colour] = {"error": DANGER, "warning": WARNING, "hint": ACCENT}
NOTHING = "Nothing to complain about."
LINES = 6


class FindingsPage:
    """Findings, the gravest first."""

    def __init__(self, screen: "EditScreen", place: pygame.Rect, container: Any) -> None:
        self._screen = screen
        self._ui = screen.ui
        self.list = RowList(screen.ui, place, self._show, container, empty=NOTHING, at_once=False, most_lines=LINES)
        self.findings: list[Finding] = []
        self._shown: object = None

    def refresh(self) -> None:
        """Show what has been found by now."""
        found = self._screen.findings
        if found is self._shown:
            return
        self._shown = found
        grades = list(SEVERITIES)
        self.findings = sorted(found, key=lambda finding: grades.index(finding.severity))
        rows = [Row(each.text, each.severity, SEVERITIES[each.severity]) for each in self.findings]
        self.list.show_rows(rows, None)

    def _show(self, index: int) -> None:
        screen, finding = self._screen, self.findings[index]
        known = finding.items.intersection(items_of(screen.document.level))
        if known:
            screen.select(known)
        if finding.place is not None:
            screen.show(finding.place)
        self.list.show_rows(self.list.rows, index)

    def close(self) -> None:
        """Take the page away."""
        self._ui.remove(self.list)
