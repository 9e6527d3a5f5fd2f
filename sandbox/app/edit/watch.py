"""Watch: looks for faults, and works out where everything will hang and go, a little in every frame."""

import time
from collections.abc import Iterator

import numpy as np
import pygame
from numpy.typing import NDArray

from sandbox.app.contracts.application import Editing
from sandbox.app.edit.proving import Proving
from sandbox.app.panel.softness_reading import MEASURING, SoftnessReading
from sandbox.app.run.playback import Playback
from sandbox.editor.edits.bake import begin_at_rest
from sandbox.editor.forecast import Firing, Forecast, TimedCommands, Trail, timed_commands
from sandbox.editor.lint.lint import Finding, findings
from sandbox.editor.range_trial import RangeTrial
from sandbox.level.document.model import Level
from sandbox.physics.softness.firmness import LARGEST_READ
from sandbox.session.session import Session

# Time [s] that each of the two may take of a frame, and how long the level has to stay as it is before they begin.
SLICE = 0.004
PATIENCE = 0.25
# How often it is looked whether another program has written the file [s].
LOOK_EVERY = 2.0
# Time [s] of a frame for values that are tried, for which the person waits.
TRYING = 0.012


class Watch:
    """Findings about the level on the screen, and its forecast while it is asked for."""

    def __init__(self, screen: Editing) -> None:
        self._screen = screen
        # What the linter found, without what the person ignores, by its text, while the level is open.
        self.findings: list[Finding] = []
        self._ignored: dict[str, Finding] = {}
        self.forecasts = False
        self.forecast: Forecast | None = None
        # Whether trails are shown, that of the next seconds, and that of the run before.
        self.trails = False
        self.trail: Trail | None = None
        self.last_trail: Trail | None = None
        # When the rules would have fired in the run before, with the level as it is now; what was done in that run.
        self.firing: Firing | None = None
        self._commands: tuple[TimedCommands, int] | None = None
        # Values of a number that are tried.
        self.range_trial: RangeTrial | None = None
        self.proving = Proving(screen)
        # How soft play says that a body is; None: not asked for of the level as it is now, or it cannot be played.
        self._softness: SoftnessReading | None = None
        self._said = ""
        self._level: Level | None = None
        self._since = self._since_look = 0.0
        self._lint: Iterator[Finding | None] | None = None
        self._found: list[Finding] = []
        self._is_reported = False
        # Whether the level is to begin as the forecast has it, and whether that was shown before.
        self._is_pending = self._was_shown = False

    def begin_at_rest(self) -> None:
        """Start the level as it will hang: at once where that is known, else once it is."""
        if not self._screen.scene.items:
            self._screen.say("There is nothing on the sheet yet.")
            return
        self._is_pending, self._was_shown = True, self.forecasts
        if not self.forecasts:
            self.toggle_forecast()
        self._take_forecast()
        if self._is_pending:
            self._screen.say("Calculating the rest position; the level will begin there.")

    def _take_forecast(self) -> None:
        """Start everything where the forecast says it will hang, once that is known and wanted."""
        forecast, screen = self.forecast, self._screen
        if not self._is_pending or forecast is None or forecast.at_rest is None:
            return
        self._is_pending = False
        if forecast.position is None:
            screen.say(f"{forecast.text}.")
        elif self._level is screen.document.level:
            position, falling, before = forecast.position, forecast.falling, screen.document.level
            if screen.edit("Begin at rest", lambda document: begin_at_rest(document, position, falling)):
                same = screen.document.level is before
                screen.say("It is at rest already." if same else "It begins at rest now. Undo takes this back.")
        if not self._was_shown:
            self.toggle_forecast()

    def toggle_forecast(self) -> None:
        """Work out where everything will hang, or no longer."""
        self.forecasts = not self.forecasts
        self._is_pending = self._is_pending and self.forecasts
        self.forecast = None
        self._level = None

    @property
    def ignored(self) -> int:
        """How many findings are ignored."""
        return len(self._ignored)

    def ignore(self, finding: Finding) -> None:
        """Show a finding no more while the level is open."""
        self._ignored[finding.text] = finding
        self.findings = [each for each in self.findings if each is not finding]

    def show_ignored(self) -> None:
        """Look for everything again."""
        self._ignored, self._level = {}, None

    def toggle_trail(self) -> None:
        """Show where what is selected will go in the next seconds and went in the last run, or no longer."""
        self.trails = not self.trails
        self.trail = self.last_trail = None
        self._level = None
        if self.trails and not self._screen.document.selection:
            self._screen.say("Select something to see where it will go.")

    @property
    def shown_trails(self) -> list[tuple[Trail, bool]]:
        """The trails that are shown, that of the last run (True) first."""
        shown = ((self.last_trail, True), (self.trail, False))
        return [(trail, is_last) for trail, is_last in shown if trail is not None and self.trails]

    def let_go(self) -> None:
        """Drop all that can be worked out again, while another screen is shown."""
        self.trail = self.last_trail = self.range_trial = self.forecast = self._lint = self._level = self.firing = (
            self._softness
        ) = None

    def softness_of(self, body: str) -> str:
        """How soft play says that a body is: a word and its sag; "" where that cannot be told."""
        screen = self._screen
        if screen.document.level is not self._level or self._since < PATIENCE:
            return MEASURING
        if self._softness is None:
            if len(screen.scene.position) > LARGEST_READ:
                return ""
            self._softness = SoftnessReading(Playback(self._level))
        if self._softness.body != body:
            self._softness.body, self._said = body, MEASURING
        if body not in self._softness.bodies:
            return ""
        said = self._softness.read(SLICE, look=False)
        if said is not None:
            self._said = f"{said.word}, {said.sag} %" if said.word else MEASURING if said.text == MEASURING else ""
        return self._said

    def remember(self, run: Session) -> None:
        """Show where things went in a run of the level, beside where they will go, and when its rules fired."""
        self._commands, self._level = timed_commands(run), None
        if self.trails:
            self.last_trail = Trail(run.level, run.retold(0))

    @property
    def moves(self) -> bool:
        """Whether findings, forecast or trails are still to be worked out."""
        level, forecast = self._screen.document.level, self.forecast
        is_firing = self.firing is not None and not self.firing.is_done
        is_waiting = level is not self._level or self._since < PATIENCE
        is_trying = self.range_trial is not None and not self.range_trial.is_done
        is_drawing = is_trying or any(
            trail is not None and not trail.is_done for trail in (self.trail, self.last_trail)
        )
        return (
            is_waiting
            or is_firing
            or self._lint is not None
            or self.proving.is_at_work
            or (self._softness is not None and self._softness.is_measuring)
            or is_drawing
            or (forecast is not None and not self._is_reported)
        )

    def update(self, frame_time: float) -> None:
        """Let frame_time [s] pass, and work for a moment at findings, forecast, trails and tried values.

        Now and then it is looked whether another program has written the file.
        """
        self._since_look += frame_time
        if self._since_look >= LOOK_EVERY and not pygame.mouse.get_pressed()[0]:
            self._since_look = 0.0
            self._screen.app.documents.look_at_disk()
        level = self._screen.document.level
        if level is not self._level:
            self._level, self._since = level, 0.0
            self._lint = self.forecast = self.trail = self.firing = self._softness = None
            self._said = ""
        if self.range_trial is not None and not self.range_trial.is_done:
            self.range_trial.advance(TRYING)
        before, self._since = self._since, self._since + frame_time
        self.proving.update(self._since >= PATIENCE)
        if self._since < PATIENCE:
            return
        if before < PATIENCE:
            self._lint, self._found = findings(level, self._screen.scene), []
            self._is_reported = False
            self.forecast = Forecast(level) if self.forecasts and self._screen.scene.items else None
            self.trail = Trail(level) if self.trails and self._screen.scene.items else None
            self.firing = Firing(level, *self._commands) if self._commands is not None and level.rules else None
        self._look()
        self._follow()
        if self.firing is not None and not self.firing.is_done:
            self.firing.advance(SLICE)
        if self.forecast is not None and self.forecast.advance(SLICE) and not self._is_reported:
            self._is_reported = True
            if self._is_pending:
                self._take_forecast()
            else:
                self._screen.say(f"{self.forecast.text}.")

    def _follow(self) -> None:
        """Work for a moment at the trails."""
        for trail in (self.trail, self.last_trail):
            if trail is not None and not trail.is_done and trail.advance(SLICE) and trail.fault:
                self._screen.say(f"{trail.fault}.")

    def _look(self) -> None:
        if self._lint is None:
            return
        end = time.perf_counter() + SLICE
        for found in self._lint:
            if found is not None:
                self._found.append(found)
            if time.perf_counter() > end:
                return
        self._lint = None
        self.findings = [finding for finding in self._found if finding.text not in self._ignored]

    @property
    def hanging(self) -> NDArray[np.float64] | None:
        """Where everything will hang [m] (n, 2), by the particles of the screen's scene; None until it is known."""
        is_present = self._level is self._screen.document.level
        return self.forecast.position if self.forecast is not None and is_present else None
