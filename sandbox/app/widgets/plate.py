"""Plate: a background that holds other widgets; and pictures of boxes with round corners, kept by size and colours."""

import pygame

from sandbox.app.base.recent_pictures import RecentPictures
from sandbox.app.draw.colours import Colour
from sandbox.app.widgets.layout import WindowLayout
from sandbox.app.widgets.styles import CLEAR, PANELS, BoxLook
from sandbox.app.widgets.widget import Pixel, Widget

# What pictures that are kept may take [bytes]; most have 10 kB.
HELD = 8_000_000
# Corners are drawn this many times larger and scaled down: smooth edges.
OVERSAMPLING = 4
_kept: RecentPictures[tuple[object, ...]] = RecentPictures(HELD)


def box(size: tuple[int, int], look: BoxLook, radius: int, rim: int) -> pygame.Surface:
    """The picture of a box [pixels], which others have too: draw on a copy; rim: width of its line."""
    key = size, radius, rim, tuple(look.back), tuple(look.rim)
    picture = _kept.find(key)
    if picture is None:
        picture = _drawn(size, look.back, look.rim, radius, rim)
        _kept.keep(key, picture)
    return picture


def _drawn(size: tuple[int, int], back: Colour, line: Colour, radius: int, rim: int) -> pygame.Surface:
    """The corners of a small box, and its middle row and column as often as needed."""
    width, height = size
    radius = min(radius, width // 2, height // 2)
    corner = min(radius + rim + 1, width // 2, height // 2)
    small = _corners(2 * corner + 1, back, line, radius, rim)
    picture = pygame.Surface(size, pygame.SRCALPHA)
    columns, rows = ([(0, corner, 0, corner), (corner, 1, corner, long - 2 * corner),
                      (corner + 1, corner, long - corner, corner)] for long in size)  # fmt: skip
    for x, wide, left, new_wide in columns:
        for y, high, top, new_high in rows:
            if wide and high and new_wide and new_high:
                part = pygame.transform.scale(small.subsurface(x, y, wide, high), (new_wide, new_high))
                picture.blit(part, (left, top), special_flags=pygame.BLEND_RGBA_ADD)
    return picture


def _corners(side: int, back: Colour, line: Colour, radius: int, rim: int) -> pygame.Surface:
    large = pygame.Surface((side * OVERSAMPLING,) * 2, pygame.SRCALPHA)
    # What is smoothed at the edge has the colour of the line, and less of it.
    large.fill((*line[:3], 0))
    pygame.draw.rect(large, line, large.get_rect(), border_radius=radius * OVERSAMPLING)
    inside = large.get_rect().inflate(-2 * rim * OVERSAMPLING, -2 * rim * OVERSAMPLING)
    if inside.width > 0:
        pygame.draw.rect(large, back, inside, border_radius=max(radius - rim, 0) * OVERSAMPLING)
    return pygame.transform.smoothscale(large, (side, side))


class Plate(Widget):
    """A panel in one of the styles."""

    def __init__(self, ui: WindowLayout, rect: pygame.Rect, parent: Widget | None = None, style: str = "") -> None:
        super().__init__(ui, rect, parent)
        self._style = PANELS[style]

    def paint(self, size: tuple[int, int]) -> pygame.Surface | None:
        """Its background, if it has one."""
        back, rim, radius = self._style
        if back is CLEAR:
            return None
        if rim is not None:
            return box(size, BoxLook(back, rim, back), self.ui.px(radius), max(self.ui.px(1), 1))
        surface = pygame.Surface(size, pygame.SRCALPHA)
        surface.fill(tuple(back))
        return surface

    def on_press(self, at: Pixel, clicks: int) -> bool:
        """Nothing, and the press ends here."""
        return True
