"""Palette: a strip at the left of the world with parts to drop and tools to use while it runs."""

import functools
from collections.abc import Callable, Set
from typing import Any

from sandbox.app.base.shortcuts import tip_of
from sandbox.app.draw.part_pictures import picture_of
from sandbox.app.play.stage import CATALOGUE
from sandbox.app.widgets.dialogs import choose
from sandbox.app.widgets.ui import Ui
from sandbox.level.document.model import Level
from sandbox.tools.dropping import PARTS
from sandbox.tools.play_tools import PLAY_TOOLS

# Sizes in layout units.
LEFT, TOP, BUTTON, GAP, EDGE = 10.0, 10.0, 34.0, 3.0, 5.0
WIDTH = BUTTON + 2 * EDGE
PICTURE = 30.0
# Where the window has less height for a button, there are two columns.
LEAST_STEP = BUTTON + GAP


NAMES = tuple(name for name, tool in PLAY_TOOLS.items() if tool.group == "Parts")
# The button of the catalogue goes by the name of the tool that has a part of it in hand.
MORE = "more"


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
        rows, most = (max(1, int((room - 2 * TOP - 2 * EDGE + GAP) // LEAST_STEP)) for room in (height, width))
        shown = names if len(names) <= rows * most else [*names[: max(rows * most - 1, 0)], MORE]
        self.left_out = [name for name in names if name not in shown]
        count = len(shown)
        columns = -(-count // min(rows, count))
        rows = -(-count // columns)
        width, tall = columns * (BUTTON + GAP) - GAP + 2 * EDGE, rows * LEAST_STEP - GAP + 2 * EDGE
        # Its right edge [layout units].
        self.right = LEFT + width
        self.back = ui.panel(ui.rect(LEFT, top + TOP, width, tall), style="card")
        self.buttons: dict[str, Any] = {}
        for number, name in enumerate(shown):
            column, row = divmod(number, rows)
            place = ui.rect(EDGE + column * (BUTTON + GAP), EDGE + row * LEAST_STEP, BUTTON, BUTTON)
            tip = "More buttons" if name == MORE else tip_of(_action_of(name), "play")
            do = self._show_menu if name == MORE else functools.partial(press, _action_of(name))
            icon = picture_of(name, ui.px(PICTURE)) if name in PARTS else name
            self.buttons[name] = ui.button(place, "", do, self.back, tip=tip, style="quiet", icon=icon)
            self.buttons[name].is_enabled = name not in refused

    def _show_menu(self) -> None:
        """Offer what has no room on the strip."""
        actions = [_action_of(name) for name in self.left_out]
        choices = [(tip_of(action, "play"), functools.partial(self._press, action)) for action in actions]
        choose(self._ui, "More", "", choices)

    def show(self, tool: str) -> None:
        """Show the tool in use."""
        for name, button in self.buttons.items():
            button.is_selected = name == tool or (name == MORE and tool in self.left_out)
