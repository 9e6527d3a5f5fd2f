"""ToyWindow: a small window without a frame that stays on top and remembers its place, where the system has such."""

import contextlib
import math
from typing import Any

import pygame

from sandbox.app.display import Display
from sandbox.editor.storage.preferences import preference, set_preference

# Its sides, or those of the square of its area; how much longer than high it is at most, or the other way round; and
# how far it begins from the corner of the desktop [layout units].
SIDE, MOST_OBLONG, FROM_CORNER = 300, 2.5, 48
# Under what its place is remembered.
KEPT = "toy"
# Systems that leave place and stacking of windows to themselves, and what is said there.
SEDATE = {"wayland": "Wayland"}
REFUSED = "lets no window stay on top or know its place: the toy is a plain small window; the arrow keys shake it."


class ToyWindow(Display):
    """The window of the toy, `shape` times as wide as it is high.

    floats: it has no frame, stays on top and knows where it is; refusal: a line why not.
    """

    def __init__(self, scale: float | None = None, shape: float = 1.0) -> None:
        self._begin(scale)
        stretch = math.sqrt(min(max(shape, 1.0 / MOST_OBLONG), MOST_OBLONG))
        size = round(SIDE * self.scale * stretch), round(SIDE * self.scale / stretch)
        driver = pygame.display.get_driver()
        self.floats, self.refusal = driver not in SEDATE, ""
        kept = preference(KEPT)
        self.kept: dict[str, Any] = kept if isinstance(kept, dict) else {}
        if self.floats:
            try:
                self.window = pygame.Window(
                    "Desk toy - Spring Sandbox", size, position=self._first_place(size), borderless=True,
                    always_on_top=True, utility=True,
                )  # fmt: skip
            except (pygame.error, TypeError) as error:
                self.floats, self.refusal = False, f"No window can stay on top here ({error}): the toy is a plain one."
        else:
            self.refusal = f"{SEDATE[driver]} {REFUSED}"
        if not self.floats:
            self.window = pygame.Window("Desk toy - Spring Sandbox", size)
        self._finish()

    def _first_place(self, size: tuple[int, int]) -> tuple[int, int]:
        """Where it was left, if that is on the desktop still; else the lower right corner."""
        desktops = pygame.display.get_desktop_sizes()
        kept = self.kept.get("place")
        if isinstance(kept, list) and len(kept) == 2 and all(type(number) is int for number in kept):
            # Other screens are right of the first or below it; negative places are left to the window manager.
            width, height = sum(size[0] for size in desktops), max(size[1] for size in desktops)
            if -size[0] // 2 <= kept[0] <= width - size[0] // 2 and 0 <= kept[1] <= height - size[1] // 2:
                return kept[0], kept[1]
        gap = round(FROM_CORNER * self.scale)
        return max(desktops[0][0] - size[0] - gap, 0), max(desktops[0][1] - size[1] - gap, 0)

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
        place = {"place": list(self.place)} if self.floats else {}
        set_preference(KEPT, self.kept | place | others)
