"""Stars: a row of the stars that a win earns, those that it has in gold and the others hollow."""

import pygame

from sandbox.app.draw.colours import DISABLED, tone
from sandbox.app.widgets.icons import painted_icon
from sandbox.app.widgets.layout import WindowLayout
from sandbox.session.outcome import MOST_STARS

GOLD = tone("ffc94d", "e09a00")
# From one star to the next, as a part of a star.
STEP = 1.08


def painted_stars(ui: WindowLayout, won: int, size: float, grown: float = 1.0) -> pygame.Surface:
    """A row of stars of a size [layout units] with straight alpha; grown: how large the last one won is, of 1."""
    side = ui.px(size)
    row = pygame.Surface((round(side * (1 + STEP * (MOST_STARS - 1))), side), pygame.SRCALPHA)
    for number in range(MOST_STARS):
        middle = round(side * (0.5 + STEP * number)), side // 2
        is_won = number < won
        shape = painted_icon("star", side, GOLD if is_won else DISABLED)
        if is_won and number == won - 1 and grown != 1.0:
            shape = pygame.transform.smoothscale_by(shape, max(grown, 0.01))
        row.blit(shape, shape.get_rect(center=middle))
    return row
