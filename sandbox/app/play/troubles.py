"""Troubles: what goes wrong in a run is found, said, and mended by buttons that are there as long as there is need."""

from collections.abc import Callable

import pygame

from sandbox.app.contracts.application import Application
from sandbox.app.draw.camera import Box
from sandbox.app.play.out_of_view import NOTICE as LEFT_VIEW
from sandbox.app.play.out_of_view import OutOfView, put_back
from sandbox.app.play.remedies import Remedies
from sandbox.app.play.stage import Stage
from sandbox.app.play.stuck import NOTICE as STUCK
from sandbox.app.play.stuck import StuckBodies
from sandbox.app.widgets.dialogs import show_lines
from sandbox.app.widgets.ui import Ui


class Troubles:
    """What is stuck, what has left the picture, what went out of bounds and what broke in the run of a stage.

    say: shows a line about the run.
    """

    def __init__(self, app: Application, stage: Callable[[], Stage], say: Callable[[str], None]) -> None:
        self._app, self._stage, self._say = app, stage, say
        self.begin()
        self.actions: dict[str, Callable[[], object]] = {
            "free": self._free, "bring_back": self._bring_back, "details": self._show_details
        }  # fmt: skip

    def begin(self) -> None:
        """Forget all of the run before, and look at another."""
        self.stuck, self.out_of_view = StuckBodies(), OutOfView()
        # What was last said of what broke, and of what went out of bounds.
        self._last_said = ["", ""]

    def build(self, ui: Ui, left: float, top: float) -> None:
        """Make the buttons, from a place on [layout units]."""
        self._ui = ui
        self.remedies = Remedies(ui, self._app.act, tuple(self.actions), left, top)

    def update(self) -> None:
        """Look at the run after its ticks."""
        self._look_for_stuck()
        self._look_for_lost()
        self._tell()
        words = {}
        if self.stuck.particles:
            words["free"] = "Free it"
        if self.out_of_view.lost_count:
            words["bring_back"] = f"Bring back {self.out_of_view.lost_count}"
        if self._details:
            words["details"] = "Details"
        self.remedies.show(words)

    def draw(self, surface: pygame.Surface) -> None:
        """Mark what is stuck."""
        stage = self._stage()
        self.stuck.draw(surface, self._ui, stage.camera, stage.playback.current)

    def _look_for_stuck(self) -> None:
        before = len(self.stuck.particles)
        self.stuck.update(self._stage().playback.session.world)
        found = len(self.stuck.particles)
        if found > before:
            self._say(STUCK)
        elif before and not found:
            self._app.take_back(STUCK)

    def _free(self) -> None:
        """Free what is stuck, all in one gesture."""
        self._app.take_back(STUCK)
        if not self.stuck.free(self._stage().playback):
            self._say("Nothing is stuck.")

    @property
    def _pictures(self) -> list[Box]:
        """The boxes [m] that are seen at first, and now."""
        camera = self._stage().camera
        return [camera.picture_of(self._stage().first_box), camera.picture]

    def _look_for_lost(self) -> None:
        was_over = self.out_of_view.is_over
        self.out_of_view.update(self._stage().playback.session.world, self._pictures)
        if self.out_of_view.is_over and not was_over:
            self._say(LEFT_VIEW)
        elif was_over and not self.out_of_view.is_over:
            self._app.take_back(LEFT_VIEW)

    def _bring_back(self) -> None:
        """Put what has left the picture back into it, at rest."""
        stage = self._stage()
        count = put_back(stage.playback, stage.first_box, self._pictures)
        self.out_of_view = OutOfView()
        self._app.take_back(LEFT_VIEW)
        verb = "is" if count == 1 else "are"
        self._say(f"{count} {verb} back in the picture." if count else "Nothing has left the picture.")

    def _tell(self) -> None:
        """Say what broke, and what was stopped; a line that has grown takes the place of what it was."""
        playback = self._stage().playback
        told = [playback.breaks.text, playback.stopped.text(playback.session.tick)]
        for text, before in zip(told, self._last_said, strict=True):
            if text != before:
                self._app.take_back(before)
                if text:
                    self._say(text)
        self._last_said = told

    @property
    def _details(self) -> list[str]:
        playback = self._stage().playback
        return playback.stopped.details(playback.session.tick)

    def _show_details(self) -> None:
        """Show what went out of bounds, with ticks and names of slots."""
        if self._details:
            show_lines(self._ui, "What went out of bounds", self._details)
        else:
            self._say("Nothing went out of bounds.")
