"""Bar and palette of the editor: a button for everything that is done often, and one for every tool."""

from collections.abc import Callable
from typing import Any

import pygame

from sandbox.app.draw.colours import ACCENT, DISABLED, TEXT, Colour
from sandbox.app.edit.edit_icons import EDIT_ICONS
from sandbox.app.edit.editing import Editing
from sandbox.app.play.toolbar import BAR_HEIGHT, BUTTON, GAP, ICON, ROOM_FOR_NAME
from sandbox.app.shortcuts import tip_of
from sandbox.app.widgets.icons import painted_icon
from sandbox.app.widgets.ui import Ui, set_icon
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
    (("snap", "snap"), ("forecast", "forecast"), ("rest", "rest")),
)  # fmt: skip
RIGHT = (("menu", "menu"), ("fit", "fit"), ("panel", "panel"))
NEEDS_SELECTION = ("duplicate", "delete", "mirror", "array", "parts", "align", "order")
MARGIN = 14.0
GROUP_GAP = 14.0


class _Buttons:
    """Icon buttons on a panel, by the action that each starts."""

    def __init__(self, ui: Ui, press: Callable[[str], None], back: Any, size: float) -> None:
        self._ui, self._press, self._back, self._size = ui, press, back, size
        self.by_action: dict[str, Any] = {}
        self._icons: dict[str, Icon] = {}
        self._painted: dict[tuple[str, Colour], pygame.Surface] = {}
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
        set_icon(button, self._icon(action, colour))
        (button.enable if enabled else button.disable)()
        (button.select if on else button.unselect)()

    def _icon(self, action: str, colour: Colour) -> pygame.Surface:
        key = (action, colour)
        if key not in self._painted:
            size = self._ui.px(ICON * self._size / BUTTON)
            self._painted[key] = painted_icon(self._icons[action], size, colour)
        return self._painted[key]


class Bar:
    """The bar at the top; `press` starts an action by its name."""

    def __init__(self, ui: Ui, press: Callable[[str], None]) -> None:
        width = ui.units[0]
        self.back = ui.panel(ui.rect(0, 0, width, BAR_HEIGHT))
        count = sum(map(len, LEFT)) + len(RIGHT) + 1
        gaps = GROUP_GAP * len(LEFT) if width >= ROOM_FOR_NAME else 4.0 * len(LEFT)
        pitch = min(BUTTON + GAP, (width - 2 * MARGIN - gaps) / count)
        size = min(BUTTON, pitch - 2)
        self.buttons = _Buttons(ui, press, self.back, size)
        x, y = MARGIN, (BAR_HEIGHT - size) / 2
        for group in LEFT:
            for action, picture in group:
                self.buttons.add(action, EDIT_ICONS[picture], x, y)
                x += pitch
            x += gaps / len(LEFT)
        right = width - MARGIN - (len(RIGHT) + 1) * pitch
        self.title = None
        if width >= ROOM_FOR_NAME:
            self.title = ui.label(ui.rect(x + 8, 0, right - x - 16, BAR_HEIGHT), "", self.back, "@title")
        self._name = ""
        for action, picture in RIGHT:
            self.buttons.add(action, EDIT_ICONS[picture], right, y)
            right += pitch
        self.buttons.add_text("help", "?", right, y)

    def show(self, screen: Editing) -> None:
        """Show what is possible now."""
        history, show = screen.history, self.buttons.show
        show("undo", history.can_undo)
        show("redo", history.can_redo)
        for action in NEEDS_SELECTION:
            show(action, bool(screen.document.selection))
        show("save", not history.is_saved or screen.level_file.path is None)
        show("snap", on=screen.snapping)
        show("forecast", on=screen.shows_forecast)
        show("panel", on=screen.show_side)
        name = screen.document.level.name + ("" if history.is_saved else " *")
        if self.title is not None and name != self._name:
            self._name = name
            self.title.set_text(name)


class Palette:
    """The tools, at the left edge below the bar; lower windows have smaller buttons."""

    def __init__(self, ui: Ui, press: Callable[[str], None], top: float, width: float, height: float) -> None:
        self.back = ui.panel(ui.rect(0, top, width, height))
        pitch = min(BUTTON + GAP, (height - 8) / len(TOOLS))
        size = min(BUTTON, pitch - 2)
        self._buttons = _Buttons(ui, press, self.back, size)
        for index, tool in enumerate(TOOLS.values()):
            self._buttons.add(tool.action, tool.icon, (width - size) / 2, 6 + index * pitch)
        self.tools = {name: self._buttons.by_action[tool.action] for name, tool in TOOLS.items()}

    def show(self, tool: str) -> None:
        """Mark the tool in use."""
        for name, each in TOOLS.items():
            self._buttons.show(each.action, on=name == tool)
