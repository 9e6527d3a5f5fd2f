"""PadMaps: the menu of what the pad shows: theory, or what runs of this level at every Cs and Cd have measured."""

from typing import Any

import pygame

from sandbox.app.panel.coefficient_pad import CoefficientPad
from sandbox.app.panel.sweeps.pad_sweeps import PadSweeps, measures_of
from sandbox.app.run.playback import Playback
from sandbox.app.widgets.picker import WordPicker
from sandbox.app.widgets.texts import wrapped
from sandbox.app.widgets.ui import Ui

THEORY = "Theory"
# Size of a menu's text, and what the menu has beside it [layout units].
MENU_TEXT, MENU_EDGES = 13.0, 40.0


class PadMaps:
    """Keeps a pad at what is chosen; sweeps: outlives it when the panel is laid out again."""

    def __init__(self, ui: Ui, place: pygame.Rect, playback: Playback, sweeps: PadSweeps, container: Any) -> None:
        self._ui, self.sweeps = ui, sweeps
        self._figures: dict[str, str | None] = {THEORY: None}
        room = place.width - ui.px(MENU_EDGES)
        for name, figure in measures_of(playback.level).items():
            # Names of checks may be of any length; two that begin alike are told apart by their numbers.
            (shown,) = wrapped(name, ui.font(MENU_TEXT), room, 1)
            number = len(self._figures)
            self._figures[shown if shown not in self._figures else f"{number} {shown}"] = figure
        self.menu = WordPicker(ui, place, list(self._figures), self._chosen, self._choose, container)

    @property
    def _chosen(self) -> str:
        return next((name for name, figure in self._figures.items() if figure == self.sweeps.measure), THEORY)

    def _choose(self, name: str) -> None:
        self.sweeps.show(self._figures[name])

    @property
    def note(self) -> str:
        """How far the runs are."""
        known, runs = self.sweeps.progress
        if self.sweeps.error is not None:
            return self.sweeps.error
        return "" if known == runs else f"{known} of {runs} runs"

    def refresh(self, playback: Playback, material: int | None, pad: CoefficientPad) -> None:
        """Take up what is new, for the springs of a material (None = all) as a run has its settings now."""
        world = playback.session.world
        name = None if material is None else list(world.material_names)[material]
        self.sweeps.follow(playback.level, world.settings, name)
        self.sweeps.update()
        self.menu.show_chosen(self._chosen)
        showing = self.sweeps.measure is not None
        pad.show_layer(self.sweeps.layer if showing else None, self.note if showing else "")
