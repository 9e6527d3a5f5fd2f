"""Pen: strokes and shapes that icons are made of."""

from itertools import pairwise

import pygame

from sandbox.app.draw.colours import Colour

# Drawn this many times larger and scaled down: smooth edges. The grid of every icon is 24 x 24.
OVERSAMPLING = 8
GRID = 24


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
