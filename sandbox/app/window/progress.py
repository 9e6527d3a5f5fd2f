"""RunProgress: a card with a bar while a run is played again, which can be cancelled; the window never looks dead."""

import time

import pygame

from sandbox.app.contracts.application import Application
from sandbox.app.play.status import draw_bar, draw_work
from sandbox.session.transaction import Interrupted

# What takes no longer than this [s] shows nothing; then the bar is drawn this often [s].
PATIENCE = 0.3
DRAWN_EVERY = 0.05
# A pause between two reports longer than this [s] is the beginning of something new.
NEW_AFTER = 1.0
# What is begun while the bar is seen is meant for what it hides, and not for a dialog that comes after it.
BEGUN = (pygame.KEYDOWN, pygame.TEXTINPUT, pygame.MOUSEBUTTONDOWN, pygame.MOUSEWHEEL)
ENDING = (pygame.QUIT, pygame.WINDOWCLOSE)
TEXT = "Playing the run again"


class RunProgress:
    """Called with ticks done and ticks in all while a session steps again."""

    def __init__(self, app: Application) -> None:
        self._app = app
        self._started = self._last = self._drawn = 0.0
        self._done = 0
        self._is_seen = False
        # Where the button is that cancels it [pixels].
        self._button = pygame.Rect(0, 0, 0, 0)

    def show(self, done: int, total: int, can_cancel: bool) -> None:
        """Draw the bar, where it has taken long enough to wonder. Raises Interrupted where the person cancels it."""
        now = time.perf_counter()
        if done < self._done or now - self._last > NEW_AFTER:
            self._started = now
        self._last, self._done = now, done
        if now - self._started < PATIENCE or now - self._drawn < DRAWN_EVERY:
            return
        pygame.event.pump()
        if can_cancel and self._is_cancelled():
            self._last = 0.0
            raise Interrupted
        self._drawn, self._is_seen = now, True
        display, share = self._app.display, done / max(total, 1)
        if can_cancel:
            self._button = draw_work(display.surface, self._app.ui, share, TEXT, self._pixel(pygame.mouse.get_pos()))
        else:
            draw_bar(display.surface, self._app.ui, share, TEXT)
        display.flip()

    def _is_cancelled(self) -> bool:
        """Whether Escape or the button was pressed since the bar is seen, or the window is to be closed."""
        begun = pygame.event.get(BEGUN) if self._is_seen else []
        return any(self._cancels(event) for event in begun) or pygame.event.peek(ENDING)

    def _cancels(self, event: pygame.event.Event) -> bool:
        if event.type == pygame.KEYDOWN:
            return bool(event.key == pygame.K_ESCAPE)
        return event.type == pygame.MOUSEBUTTONDOWN and self._button.collidepoint(self._pixel(event.pos))

    def _pixel(self, position: tuple[int, int]) -> tuple[float, float]:
        ratio = self._app.display.pixel_ratio
        return position[0] * ratio[0], position[1] * ratio[1]

    def end(self) -> None:
        """As a frame ends: forget what was pressed in it, where the bar was seen."""
        if self._is_seen:
            self._is_seen = False
            pygame.event.clear(BEGUN)
