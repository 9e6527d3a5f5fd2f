"""Watch: looks for faults and works out where everything will hang, a little in every frame."""

import time
from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

from sandbox.editor.forecast import Forecast
from sandbox.editor.lint import Finding, findings
from sandbox.editor.scene import Scene
from sandbox.level.model import Level

if TYPE_CHECKING:
    from sandbox.app.edit.screen import EditScreen

# Time [s] that each of the two may take of a frame, and how long the level has to stay as it is before they begin.
SLICE = 0.004
PATIENCE = 0.25


class Watch:
    """Findings about the level on the screen, and its forecast while it is asked for."""

    def __init__(self, screen: "EditScreen") -> None:
        self._screen = screen
        self.findings: list[Finding] = []
        self.forecasts = False
        self.forecast: Forecast | None = None
        self._level: Level | None = None
        self._since = 0.0
        self._lint: Iterator[Finding | None] | None = None
        self._found: list[Finding] = []
        self._hanging: tuple[Forecast, Scene, Scene] | None = None

    def toggle_forecast(self) -> None:
        """Work out where everything will hang, or no longer."""
        self.forecasts = not self.forecasts
        self.forecast = None
        self._level = None

    def update(self, frame_time: float) -> None:
        """Go on with both for a moment."""
        level = self._screen.document.level
        if level is not self._level:
            self._level, self._since = level, 0.0
            self._lint = self.forecast = None
        before, self._since = self._since, self._since + frame_time
        if self._since < PATIENCE:
            return
        if before < PATIENCE:
            self._lint, self._found = findings(level, self._screen.scene), []
            self.forecast = Forecast(level) if self.forecasts and self._screen.scene.items else None
        self._look()
        if self.forecast is not None:
            self.forecast.advance(SLICE)

    def _look(self) -> None:
        if self._lint is None:
            return
        end = time.perf_counter() + SLICE
        for found in self._lint:
            if found is not None:
                self._found.append(found)
            if time.perf_counter() > end:
                return
        self._lint, self.findings = None, self._found

    def forecast_scene(self, scene: Scene) -> Scene | None:
        """The scene with everything where it will hang, once that is known."""
        forecast = self.forecast
        if forecast is None or forecast.position is None or self._level is not scene.level:
            return None
        if self._hanging is None or self._hanging[0] is not forecast or self._hanging[1] is not scene:
            self._hanging = (forecast, scene, replace(scene, position=forecast.position))
        return self._hanging[2]
