"""HookeLesson: Hooke's spring and the article's side by side, made stiffer until the one explodes."""

import math
from collections.abc import Callable, Set
from dataclasses import replace
from typing import Any

import numpy as np
import pygame

from sandbox.app.base.loop import Profile
from sandbox.app.compare.compare_screen import CompareScreen, draw_card_of_words
from sandbox.app.compare.hooke_level import CD, FIRST_CS, FIRST_K, MOST_DOUBLINGS, C, SpringTrial, lesson_level, words
from sandbox.app.compare.second_run import TwinPlayback
from sandbox.app.contracts.application import Application
from sandbox.app.contracts.screen import Pixel
from sandbox.app.draw.colours import ACCENT, DANGER, DECADE, LINE, MUTED, SURFACE, TEXT, mixed
from sandbox.app.panel.coefficient_pad import CoefficientPad
from sandbox.app.panel.panel_rows import PANEL_WIDTH, PanelRows, SidePanel
from sandbox.app.play.toolbar import BAR_HEIGHT
from sandbox.app.run.playback import Playback
from sandbox.app.widgets.button import Choice
from sandbox.app.widgets.scroll import ScrollArea
from sandbox.app.widgets.texts import TextBlock
from sandbox.app.widgets.ui import Ui
from sandbox.app.widgets.widget import Widget
from sandbox.physics.world import World

# Who is farther away than this [m], or faster [m/s], has exploded: a weight that hangs comes to neither.
FAR, FAST = 60.0, 2e4
# From the middle of a half to the button below the words in it [layout units].
BELOW_WORDS = 38.0
# Sizes in layout units.
ROW, GAUGE, WORDS_HEIGHT = 32.0, 42.0, 124.0
MASSES, RATES, SPRINGS = (0.1, 1.0, 10.0), (30, 60, 240), (1, 6)
# Sizes in layout units.
TEXT_SIZE, TRACK, KNOB, SIDE = 11.5, 5.0, 6.0, 8.0


class HookeLesson(CompareScreen):
    """The lesson; A is Hooke's spring, B the article's."""

    welcome = ""

    def __init__(self, app: Application, trial: SpringTrial | None = None) -> None:
        self.trial = SpringTrial() if trial is None else trial
        self.exploded_at: int | None = None
        super().__init__(app, *self._runs(), None)
        self._wants_panel = True

    def _runs(self) -> tuple[TwinPlayback, TwinPlayback]:
        return TwinPlayback(lesson_level(self.trial, True)), TwinPlayback(lesson_level(self.trial, False))

    def build(self, ui: Ui) -> None:
        """Lay everything out again; the panel is there in every window."""
        self._wants_panel = True if self._wants_panel is None else self._wants_panel
        super().build(ui)
        left, top, width, height = self.viewport
        place = self.restart_button.rect.copy()
        place.midtop = (left + width // 2, top + height // 2 + ui.px(BELOW_WORDS))
        self.restart_button.move_to(place.topleft)

    def _make_panel(self, ui: Ui, choices: dict[str, Callable[[str], None]], height: float) -> SidePanel:
        panel = LessonPanel(ui, self.playback, self.trial, self.try_out, self._reset, BAR_HEIGHT, height)
        panel.show_trial(self.trial, self.exploded_at)
        return panel

    def try_out(self, trial: SpringTrial) -> None:
        """Begin another trial."""
        self.trial = trial
        self._reset()

    def _next_runs(self) -> tuple[TwinPlayback, TwinPlayback]:
        fresh = self._runs()
        fresh[0].clock.paused, fresh[0].clock.speed = self.playback.clock.paused, abs(self.playback.clock.speed)
        self.exploded_at = None
        if isinstance(self.panel, LessonPanel):
            self.panel.show_trial(self.trial, None)
        return fresh

    # A frame.

    def update(self, frame_time: float, pointer: Pixel | None, profile: Profile) -> None:
        """Let time pass, and look whether one of the springs has exploded."""
        super().update(frame_time, pointer, profile)
        world = self.playback.session.world
        if self.exploded_at is None and has_exploded(world):
            self.exploded_at = world.tick
            if isinstance(self.panel, LessonPanel):
                self.panel.show_trial(self.trial, self.exploded_at)

    def _tell(self) -> None:
        """Show the run's messages until a spring explodes; after that the lesson says better what happened."""
        if self.exploded_at is not None:
            self.playback.messages.clear()
        super()._tell()

    def _show_again(self) -> None:
        self.restart_button.visible = self.exploded_at is not None

    def draw(self, surface: pygame.Surface, profile: Profile) -> None:
        """Draw both springs, and the word for what happened."""
        super().draw(surface, profile)
        if self.exploded_at is not None:
            draw_card_of_words(surface, self._ui, pygame.Rect(self.viewport), "It exploded.")

    def captions(self) -> tuple[list[str], list[str]]:
        """The caption of each half: the formula and its numbers."""
        trial = self.trial
        return (
            ["Hooke: F = -k x - c v", f"k = {trial.k:,.0f} N/m   c = {C:g} N s/m"],
            ["The article: fractions of rigid", f"Cs = {trial.cs:g}   Cd = {CD:g}"],
        )

    def _settings_words(self) -> list[str]:
        return ["   ".join(lines) for lines in self.captions()]

    def states(self) -> list[str]:
        """State words for the window's title: those of the run, and whether a spring has exploded."""
        return [*super().states(), *([] if self.exploded_at is None else ["exploded"])]


def has_exploded(world: World) -> bool:
    """Whether something of a world has left all bounds."""
    position, velocity = world.position, world.velocity
    with np.errstate(over="ignore", invalid="ignore"):
        return not bool(np.all(np.abs(position) < FAR) and np.all(np.abs(velocity) < FAST))


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
        self._rows = PanelRows(ui, self.area.content)
        self._build(restart)
        self.area.set_height(ui.px(self._rows.y + 8))
        self.refresh()

    def _build(self, restart: Callable[[], None]) -> None:
        ui, row, back = self._ui, self._rows.row, self._rows.back
        TextBlock(ui, row(24, 2), "Stiffer, until it explodes", back, 15.0, TEXT, is_bold=True)
        self.text = TextBlock(ui, row(WORDS_HEIGHT, 6), "", back, 12.5, TEXT)
        place = row(ROW + 2, 10)
        half = (place.width - ui.px(8)) // 2
        first, second = place.copy(), place.move(half + ui.px(8), 0)
        first.width = second.width = half
        self.stiffer = ui.button(first, "Stiffer × 2", lambda: self._stiffen(1), back, style="primary")
        self.softer = ui.button(second, "Softer ÷ 2", lambda: self._stiffen(-1), back)
        self.hooke = LimitGauge(ui, row(GAUGE, 4), FIRST_K / 2, FIRST_K * 2.0**MOST_DOUBLINGS, back)
        self.article = LimitGauge(ui, row(GAUGE, 8), FIRST_CS / 2, FIRST_CS * 2.0**MOST_DOUBLINGS, back)
        self.masses = self._choice("Weight", [(f"{mass:g}", f"{mass:g} kg") for mass in MASSES], self._set_mass)
        self.rates = self._choice("Ticks a second", [(str(rate), str(rate)) for rate in RATES], self._set_rate)
        self.springs = self._choice("Springs", [("1", "One"), ("6", "Six in a row")], self._set_springs)
        self.restart_button = ui.button(row(ROW, 4), "Again", restart, back, tip="Both from the beginning  [R]")

    def _choice(self, title: str, options: list[tuple[str, str]], choose: Callable[[str], None]) -> Choice:
        rows = self._rows
        self._ui.label(rows.row(18, 1), title, rows.back, "muted")
        return self._ui.choice(rows.row(26, 8), [(value, text, "") for value, text in options], choose, rows.back)

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
        """Show the values of the present trial."""
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


class LimitGauge(Widget):
    """A track from low to high; beyond its limit it is hatched."""

    def __init__(self, ui: Ui, rect: pygame.Rect, low: float, high: float, container: Any = None) -> None:
        super().__init__(ui, rect, container)
        self._low, self._high = low, high
        self._shown: tuple[float, float, str, str] = (low, high, "", "")

    def show_value(self, value: float, limit: float, text: str, limit_text: str) -> None:
        """Show a value and its limit, with what stands above at the left and at the right."""
        if (value, limit, text, limit_text) != self._shown:
            self._shown = (value, limit, text, limit_text)
            self.repaint()

    def _fraction(self, value: float) -> float:
        fraction = math.log(max(value, self._low) / self._low) / math.log(self._high / self._low)
        return min(max(fraction, 0.0), 1.0)

    def paint(self, size: tuple[int, int]) -> pygame.Surface:
        """Track, limit and knob, the words above."""
        surface = pygame.Surface(size, pygame.SRCALPHA)
        px, font = self.ui.px, self.ui.font(TEXT_SIZE)
        value, limit, text, limit_text = self._shown
        is_beyond = value > limit
        left = self.ui.font(TEXT_SIZE, True).render(text, True, DANGER if is_beyond else TEXT)
        right = font.render(limit_text, True, MUTED)
        surface.blit(left, (0, 0))
        surface.blit(right, right.get_rect(topright=(size[0], 0)))
        start, length, middle = px(SIDE), size[0] - 2 * px(SIDE), size[1] - px(KNOB + 3)
        end = start + self._fraction(limit) * length
        thick = px(TRACK)
        pygame.draw.rect(surface, LINE, (start, middle - thick // 2, length, thick), border_radius=max(1, thick // 2))
        if limit < self._high:
            beyond = pygame.Rect(round(end), middle - thick // 2, round(start + length - end), thick)
            pygame.draw.rect(surface, mixed(SURFACE, DANGER, 0.35), beyond)
            for x in range(beyond.left, beyond.right, max(3, px(4))):
                pygame.draw.line(surface, DANGER, (x, beyond.bottom - 1), (min(x + thick, beyond.right), beyond.top))
        pygame.draw.line(surface, MUTED, (end, middle - px(7)), (end, middle + px(6)), max(1, px(1.5)))
        pygame.draw.line(surface, DECADE, (start, middle - px(3)), (start, middle + px(3)))
        at = (start + self._fraction(value) * length, middle)
        pygame.draw.aacircle(surface, TEXT, at, px(KNOB))
        pygame.draw.aacircle(surface, DANGER if is_beyond else ACCENT, at, px(KNOB - 2.5))
        return surface
