"""Toolbar: the bar at the top with tools, time and files."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import pygame

from sandbox.app.draw.colours import ACCENT, DANGER, DISABLED, TEXT, Colour
from sandbox.app.shortcuts import tip_of
from sandbox.app.widgets.icons import ICONS, painted_icon
from sandbox.app.widgets.ui import Ui, set_icon

# Sizes in layout units.
BAR_HEIGHT = 52.0
BUTTON = 34.0
GAP = 6.0
ICON = 18.0
SLOW_WIDTH = 46.0
SHARE_WIDTH = 68.0
# Narrower windows leave the level's name out, and the wider gaps between the groups.
ROOM_FOR_NAME = 1000.0


@dataclass(frozen=True)
class BarState:
    """What the bar shows."""

    name: str
    tool: str
    paused: bool
    speed: float
    recording: bool
    can_undo: bool
    can_redo: bool
    panel: bool
    palette: bool


class Toolbar:
    """Buttons for every action of the bar; `press` starts an action by its name."""

    def __init__(self, ui: Ui, press: Callable[[str], None], of_document: bool = False) -> None:
        self._ui, self._press = ui, press
        self._state: BarState | None = None
        width = ui.units[0]
        self.back = ui.panel(ui.rect(0, 0, width, BAR_HEIGHT))
        self._icons: dict[tuple[str, Colour], pygame.Surface] = {}
        self._x = 14.0
        self._button("edit", "edit")
        wide = 22.0 if width >= ROOM_FOR_NAME else 10.0
        self._x += wide
        self.tools = {name: self._button(f"tool_{name}", name) for name in ("drag", "pin", "cut")}
        self.palette = self._button("palette", "parts")
        self._x += wide
        self.undo = self._button("undo", "undo")
        self.redo = self._button("redo", "redo")
        self._x += wide
        self.reset = self._button("reset", "reset")
        self.pause = self._button("pause", "pause")
        self.step = self._button("step", "step")
        self.slow = self._text_button("slow", "1x", SLOW_WIDTH)
        if of_document:
            self._button("keep", "keep")
        self._x += wide
        self.record = self._button("record", "record")
        self.save = self._button("save", "save")
        title_left = self._x + 10
        named = width >= ROOM_FOR_NAME
        self._x = width - 14 - 4 * BUTTON - 4 * GAP - (SHARE_WIDTH if named else BUTTON)
        self.title = None
        if named:
            place = ui.rect(title_left, 0, self._x - title_left - 14, BAR_HEIGHT)
            self.title = ui.label(place, "", self.back, "@title")
        if named:
            self._text_button("share", "Share", SHARE_WIDTH, "")
        else:
            self._button("share", "share")
        self._button("gallery", "levels")
        self._button("fit", "fit")
        self.panel = self._button("panel", "panel")
        self._text_button("help", "?", BUTTON)

    def show(self, state: BarState) -> None:
        """Show a state, changing what differs."""
        before, self._state = self._state, state
        if state == before:
            return
        for name, button in self.tools.items():
            set_icon(button, self._icon(name, ACCENT if name == state.tool else TEXT))
            (button.select if name == state.tool else button.unselect)()
        set_icon(self.pause, self._icon("play" if state.paused else "pause", ACCENT if state.paused else TEXT))
        set_icon(self.record, self._icon("stop" if state.recording else "record", DANGER))
        self.slow.set_text("1x" if state.speed == 1.0 else f"1/{round(1 / state.speed)}x")
        (self.slow.unselect if state.speed == 1.0 else self.slow.select)()
        (self.panel.select if state.panel else self.panel.unselect)()
        (self.palette.select if state.palette else self.palette.unselect)()
        (self.undo.enable if state.can_undo else self.undo.disable)()
        (self.redo.enable if state.can_redo else self.redo.disable)()
        for button, name, on in ((self.undo, "undo", state.can_undo), (self.redo, "redo", state.can_redo)):
            set_icon(button, self._icon(name, TEXT if on else DISABLED))
        if self.title is not None:
            self.title.set_text(state.name)

    def _icon(self, name: str, colour: Colour) -> pygame.Surface:
        key = (name, colour)
        if key not in self._icons:
            self._icons[key] = painted_icon(ICONS[name], self._ui.px(ICON), colour)
        return self._icons[key]

    def _place(self, width: float) -> pygame.Rect:
        place = self._ui.rect(self._x, (BAR_HEIGHT - BUTTON) / 2, width, BUTTON)
        self._x += width + GAP
        return place

    def _button(self, action: str, picture: str) -> Any:
        return self._ui.button(
            self._place(BUTTON),
            "",
            lambda: self._press(action),
            self.back,
            icon=self._icon(picture, TEXT),
            tip=tip_of(action, "play"),
            style="@quiet",
        )

    def _text_button(self, action: str, text: str, width: float, style: str = "@quiet") -> Any:
        place = self._place(width)
        return self._ui.button(
            place, text, lambda: self._press(action), self.back, tip=tip_of(action, "play"), style=style
        )
