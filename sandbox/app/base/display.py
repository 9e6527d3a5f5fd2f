"""Display: the window, where it stood the last time, how large things are on it, and what it is opened for."""

import math
import os
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import pygame

from sandbox.level.format.shipped import shipped_folder

if TYPE_CHECKING:
    from sandbox.level.document.model import Level
    from sandbox.session.replay.recording import Replay


@dataclass(frozen=True)
class StartRequest:
    """What the app is to show first: a level (source: its file), a replay, a scene, or a file to edit, "" = an empty
    sheet.
    """

    level: "Level | None" = None
    replay: "Replay | None" = None
    source: Path | None = None
    edit: str | None = None
    scene: Path | None = None


os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")
# Real pixels on Windows instead of a picture that the system stretches.
os.environ.setdefault("SDL_WINDOWS_DPI_AWARENESS", "permonitorv2")
os.environ.setdefault("SDL_VIDEO_X11_WMCLASS", "spring-sandbox")


# Window at scale 1, and the smallest that everything fits in.
WINDOW_SIZE = (1280, 720)
SMALLEST_WINDOW = (640, 440)
# What everything is laid out for at least [layout units]: in less, pages have no room for their buttons.
FEWEST_UNITS = (480, 360)
# So much of a window's bar has to be on a desktop [pixels].
BAR_IN_SIGHT = 80
INVISIBLE_DRIVERS = ("dummy", "offscreen", "evdev")
SCALE_RANGE = (0.5, 4.0)
# Desktops higher than this [pixels] have small pixels, unless told otherwise.
PLAIN_HEIGHT = 1200


def has_display() -> bool:
    """Whether a window can be opened."""
    driver = os.environ.get("SDL_VIDEODRIVER", "")
    plain = sys.platform in ("win32", "darwin", "cygwin")
    if not (driver or plain or os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        return False
    try:
        pygame.display.init()
    except pygame.error:
        return False
    # Where the server of DISPLAY is gone, SDL takes a driver that shows nothing.
    return bool(driver) or pygame.display.get_driver() not in INVISIBLE_DRIVERS


class Display:
    """The window; surface: its real pixels; pixel_ratio: real pixels per unit of a mouse position (x, y).

    kept: left, top, width and height that it had the last time, where it opens again if a desktop is there.
    """

    scale: float
    # The place that was asked for, if one was.
    _asked: tuple[int, int] | None = None

    def __init__(self, scale: float | None = None, kept: Sequence[int] | None = None) -> None:
        desktop = self._begin(scale)
        size = [min(round(side * self.scale), most) for side, most in zip(WINDOW_SIZE, desktop, strict=True)]
        place: int | tuple[int, int] = pygame.WINDOWPOS_UNDEFINED
        if kept is not None:
            limits = zip(kept[2:], SMALLEST_WINDOW, desktop, strict=True)
            size = [min(max(side, least), most) for side, least, most in limits]
            place = (kept[0], kept[1]) if _is_on_a_desktop(kept) else place
        self._asked = place if isinstance(place, tuple) else None
        self.window = pygame.Window("Spring Sandbox", size, place, resizable=True, allow_high_dpi=True)
        self.window.minimum_size = SMALLEST_WINDOW
        self._finish()
        # A window in points of two pixels says so itself.
        ratio = self.pixel_ratio[1]
        if scale is None and ratio > 1.0:
            self.scale = ratio

    def _begin(self, scale: float | None) -> tuple[int, int]:
        """Start pygame's display and fonts before the window is made; give the size of the desktop [pixels]."""
        pygame.display.init()
        pygame.font.init()
        width, height = pygame.display.get_desktop_sizes()[0]
        self.scale = scale or _guessed_scale((width, height))
        if pygame.display.get_driver() == "x11":
            # A picture made by the processor goes to an X server faster as it is than by way of a texture: 0.6 ms
            # against 12 ms where OpenGL itself is done by software.
            os.environ.setdefault("SDL_FRAMEBUFFER_ACCELERATION", "0")
        return width, height

    def _finish(self) -> None:
        """Give the new window its icon, and take note of its surface, size and place."""
        self.window.set_icon(pygame.image.load(shipped_folder("assets") / "icon.png"))
        self.surface = self.window.get_surface()
        self._shown_size = self.size
        self._first = self.window.position
        self.fullscreen = False
        # Whether nobody sees it, because it is minimised: then nothing is drawn.
        self.hidden = False

    @property
    def pixel_ratio(self) -> tuple[float, float]:
        """Real pixels per unit of a mouse position."""
        (width, height), pixels = self.window.size, self.surface.get_size()
        return pixels[0] / max(width, 1), pixels[1] / max(height, 1)

    @property
    def size(self) -> tuple[int, int]:
        """Size in real pixels."""
        width, height = self.surface.get_size()
        return width, height

    def settle(self) -> None:
        """Note the window's place after it was opened."""
        self._first = self.window.position

    @property
    def kept(self) -> list[int] | None:
        """Left, top, width and height to open the window with again; None while it fills the screen or is minimised.

        A window manager may put a window beside the place that was asked for, by the width of its frame, and would do
        so at each start: what is kept is what to ask for.
        """
        if self.fullscreen or self.hidden:
            return None
        (x, y), (left, top) = self.window.position, self._first
        asked = self._asked or (left, top)
        return [asked[0] + x - left, asked[1] + y - top, *self.window.size]

    def refresh(self) -> bool:
        """Take up a new window size; True where it changed."""
        self.surface = self.window.get_surface()
        before, self._shown_size = self._shown_size, self.size
        return self.size != before

    def toggle_fullscreen(self) -> None:
        """Fill the screen, or go back to a window."""
        self.fullscreen = not self.fullscreen
        if self.fullscreen:
            self.window.set_fullscreen(desktop=True)
        else:
            self.window.set_windowed()

    def flip(self) -> None:
        """Show what was drawn."""
        self.window.flip()

    def close(self) -> None:
        """Close the window."""
        self.window.destroy()
        pygame.display.quit()


# Under what it is remembered.
KEPT = "window"


def kept_window() -> list[int] | None:
    """Left, top, width and height of the window of the last time [pixels]; None where nothing usable is remembered."""
    from sandbox.editor.storage.preferences import preference

    kept = preference(KEPT)
    is_place = isinstance(kept, list) and len(kept) == 4 and all(type(side) is int for side in kept)
    return kept if is_place and abs(kept[0]) + abs(kept[1]) < 1 << 20 and min(kept[2:]) > 0 else None


def keep_window(place: list[int] | None) -> None:
    """Remember left, top, width and height of the window; None leaves what was remembered."""
    if place is not None:
        from sandbox.editor.storage.preferences import set_preference

        set_preference(KEPT, place)


def _is_on_a_desktop(kept: Sequence[int]) -> bool:
    """Whether the bar of a window would be where it can be taken; desktops are taken to lie side by side."""
    sizes = pygame.display.get_desktop_sizes()
    widest = sum(width for width, _ in sizes)
    highest = max(height for _, height in sizes)
    left, top, width, _ = kept
    return 0 <= top <= highest - BAR_IN_SIGHT and -width + BAR_IN_SIGHT <= left <= widest - BAR_IN_SIGHT


def fitting_layout(size: tuple[int, int], scale: float) -> tuple[tuple[int, int], float]:
    """Size [pixels] and scale that a window is laid out for: smaller than asked for where it would hold too little.

    Below the least scale there is, what is right and below is cut off.
    """
    width, height = FEWEST_UNITS
    scale = max(min(scale, size[0] / width, size[1] / height), SCALE_RANGE[0])
    return (max(size[0], round(width * scale)), max(size[1], round(height * scale))), scale


def _guessed_scale(desktop: tuple[int, int]) -> float:
    """Scale that the system asks for, or that the desktop's height suggests."""
    for name in ("GDK_SCALE", "QT_SCALE_FACTOR"):
        try:
            asked = float(os.environ[name])
        except (KeyError, ValueError):
            continue
        if math.isfinite(asked):
            return min(max(asked, 1.0), SCALE_RANGE[1])
    if sys.platform == "win32":
        import ctypes

        return min(max(ctypes.windll.user32.GetDpiForSystem() / 96.0, 1.0), SCALE_RANGE[1])
    return 1.0 if desktop[1] <= PLAIN_HEIGHT else round(desktop[1] / 1080 * 4) / 4
