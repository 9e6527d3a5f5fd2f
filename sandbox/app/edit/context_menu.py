"""The menu of the right button on the sheet: what lies under the pointer, and what can be done with the selection."""

from collections.abc import Callable
from typing import NamedTuple

from sandbox.app.base.shortcuts import shortcuts
from sandbox.app.contracts.application import Editing
from sandbox.app.contracts.screen import Pixel
from sandbox.app.draw.colours import MUTED
from sandbox.app.widgets.picker import open_menu_at
from sandbox.app.widgets.rows import Row
from sandbox.editor.edits.grouping import groups_of, with_groups
from sandbox.editor.items import Item
from sandbox.editor.objects import name_of
from sandbox.editor.pick import items_at

WIDTH = 250.0
# More things that lie over each other are not offered.
MOST_UNDER = 6
# Actions of the menu over something, and of that over the bare sheet, in their order.
OVER_THINGS = (
    "cut", "copy", "paste", "duplicate", "delete", "group", "ungroup", "mirror", "array", "forward", "backward", "hide",
    "lock", "trail", "try_range", "keep_part",
)  # fmt: skip
OVER_NOTHING = ("paste", "select_all", "find", "hide", "lock", "fit")
SHORT = {
    "delete": "Delete", "paste": "Paste here",
    "group": "Group", "ungroup": "Ungroup", "forward": "One forward", "backward": "One backward",
    "array": "Several copies...", "mirror": "Mirror...", "keep_part": "Keep as a part...", "fit": "Fit to view",
    "trail": "Trail: where it will go", "try_range": "Try a range of a number...", "hide": "Hide", "lock": "Lock",
}  # fmt: skip


class _Entry(NamedTuple):
    row: Row
    do: Callable[[], object]


def open_context_menu(screen: Editing, pixel: Pixel) -> None:
    """Select what lies under a pixel, unless it is selected, and offer what can be done there."""
    at = screen.camera.to_world(pixel)
    under = items_at(screen.scene, at, screen.reach, screen.visibility.closed, MOST_UNDER)
    if not under:
        screen.select(frozenset())
    elif not screen.document.selection.intersection(under):
        screen.select(with_groups(screen.document.level, frozenset(under[:1])) - screen.visibility.closed)
    entries = [*_actions(screen, pixel, OVER_THINGS if under else OVER_NOTHING), *_things(screen, under)]
    rows = [entry.row for entry in entries]
    open_menu_at(screen.ui, pixel, screen.ui.px(WIDTH), rows, lambda index: entries[index].do())


def _things(screen: Editing, under: list[Item]) -> list[_Entry]:
    """What lies under the pointer, each alone, and the group of the first."""
    level = screen.document.level
    if len(under) < 2 and not any(item in groups_of(level) for item in under):
        return []
    return [
        _Entry(Row(f"Select {name_of(level, item)}", colour=MUTED), lambda item=item: screen.select(frozenset([item])))  # type: ignore[misc]
        for item in under
    ]


def _actions(screen: Editing, pixel: Pixel, names: tuple[str, ...]) -> list[_Entry]:
    by_name = {entry.action: entry for entry in shortcuts("edit") if entry.action}

    def act(name: str) -> None:
        # What is pasted comes to where the menu was opened.
        screen.pointer = pixel
        screen.actions[name]()

    selection, groups = screen.document.selection, groups_of(screen.document.level)
    idle = {"group"} if len(selection) < 2 else set()
    idle |= {"ungroup"} if not selection.intersection(groups) else set()
    entries = []
    for name in names:
        if name in idle:
            continue
        entry = by_name[name]
        label = SHORT.get(name, entry.label) if names is OVER_THINGS or name not in ("hide", "lock") else entry.label
        row = Row(label, aside=entry.keys[0] if entry.keys else "")
        entries.append(_Entry(row, lambda name=name: act(name)))  # type: ignore[misc]
    return entries
