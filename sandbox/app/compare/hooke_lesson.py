"""HookeLesson: Hooke's spring and the article's side by side, made stiffer until the one explodes."""

from collections.abc import Callable

import numpy as np
import pygame

from sandbox.app.base.profile import Profile
from sandbox.app.compare.compare_screen import CompareScreen
from sandbox.app.compare.difference import draw_card_of_words
from sandbox.app.compare.hooke_level import CD, C, SpringTrial, lesson_level
from sandbox.app.compare.lesson_panel import LessonPanel
from sandbox.app.compare.twin import TwinPlayback
from sandbox.app.contracts.application import Application
from sandbox.app.contracts.screen import Pixel
from sandbox.app.panel.panel_rows import SidePanel
from sandbox.app.play.toolbar import BAR_HEIGHT
from sandbox.app.widgets.ui import Ui
from sandbox.physics.world import World

# Who is farther away than this [m], or faster [m/s], has exploded: a weight that hangs comes to neither.
FAR, FAST = 60.0, 2e4
# From the middle of a half to the button below the words in it [layout units].
BELOW_WORDS = 38.0


def has_exploded(world: World) -> bool:
    """Whether something of a world has left all bounds."""
    position, velocity = world.position, world.velocity
    with np.errstate(over="ignore", invalid="ignore"):
        return not bool(np.all(np.abs(position) < FAR) and np.all(np.abs(velocity) < FAST))


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
        """Let time pass, and look whether it has exploded."""
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
        """Draw both, and the word for what happened."""
        super().draw(surface, profile)
        if self.exploded_at is not None:
            draw_card_of_words(surface, self._ui, pygame.Rect(self.viewport), "It exploded.")

    def captions(self) -> tuple[list[str], list[str]]:
        """What stands over each half: the formula and its numbers."""
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
