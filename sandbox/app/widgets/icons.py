"""Icons, drawn by program: sharp at every scale."""

from collections.abc import Callable

import pygame

from sandbox.app.draw.colours import Colour
from sandbox.app.edit.edit_icons import EDIT_DRAWINGS
from sandbox.app.widgets.pen import Pen


def _drag(pen: Pen) -> None:
    pen.line((12, 3), (12, 21))
    pen.line((3, 12), (21, 12))
    for x, y, dx, dy in ((12, 3, 3, 3), (12, 21, 3, -3)):
        pen.line((x - dx, y + dy), (x, y), (x + dx, y + dy))
    for x, y, dx, dy in ((3, 12, 3, 3), (21, 12, -3, 3)):
        pen.line((x + dx, y - dy), (x, y), (x + dx, y + dy))


def _pin(pen: Pen) -> None:
    pen.disc(12, 9, 6, 2)
    pen.disc(12, 9, 2)
    pen.line((12, 15), (12, 21))


def _cut(pen: Pen) -> None:
    pen.disc(6, 7, 3, 2)
    pen.disc(6, 17, 3, 2)
    pen.line((8.5, 9), (20, 17.5))
    pen.line((8.5, 15), (20, 6.5))


def _play(pen: Pen) -> None:
    pen.shape((7, 4), (20, 12), (7, 20))


def _pause(pen: Pen) -> None:
    pen.line((8, 6), (8, 18), width=3.5)
    pen.line((16, 6), (16, 18), width=3.5)


def _step(pen: Pen) -> None:
    pen.shape((5, 5), (15, 12), (5, 19))
    pen.line((18, 6), (18, 18), width=2.6)


def _reset(pen: Pen) -> None:
    pen.arc(12, 12.5, 7.5, 60, 350)
    pen.shape((11.5, 1.5), (18.5, 5.5), (12, 10))


def _undo(pen: Pen) -> None:
    pen.line((9, 4.5), (4, 9), (9, 13.5))
    pen.line((4.5, 9), (14, 9))
    pen.arc(14, 14, 5, 90, -90)
    pen.line((14, 19), (9, 19))


def _redo(pen: Pen) -> None:
    pen.line((15, 4.5), (20, 9), (15, 13.5))
    pen.line((19.5, 9), (10, 9))
    pen.arc(10, 14, 5, 90, 270)
    pen.line((10, 19), (15, 19))


def _record(pen: Pen) -> None:
    pen.disc(12, 12, 6.5)


def _stop(pen: Pen) -> None:
    pen.shape((6, 6), (18, 6), (18, 18), (6, 18))


def _levels(pen: Pen) -> None:
    for x in (4, 13.5):
        for y in (4, 13.5):
            pen.shape((x, y), (x + 6.5, y), (x + 6.5, y + 6.5), (x, y + 6.5))


def _fit(pen: Pen) -> None:
    for x, dx in ((4, 4.5), (20, -4.5)):
        for y, dy in ((4, 4.5), (20, -4.5)):
            pen.line((x + dx, y), (x, y), (x, y + dy))


def _panel(pen: Pen) -> None:
    for y, x in ((6, 15), (12, 8), (18, 13)):
        pen.line((4, y), (20, y), width=1.6)
        pen.disc(x, y, 2.8)


def _save(pen: Pen) -> None:
    pen.line((12, 3.5), (12, 14))
    pen.line((7.5, 10), (12, 14.5), (16.5, 10))
    pen.line((4, 15), (4, 20), (20, 20), (20, 15))


def _spring(pen: Pen) -> None:
    pen.line((3, 12), (6, 12), (8, 6), (12, 18), (16, 6), (18, 12), (21, 12), width=2.2)
    pen.disc(3.5, 12, 3)
    pen.disc(20.5, 12, 3)


_DRAWINGS: dict[str, Callable[[Pen], None]] = {
    "drag": _drag, "pin": _pin, "cut": _cut, "play": _play, "pause": _pause, "step": _step, "reset": _reset,
    "undo": _undo, "redo": _redo, "record": _record, "stop": _stop, "levels": _levels, "fit": _fit,
    "panel": _panel, "save": _save, "spring": _spring, **EDIT_DRAWINGS,
}  # fmt: skip


def icon(name: str, size: int, colour: Colour) -> pygame.Surface:
    """An icon of size [pixels] with straight alpha."""
    pen = Pen(size, colour)
    _DRAWINGS[name](pen)
    # Scaling mixes in the colour of transparent pixels: only their alpha may count.
    shape = pygame.transform.smoothscale(pen.surface, (size, size))
    flat = pygame.Surface((size, size), pygame.SRCALPHA)
    flat.fill((*colour, 0))
    alpha = pygame.surfarray.pixels_alpha(flat)
    alpha[:] = pygame.surfarray.array_alpha(shape)
    del alpha
    return flat
