"""WindowLayout: the window that widgets stand in, its scale and its fonts."""

import pygame

from sandbox.app.widgets.fonts import plain_font
from sandbox.app.widgets.theme import Manager


class WindowLayout:
    """A window of size [pixels]; positions and sizes given to it are layout units of `scale` pixels."""

    def __init__(self, size: tuple[int, int], scale: float, pixel_ratio: tuple[float, float] = (1.0, 1.0)) -> None:
        self.size = size
        self.scale = scale
        self.manager = Manager(size, scale)
        self.manager.mouse_pos_scale_factor = list(pixel_ratio)
        self.root = self.manager.get_root_container()

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
        """The widgets' font in a size of layout units, for what is painted."""
        return plain_font(self.px(size), bold)
