"""WindowLayout: the window that widgets stand in as they know it: its scale and fonts, its pointer and its keyboard."""

from typing import Any

import pygame

from sandbox.app.widgets.fonts import plain_font


class WindowLayout:
    """A window of size [pixels]; positions and sizes given to it are layout units of `scale` pixels.

    pixel_ratio: pixels per unit of a mouse position. pointer: where the mouse is [pixels], and under: the widget that
    it is over. focus: the widget that has the keyboard. held: the one on which the left button was pressed, until it is
    let go. origin: what was clicked or left last, from which Tab goes on. is_laid: whether it is known where all are.
    """

    # The widgets are of classes that know this one.
    root: Any

    def __init__(self, size: tuple[int, int], scale: float, pixel_ratio: tuple[float, float] = (1.0, 1.0)) -> None:
        self.size = size
        self.scale = scale
        self.pixel_ratio = pixel_ratio
        self.pointer = (-1, -1)
        self.under: Any = None
        self.focus: Any = None
        self.held: Any = None
        self.origin: Any = None
        self.is_laid = False

    def px(self, units: float) -> int:
        """Layout units in pixels."""
        return round(units * self.scale)

    def rect(self, x: float, y: float, width: float, height: float) -> pygame.Rect:
        """A rectangle of layout units in pixels."""
        return pygame.Rect(self.px(x), self.px(y), self.px(width), self.px(height))

    @property
    def units(self) -> tuple[float, float]:
        """Size of the window in layout units."""
        return self.size[0] / self.scale, self.size[1] / self.scale

    def font(self, size: float, bold: bool = False) -> pygame.font.Font:
        """The widgets' font in a size of layout units."""
        return plain_font(self.px(size), bold)

    def focus_on(self, widget: Any, by_hand: bool = False) -> None:
        """Give a widget the keyboard; by_hand: it was clicked, which needs no ring around it."""
        raise NotImplementedError

    def blur(self) -> None:
        """Take the keyboard from the widget that has it, so that keys go to the world."""
        raise NotImplementedError

    def forget(self, widget: Any) -> None:
        """Forget a widget that is removed."""
        for name in ("under", "focus", "held", "origin"):
            if getattr(self, name) is widget:
                setattr(self, name, None)
