"""RunProgress: a card with a bar while a run is played again, so that the window never looks dead."""

import time

import pygame

from sandbox.app.application import Application
from sandbox.app.play.status import draw_bar

# What takes no longer than this [s] shows nothing; then the bar is drawn this often [s].
PATIENCE = 0.3
DRAWN_EVERY = 0.05
# A pause between two reports longer than this [s] is the beginning of something new.
NEW_AFTER = 1.0
# What is begun while the bar is seen is meant for what it hides, and not for a dialog that comes after it.
BEGUN = (pygame.KEYDOWN, pygame.TEXTINPUT, pygame.MOUSEBUTTONDOWN, pygame.MOUSEWHEEL)


class RunProgress:
    """Called with ticks done and ticks in all while a session steps again."""

    def __init__(self, app: Application) -> None:
        self._app = app
        self._started = self._last = self._drawn = 0.0
        self._done = 0
        self._is_seen = False

    def show(self, done: int, total: int) -> None:
        """Draw the bar, where it has taken long enough to wonder."""
        now = time.perf_counter()
        if done < self._done or now - self._last > NEW_AFTER:
            self._started = now
        self._last, self._done = now, done
        if now - self._started < PATIENCE or now - self._drawn < DRAWN_EVERY:
            return
        self._drawn, self._is_seen = now, True
        pygame.event.pump()
        draw_bar(self._app.display.surface, self._app.ui, done / max(total, 1), "Playing the run again")
        self._app.display.flip()

    def end(self) -> None:
        """As a frame ends: forget what was pressed in it, where the bar was seen."""
        if self._is_seen:
            self._is_seen = False
            pygame.event.clear(BEGUN)
