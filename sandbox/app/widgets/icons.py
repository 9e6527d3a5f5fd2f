"""Icons: the pictures in assets/icons, sharp at every scale and in any colour; and rows of stars that are won."""

from functools import lru_cache

import pygame

from sandbox.app.draw.colours import DISABLED, Colour, tone
from sandbox.app.widgets.fonts import plain_font
from sandbox.level.format.shipped import shipped_folder
from sandbox.session.outcome import MOST_STARS

# Icons that are kept, in their sizes and colours; most have 2 kB.
MOST_ICONS = 500
# Stars that are won; from one star to the next, as a part of a star.
GOLD = tone("ffc94d", "e09a00")
STEP = 1.08


def painted_icon(name: str, size: int, colour: Colour) -> pygame.Surface:
    """An icon of size [pixels] with straight alpha, by the name of its file; without a file, its first letter.

    Who asks for the same one again gets the same picture.
    """
    return _painted(name, size, tuple(colour))


@lru_cache(MOST_ICONS)
def _painted(name: str, size: int, colour: tuple[int, ...]) -> pygame.Surface:
    file = shipped_folder("assets") / "icons" / f"{name}.svg"
    flat = pygame.Surface((size, size), pygame.SRCALPHA)
    if not file.is_file():
        letter = plain_font(round(0.8 * size), True).render(name[:1].upper(), True, colour)
        flat.blit(letter, letter.get_rect(center=flat.get_rect().center))
        return flat
    # Of the file only its alpha counts.
    shape = pygame.image.load_sized_svg(file, (size, size))
    flat.fill((*colour, 0))
    alpha = pygame.surfarray.pixels_alpha(flat)
    alpha[:] = pygame.surfarray.array_alpha(shape)
    del alpha
    return flat


def painted_stars(won: int, size: int, grown: float = 1.0) -> pygame.Surface:
    """A row of stars of size [pixels] with straight alpha: those won in gold, the last of them so large (0..1)."""
    row = pygame.Surface((round(size * (1 + STEP * (MOST_STARS - 1))), size), pygame.SRCALPHA)
    for number in range(MOST_STARS):
        shape = painted_icon("star", size, GOLD if number < won else DISABLED)
        if number == won - 1 and grown != 1.0:
            shape = pygame.transform.smoothscale_by(shape, grown)
        row.blit(shape, shape.get_rect(center=(round(size * (0.5 + STEP * number)), size // 2)))
    return row
