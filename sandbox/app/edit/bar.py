"""Bar and palette of the editor: a button for everything that is done often, and one for every tool."""

from collections.abc import Callable
from typing import Any

import pygame

from sandbox.app.base.shortcuts import tip_of
from sandbox.app.contracts.editing import Editing
from sandbox.app.draw.colours import ACCENT, DISABLED, TEXT, Colour
from sandbox.app.edit.edit_icons import EDIT_ICONS
from sandbox.app.play.toolbar import BAR_HEIGHT, BUTTON, GAP, ICON, ROOM_FOR_NAME
from sandbox.app.widgets.bar_title import BarTitle
from sandbox.app.widgets.icons import painted_icon
from sandbox.app.widgets.ui import Ui
from sandbox.editor.tools.icons import Icon
from sandbox.editor.tools.palette import TOOLS

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
GROUP_GAP = 14.0


class _Buttons:
    """Icon buttons on a panel, by the action that each starts."""

    def __init__(self, ui: Ui, press: Callable[[str], None], back: Any, size: float) -> None:
        self._ui, self._press, self._back, self._size = ui, press, back, size
        self.by_action: dict[str, Any] = {}
        self._icons: dict[str, Icon] = {}
        self._shown: dict[str, Colour] = {}

    def add(self, action: str, icon: Icon, x: float, y: float) -> None:
        """A button of an action at a place [layout units]."""
        ui = self._ui
        self._icons[action] = icon
        self.by_action[action] = ui.button(
            ui.rect(x, y, self._size, self._size),
            "",
            lambda: self._press(action),
            self._back,
            icon=self._icon(action, TEXT),
            tip=tip_of(action, "edit"),
            style="@quiet",
        )
        self._shown[action] = TEXT

    def add_text(self, action: str, text: str, x: float, y: float) -> None:
        """A button with a letter in place of a picture."""
        ui, place = self._ui, self._ui.rect(x, y, self._size, self._size)
        tip = tip_of(action, "edit")
        self.by_action[action] = ui.button(
            place, text, lambda: self._press(action), self._back, tip=tip, style="@quiet"
        )

    def show(self, action: str, enabled: bool = True, on: bool = False) -> None:
        """Show an action as possible or not, and on or off, changing what differs."""
        colour = ACCENT if on else TEXT if enabled else DISABLED
        if self._shown.get(action) == colour:
            return
        self._shown[action] = colour
        button = self.by_action[action]
        button.show_icon(self._icon(action, colour))
        (button.enable if enabled else button.disable)()
        (button.select if on else button.unselect)()

    def _icon(self, action: str, colour: Colour) -> pygame.Surface:
        return painted_icon(self._icons[action], self._ui.px(ICON * self._size / BUTTON), colour)


class Bar:
    """The bar at the top; `press` starts an action by its name."""

    def __init__(self, ui: Ui, press: Callable[[str], None]) -> None:
        width = ui.units[0]
        self.back = ui.panel(ui.rect(0, 0, width, BAR_HEIGHT))
        gaps = GROUP_GAP * len(LEFT) if width >= ROOM_FOR_NAME else 4.0 * len(LEFT)
        room = width - 2 * MARGIN - gaps
        count = sum(map(len, LEFT)) + len(RIGHT) + 1
        self.left_out = LEAVING[: max(0, count - int(room // LEAST_PITCH))]
        pitch = min(BUTTON + GAP, room / (count - len(self.left_out)))
        size = min(BUTTON, pitch - 2)
        self.buttons = _Buttons(ui, press, self.back, size)
        x, y = MARGIN, (BAR_HEIGHT - size) / 2
        for group in LEFT:
            for action, picture in group:
                if action not in self.left_out:
                    self.buttons.add(action, EDIT_ICONS[picture], x, y)
                    x += pitch
            x += gaps / len(LEFT)
        at_right = [entry for entry in RIGHT if entry[0] not in self.left_out]
        right = width - MARGIN - (len(at_right) + 1) * pitch
        self.title: BarTitle | None = None
        if width >= ROOM_FOR_NAME:
            self.title = BarTitle(ui, ui.rect(x + 8, 0, right - x - 16, BAR_HEIGHT), self.back)
        for action, picture in at_right:
            self.buttons.add(action, EDIT_ICONS[picture], right, y)
            right += pitch
        self.buttons.add_text("help", "?", right, y)

    def show(self, screen: Editing) -> None:
        """Show what is possible now."""
        history = screen.history

        def show(action: str, enabled: bool = True, on: bool = False) -> None:
            if action not in self.left_out:
                self.buttons.show(action, enabled, on)

        show("undo", history.can_undo)
        show("redo", history.can_redo)
        for action in NEEDS_SELECTION:
            show(action, bool(screen.document.selection))
        show("save", not history.is_saved or screen.level_file.path is None)
        show("snap", on=screen.snapping)
        show("forecast", on=screen.shows_forecast)
        show("trail", on=screen.shows_trail)
        show("panel", on=screen.show_side)
        name = screen.document.level.name + ("" if history.is_saved else " *")
        if self.title is not None:
            self.title.show_text(name)


def palette_columns(height: float) -> int:
    """Columns of tools that a palette of that height [layout units] has: as few as leave its buttons large enough."""
    return min(3, max(1, -(-len(TOOLS) // max(1, int((height - 8) // LEAST_TOOL_PITCH)))))


def palette_width(height: float) -> float:
    """Width [layout units] of a palette of that height."""
    columns = palette_columns(height)
    return PALETTE_WIDTH if columns == 1 else 8.0 + columns * TOOL_COLUMN


class Palette:
    """The tools, at the left edge below the bar; lower windows have more columns of them."""

    def __init__(self, ui: Ui, press: Callable[[str], None], top: float, height: float) -> None:
        width, columns = palette_width(height), palette_columns(height)
        self.back = ui.panel(ui.rect(0, top, width, height))
        rows = -(-len(TOOLS) // columns)
        pitch = min(BUTTON + GAP, (height - 8) / rows)
        across = (width - 8.0) / columns
        size = min(BUTTON, pitch - 2, across - 2)
        self._buttons = _Buttons(ui, press, self.back, size)
        for index, tool in enumerate(TOOLS.values()):
            column, row = divmod(index, rows)
            x = 4.0 + column * across + (across - size) / 2
            self._buttons.add(tool.action, tool.icon, x, 6 + row * pitch)
        self.tools = {name: self._buttons.by_action[tool.action] for name, tool in TOOLS.items()}

    def show(self, tool: str) -> None:
        """Mark the tool in use."""
        for name, each in TOOLS.items():
            self._buttons.show(each.action, on=name == tool)
