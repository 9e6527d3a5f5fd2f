"""Pictures of lessons: two sides at their beginning."""

import pygame

from sandbox.app.compare.hooke_level import SpringTrial, lesson_level
from sandbox.app.draw.colours import LINE, ThemeName
from sandbox.app.draw.picture import draw_picture
from sandbox.session.session import Session

# Drawn in this size [pixels] for each side, what it shows [m], and how thick lines are.
SIZE, BOX, LINE_SCALE = (320, 360), (-1.4, -3.1, 2.0, 0.6), 1.6
SIDES = ((SpringTrial(), False), (SpringTrial(doublings=2), True))


def lesson_picture(size: tuple[int, int], theme: ThemeName) -> pygame.Surface:
    """Both sides beside each other in a size [pixels] and a theme."""
    whole = pygame.Surface((2 * SIZE[0], SIZE[1]), 0, 32)
    for k, (trial, is_hooke) in enumerate(SIDES):
        level = lesson_level(trial, is_hooke)
        whole.blit(draw_picture(level, Session(level).snapshot(), SIZE, BOX, LINE_SCALE, theme), (k * SIZE[0], 0))
    pygame.draw.line(whole, LINE, (SIZE[0], 0), (SIZE[0], SIZE[1]), 4)
    return pygame.transform.smoothscale(whole, size)


def twice(picture: pygame.Surface) -> pygame.Surface:
    """The middle of a picture twice beside itself, in the same size."""
    width, height = picture.get_size()
    whole = picture.copy()
    middle = pygame.Rect(width // 4, 0, width - width // 2, height)
    for left in (0, width // 2):
        whole.blit(picture, (left, 0), middle)
    pygame.draw.line(whole, LINE, (width // 2, 0), (width // 2, height), 2)
    return whole
