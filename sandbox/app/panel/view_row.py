"""ViewRow: a row of small buttons that show overlays over the world, or no longer, each with its key in its tip."""

from collections.abc import Callable, Sequence, Set
from functools import partial
from typing import Any

import pygame

from sandbox.app.base.shortcuts import tip_of
from sandbox.app.widgets.ui import Ui

ICON = 17.0
GAP = 3.0


class ViewRow:
    """The buttons of overlays; toggle: what a press does with the name of one."""

    def __init__(
        self, ui: Ui, rect: pygame.Rect, names: Sequence[str], toggle: Callable[[str], None], container: Any
    ) -> None:  # fmt: skip
        self.buttons = {}
        step = (rect.width + ui.px(GAP)) / len(names)
        for index, name in enumerate(names):
            left, right = round(index * step), round((index + 1) * step - ui.px(GAP))
            place = pygame.Rect(rect.left + left, rect.top, right - left, rect.height)
            self.buttons[name] = ui.button(
                place, "", partial(toggle, name), container, style="segment", icon=name, icon_size=ICON,
                tip=tip_of(name, "play"),
            )  # fmt: skip

    def show(self, shown: Set[str]) -> None:
        """Mark those that are shown."""
        for name, button in self.buttons.items():
            button.is_selected = name in shown
