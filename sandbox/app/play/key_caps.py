"""Keys that a level gives a meaning, shown while it is played; those that are held down are lit."""

from collections.abc import Sequence

import pygame

from sandbox.app.base.gamepads import controls_of
from sandbox.app.draw.colours import ACCENT, BACKGROUND, LINE, MUTED, NOTICE, TEXT, Colour
from sandbox.app.widgets.ui import Ui

# Sizes in layout units.
CAP, GAP, INSET = 26.0, 5.0, 14.0
TEXT_SIZE = 12.5
# Where the stick and the cross of a gamepad point: right and down.
_WAYS = {"left": (-1, 0), "right": (1, 0), "up": (0, -1), "down": (0, 1)}
# What they take of the lower edge, from a level that has some: in a narrower world, notices lie above them.
KEYS_HEIGHT, ROOM_BESIDE = CAP + INSET, 720.0


def draw_key_caps(
    surface: pygame.Surface,
    ui: Ui,
    keys: Sequence[tuple[str, bool]],
    viewport: tuple[int, int, int, int],
    on_pad: bool = False,
) -> None:
    """Draw the caps of keys, (name, whether it is held) each, at the lower right of a viewport [pixels].

    on_pad: show what presses them on a gamepad, in round caps.
    """
    left, top, width, height = viewport
    font, side = ui.font(TEXT_SIZE, True), ui.px(CAP)
    x, y = left + width - ui.px(INSET), top + height - ui.px(INSET) - side
    if on_pad:
        held = dict(keys)
        keys = [(control, held[name]) for name, control in controls_of(held).items()]
    rounding = side // 2 if on_pad else ui.px(6)
    for name, is_held in reversed(keys):
        colour = BACKGROUND if is_held else TEXT
        picture = font.render(name.upper() if len(name) == 1 else name, True, colour)
        is_arrow = on_pad and name in _WAYS
        cap = pygame.Rect(0, y, side if is_arrow else max(side, picture.get_width() + ui.px(12)), side)
        cap.right = x
        pygame.draw.rect(surface, ACCENT if is_held else NOTICE, cap, border_radius=rounding)
        pygame.draw.rect(surface, ACCENT if is_held else LINE, cap, max(1, ui.px(1.2)), border_radius=rounding)
        if is_arrow:
            _draw_arrow(surface, cap, _WAYS[name], colour)
        else:
            surface.blit(picture, picture.get_rect(center=cap.center))
        x = cap.left - ui.px(GAP)
    if keys and not on_pad:
        word = ui.font(TEXT_SIZE).render("keys", True, MUTED)
        surface.blit(word, word.get_rect(midright=(x - ui.px(3), y + side // 2)))


def _draw_arrow(surface: pygame.Surface, cap: pygame.Rect, way: tuple[int, int], colour: Colour) -> None:
    """Draw a triangle in a cap; way: right and down, a unit."""
    middle, (x, y), size = pygame.Vector2(cap.center), way, cap.height * 0.22
    along, across = pygame.Vector2(x, y) * size, pygame.Vector2(-y, x) * size
    pygame.draw.polygon(surface, colour, (middle + along, middle - along + across, middle - along - across))
