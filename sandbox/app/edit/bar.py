"""The bar of the editor, the palette of its tools, and the menu of a right click."""

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import pygame

from sandbox.app.base.shortcuts import shortcuts, tip_of
from sandbox.app.contracts.application import Editing
from sandbox.app.contracts.screen import Pixel
from sandbox.app.draw.colours import MUTED
from sandbox.app.play.toolbar import BAR_HEIGHT, BUTTON, GAP, ICON, ROOM_FOR_NAME
from sandbox.app.widgets.button import BarTitle, Button
from sandbox.app.widgets.picker import open_menu_at
from sandbox.app.widgets.rows import Row
from sandbox.app.widgets.ui import Ui
from sandbox.app.widgets.widget import Widget
from sandbox.editor.edits.grouping import groups_of, with_groups
from sandbox.editor.items import Item
from sandbox.editor.objects import name_of
from sandbox.editor.pick import items_at
from sandbox.editor.tools.palette import TOOL_GROUPS, TOOLS

# Groups of actions from the left, and those at the right end, with their pictures.
LEFT = (
    (("play", "play"),),
    (("undo", "undo"), ("redo", "redo")),
    (("new", "new"), ("open", "open"), ("save", "save")),
    (
        ("duplicate", "duplicate"), ("delete", "delete"), ("mirror", "mirror"), ("array", "array"), ("parts", "group"),
        ("align", "align"), ("order", "order"),
    ),
    (("snap", "snap"), ("forecast", "forecast"), ("trail", "trail"), ("rest", "rest")),
)  # fmt: skip
RIGHT = (("menu", "menu"), ("fit", "fit"), ("panel", "panel"))
# What goes into the menu where the window is too narrow, first what is missed least.
LEAVING = (
    "order",
    "align",
    "array",
    "fit",
    "open",
    "new",
    "mirror",
    "parts",
    "snap",
    "rest",
    "trail",
    "duplicate",
    "delete",
)
# Buttons are no smaller than this; more of them go into the menu, or into a second column.
LEAST_PITCH = 33.0
LEAST_TOOL_PITCH = 26.0
TOOL_COLUMN = 34.0
NEEDS_SELECTION = ("duplicate", "delete", "mirror", "array", "parts", "align", "order")
MARGIN = 14.0
PALETTE_WIDTH = 52.0
# Tools have names in windows that are wide enough, and high enough for them and the headings of their groups.
ROOM_FOR_TOOL_NAMES = 1200.0
NAMED_WIDTH, HEADING = 116.0, 19.0
LEAST_NAMED_PITCH, NAMED_PITCH = 21.0, 27.0
GROUP_GAP = 14.0
WIDTH = 250.0
# More things that lie over each other are not offered.
MOST_UNDER = 6
# Actions of the menu over something, and of that over the bare sheet, in their order.
OVER_THINGS = (
    "rename", "cut", "copy", "paste", "duplicate", "delete", "group", "ungroup", "mirror", "array", "forward",
    "backward", "hide", "lock", "trail", "try_range", "keep_part",
)  # fmt: skip
OVER_NOTHING = ("paste", "select_all", "find", "hide", "lock", "fit")
SHORT = {
    "rename": "Rename...", "duplicate": "Duplicate", "delete": "Delete", "paste": "Paste here",
    "group": "Group", "ungroup": "Ungroup", "forward": "One forward", "backward": "One backward",
    "array": "Several copies...", "mirror": "Mirror...", "keep_part": "Keep as a part...", "fit": "Fit to view",
    "trail": "Trail: where it will go", "try_range": "Try a range of a number...", "hide": "Hide", "lock": "Lock",
}  # fmt: skip


class Bar:
    """The bar at the top; `press` starts an action by its name."""

    def __init__(self, ui: Ui, press: Callable[[str], None]) -> None:
        width = ui.units[0]
        self.back = ui.panel(ui.rect(0, 0, width, BAR_HEIGHT))
        gaps = GROUP_GAP * len(LEFT) if width >= ROOM_FOR_NAME else 4.0 * len(LEFT)
        available = width - 2 * MARGIN - gaps
        count = sum(map(len, LEFT)) + len(RIGHT) + 1
        self.left_out = LEAVING[: max(0, count - int(available // LEAST_PITCH))]
        pitch = min(BUTTON + GAP, available / (count - len(self.left_out)))
        size = min(BUTTON, pitch - 2)
        self.buttons: dict[str, Button] = {}
        x, y = MARGIN, (BAR_HEIGHT - size) / 2
        for group in LEFT:
            for action, picture in group:
                if action not in self.left_out:
                    place = ui.rect(x, y, size, size)
                    self.buttons[action] = _add_button(ui, press, self.back, action, picture, place)
                    x += pitch
            x += gaps / len(LEFT)
        at_right = [entry for entry in RIGHT if entry[0] not in self.left_out]
        right = width - MARGIN - (len(at_right) + 1) * pitch
        self.title: BarTitle | None = None
        if width >= ROOM_FOR_NAME:
            self.title = BarTitle(ui, ui.rect(x + 8, 0, right - x - 16, BAR_HEIGHT), self.back)
        for action, picture in at_right:
            place = ui.rect(right, y, size, size)
            self.buttons[action] = _add_button(ui, press, self.back, action, picture, place)
            right += pitch
        tip = tip_of("help", "edit")
        place = ui.rect(right, y, size, size)
        self.buttons["help"] = ui.button(place, "?", partial(press, "help"), self.back, tip=tip, style="quiet")

    def show(self, screen: Editing) -> None:
        """Enable the buttons whose actions are possible now."""
        history = screen.history

        def show(action: str, enabled: bool = True, on: bool = False) -> None:
            if action in self.buttons:
                self.buttons[action].is_enabled, self.buttons[action].is_selected = enabled, on

        show("undo", history.can_undo)
        show("redo", history.can_redo)
        for action in NEEDS_SELECTION:
            show(action, bool(screen.document.selection))
        show("save", not history.is_saved or screen.level_file.path is None)
        show("snap", on=screen.snapping)
        show("forecast", on=screen.watch.forecasts)
        show("trail", on=screen.watch.trails)
        show("panel", on=screen.show_side)
        name = screen.document.level.name + ("" if history.is_saved else " *")
        if self.title is not None:
            self.title.show_text(name)


class Palette:
    """The tools, at the left edge below the bar: in groups with names where there is room, else icons in columns."""

    def __init__(self, ui: Ui, press: Callable[[str], None], top: float, height: float) -> None:
        width = palette_width(ui.units[0], height)
        self.back = ui.panel(ui.rect(0, top, width, height))
        self.tools: dict[str, Button] = {}
        if _has_names(ui.units[0], height):
            self._add_named(ui, press, height)
        else:
            self._add_icons(ui, press, width, height)

    def _add_named(self, ui: Ui, press: Callable[[str], None], height: float) -> None:
        pitch = min(NAMED_PITCH, (height - 8.0 - len(TOOL_GROUPS) * HEADING) / len(TOOLS))
        y = 4.0
        for group, tools in TOOL_GROUPS.items():
            ui.label(ui.rect(10.0, y + 3.0, NAMED_WIDTH - 12.0, HEADING - 4.0), group, self.back, "muted")
            y += HEADING
            for tool in tools:
                place, name = ui.rect(6.0, y, NAMED_WIDTH - 12.0, pitch - 1.0), tool.title.capitalize()
                self.tools[tool.name] = _add_button(ui, press, self.back, tool.action, tool.name, place, name)
                y += pitch

    def _add_icons(self, ui: Ui, press: Callable[[str], None], width: float, height: float) -> None:
        columns = palette_columns(height)
        rows = -(-len(TOOLS) // columns)
        pitch = min(BUTTON + GAP, (height - 8) / rows)
        across = (width - 8.0) / columns
        size = min(BUTTON, pitch - 2, across - 2)
        for index, tool in enumerate(TOOLS.values()):
            column, row = divmod(index, rows)
            x = 4.0 + column * across + (across - size) / 2
            place = ui.rect(x, 6 + row * pitch, size, size)
            self.tools[tool.name] = _add_button(ui, press, self.back, tool.action, tool.name, place)

    def show(self, tool: str) -> None:
        """Mark the tool in use."""
        for name, button in self.tools.items():
            button.is_selected = name == tool


def palette_width(width: float, height: float) -> float:
    """Width [layout units] of a palette of that height in a window of that width."""
    if _has_names(width, height):
        return NAMED_WIDTH
    columns = palette_columns(height)
    return PALETTE_WIDTH if columns == 1 else 8.0 + columns * TOOL_COLUMN


def palette_columns(height: float) -> int:
    """Columns of tools that a palette of that height [layout units] has: as few as leave its buttons large enough."""
    return min(3, max(1, -(-len(TOOLS) // max(1, int((height - 8) // LEAST_TOOL_PITCH)))))


def _has_names(width: float, height: float) -> bool:
    """Whether a palette of that height in a window of that width [layout units] has room for the names of tools."""
    return width >= ROOM_FOR_TOOL_NAMES and height - len(TOOL_GROUPS) * HEADING >= LEAST_NAMED_PITCH * len(TOOLS)


def _add_button(
    ui: Ui, press: Callable[[str], None], back: Widget, action: str, icon: str, place: pygame.Rect, name: str = ""
) -> Button:
    """A button that starts an action; with a name beside its icon where there is one."""
    size = place.height / ui.scale
    return ui.button(
        place, name, partial(press, action), back, icon=icon, tip=tip_of(action, "edit"),
        icon_size=min(size - 5.0, ICON) if name else ICON * size / BUTTON, style="tool" if name else "quiet",
    )  # fmt: skip


class _Entry(NamedTuple):
    row: Row
    do: Callable[[], object]


def open_context_menu(screen: Editing, pixel: Pixel, keeps_selection: bool = False) -> None:
    """Select what lies under a pixel, unless it is selected or that is to stay, and offer what can be done there."""
    at = screen.camera.to_world(pixel)
    under = items_at(screen.scene, at, screen.reach, screen.visibility.closed, MOST_UNDER)
    if keeps_selection:
        under = list(screen.document.selection)[:1]
    elif not under:
        screen.select(frozenset())
    elif not screen.document.selection.intersection(under):
        screen.select(with_groups(screen.document.level, frozenset(under[:1])) - screen.visibility.closed)
    entries = [*_actions(screen, pixel, OVER_THINGS if under else OVER_NOTHING), *_things(screen, under)]
    rows = [entry.row for entry in entries]
    place = screen.camera.viewport
    open_menu_at(screen.ui, pixel, screen.ui.px(WIDTH), rows, lambda index: entries[index].do(), place)


def open_menu_by_key(screen: Editing) -> None:
    """Offer what can be done with the selection, or else at the keyboard cursor, or the middle of the sheet."""
    box, place = screen.selection_box, screen.cursor or screen.camera.to_world(screen.camera.middle)
    if box is not None:
        place = (box[0] + box[2]) / 2.0, (box[1] + box[3]) / 2.0
    open_context_menu(screen, screen.camera.to_pixels(place), keeps_selection=box is not None)


def _things(screen: Editing, under: list[Item]) -> list[_Entry]:
    """The things under the pointer, each alone, and the group of the first."""
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
    disabled = {"group"} if len(selection) < 2 else set()
    disabled |= {"ungroup"} if not selection.intersection(groups) else set()
    entries = []
    for name in names:
        if name in disabled:
            continue
        entry = by_name[name]
        label = SHORT.get(name, entry.label) if names is OVER_THINGS or name not in ("hide", "lock") else entry.label
        row = Row(label, aside=entry.keys[0] if entry.keys else "")
        entries.append(_Entry(row, lambda name=name: act(name)))  # type: ignore[misc]
    return entries
