"""Remedies: buttons below the bar for what went wrong in a run, each as long as there is a reason for it."""

from collections.abc import Callable, Mapping
from functools import partial

import pygame

from sandbox.app.base.shortcuts import tip_of
from sandbox.app.widgets.ui import Ui

# Size of a button, and how far it is from the next [layout units].
WIDTH, HEIGHT, GAP = 124.0, 34.0, 6.0


class Remedies:
    """Buttons by the names of what they do, from a place on [layout units]; `press` does that."""

    def __init__(self, ui: Ui, press: Callable[[str], None], names: tuple[str, ...], left: float, top: float) -> None:
        self._ui, self._left, self._top = ui, left, top
        self.buttons = {
            name: ui.button(self._place(0), "", partial(press, name), tip=tip_of(name, "play")) for name in names
        }
        for button in self.buttons.values():
            button.visible = False

    def _place(self, row: int) -> pygame.Rect:
        return self._ui.rect(self._left, self._top + row * (HEIGHT + GAP), WIDTH, HEIGHT)

    def show(self, words: Mapping[str, str]) -> None:
        """Show those that there are words for, one below the other, and no others."""
        for row, (name, text) in enumerate(words.items()):
            self.buttons[name].show_text(text)
            self.buttons[name].move_to(self._place(row).topleft)
        for name, button in self.buttons.items():
            button.visible = name in words
