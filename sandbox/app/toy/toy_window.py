"""ToyWindow: a small window without a frame that stays on top and remembers its place, where the system has such."""

import contextlib
import math
import os
from typing import Any

import pygame
from filelock import FileLock, Timeout

from sandbox.app.base.display import Display
from sandbox.editor.storage.preferences import data_folder, preference, set_preference

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
        """The window's place on the desktop [pixels]; always the same where the system does not tell it."""
        x, y = self.window.position if self.floats else (0, 0)
        return x, y

    def move_to(self, place: tuple[int, int]) -> None:
        """Move the window."""
        if self.floats:
            with contextlib.suppress(pygame.error):
                self.window.position = place

    def keep(self, **others: Any) -> None:
        """Remember the window's place, and other values by name."""
        self.desk.keep(self.place if self.floats else None, self.window.size, **others)

    def close(self) -> None:
        """Close the window; its place becomes free for another toy."""
        super().close()
        self.desk.leave()


# Under what toys are remembered; this many places are kept, of the levels that were toys last.
KEPT, MOST_PLACES = "toy", 40
# This many toys at once keep out of each other's way.
MOST_TOYS = 12

Place = tuple[int, int]


class Desk:
    """The desktop as one toy sees it while it is open; level: the name of what it plays."""

    def __init__(self, level: str) -> None:
        self._level = level
        self._seat, self._others = "", list[str]()
        self._lock: FileLock | None = None
        # A seat is taken while a process holds its lock, which the system lets go of when that ends.
        with contextlib.suppress(OSError):
            data_folder().mkdir(parents=True, exist_ok=True)
            for seat in map(str, range(MOST_TOYS)):
                self._look_at(seat)

    def _look_at(self, seat: str) -> None:
        lock = FileLock(data_folder() / f"toy-{seat}.lock", thread_local=False)
        try:
            lock.acquire(timeout=0)
        except Timeout:
            self._others.append(seat)
            return
        if self._lock is None:
            self._seat, self._lock = seat, lock
        else:
            lock.release()

    @property
    def kept(self) -> dict[str, Any]:
        """The remembered values of all toys."""
        kept = preference(KEPT)
        return kept if isinstance(kept, dict) else {}

    def first_place(self, size: tuple[int, int], gap: int) -> Place:
        """Where its window of a size [pixels] opens: where that of its level was left, else in the lower right corner.

        gap: how far it is from the edges. Where a toy stands there already, it opens beside that, or above.
        """
        desktops = pygame.display.get_desktop_sizes()
        taken = [pygame.Rect(each) for each in self._taken()]

        def is_free(place: Place) -> bool:
            return pygame.Rect(place, size).collidelist(taken) < 0

        kept = self._kept_place()
        # Other screens are right of the first or below it; negative places are left to the window manager.
        width, height = sum(each[0] for each in desktops), max(each[1] for each in desktops)
        if kept is not None and is_free(kept):
            x, y = kept
            if -size[0] // 2 <= x <= width - size[0] // 2 and 0 <= y <= height - size[1] // 2:
                return kept
        right, bottom = (max(desktops[0][axis] - size[axis] - gap, 0) for axis in (0, 1))
        step = gap // 4
        # Whatever stands there, the next that could be free is beside it or above it.
        across = sorted({right, *(rect.left - size[0] - step for rect in taken)}, reverse=True)
        up = sorted({bottom, *(rect.top - size[1] - step for rect in taken)}, reverse=True)
        places = [(x, y) for y in up for x in across if 0 <= x <= right and 0 <= y <= bottom]
        return next(filter(is_free, places), (right, bottom))

    def keep(self, place: Place | None, size: tuple[int, int], **others: Any) -> None:
        """Remember where its window of a size [pixels] is, if that is known, and others by name."""
        kept = self.kept
        if place is not None:
            places, open_ = _table(kept, "places"), _table(kept, "open")
            # The last in the table is the last that was moved.
            places.pop(self._level, None)
            places[self._level] = list(place)
            open_[self._seat] = [*place, *size]
            kept |= {"places": dict(list(places.items())[-MOST_PLACES:]), "open": open_}
        set_preference(KEPT, kept | others)

    def leave(self) -> None:
        """Close the toy."""
        if self._lock is not None:
            self._lock.release()

    def _kept_place(self) -> Place | None:
        found = _integers(_table(self.kept, "places").get(self._level), 2)
        return None if found is None else (found[0], found[1])

    def _taken(self) -> list[list[int]]:
        """Rectangles of the toys that are open [pixels]."""
        open_ = _table(self.kept, "open")
        return [place for seat in self._others if (place := _integers(open_.get(seat), 4)) is not None]


def _table(kept: dict[str, Any], name: str) -> dict[str, Any]:
    found = kept.get(name)
    return dict(found) if isinstance(found, dict) else {}


def _integers(read: Any, count: int) -> list[int] | None:
    fits = isinstance(read, list) and len(read) == count and all(type(number) is int for number in read)
    return read if fits else None
