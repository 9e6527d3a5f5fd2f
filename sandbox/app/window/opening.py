"""Opening: the window with words at once; the rest of the program is imported meanwhile, on a thread.

Nothing that is imported here needs numpy or pydantic.
"""

import math
import threading
import time
from collections.abc import Callable

import pygame

from sandbox.app.base.display import Display, StartRequest
from sandbox.app.base.loop import Profile
from sandbox.app.draw.colours import ACCENT, BACKGROUND, LINE, MUTED, TEXT, Colour, mixed
from sandbox.app.widgets.fonts import plain_font

# Pictures a second until the app is there: more of them would take a quarter of the time from what they wait for.
START_RATE = 20
CLOSING = (pygame.QUIT, pygame.WINDOWCLOSE)
# Sizes in layout units.
TITLE_SIZE, LINE_SIZE = 30, 14


class _Work(threading.Thread):
    """Imports the app and reads the request on a thread of its own."""

    def __init__(self, find: Callable[[], StartRequest]) -> None:
        super().__init__(daemon=True)
        self._find = find
        self.request: StartRequest | None = None
        self.error: BaseException | None = None

    def run(self) -> None:
        try:
            # What numpy's median imports when it is first asked for one, which the first page does.
            import numpy.ma  # noqa: F401

            import sandbox.app.window.app  # noqa: F401

            self.request = self._find()
        except BaseException as error:  # handed on to the thread that waits
            self.error = error


class _StartPicture:
    """The name of the program, and a ring that turns."""

    def __init__(self, display: Display, times: Profile) -> None:
        self._display, self._times, self._scale = display, times, display.scale
        self._began = time.perf_counter()

    def _written(self, bold: bool, size: int, text: str, colour: Colour) -> pygame.Surface:
        return plain_font(round(size * self._scale), bold).render(text, True, colour)

    def show(self) -> None:
        """Show the picture of this moment."""
        with self._times.part("frame"):
            self._draw(self._display.surface, time.perf_counter() - self._began)
            self._display.flip()
        self._times.shown()

    def _draw(self, surface: pygame.Surface, seconds: float) -> None:
        surface.fill(BACKGROUND)
        middle, y = surface.get_width() // 2, surface.get_height() // 2
        # Written for each picture: the theme that the person chose is known only while the app is made.
        title = self._written(True, TITLE_SIZE, "Spring Sandbox", TEXT)
        surface.blit(title, title.get_rect(midbottom=(middle, y - round(30 * self._scale))))
        line = self._written(False, LINE_SIZE, "Starting", MUTED)
        surface.blit(line, line.get_rect(midtop=(middle, y + round(34 * self._scale))))
        for dot in range(10):
            turn = math.tau * dot / 10
            age = (dot / 10 - seconds * 0.9) % 1.0
            at = middle + math.cos(turn) * 16 * self._scale, y + math.sin(turn) * 16 * self._scale
            pygame.draw.aacircle(surface, mixed(LINE, ACCENT, age), at, 3 * self._scale)


def open_app(
    find: Callable[[], StartRequest],
    *,
    profile: bool = False,
    seconds: float | None = None,
    scale: float | None = None,
    theme: str | None = None,
    says_states: bool = False,
) -> int:
    """Open the window and run until it is closed, or for this many seconds; returns the exit code.

    find: says what to show, called once the window is there; what it raises is raised here, with the window closed.
    profile: print where a frame's time went, at the end. scale, theme: in place of what is remembered of the person.
    says_states: the window's title says what happens, for programs that follow it.
    """
    began = time.perf_counter()
    times = Profile()
    from sandbox.app.base.display import kept_window

    display = Display(scale, kept_window())
    words = _StartPicture(display, times)
    try:
        request = _wait(display, words, times, _Work(find))
    except BaseException:
        display.close()
        raise
    if request is None:
        display.close()
        return 0
    from sandbox.app.window.app import run_app

    run_app(display, request, times, seconds, {"scale": scale, "theme": theme}, words.show, says_states)
    if profile:
        print(times.table(began))
    return 0


def _wait(display: Display, words: _StartPicture, times: Profile, work: _Work) -> StartRequest | None:
    """Show words until the work is done; None where the window was closed."""
    clock = pygame.time.Clock()
    while True:
        # Keys and clicks stay in the queue, for the app.
        if pygame.event.get(CLOSING):
            return None
        display.refresh()
        words.show()
        if work.ident is None:
            times.reached("words in the window")
            work.start()
        if not work.is_alive():
            break
        clock.tick(START_RATE)
    if work.error is not None:
        raise work.error
    return work.request
