"""ToyWindow: a small window without a frame that stays on top and remembers its place, where the system has such."""

import contextlib
import math
import os
from typing import Any

import pygame

from sandbox.app.base.display import Display
from sandbox.app.toy.desk import Desk

# Its sides, or those of the square of its area; how much longer than high it is at most, or the other way round; and
# how far it begins from the corner of the desktop [layout units].
SIDE, MOST_OBLONG, FROM_CORNER = 300, 2.5, 48
# Systems that leave place and stacking of windows to themselves, and what is said there.
SEDATE = {"wayland": "Wayland"}
REFUSED = "does not let windows stay on top: the toy is a plain small window; the arrow keys shake it."


class ToyWindow(Display):
    """The window of the toy, `shape` times as wide as it is high; level: the name of what it plays.

    floats: it has no frame, stays on top and knows where it is; refusal: a line why not.
    """

    def __init__(self, scale: float | None = None, shape: float = 1.0, level: str = "") -> None:
        # A press counts also where it is the one that gives the window the keyboard: a toy lies on top, unfocused.
        os.environ.setdefault("SDL_MOUSE_FOCUS_CLICKTHROUGH", "1")
        self._begin(scale)
        stretch = math.sqrt(min(max(shape, 1.0 / MOST_OBLONG), MOST_OBLONG))
        size = round(SIDE * self.scale * stretch), round(SIDE * self.scale / stretch)
        driver = pygame.display.get_driver()
        self.floats, self.refusal = driver not in SEDATE, ""
        self.desk = Desk(level)
        if self.floats:
            gap = round(FROM_CORNER * self.scale)
            try:
                self.window = pygame.Window(
                    "Desk toy - Spring Sandbox", size, position=self.desk.first_place(size, gap),
                    borderless=True, always_on_top=True, utility=True,
                )  # fmt: skip
            except (pygame.error, TypeError) as error:
                self.floats, self.refusal = False, f"Windows cannot stay on top here ({error}): the toy is a plain one."
        else:
            self.refusal = f"{SEDATE[driver]} {REFUSED}"
        if not self.floats:
            self.window = pygame.Window("Desk toy - Spring Sandbox", size)
        self._finish()
        self.keep()

    @property
    def place(self) -> tuple[int, int]:
        """Where it is on the desktop [pixels]; always the same where it does not know."""
        x, y = self.window.position if self.floats else (0, 0)
        return x, y

    def move_to(self, place: tuple[int, int]) -> None:
        """Put it there."""
        if self.floats:
            with contextlib.suppress(pygame.error):
                self.window.position = place

    def keep(self, **others: Any) -> None:
        """Remember its place, and others by name."""
        self.desk.keep(self.place if self.floats else None, self.window.size, **others)

    def close(self) -> None:
        """Close it; its place is another's."""
        super().close()
        self.desk.leave()
