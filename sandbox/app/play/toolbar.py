"""Toolbar: the bar at the top with tools, time and files; and the palette, the strip of parts at the left."""

import functools
from collections.abc import Callable, Set
from dataclasses import dataclass
from functools import partial
from typing import Any

from sandbox.app.base.shortcuts import keys_of, label_of, tip_of
from sandbox.app.draw.colours import ACCENT
from sandbox.app.draw.picture import picture_of
from sandbox.app.play.stage import CATALOGUE
from sandbox.app.widgets.button import BarTitle
from sandbox.app.widgets.dialogs import choose
from sandbox.app.widgets.picker import open_menu_at
from sandbox.app.widgets.rows import Row
from sandbox.app.widgets.ui import Ui
from sandbox.tools.dropping import PARTS
from sandbox.tools.play_tools import PLAY_TOOLS

# Sizes in layout units.
BAR_HEIGHT = 52.0
BUTTON = 34.0
GAP = 6.0
ICON = 18.0
MARGIN = 14.0
SHARE_WIDTH = 68.0
MENU_WIDTH = 330.0
# Narrower windows leave the level's name out, and the wider gaps between the groups; and so does less room for it.
ROOM_FOR_NAME = 1000.0
LEAST_NAME = 90.0
WIDE_GAP, NARROW_GAP = 16.0, 4.0
# Groups of actions from the left, and those at the right end, with their pictures.
LEFT = (
    (("edit", "edit"),),
    (("palette", "parts"), ("tool_cut", "cut")),
    (("undo", "undo"), ("reset", "reset"), ("pause", "pause")),
)
RIGHT = (("share", "share"), ("gallery", "levels"), ("panel", "panel"), ("more", "more"))
# What is done more rarely is in the menu of the last button, in this order.
MENU = (
    "share", "edit", "keep", "tool_drag", "tool_pin", "redo", "restart", "as_it_was", "step", "slow", "timeline",
    "ghost", "solution", "card", "graphs", "compare", "fit", "sound", "save", "record", "toy", "settings", "help",
)  # fmt: skip
# The word on a button in a wide window.
WIDE_WORDS = {"share": "Share"}


@dataclass(frozen=True)
class BarState:
    """The state of run and window that the bar's buttons show."""

    name: str
    tool: str
    paused: bool
    speed: float
    recording: bool
    can_undo: bool
    panel: bool
    palette: bool
    sound: bool
    timeline: bool
    graphs: bool
    ghost: bool


class Toolbar:
    """Nine buttons at most, and a menu of all else but what is in `absent`; `press` starts an action by its name.

    in_menu: actions with a button that are in the menu instead.
    """

    def __init__(self, ui: Ui, press: Callable[[str], None], absent: Set[str], in_menu: Set[str]) -> None:
        self._ui, self._press = ui, press
        self._state: BarState | None = None
        width = ui.units[0]
        self.back = ui.panel(ui.rect(0, 0, width, BAR_HEIGHT))
        self._is_wide = width >= ROOM_FOR_NAME
        self.buttons: dict[str, Any] = {}
        hidden, x = absent | in_menu, MARGIN
        for group in LEFT:
            shown = [entry for entry in group if entry[0] not in hidden]
            for action, picture in shown:
                x = self._add(action, picture, x)
            x += (WIDE_GAP if self._is_wide else NARROW_GAP) if shown else 0.0
        at_right = [entry for entry in RIGHT if entry[0] not in hidden]
        right = width - MARGIN + GAP - sum(self._width(action) + GAP for action, _ in at_right)
        self.title: BarTitle | None = None
        if self._is_wide and right - x - 18 >= LEAST_NAME:
            self.title = BarTitle(ui, ui.rect(x + 4, 0, right - x - 18, BAR_HEIGHT), self.back)
        for action, picture in at_right:
            right = self._add(action, picture, right)
        # Actions of the menu.
        self.left_out = [action for action in MENU if action not in absent and action not in self.buttons]

    def _width(self, action: str) -> float:
        return SHARE_WIDTH if self._is_wide and action in WIDE_WORDS else BUTTON

    def _add(self, action: str, picture: str, x: float) -> float:
        """Add an action's button at a place; gives the next one."""
        words, width = WIDE_WORDS.get(action, "") if self._is_wide else "", self._width(action)
        is_menu = action == "more"
        self.buttons[action] = self._ui.button(
            self._ui.rect(x, (BAR_HEIGHT - BUTTON) / 2, width, BUTTON), words,
            self._show_menu if is_menu else partial(self._press, action), self.back, icon="" if words else picture,
            tip="More" if is_menu else tip_of(action, "play"), style="" if words else "quiet",
        )  # fmt: skip
        return x + width + GAP

    def _show_menu(self) -> None:
        """Open the menu below its button: what is on has a word at its right."""
        ui, below, states = self._ui, self.buttons["more"].rect, self._menu_states()
        rows = [Row(label_of(action, "play"), aside=states.get(action, keys_of(action))) for action in self.left_out]
        width = min(ui.px(MENU_WIDTH), ui.size[0])
        place = below.right - width, below.bottom
        open_menu_at(ui, place, width, rows, lambda index: self._press(self.left_out[index]), (0, 0, *ui.size))

    def _menu_states(self) -> dict[str, str]:
        state = self._state
        if state is None:
            return {}
        on = [name for name in ("timeline", "graphs", "ghost") if getattr(state, name)]
        on += ["record"] if state.recording else []
        words = dict.fromkeys(on, "on") | ({} if state.sound else {"sound": "off"})
        return words | ({} if state.speed == 1.0 else {"slow": words_of(state.speed)})

    def show(self, state: BarState) -> None:
        """Show a state, changing what differs."""
        before, self._state = self._state, state
        if state == before:
            return
        self._mark("tool_cut", state.tool == "cut")
        self.buttons["pause"].show_icon("play" if state.paused else "pause", ACCENT if state.paused else None)
        for name in ("panel", "palette"):
            self._mark(name, getattr(state, name))
        self.buttons["undo"].is_enabled = state.can_undo
        if self.title is not None:
            self.title.show_text(state.name)

    def _mark(self, action: str, on: bool) -> None:
        """Show an action's button as on or off, where it is on the bar."""
        if action in self.buttons:
            self.buttons[action].is_selected = on


def words_of(speed: float) -> str:
    """A speed for a button: 1/2x, 4x, -1x."""
    return f"{speed:g}x" if abs(speed) >= 1.0 else f"1/{round(1 / speed)}x"


def state_of(speed: float) -> str:
    """A speed in words, for the status line."""
    if speed < 0.0:
        return "backwards" if speed == -1.0 else f"backwards {-speed:g}x"
    if speed == 1.0:
        return "playing"
    return f"fast {speed:g}x" if speed > 1.0 else f"slow motion 1/{round(1 / speed)}"


# Sizes in layout units.
_LEFT_EDGE, _TOP_EDGE, PALETTE_BUTTON, _PALETTE_GAP, _EDGE = 10.0, 10.0, 34.0, 3.0, 5.0
_WIDTH = PALETTE_BUTTON + 2 * _EDGE
_PICTURE = 30.0
# Where the window has less height for a button, there are two columns.
_LEAST_STEP = PALETTE_BUTTON + _PALETTE_GAP


NAMES = tuple(name for name, tool in PLAY_TOOLS.items() if tool.group == "Parts")
# The button of the catalogue goes by the name of the tool that has a part of it in hand.
_MORE = "more"


def _action_of(name: str) -> str:
    return "catalogue" if name == CATALOGUE else f"tool_{name}"


def offered_parts(refused: Set[str]) -> list[str]:
    """The names on the strip of parts but those of refused tools."""
    return [name for name in (*NAMES, CATALOGUE) if name not in refused]


class PartsPalette:
    """Buttons that take up what they show; `press` starts an action by its name.

    refused: names of tools that the level keeps away. left_out: names that have no room in a world of that width and
    height [layout units]; they are in a menu.
    """

    def __init__(
        self, ui: Ui, press: Callable[[str], None], top: float, width: float, height: float, refused: Set[str]
    ) -> None:
        self._ui, self._press = ui, press
        names = offered_parts(refused)
        rows, most = (
            max(1, int((side - 2 * _TOP_EDGE - 2 * _EDGE + _PALETTE_GAP) // _LEAST_STEP)) for side in (height, width)
        )
        shown = names if len(names) <= rows * most else [*names[: max(rows * most - 1, 0)], _MORE]
        self.left_out = [name for name in names if name not in shown]
        count = len(shown)
        columns = -(-count // min(rows, count))
        rows = -(-count // columns)
        width, tall = (
            columns * (PALETTE_BUTTON + _PALETTE_GAP) - _PALETTE_GAP + 2 * _EDGE,
            rows * _LEAST_STEP - _PALETTE_GAP + 2 * _EDGE,
        )
        # Its right edge [layout units].
        self.right = _LEFT_EDGE + width
        self.back = ui.panel(ui.rect(_LEFT_EDGE, top + _TOP_EDGE, width, tall), style="card")
        self.buttons: dict[str, Any] = {}
        for number, name in enumerate(shown):
            column, row = divmod(number, rows)
            place = ui.rect(
                _EDGE + column * (PALETTE_BUTTON + _PALETTE_GAP),
                _EDGE + row * _LEAST_STEP,
                PALETTE_BUTTON,
                PALETTE_BUTTON,
            )
            tip = "More buttons" if name == _MORE else tip_of(_action_of(name), "play")
            do = self._show_menu if name == _MORE else functools.partial(press, _action_of(name))
            icon = picture_of(name, ui.px(_PICTURE)) if name in PARTS else name
            self.buttons[name] = ui.button(place, "", do, self.back, tip=tip, style="quiet", icon=icon)

    def _show_menu(self) -> None:
        """Open the menu of parts that do not fit on the strip."""
        actions = [_action_of(name) for name in self.left_out]
        choices = [(tip_of(action, "play"), functools.partial(self._press, action)) for action in actions]
        choose(self._ui, "More", "", choices)

    def show(self, tool: str) -> None:
        """Show the tool in use."""
        for name, button in self.buttons.items():
            button.is_selected = name == tool or (name == _MORE and tool in self.left_out)
