"""Shapes: the backgrounds of buttons, lines of text and boxes; each is drawn once, and as small as it can be."""

from collections.abc import Sequence
from typing import Any, NamedTuple, cast

import pygame
from pygame_gui.core.drawable_shapes import RoundedRectangleShape
from pygame_gui.core.drawable_shapes.drawable_shape import DrawableShape
from pygame_gui.core.interfaces import IUIManagerInterface
from pygame_gui.core.surface_cache import SurfaceCache

from sandbox.app.base.recent_pictures import RecentPictures

# What pictures of buttons and the like that are kept may take [bytes]; most have 10 kB, none has more than 160.
HELD = 8_000_000
# Larger ones [pixels] are made again, as the library has it.
LARGEST_KEPT = 40_000
# Rounded rectangles are drawn no larger [pixels], and stretched: the library gives the background inside a border the
# corners of the border, made as much smaller, and in a much smaller shape that would be seen.
ENOUGH = 64


class _Asked(NamedTuple):
    """What a picture is of, as the library asks for it."""

    shape: str
    size: tuple[int, int]
    shadow_width: int
    border_widths: dict[str, int]
    border: Any
    background: Any
    radii: Sequence[int] | None = None


class Shapes(SurfaceCache):
    """Pictures of shapes without text, by all that they depend on.

    The library's own cache takes 4 MB at once and copies each picture into them, and counts users of a theme that are
    taken away: those of a window that is let go of as a whole are not. And the library draws rounded rectangles at
    four times their size, a tenth of a second for a box of half the window; here their corners alone are drawn so.
    """

    def __init__(self) -> None:
        super().__init__()
        self.cache_surfaces.clear()
        self._kept: RecentPictures[str] = RecentPictures(HELD)
        self._asked: _Asked | None = None

    # What a shape that is drawn here asks of a manager.

    def get_theme(self) -> "Shapes":
        """The theme in as much as a shape needs it, which is a cache."""
        return self

    @property
    def shape_cache(self) -> "Shapes":
        """The cache of the theme."""
        return self

    def build_cache_id(self, *asked: Any) -> str:  # type: ignore[override]
        """What a picture is kept under."""
        self._asked = _Asked(*asked)
        return super().build_cache_id(*asked)

    def add_surface_to_cache(self, surface: pygame.Surface, string_id: str) -> None:
        """Keep a picture, in place of those that were not asked for for longest."""
        self._kept.keep(string_id, surface)

    def find_surface_in_cache(self, lookup_id: str) -> pygame.Surface | None:
        """A picture that was kept, or one that is stretched; None: the library is to draw it."""
        kept = self._kept.find(lookup_id)
        if kept is not None:
            return kept
        asked, self._asked = self._asked, None
        picture = None if asked is None else self._stretched(asked)
        if picture is not None and picture.width * picture.height < LARGEST_KEPT:
            self._kept.keep(lookup_id, picture)
        return picture

    def remove_user_from_cache_item(self, string_id: str) -> None:
        """Nothing: what is used no more goes by its age."""

    def update(self) -> None:
        """Nothing."""

    def _stretched(self, asked: _Asked) -> pygame.Surface | None:
        """A rounded rectangle: a small one, with its middle row and column as often as needed."""
        side = _side(asked)
        if side is None:
            return None
        theming = {
            "normal_bg": asked.background,
            "normal_border": asked.border,
            "border_width": asked.border_widths,
            "shape_corner_radius": list(asked.radii or ()),
            "border_overlap": 1,
        }
        square, manager = pygame.Rect(0, 0, side, side), cast(IUIManagerInterface, self)
        small = RoundedRectangleShape(square, theming, ["normal"], manager).get_surface("normal")
        return _widened(_widened(small, asked.size[0], 0), asked.size[1], 1)


def _side(asked: _Asked) -> int | None:
    """Sides of the square to stretch; None: the shape has no round corners, or is no larger than they are."""
    if asked.radii is None or asked.shadow_width:
        return None
    side = min(*asked.size, ENOUGH)
    least = 2 * (max(asked.radii) + asked.border_widths["left"]) + 4
    return side if least <= side < max(asked.size) else None


def _widened(picture: pygame.Surface, length: int, axis: int) -> pygame.Surface:
    """A picture made `length` pixels long along an axis by what is in its middle."""
    size = list(picture.get_size())
    whole, half = size[axis], size[axis] // 2
    size[axis] = length
    result = pygame.Surface(size, pygame.SRCALPHA, 32)
    start, end, middle = [0, 0], [0, 0], [0, 0]
    end[axis], middle[axis] = length - (whole - half), half
    column = picture.subsurface(middle, [1 if along == axis else size[along] for along in (0, 1)])
    result.blit(pygame.transform.scale(column, size), (0, 0), special_flags=pygame.BLEND_RGBA_ADD)
    for place, first, long in ((start, 0, half), (end, half, whole - half)):
        corner = [first if along == axis else 0 for along in (0, 1)]
        part = picture.subsurface(corner, [long if along == axis else size[along] for along in (0, 1)])
        result.fill(0, (place, part.get_size()))
        result.blit(part, place, special_flags=pygame.BLEND_RGBA_ADD)
    return result


def _redraw_shown(shape: DrawableShape, force_full_redraw: bool = False) -> None:
    for state in shape.states.values():
        state.generated = False
    shape.states_to_redraw_queue.clear()
    shape.redraw_state(shape.active_state.state_id)


# The library draws all states of a button one after another, in the frames that come; most are never seen. The others
# are drawn by `set_active_state`, once they are.
DrawableShape.redraw_all_states = _redraw_shown  # type: ignore[method-assign, assignment]
