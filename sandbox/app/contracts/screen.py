"""Screen: what fills the window under its pages: the run that is played, or the level that is edited."""

from collections.abc import Callable
from typing import Literal, NamedTuple, Protocol

import pygame

from sandbox.app.base.loop import Profile
from sandbox.app.base.shortcuts import Mode
from sandbox.app.draw.camera import Camera
from sandbox.app.draw.colours import Colour
from sandbox.app.widgets.ui import Ui

Pixel = tuple[float, float]
# Left edge, how far above the status line, right end [layout units].
NoticesPlace = tuple[float, float, float]
# A world that is lower or narrower has notices over the status line [layout units].
ROOM_FOR_NOTICES = 280.0
Pointer = Literal["down", "move", "up"]


class Figures(NamedTuple):
    """Figures of the loop: ticks and frames [1/s], and the work of a frame [ms], without waiting for the next."""

    ticks: float = 0.0
    frames: float = 0.0
    work: float = 0.0


class Screen(Protocol):
    """What the app asks of a screen; actions by the names of the table of shortcuts."""

    mode: Mode
    actions: dict[str, Callable[[], object]]

    @property
    def notices_place(self) -> NoticesPlace | None:
        """Where notices cover no widgets; None: they would cover most of the world, and lie over the status line."""
        ...

    @property
    def moves(self) -> bool:
        """Whether its picture changes by itself, or is still being worked out."""
        ...

    @property
    def camera(self) -> Camera:
        """The camera of the world on the screen."""
        ...

    def build(self, ui: Ui) -> None:
        """Lay the widgets out again."""
        ...

    def contains(self, pixel: Pixel) -> bool:
        """Whether a pixel shows the world."""
        ...

    def point(self, kind: Pointer, pixel: Pixel, modifiers: int, clicks: int = 1) -> None:
        """React to the pointer; clicks: 2 for the second press of a double click."""
        ...

    def open_menu(self, pixel: Pixel) -> None:
        """React to the right button over the world."""
        ...

    @property
    def takes_rest(self) -> bool:
        """Whether a finger that rests on the world is the right button."""
        ...

    def turn_wheel(self, pixel: Pixel, steps: float) -> None:
        """React to the wheel over the world."""
        ...

    def press_arrow(self, dx: int, dy: int, modifiers: int) -> None:
        """React to an arrow key; dy is upward."""
        ...

    def press_key(self, key: int, modifiers: int) -> bool:
        """React to a key that the level itself gives a meaning; whether it has one."""
        ...

    def release_key(self, key: int) -> None:
        """React to a key that is let go."""
        ...

    def update(self, frame_time: float, pointer: Pixel | None, profile: Profile) -> None:
        """Let frame_time [s] pass; pointer: where the mouse is over the world, if it is."""
        ...

    def draw(self, surface: pygame.Surface, profile: Profile) -> None:
        """Draw everything but the widgets."""
        ...

    def status(self, figures: Figures) -> list[tuple[str, Colour]]:
        """The status line's parts."""
        ...

    def title(self) -> str:
        """The window's title: the level's name, with * where it is not saved."""
        ...

    def states(self) -> list[str]:
        """State words for the window's title, for programs that follow what happens."""
        ...

    def leave(self) -> None:
        """Give up drags and drawings, as another screen comes."""
        ...
