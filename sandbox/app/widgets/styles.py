"""Styles: colours, letters and corners of buttons, labels, panels and lines of text; pictures of boxes, and plates."""

from typing import Literal, NamedTuple

import pygame

from sandbox.app.base.recent_pictures import RecentPictures
from sandbox.app.draw.colours import ACCENT, BACKGROUND, CHOSEN, FIELD, MENU, MUTED, SURFACE, TEXT, Colour, tone
from sandbox.app.widgets.widget import Pixel, Widget, WindowLayout

# What pictures that are kept may take [bytes]; most have 10 kB.
HELD = 8_000_000
# Corners are drawn this many times larger and scaled down: smooth edges.
OVERSAMPLING = 4
_kept: RecentPictures[tuple[object, ...]] = RecentPictures(HELD)

State = Literal["normal", "hovered", "active", "selected", "disabled"]
CLEAR = tone("00000000", "00000000")
WHITE = tone("ffffff", "ffffff")
# Letters and rims of what is lit, and rims of lines to type into.
BRIGHT, CHOSEN_TEXT = tone("ffffff", "101620"), tone("8ff0d8", "075c4d")
RIM, HOVERED_RIM = tone("2f3745", "ddd5c6"), tone("435064", "b9ae97")
FIELD_RIM = tone("2f3745", "cfc6b4")
SELECTION = tone("2b6257", "bfe5da")
TIP_BACK = tone("2d3543", "fffdf8")
_PLAIN = tone("232934", "f1ebdd")
_HEADING = tone("ffffff", "1c2430")


class BoxLook(NamedTuple):
    """Colours of a box and of its text."""

    back: Colour
    rim: Colour
    text: Colour


class ButtonStyle(NamedTuple):
    """The look of a button in each state; size of its letters and radius of its corners [layout units]."""

    looks: dict[State, BoxLook]
    size: float = 13.0
    radius: float = 6.0


class LabelStyle(NamedTuple):
    """The look of a line of text; size [layout units]; side: 0 left, 0.5 middle, 1 right."""

    text: Colour
    size: float = 13.0
    is_bold: bool = False
    side: float = 0.0


class PanelStyle(NamedTuple):
    """Colours of a panel, and the radius of its corners [layout units]."""

    back: Colour
    rim: Colour | None = None
    radius: float = 0.0


_BUTTON: dict[State, BoxLook] = {
    "normal": BoxLook(_PLAIN, RIM, TEXT),
    "hovered": BoxLook(tone("2d3543", "e7dfcd"), HOVERED_RIM, BRIGHT),
    "active": BoxLook(tone("35404f", "ddd3bd"), ACCENT, BRIGHT),
    "selected": BoxLook(CHOSEN, ACCENT, CHOSEN_TEXT),
    "disabled": BoxLook(tone("1b2028", "f6f2e8"), tone("232934", "ebe5d8"), tone("5a6474", "a5a79f")),
}
_QUIET: dict[State, BoxLook] = {
    "normal": BoxLook(SURFACE, SURFACE, TEXT),
    "disabled": BoxLook(SURFACE, SURFACE, _BUTTON["disabled"].text),
}
_PRIMARY: dict[State, BoxLook] = {
    "normal": BoxLook(tone("2f8f7b", "0e7c69"), tone("38a78f", "0a6a59"), WHITE),
    "hovered": BoxLook(tone("38a78f", "0a6a59"), tone("5ed0b2", "075c4d"), WHITE),
    "active": BoxLook(tone("27786a", "075c4d"), ACCENT, WHITE),
}
_CHIP: dict[State, BoxLook] = {
    "normal": BoxLook(CLEAR, CLEAR, TEXT),
    "hovered": BoxLook(tone("2d354380", "e7dfcd80"), HOVERED_RIM, BRIGHT),
}
BUTTONS = {
    "": ButtonStyle(_BUTTON),
    "segment": ButtonStyle(_BUTTON, 12.0),
    "quiet": ButtonStyle(_BUTTON | _QUIET),
    "tool": ButtonStyle(_BUTTON | _QUIET, 12.0),
    "primary": ButtonStyle(_BUTTON | _PRIMARY),
    "chip": ButtonStyle(_BUTTON | _CHIP, 12.0, 13.0),
}
LABELS = {
    "": LabelStyle(tone("c3cbd8", "3b4554")),
    "heading": LabelStyle(MUTED, 11.0, True),
    "title": LabelStyle(_HEADING, 15.0, True),
    "display": LabelStyle(_HEADING, 24.0, True),
    "muted": LabelStyle(MUTED, 12.0),
    "middle": LabelStyle(TEXT, side=0.5),
    "right": LabelStyle(MUTED, 12.0, side=1.0),
    "key": LabelStyle(tone("8ff0d8", "0e7c69"), 12.0, True, 1.0),
}
PANELS: dict[str, PanelStyle] = {
    "": PanelStyle(SURFACE),
    "shade": PanelStyle(tone("0b0d11d8", "3b3a34a8")),
    "cover": PanelStyle(BACKGROUND),
    "clear": PanelStyle(CLEAR),
    "card": PanelStyle(SURFACE, RIM, 8.0),
    "dialog": PanelStyle(MENU, tone("343d4c", "ddd5c6"), 12.0),
}
FIELD_LOOK, FOCUSED_FIELD = BoxLook(FIELD, FIELD_RIM, TEXT), BoxLook(FIELD, ACCENT, TEXT)
HOVERED_FIELD = BoxLook(FIELD, HOVERED_RIM, TEXT)
TIP = BoxLook(TIP_BACK, HOVERED_RIM, TEXT)


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


def put_rim(card: pygame.Surface, colour: Colour, width: int, radius: int) -> None:
    """Draw the rim of a card, and cut off what was painted beyond its round corners."""
    pygame.draw.rect(card, colour, card.get_rect(), width, border_radius=radius)
    mask = pygame.Surface(card.get_size(), pygame.SRCALPHA)
    pygame.draw.rect(mask, (255, 255, 255), mask.get_rect(), border_radius=radius)
    card.blit(mask, (0, 0), special_flags=pygame.BLEND_RGBA_MIN)


class Plate(Widget):
    """A panel in one of the styles."""

    def __init__(self, ui: WindowLayout, rect: pygame.Rect, parent: Widget | None = None, style: str = "") -> None:
        super().__init__(ui, rect, parent)
        self._style = PANELS[style]

    def paint(self, size: tuple[int, int]) -> pygame.Surface | None:
        """The background of the plate's style, if it has one."""
        back, rim, radius = self._style
        if back is CLEAR:
            return None
        if rim is not None:
            return box(size, BoxLook(back, rim, back), self.ui.px(radius), max(self.ui.px(1), 1))
        surface = pygame.Surface(size, pygame.SRCALPHA)
        surface.fill(tuple(back))
        return surface

    def on_press(self, at: Pixel, clicks: int) -> bool:
        """Take the press and do nothing, so that no widget below gets it."""
        return True
