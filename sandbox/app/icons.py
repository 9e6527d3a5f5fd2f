"""Icons, drawn by program: sharp at every scale."""

from collections.abc import Callable
from itertools import pairwise

import pygame

Colour = tuple[int, int, int]
# Drawn this many times larger and scaled down: smooth edges. The grid of every icon is 24 x 24.
OVERSAMPLING = 8
GRID = 24


class _Pen:
    def __init__(self, size: int, colour: Colour) -> None:
        self.k = size * OVERSAMPLING / GRID
        self.surface = pygame.Surface((size * OVERSAMPLING,) * 2, pygame.SRCALPHA)
        self.colour = colour

    def line(self, *points: tuple[float, float], width: float = 2.0) -> None:
        placed = [(x * self.k, y * self.k) for x, y in points]
        for start, end in pairwise(placed):
            pygame.draw.line(self.surface, self.colour, start, end, round(width * self.k))
        for point in placed:
            pygame.draw.circle(self.surface, self.colour, point, width * self.k / 2)

    def shape(self, *points: tuple[float, float]) -> None:
        pygame.draw.polygon(self.surface, self.colour, [(x * self.k, y * self.k) for x, y in points])

    def disc(self, x: float, y: float, radius: float, width: float = 0.0) -> None:
        pygame.draw.circle(self.surface, self.colour, (x * self.k, y * self.k), radius * self.k, round(width * self.k))

    def arc(self, x: float, y: float, radius: float, start: float, end: float) -> None:
        vector = pygame.Vector2(radius, 0)
        steps = 40
        turns = [start + (end - start) * step / steps for step in range(steps + 1)]
        self.line(*[(x + vector.rotate(-turn).x, y + vector.rotate(-turn).y) for turn in turns])


def _drag(pen: _Pen) -> None:
    pen.line((12, 3), (12, 21))
    pen.line((3, 12), (21, 12))
    for x, y, dx, dy in ((12, 3, 3, 3), (12, 21, 3, -3)):
        pen.line((x - dx, y + dy), (x, y), (x + dx, y + dy))
    for x, y, dx, dy in ((3, 12, 3, 3), (21, 12, -3, 3)):
        pen.line((x + dx, y - dy), (x, y), (x + dx, y + dy))


def _pin(pen: _Pen) -> None:
    pen.disc(12, 9, 6, 2)
    pen.disc(12, 9, 2)
    pen.line((12, 15), (12, 21))


def _cut(pen: _Pen) -> None:
    pen.disc(6, 7, 3, 2)
    pen.disc(6, 17, 3, 2)
    pen.line((8.5, 9), (20, 17.5))
    pen.line((8.5, 15), (20, 6.5))


def _play(pen: _Pen) -> None:
    pen.shape((7, 4), (20, 12), (7, 20))


def _pause(pen: _Pen) -> None:
    pen.line((8, 6), (8, 18), width=3.5)
    pen.line((16, 6), (16, 18), width=3.5)


def _step(pen: _Pen) -> None:
    pen.shape((5, 5), (15, 12), (5, 19))
    pen.line((18, 6), (18, 18), width=2.6)


def _reset(pen: _Pen) -> None:
    pen.arc(12, 12.5, 7.5, 60, 350)
    pen.shape((11.5, 1.5), (18.5, 5.5), (12, 10))


def _undo(pen: _Pen) -> None:
    pen.line((9, 4.5), (4, 9), (9, 13.5))
    pen.line((4.5, 9), (14, 9))
    pen.arc(14, 14, 5, 90, -90)
    pen.line((14, 19), (9, 19))


def _redo(pen: _Pen) -> None:
    pen.line((15, 4.5), (20, 9), (15, 13.5))
    pen.line((19.5, 9), (10, 9))
    pen.arc(10, 14, 5, 90, 270)
    pen.line((10, 19), (15, 19))


def _record(pen: _Pen) -> None:
    pen.disc(12, 12, 6.5)


def _stop(pen: _Pen) -> None:
    pen.shape((6, 6), (18, 6), (18, 18), (6, 18))


def _levels(pen: _Pen) -> None:
    for x in (4, 13.5):
        for y in (4, 13.5):
            pen.shape((x, y), (x + 6.5, y), (x + 6.5, y + 6.5), (x, y + 6.5))


def _fit(pen: _Pen) -> None:
    for x, dx in ((4, 4.5), (20, -4.5)):
        for y, dy in ((4, 4.5), (20, -4.5)):
            pen.line((x + dx, y), (x, y), (x, y + dy))


def _panel(pen: _Pen) -> None:
    for y, x in ((6, 15), (12, 8), (18, 13)):
        pen.line((4, y), (20, y), width=1.6)
        pen.disc(x, y, 2.8)


def _save(pen: _Pen) -> None:
    pen.line((12, 3.5), (12, 14))
    pen.line((7.5, 10), (12, 14.5), (16.5, 10))
    pen.line((4, 15), (4, 20), (20, 20), (20, 15))


def _spring(pen: _Pen) -> None:
    pen.line((3, 12), (6, 12), (8, 6), (12, 18), (16, 6), (18, 12), (21, 12), width=2.2)
    pen.disc(3.5, 12, 3)
    pen.disc(20.5, 12, 3)


_DRAWINGS: dict[str, Callable[[_Pen], None]] = {
    "drag": _drag, "pin": _pin, "cut": _cut, "play": _play, "pause": _pause, "step": _step, "reset": _reset,
    "undo": _undo, "redo": _redo, "record": _record, "stop": _stop, "levels": _levels, "fit": _fit,
    "panel": _panel, "save": _save, "spring": _spring,
}  # fmt: skip


def icon(name: str, size: int, colour: Colour) -> pygame.Surface:
    """An icon of size [pixels] with straight alpha."""
    pen = _Pen(size, colour)
    _DRAWINGS[name](pen)
    # Scaling mixes in the colour of transparent pixels: only their alpha may count.
    shape = pygame.transform.smoothscale(pen.surface, (size, size))
    flat = pygame.Surface((size, size), pygame.SRCALPHA)
    flat.fill((*colour, 0))
    alpha = pygame.surfarray.pixels_alpha(flat)
    alpha[:] = pygame.surfarray.array_alpha(shape)
    del alpha
    return flat
