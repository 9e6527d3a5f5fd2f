"""Icons, drawn by program: sharp at every scale."""

import math
from functools import lru_cache
from itertools import pairwise

import pygame

from sandbox.app.draw.colours import Colour
from sandbox.editor.tools.icons import Icon, IconPen, draw_pin, draw_spring

# Drawn this many times larger and scaled down: smooth edges. The grid of every icon is 24 x 24.
OVERSAMPLING = 8
GRID = 24
# Icons that are kept, in their sizes and colours; most have 2 kB.
MOST_ICONS = 500


class Pen:
    """Draws lines and shapes on a grid of 24 x 24, `surface` is the picture, larger than the icon."""

    def __init__(self, size: int, colour: Colour) -> None:
        self.k = size * OVERSAMPLING / GRID
        self.surface = pygame.Surface((size * OVERSAMPLING,) * 2, pygame.SRCALPHA)
        self.colour = colour

    def line(self, *points: tuple[float, float], width: float = 2.0) -> None:
        """A line through points, with round ends."""
        placed = [(x * self.k, y * self.k) for x, y in points]
        for start, end in pairwise(placed):
            pygame.draw.line(self.surface, self.colour, start, end, round(width * self.k))
        for point in placed:
            pygame.draw.circle(self.surface, self.colour, point, width * self.k / 2)

    def shape(self, *points: tuple[float, float]) -> None:
        """A filled polygon."""
        pygame.draw.polygon(self.surface, self.colour, [(x * self.k, y * self.k) for x, y in points])

    def disc(self, x: float, y: float, radius: float, width: float = 0.0) -> None:
        """A disc, or a ring of a width."""
        pygame.draw.circle(self.surface, self.colour, (x * self.k, y * self.k), radius * self.k, round(width * self.k))

    def arc(self, x: float, y: float, radius: float, start: float, end: float) -> None:
        """An arc about a point, counter-clockwise between two angles in degrees."""
        vector = pygame.Vector2(radius, 0)
        steps = 40
        turns = [start + (end - start) * step / steps for step in range(steps + 1)]
        self.line(*[(x + vector.rotate(-turn).x, y + vector.rotate(-turn).y) for turn in turns])


def _drag(pen: IconPen) -> None:
    pen.line((12, 3), (12, 21))
    pen.line((3, 12), (21, 12))
    for x, y, dx, dy in ((12, 3, 3, 3), (12, 21, 3, -3)):
        pen.line((x - dx, y + dy), (x, y), (x + dx, y + dy))
    for x, y, dx, dy in ((3, 12, 3, 3), (21, 12, -3, 3)):
        pen.line((x + dx, y - dy), (x, y), (x + dx, y + dy))


def _cut(pen: IconPen) -> None:
    pen.disc(6, 7, 3, 2)
    pen.disc(6, 17, 3, 2)
    pen.line((8.5, 9), (20, 17.5))
    pen.line((8.5, 15), (20, 6.5))


def _play(pen: IconPen) -> None:
    pen.shape((7, 4), (20, 12), (7, 20))


def _pause(pen: IconPen) -> None:
    pen.line((8, 6), (8, 18), width=3.5)
    pen.line((16, 6), (16, 18), width=3.5)


def _step(pen: IconPen) -> None:
    pen.shape((5, 5), (15, 12), (5, 19))
    pen.line((18, 6), (18, 18), width=2.6)


def _reset(pen: IconPen) -> None:
    pen.arc(12, 12.5, 7.5, 60, 350)
    pen.shape((11.5, 1.5), (18.5, 5.5), (12, 10))


def _undo(pen: IconPen) -> None:
    pen.line((9, 4.5), (4, 9), (9, 13.5))
    pen.line((4.5, 9), (14, 9))
    pen.arc(14, 14, 5, 90, -90)
    pen.line((14, 19), (9, 19))


def _redo(pen: IconPen) -> None:
    pen.line((15, 4.5), (20, 9), (15, 13.5))
    pen.line((19.5, 9), (10, 9))
    pen.arc(10, 14, 5, 90, 270)
    pen.line((10, 19), (15, 19))


def _record(pen: IconPen) -> None:
    pen.disc(12, 12, 6.5)


def _stop(pen: IconPen) -> None:
    pen.shape((6, 6), (18, 6), (18, 18), (6, 18))


def _levels(pen: IconPen) -> None:
    for x in (4, 13.5):
        for y in (4, 13.5):
            pen.shape((x, y), (x + 6.5, y), (x + 6.5, y + 6.5), (x, y + 6.5))


def _fit(pen: IconPen) -> None:
    for x, dx in ((4, 4.5), (20, -4.5)):
        for y, dy in ((4, 4.5), (20, -4.5)):
            pen.line((x + dx, y), (x, y), (x, y + dy))


def _panel(pen: IconPen) -> None:
    for y, x in ((6, 15), (12, 8), (18, 13)):
        pen.line((4, y), (20, y), width=1.6)
        pen.disc(x, y, 2.8)


def _save(pen: IconPen) -> None:
    pen.line((12, 3.5), (12, 14))
    pen.line((7.5, 10), (12, 14.5), (16.5, 10))
    pen.line((4, 15), (4, 20), (20, 20), (20, 15))


def _edit(pen: IconPen) -> None:
    pen.line((5, 19), (6, 14.5), (16, 4.5), (19.5, 8), (9.5, 18), (5, 19))
    pen.line((13.5, 7), (17, 10.5))


def _keep(pen: IconPen) -> None:
    pen.line((6.5, 3.5), (17.5, 3.5), (17.5, 20.5), (12, 15.5), (6.5, 20.5), (6.5, 3.5))


def _settings(pen: IconPen) -> None:
    pen.disc(12, 12, 6.6, 3.4)
    for turn in range(8):
        x, y = math.cos(turn * math.pi / 4), math.sin(turn * math.pi / 4)
        pen.line((12 + 7 * x, 12 + 7 * y), (12 + 8.6 * x, 12 + 8.6 * y), width=4.2)


def _more(pen: IconPen) -> None:
    for y in (5.5, 12, 18.5):
        pen.disc(12, y, 1.9)


def _parts(pen: IconPen) -> None:
    pen.disc(7.5, 7.5, 4.2, 2)
    pen.line((13.5, 4), (20, 4), (20, 10.5), (13.5, 10.5), (13.5, 4))
    pen.line((12, 14), (12, 21))
    pen.line((8.5, 17.5), (15.5, 17.5))


def _share(pen: IconPen) -> None:
    for x, y in ((6, 12), (17.5, 5.5), (17.5, 18.5)):
        pen.disc(x, y, 3.2)
    pen.line((6, 12), (17.5, 5.5), width=1.8)
    pen.line((6, 12), (17.5, 18.5), width=1.8)


def _lattice(pen: IconPen) -> None:
    pen.line((4, 6), (20, 6), (20, 18), (4, 18), (4, 6), width=1.6)
    pen.line((4, 18), (12, 6), (20, 18), width=1.6)


def _particles(pen: IconPen) -> None:
    for x, y in ((6, 6), (18, 7), (11, 13), (6, 19), (19, 18)):
        pen.disc(x, y, 2.4)


def _contacts(pen: IconPen) -> None:
    pen.line((3, 18), (21, 18))
    pen.disc(12, 18, 3.4)
    pen.line((12, 17), (12, 5), width=1.6)


def _forces(pen: IconPen) -> None:
    pen.line((12, 21), (12, 5), width=3.4)
    pen.shape((6, 10), (12, 2.5), (18, 10))


def _velocities(pen: IconPen) -> None:
    pen.line((3, 12), (20, 12))
    pen.line((14.5, 6.5), (20.5, 12), (14.5, 17.5))


def _stability(pen: IconPen) -> None:
    pen.arc(12, 16, 8.5, 0, 180)
    pen.line((12, 16), (17, 9.5))
    pen.disc(12, 16, 2.2)


def _graphs(pen: IconPen) -> None:
    pen.line((4, 4), (4, 20), (20, 20), width=1.8)
    pen.line((6.5, 15), (10, 9), (13.5, 13), (19.5, 5.5), width=1.8)


def _compare(pen: IconPen) -> None:
    pen.line((4, 5), (10, 5), (10, 19), (4, 19), (4, 5), width=1.8)
    pen.line((14, 5), (20, 5), (20, 19), (14, 19), (14, 5), width=1.8)
    pen.disc(7, 9, 1.7)
    pen.disc(17, 14.5, 1.7)


def _speaker(pen: IconPen) -> None:
    pen.shape((3, 9), (7, 9), (12, 4.5), (12, 19.5), (7, 15), (3, 15))


def _sound(pen: IconPen) -> None:
    _speaker(pen)
    pen.arc(12, 12, 4.6, -50, 50)
    pen.arc(12, 12, 8.6, -50, 50)


def _muted(pen: IconPen) -> None:
    _speaker(pen)
    pen.line((15.5, 9), (21, 15))
    pen.line((21, 9), (15.5, 15))


def _timeline(pen: IconPen) -> None:
    pen.line((3, 12), (21, 12), width=1.8)
    pen.disc(9, 12, 3.4)
    for x in (5, 15, 19):
        pen.line((x, 6), (x, 8.5), width=1.6)


def _back(pen: IconPen) -> None:
    pen.shape((19, 5), (9, 12), (19, 19))
    pen.line((6, 6), (6, 18), width=2.6)


def _backwards(pen: IconPen) -> None:
    pen.shape((18, 4), (5, 12), (18, 20))


def _mark_beside(pen: IconPen, turn: int) -> None:
    for x in (12 - 7 * turn, 12):
        pen.shape((x, 5), (x + 7 * turn, 12), (x, 19))
    pen.line((12 + 8.5 * turn, 5), (12 + 8.5 * turn, 19), width=2.2)


def _bookmark(pen: IconPen) -> None:
    pen.line((7, 3), (7, 21))
    pen.shape((7, 4), (19, 8), (7, 12))


def _loop(pen: IconPen) -> None:
    pen.arc(12, 12, 7.5, 30, 200)
    pen.arc(12, 12, 7.5, 210, 380)
    pen.shape((16, 10.5), (23, 10.5), (19.5, 5))
    pen.shape((8, 13.5), (1, 13.5), (4.5, 19))


def _branch(pen: IconPen) -> None:
    pen.line((4, 12), (10, 12), (19, 5))
    pen.line((10, 12), (19, 19))
    for y in (5, 19):
        pen.disc(19, y, 2.6)


def _toy(pen: IconPen) -> None:
    pen.line((4, 4), (20, 4), (20, 20), (4, 20), (4, 4), width=1.8)
    for x in (9.5, 14.5):
        pen.disc(x, 10.5, 1.6)
    pen.arc(12, 13, 3.6, 200, 340)


ICONS: dict[str, Icon] = {
    "settings": _settings, "more": _more,
    "drag": _drag, "pin": draw_pin, "cut": _cut, "play": _play, "pause": _pause, "step": _step, "reset": _reset,
    "undo": _undo, "redo": _redo, "record": _record, "stop": _stop, "levels": _levels, "fit": _fit,
    "panel": _panel, "save": _save, "edit": _edit, "keep": _keep, "share": _share, "spring": draw_spring,
    "lattice": _lattice, "particles": _particles, "contacts": _contacts, "forces": _forces,
    "velocities": _velocities, "stability": _stability, "parts": _parts, "sound": _sound, "muted": _muted,
    "compare": _compare, "graphs": _graphs, "toy": _toy,
    "timeline": _timeline, "back": _back, "backwards": _backwards, "bookmark": _bookmark, "loop": _loop,
    "next_mark": lambda pen: _mark_beside(pen, 1), "previous_mark": lambda pen: _mark_beside(pen, -1),
    "branch": _branch,
}  # fmt: skip


def painted_icon(icon: Icon, size: int, colour: Colour) -> pygame.Surface:
    """An icon of size [pixels] with straight alpha; who asks for the same one again gets the same picture."""
    return _painted(icon, size, tuple(colour))


@lru_cache(MOST_ICONS)
def _painted(icon: Icon, size: int, colour: tuple[int, ...]) -> pygame.Surface:
    pen = Pen(size, colour)
    icon(pen)
    # Scaling mixes in the colour of transparent pixels: only their alpha may count.
    shape = pygame.transform.smoothscale(pen.surface, (size, size))
    flat = pygame.Surface((size, size), pygame.SRCALPHA)
    flat.fill((*colour, 0))
    alpha = pygame.surfarray.pixels_alpha(flat)
    alpha[:] = pygame.surfarray.array_alpha(shape)
    del alpha
    return flat
