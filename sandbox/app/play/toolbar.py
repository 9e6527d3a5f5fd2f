"""Toolbar: the bar at the top with tools, time and files; and the palette, the strip of parts at the left."""

import functools
from collections.abc import Callable, Sequence, Set
from dataclasses import dataclass
from functools import partial
from typing import Any

from sandbox.app.base.shortcuts import tip_of
from sandbox.app.draw.colours import ACCENT, DANGER, DISABLED, Colour
from sandbox.app.draw.picture import picture_of
from sandbox.app.play.stage import CATALOGUE
from sandbox.app.widgets.button import BarTitle
from sandbox.app.widgets.dialogs import choose
from sandbox.app.widgets.ui import Ui
from sandbox.level.document.model import Level
from sandbox.tools.dropping import PARTS
from sandbox.tools.play_tools import PLAY_TOOLS

# Sizes in layout units.
BAR_HEIGHT = 52.0
BUTTON = 34.0
GAP = 6.0
ICON = 18.0
SLOW_WIDTH = 46.0
MARGIN = 14.0
SHARE_WIDTH = 68.0
# Narrower windows leave the level's name out, and the wider gaps between the groups; and so does less room for it.
ROOM_FOR_NAME = 1000.0
LEAST_NAME = 90.0
WIDE_GAP, NARROW_GAP = 16.0, 4.0
# Groups of actions from the left, and those at the right end, with their pictures.
LEFT = (
    (("edit", "edit"),),
    (("tool_drag", "drag"), ("tool_pin", "pin"), ("tool_cut", "cut"), ("palette", "parts")),
    (("undo", "undo"), ("redo", "redo")),
    (("reset", "reset"), ("pause", "pause"), ("step", "step"), ("slow", ""), ("timeline", "timeline")),
    (("keep", "keep"),),
    (("save", "save"), ("record", "record")),
)  # fmt: skip
RIGHT = (
    ("share", "share"),
    ("toy", "toy"),
    ("graphs", "graphs"),
    ("ghost", "ghost"),
    ("compare", "compare"),
    ("gallery", "levels"),
    ("sound", "sound"),
    ("settings", "settings"),
    ("fit", "fit"),
    ("panel", "panel"),
    ("help", ""),
)
# Words on the buttons that have no picture; in a wide window on that to share too.
WORDS = {"slow": "1x", "help": "?"}
WIDE_WORDS = {**WORDS, "share": "Share"}
# What goes into the menu where the window is too narrow, first what is missed least.
LEAVING = (
    "toy",
    "compare",
    "ghost",
    "graphs",
    "settings",
    "timeline",
    "record",
    "sound",
    "fit",
    "redo",
    "step",
    "help",
    "slow",
    "keep",
    "share",
    "save",
    "panel",
    "palette",
    "tool_pin",
    "edit",
)


@dataclass(frozen=True)
class BarState:
    """The state of run and window that the bar's buttons show."""

    name: str
    tool: str
    paused: bool
    speed: float
    recording: bool
    can_undo: bool
    can_redo: bool
    panel: bool
    palette: bool
    sound: bool
    timeline: bool
    graphs: bool
    ghost: bool


def fitting(actions: Sequence[str], width: float, is_wide: bool = False) -> list[str]:
    """The actions whose buttons fit side by side into a width [layout units], the menu's button included.

    is_wide: with words on them and wider gaps between the groups.
    """
    available, shown = width - BUTTON - GAP, list(actions)
    for action in LEAVING:
        needed = sum(_width(each, is_wide) + GAP for each in shown) + (WIDE_GAP if is_wide else NARROW_GAP) * len(LEFT)
        if needed <= (width if len(shown) == len(actions) else available):
            break
        if action in shown:
            shown.remove(action)
    return shown


def _width(action: str, is_wide: bool = False) -> float:
    return {"slow": SLOW_WIDTH, "share": SHARE_WIDTH if is_wide else BUTTON}.get(action, BUTTON)


class Toolbar:
    """Buttons for every action of the bar but those in `without`; `press` starts an action by its name.

    refused: names of tools that are greyed, as the level keeps them away.
    """

    def __init__(
        self, ui: Ui, press: Callable[[str], None], without: Set[str] = frozenset(), refused: Set[str] = frozenset()
    ) -> None:
        self._ui, self._press = ui, press
        self._state: BarState | None = None
        width = ui.units[0]
        self.back = ui.panel(ui.rect(0, 0, width, BAR_HEIGHT))
        self._pictures = dict(entry for group in (*LEFT, RIGHT) for entry in group)
        offered = [action for action in self._pictures if action not in without]
        is_wide = self._is_wide = width >= ROOM_FOR_NAME
        shown = fitting(offered, width - 2 * MARGIN, is_wide)
        self.left_out = [action for action in offered if action not in shown]
        self.buttons: dict[str, Any] = {}
        self._x = MARGIN
        for group in LEFT:
            for action, _ in group:
                if action in shown:
                    self._add(action)
            self._x += WIDE_GAP if is_wide else NARROW_GAP
        title_left = self._x + 4
        at_right = [action for action, _ in RIGHT if action in shown]
        at_end = [*at_right, *(["more"] if self.left_out else [])]
        self._x = width - MARGIN + GAP - sum(_width(action, is_wide) + GAP for action in at_end)
        self.title: BarTitle | None = None
        name_width = self._x - title_left - 14
        if is_wide and name_width >= LEAST_NAME:
            self.title = BarTitle(ui, ui.rect(title_left, 0, name_width, BAR_HEIGHT), self.back)
        for action in at_right:
            self._add(action)
        if self.left_out:
            self._pictures["more"] = "more"
            self._add("more", self._show_menu, "More buttons")
        self.tools = {name: self.buttons.get(f"tool_{name}") for name in ("drag", "pin", "cut")}
        for name, button in self.tools.items():
            if button is not None:
                button.is_enabled = name not in refused

    def _show_menu(self) -> None:
        """Open the menu of actions that do not fit on the bar."""
        press = self._press
        choices = [(tip_of(action, "play"), partial(press, action)) for action in self.left_out]
        choose(self._ui, "More", "", choices)

    def show(self, state: BarState) -> None:
        """Show a state, changing what differs."""
        before, self._state = self._state, state
        if state == before:
            return
        for name in self.tools:
            self._mark(f"tool_{name}", name == state.tool)
        self._picture("pause", "play" if state.paused else "pause", ACCENT if state.paused else None)
        self._picture("record", "stop" if state.recording else "record", DANGER)
        self._picture("sound", "sound" if state.sound else "muted", None if state.sound else DISABLED)
        for name in ("panel", "palette", "timeline", "graphs", "ghost"):
            self._mark(name, getattr(state, name))
        self._mark("record", state.recording)
        self._mark("slow", state.speed != 1.0)
        for name, on in (("undo", state.can_undo), ("redo", state.can_redo)):
            if name in self.buttons:
                self.buttons[name].is_enabled = on
        if "slow" in self.buttons:
            self.buttons["slow"].show_text(words_of(state.speed))
        if self.title is not None:
            self.title.show_text(state.name)

    def _mark(self, action: str, on: bool) -> None:
        """Show an action's button as on or off, where it is on the bar."""
        if action in self.buttons:
            self.buttons[action].is_selected = on

    def _picture(self, action: str, icon: str, tint: Colour | None) -> None:
        """Show another icon on an action's button, where it is on the bar."""
        if action in self.buttons:
            self.buttons[action].show_icon(icon, tint)

    def _add(self, action: str, do: Callable[[], None] | None = None, tip: str = "") -> None:
        """Add an action's button at the next place; do: in place of what the table of shortcuts has."""
        width, words = _width(action, self._is_wide), (WIDE_WORDS if self._is_wide else WORDS).get(action, "")
        place = self._ui.rect(self._x, (BAR_HEIGHT - BUTTON) / 2, width, BUTTON)
        self._x += width + GAP
        self.buttons[action] = self._ui.button(
            place,
            words,
            do or partial(self._press, action),
            self.back,
            icon="" if words else self._pictures[action],
            tip=tip or tip_of(action, "play"),
            style="" if action == "share" and words else "quiet",
        )


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


def refused_tools(level: Level) -> set[str]:
    """The names of tools that hands may not use in a level, that of the catalogue too."""
    if level.hands is None:
        return set()
    allows = level.hands.allows
    refused = {name for name, tool in PLAY_TOOLS.items() if not allows(tool.deed)}
    return refused if allows("add") else refused | {CATALOGUE}


class PartsPalette:
    """Buttons that take up what they show; `press` starts an action by its name.

    refused: names of tools that are greyed, as the level keeps them away. left_out: names that have no room in a world
    of that width and height [layout units]; they are in a menu.
    """

    def __init__(
        self, ui: Ui, press: Callable[[str], None], top: float, width: float, height: float, refused: Set[str]
    ) -> None:
        self._ui, self._press = ui, press
        names = [*NAMES, CATALOGUE]
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
            self.buttons[name].is_enabled = name not in refused

    def _show_menu(self) -> None:
        """Open the menu of parts that do not fit on the strip."""
        actions = [_action_of(name) for name in self.left_out]
        choices = [(tip_of(action, "play"), functools.partial(self._press, action)) for action in actions]
        choose(self._ui, "More", "", choices)

    def show(self, tool: str) -> None:
        """Show the tool in use."""
        for name, button in self.buttons.items():
            button.is_selected = name == tool or (name == _MORE and tool in self.left_out)
