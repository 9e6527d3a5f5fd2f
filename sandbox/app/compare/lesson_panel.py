"""LessonPanel: the panel of the lesson on Hooke's spring: what to see and try, and what can be changed."""

from collections.abc import Callable, Set
from dataclasses import replace

import pygame

from sandbox.app.compare.hooke_level import CD, FIRST_CS, FIRST_K, MOST_DOUBLINGS, C, SpringTrial, words
from sandbox.app.compare.limit_gauge import LimitGauge
from sandbox.app.draw.colours import TEXT
from sandbox.app.panel.coefficient_pad import CoefficientPad
from sandbox.app.panel.panel_rows import INSIDE, MARGIN, PANEL_WIDTH
from sandbox.app.run.playback import Playback
from sandbox.app.widgets.button import Choice
from sandbox.app.widgets.scroll import ScrollArea
from sandbox.app.widgets.texts import TextBlock
from sandbox.app.widgets.ui import Ui

# Sizes in layout units.
ROW, GAUGE, WORDS_HEIGHT = 32.0, 42.0, 124.0
MASSES, RATES, SPRINGS = (0.1, 1.0, 10.0), (30, 60, 240), (1, 6)


class LessonPanel:
    """The panel; change: what is done with another trial, restart: what begins the same trial again."""

    pad: CoefficientPad | None = None
    material: int | None = None

    def __init__(
        self, ui: Ui, playback: Playback, trial: SpringTrial, change: Callable[[SpringTrial], None],
        restart: Callable[[], None], top: float, height: float,
    ) -> None:  # fmt: skip
        self._ui, self.playback, self._trial, self._change = ui, playback, trial, change
        self._exploded_at: int | None = None
        background = ui.panel(ui.rect(ui.units[0] - PANEL_WIDTH, top, PANEL_WIDTH, height))
        self.area = ScrollArea(ui, ui.rect(0, 0, PANEL_WIDTH, height), background)
        self._back, self._y = self.area.content, 14.0
        self._build(restart)
        self.area.set_height(ui.px(self._y + 8))
        self.refresh()

    def _build(self, restart: Callable[[], None]) -> None:
        ui, back = self._ui, self._back
        TextBlock(ui, self._next(24, 2), "Stiffer, until it explodes", back, 15.0, TEXT, is_bold=True)
        self.text = TextBlock(ui, self._next(WORDS_HEIGHT, 6), "", back, 12.5, TEXT)
        place = self._next(ROW + 2, 10)
        half = (place.width - ui.px(8)) // 2
        first, second = place.copy(), place.move(half + ui.px(8), 0)
        first.width = second.width = half
        self.stiffer = ui.button(first, "Stiffer × 2", lambda: self._stiffen(1), back, style="primary")
        self.softer = ui.button(second, "Softer ÷ 2", lambda: self._stiffen(-1), back)
        self.hooke = LimitGauge(ui, self._next(GAUGE, 4), FIRST_K / 2, FIRST_K * 2.0**MOST_DOUBLINGS, back)
        self.article = LimitGauge(ui, self._next(GAUGE, 8), FIRST_CS / 2, FIRST_CS * 2.0**MOST_DOUBLINGS, back)
        self.masses = self._choice("Weight", [(f"{mass:g}", f"{mass:g} kg") for mass in MASSES], self._set_mass)
        self.rates = self._choice("Ticks a second", [(str(rate), str(rate)) for rate in RATES], self._set_rate)
        self.springs = self._choice("Springs", [("1", "One"), ("6", "Six in a row")], self._set_springs)
        self.restart_button = ui.button(self._next(ROW, 4), "Again", restart, back, tip="Both from the beginning  [R]")

    def _next(self, height: float, gap: float) -> pygame.Rect:
        place = self._ui.rect(MARGIN, self._y, INSIDE, height)
        self._y += height + gap
        return place

    def _choice(self, title: str, options: list[tuple[str, str]], choose: Callable[[str], None]) -> Choice:
        self._ui.label(self._next(18, 1), title, self._back, "muted")
        return self._ui.choice(self._next(26, 8), [(value, text, "") for value, text in options], choose, self._back)

    # Changing.

    def _stiffen(self, by: int) -> None:
        doublings = min(max(self._trial.doublings + by, 0), MOST_DOUBLINGS)
        self._change(replace(self._trial, doublings=doublings))

    def _set_mass(self, value: str) -> None:
        self._change(replace(self._trial, mass=float(value)))

    def _set_rate(self, value: str) -> None:
        self._change(replace(self._trial, rate=int(value)))

    def _set_springs(self, value: str) -> None:
        self._change(replace(self._trial, springs=int(value)))

    # Showing.

    def show_trial(self, trial: SpringTrial, exploded_at: int | None) -> None:
        """Show a trial, and when Hooke's side of it exploded."""
        self._trial, self._exploded_at = trial, exploded_at
        self.refresh()

    def refresh(self) -> None:
        """Show the trial as it is now."""
        trial = self._trial
        self.text.show_text(words(trial, self._exploded_at))
        limit = f"at most {trial.highest_k:,.0f}"
        self.hooke.show_value(trial.k, trial.highest_k, f"A  k = {trial.k:,.0f} N/m, c = {C:g}", limit)
        self.article.show_value(trial.cs, 1.0, f"B  Cs = {trial.cs:g}, Cd = {CD:g}", "at most 1, always")
        self.masses.show(f"{trial.mass:g}")
        self.rates.show(str(trial.rate))
        self.springs.show(str(trial.springs))
        self.stiffer.is_enabled = trial.doublings < MOST_DOUBLINGS
        self.softer.is_enabled = trial.doublings > 0

    def show_choices(self, strength: str, views: Set[str]) -> None:
        """Show nothing: the lesson has neither the strength of the hand nor overlays."""

    def choose_material(self, material: int | None) -> None:
        """Change nothing: the lesson has one material alone."""

    def attach(self, playback: Playback) -> None:
        """Show and change another run of the lesson."""
        self.playback = playback
