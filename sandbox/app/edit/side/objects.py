"""Pages that are lists: everything in the level, the steps of the history, problems that may have been overlooked."""

from collections.abc import Callable
from functools import partial
from typing import Any

import pygame

from sandbox.app.base.sentences import sentence
from sandbox.app.contracts.application import Editing
from sandbox.app.draw.colours import ACCENT, DANGER, DISABLED, MUTED, TEXT, WARNING, Colour
from sandbox.app.draw.looks import material_colours
from sandbox.app.edit.side.side_page import SidePage
from sandbox.app.widgets.dialogs import ask
from sandbox.app.widgets.property_widgets import GAP, ROW
from sandbox.app.widgets.rows import Row, RowList
from sandbox.editor.document import Document, EditError
from sandbox.editor.edits.fields import rename, set_field
from sandbox.editor.edits.grouping import rename_group, shift
from sandbox.editor.items import Item, Selection, items_of
from sandbox.editor.lint.finding import SEVERITIES, Finding, Remedy
from sandbox.editor.objects import ObjectLine, object_lines

HINT = "Find by name, kind or material"
EMPTY = "Nothing is on the sheet yet. Draw something, or put a ready part there from the page Parts."
NOT_FOUND = "Nothing matches these words."
# More lines are not listed; words find the others.
LISTED = 2_000
# Of one thing, which words on it take away again what the button gives.
HIDE, SHOW, LOCK, OPEN = "Hide", "Show", "Lock", "Unlock"
COLOURS: dict[str, Colour] = {"error": DANGER, "warning": WARNING, "hint": ACCENT}
NOTHING = "No problems found."
LINES = 6
# Width of the button that ignores a finding [layout units].
IGNORE_WIDTH = 72.0
NO_REMEDY = "Choose a finding to see it"


class ObjectsPage(SidePage):
    """A line to search in, the list, and buttons for what is selected."""

    def __init__(self, screen: Editing, place: pygame.Rect, container: Any) -> None:
        self._screen, self._ui = screen, screen.ui
        ui, gap, row = screen.ui, screen.ui.px(GAP), screen.ui.px(ROW)
        width = place.width - ui.px(6)
        self.search = ui.field(pygame.Rect(place.topleft, (width, row)), "", lambda _: True, container, 80, hint=HINT)
        self.search.enter = lambda _: self._choose_first()
        top, bottom = place.top + row + gap, place.bottom - row - 2 * gap
        self.list = RowList(
            ui, pygame.Rect(place.left, top, width, bottom - top), self._choose, container, empty=EMPTY, at_once=False
        )
        actions: tuple[tuple[str, Callable[[], None], str], ...] = (
            (HIDE, self._hide, "Hide the selection while you edit; it still plays"),
            (LOCK, self._lock, "Clicks on the sheet do not select it; this list does"),
            ("Up", partial(self._move, False), "Move it up: it is drawn behind the one above"),
            ("Down", partial(self._move, True), "Move it down: it is drawn in front of the one below"),
            ("Rename", self.ask_name, "Rename it everywhere"),
        )
        wide = (width - (len(actions) - 1) * gap) // len(actions)
        self.buttons = {}
        for number, (text, do, tip) in enumerate(actions):
            at = pygame.Rect(place.left + number * (wide + gap), bottom + gap, wide, row)
            self.buttons[text] = ui.button(at, text, do, container, style="segment", tip=tip)
        self.lines: list[ObjectLine] = []
        self._shown: tuple[object, object] = (None, None)
        self._query = ""
        self._last = 0

    def refresh(self) -> None:
        """Show the level's present things."""
        screen = self._screen
        document, visibility, query = screen.document, screen.visibility, self.search.typed
        if any(old is not new for old, new in zip(self._shown, (document, visibility), strict=True)) or (
            query != self._query
        ):
            self._shown, self._query = (document, visibility), query
            self._show(query)
        pointed = self.list.pointed
        screen.light_up(frozenset() if pointed is None or pointed >= len(self.lines) else self.lines[pointed].items)

    def _show(self, query: str) -> None:
        screen, level = self._screen, self._screen.document.level
        self.lines = object_lines(level, query)
        colours = material_colours(screen.scene.level.materials)
        rows = [self._row(line, colours) for line in self.lines[:LISTED]]
        if len(self.lines) > LISTED:
            rows.append(Row(f"{len(self.lines) - LISTED:,} more: find them by words", colour=DISABLED))
        selected = self._selected
        chosen = frozenset(index for index, line in enumerate(self.lines[:LISTED]) if line.items <= selected)
        first = self._last if self._last in chosen else min(chosen, default=None)
        self.list.empty = NOT_FOUND if query.strip() else EMPTY
        self.list.show_rows(rows, first, reveal=True, also=chosen)
        for button in self.buttons.values():
            button.is_enabled = bool(selected)
        hidden, locked = selected & screen.visibility.hidden, selected & screen.visibility.locked
        self.buttons[HIDE].show_text(SHOW if hidden else HIDE)
        self.buttons[LOCK].show_text(OPEN if locked else LOCK)
        if len({line.items for line in self._chosen_lines}) != 1:
            self.buttons["Rename"].is_enabled = False

    def _row(self, line: ObjectLine, colours: dict[str, Any]) -> Row:
        visibility = self._screen.visibility
        states = [word for word, items in (("hidden", visibility.hidden), ("locked", visibility.locked))
                  if line.items <= items]  # fmt: skip
        colour = DISABLED if "hidden" in states else TEXT
        swatch = None if line.material is None else colours.get(line.material)
        aside = ", ".join([line.kind, *states])
        # Long names often differ at their ends.
        return Row(line.name, "", swatch, colour, aside, int(line.group is not None), keeps_end=True)

    def _choose_first(self) -> None:
        """Select the first line that has the words, and go on in the list."""
        if self.lines:
            self._choose(0)
            self._ui.focus_on(self.list)

    @property
    def _selected(self) -> Selection:
        return self._screen.document.selection

    @property
    def _chosen_lines(self) -> list[ObjectLine]:
        """The lines of what is selected, a group's in place of those of all its members."""
        chosen = [line for line in self.lines if line.items <= self._selected]
        whole = {line.name for line in chosen if len(line.items) > 1}
        return [line for line in chosen if line.group not in whole]

    def _choose(self, index: int) -> None:
        """Select a line alone; with Ctrl it too or no longer, with Shift all up to it."""
        if index >= len(self.lines):
            return
        modifiers, items = pygame.key.get_mods(), self.lines[index].items
        if modifiers & pygame.KMOD_SHIFT:
            low, high = sorted((min(self._last, len(self.lines) - 1), index))
            self._screen.select(frozenset().union(*(line.items for line in self.lines[low : high + 1])))
            return
        self._last = index
        is_more = modifiers & (pygame.KMOD_CTRL | pygame.KMOD_META)
        if is_more:
            items = self._selected - items if items <= self._selected else self._selected | items
        self._screen.select(items)
        self._screen.reveal(items)

    def _hide(self) -> None:
        visibility = self._screen.visibility
        self._screen.set_visibility(visibility.hide(self._selected, on=not self._selected & visibility.hidden))

    def _lock(self) -> None:
        visibility = self._screen.visibility
        self._screen.set_visibility(visibility.lock(self._selected, on=not self._selected & visibility.locked))

    def _move(self, down: bool) -> None:
        """Move the selected items one place up or down in the file's order."""
        before = self._screen.document.level
        if self._screen.edit("Order", partial(shift, later=down)) and self._screen.document.level is before:
            self._screen.say("Nothing of its kind is below it." if down else "Nothing of its kind is above it.")

    def ask_name(self) -> None:
        """Ask for another name of the one thing or group that is selected."""
        self.search.typed = ""
        self.refresh()
        if len({line.items for line in self._chosen_lines}) != 1:
            self._screen.say("Select one thing, or one group, to rename it.")
            return
        line = self._chosen_lines[0]
        only: Item | None = next(iter(line.items)) if len(line.items) == 1 and line.kind[:5] != "group" else None

        def answer(name: str) -> str | None:
            screen = self._screen
            try:
                if only is None:
                    document = rename_group(screen.document, line.name, name)
                elif only.kind == "spring":
                    document = set_field(screen.document, line.items, "name", name)
                else:
                    document = rename(screen.document, only, name)
            except EditError as error:
                return sentence(error)
            if only is not None and only.kind != "spring":
                screen.set_visibility(screen.visibility.renamed(only, Item(only.kind, name)))
            screen.apply(f"Rename {line.name}", document)
            return None

        ask(
            self._ui,
            f"Rename {line.name}",
            "Checks, joints and springs that name it are updated.",
            line.name,
            "Rename",
            answer,
        )

    def close(self) -> None:
        """Take the page away."""
        self._screen.light_up(frozenset())


class HistoryPage(SidePage):
    """The steps of the history, the present one marked, those that were undone in grey below it."""

    def __init__(self, screen: Editing, place: pygame.Rect, container: Any) -> None:
        self._screen = screen
        self._ui = screen.ui
        self.list = RowList(screen.ui, place, self._go, container)
        self._shown: Document | None = None

    def refresh(self) -> None:
        """Show the steps as they are now."""
        history = self._screen.history
        if history.document is self._shown:
            return
        self._shown = history.document
        rows = [
            Row(label or "Edit", colour=TEXT if index <= history.index else DISABLED, aside=subject)
            for index, (label, subject) in enumerate(zip(history.labels, history.subjects, strict=True))
        ]
        self.list.show_rows(rows, history.index, reveal=True)

    def _go(self, index: int) -> None:
        if index != self._screen.history.index:
            self._screen.step_to(index)


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
        """Offer on the button to mend the chosen finding, where an edit can."""
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
