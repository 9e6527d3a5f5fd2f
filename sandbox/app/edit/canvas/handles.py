"""Handles: the box around the selection, with eight squares to scale it by and a knob to turn it by."""

import math
from dataclasses import dataclass

import numpy as np
import pygame

from sandbox.app.draw.camera import Box, Camera, Point
from sandbox.app.draw.colours import ACCENT, BACKGROUND

# Sizes in layout units: side of a square, how far off a press still takes it, how far the knob stands above the box.
SIDE = 8.0
REACH = 9.0
KNOB = 26.0
# The box keeps this distance from what it holds; nearer, its handles lie over particles.
PADDING = 14.0
# A turn snaps to whole multiples of this [degrees].
TURN_STEP = 15.0
# What is scaled keeps at least this part of its size, and its side.
SMALLEST_FACTOR = 1e-3

# Names of the squares: which side of the box they lie on, x to the right, y up.
SIDES = {
    "left": (-1, 0), "right": (1, 0), "bottom": (0, -1), "top": (0, 1), "bottom left": (-1, -1),
    "bottom right": (1, -1), "top left": (-1, 1), "top right": (1, 1),
}  # fmt: skip


@dataclass(frozen=True)
class Scaling:
    """How a selection is scaled: factors about a point [m]."""

    x: float
    y: float
    centre: Point

    @property
    def matrix(self) -> np.ndarray:
        """The map (2, 3) of the scaling."""
        (x, y), (cx, cy) = (self.x, self.y), self.centre
        return np.array([[x, 0.0, cx - x * cx], [0.0, y, cy - y * cy]])


@dataclass(frozen=True)
class Turn:
    """How a selection is turned: an angle [rad], counter-clockwise, about a point [m]."""

    angle: float
    centre: Point

    @property
    def matrix(self) -> np.ndarray:
        """The map (2, 3) of the turn."""
        c, s, (x, y) = math.cos(self.angle), math.sin(self.angle), self.centre
        return np.array([[c, -s, x - c * x + s * y], [s, c, y - s * x - c * y]])


class Handles:
    """The handles of a box [m] as a camera shows it; uneven: whether its sides can be scaled apart.

    is_line: whether it is about a line from end to end, which its ends alone make longer.
    """

    def __init__(self, box: Box, camera: Camera, scale: float, uneven: bool, is_line: bool = False) -> None:
        self.box, self._camera, self._scale = box, camera, scale
        left, bottom, right, top = box
        (x0, y0), (x1, y1) = camera.to_pixels((left, top)), camera.to_pixels((right, bottom))
        pad = PADDING * scale
        self.frame = (x0 - pad, y0 - pad, x1 + pad, y1 + pad)
        sides = {} if is_line else SIDES
        names = [name for name, (x, y) in sides.items() if self._fits(x, y) and (uneven or (x and y))]
        self.places = {name: self._place(*SIDES[name]) for name in names}
        self.knob = ((self.frame[0] + self.frame[2]) / 2, self.frame[1] - KNOB * scale)

    def _fits(self, x: int, y: int) -> bool:
        """Whether scaling on that side means anything: a level rope has no height."""
        left, bottom, right, top = self.box
        return (not x or right > left) and (not y or top > bottom)

    def _place(self, x: int, y: int) -> Point:
        left, top, right, bottom = self.frame
        return (left + right) / 2 + x * (right - left) / 2, (top + bottom) / 2 - y * (bottom - top) / 2

    def at(self, pixel: Point) -> str | None:
        """Name of the handle at a pixel; "turn" is the knob."""
        reach = REACH * self._scale
        places = {"turn": self.knob, **self.places}
        near = [name for name, place in places.items() if math.dist(place, pixel) <= reach]
        return min(near, key=lambda name: math.dist(places[name], pixel), default=None)

    def scaling(self, name: str, start: Point, now: Point, even: bool, about_centre: bool) -> Scaling:
        """What a drag of a square from one point [m] to another does; even: both sides alike."""
        left, bottom, right, top = self.box
        sx, sy = SIDES[name]
        middle = ((left + right) / 2, (bottom + top) / 2)
        fixed = middle if about_centre else (left if sx > 0 else right, bottom if sy > 0 else top)
        fixed = (fixed[0] if sx else middle[0], fixed[1] if sy else middle[1])
        corner = (right if sx > 0 else left, top if sy > 0 else bottom)
        dx, dy = now[0] - start[0], now[1] - start[1]
        fx = _factor(corner[0] - fixed[0], dx) if sx else 1.0
        fy = _factor(corner[1] - fixed[1], dy) if sy else 1.0
        if even:
            factor = max(fx, fy, key=lambda value: abs(value - 1.0))
            fx = fy = factor
        return Scaling(fx, fy, fixed)

    def turn(self, start: Point, now: Point, free: bool) -> Turn:
        """What a drag of the knob from one point [m] to another does; free: not only round angles."""
        left, bottom, right, top = self.box
        x, y = (left + right) / 2, (bottom + top) / 2
        angle = math.atan2(now[1] - y, now[0] - x) - math.atan2(start[1] - y, start[0] - x)
        angle = math.remainder(angle, math.tau)
        if not free:
            angle = math.radians(round(math.degrees(angle) / TURN_STEP) * TURN_STEP)
        return Turn(angle, (x, y))

    def draw(self, surface: pygame.Surface) -> None:
        """Draw box, squares and knob."""
        left, top, right, bottom = (round(value) for value in self.frame)
        pygame.draw.rect(surface, ACCENT, (left, top, right - left, bottom - top), 1)
        pygame.draw.aaline(surface, ACCENT, ((left + right) / 2, top), self.knob)
        side = round(SIDE * self._scale)
        for x, y in self.places.values():
            square = pygame.Rect(0, 0, side, side)
            square.center = (round(x), round(y))
            pygame.draw.rect(surface, BACKGROUND, square.inflate(2, 2))
            pygame.draw.rect(surface, ACCENT, square)
        pygame.draw.aacircle(surface, BACKGROUND, self.knob, side * 0.75)
        pygame.draw.aacircle(surface, ACCENT, self.knob, side * 0.6)


def _factor(extent: float, change: float) -> float:
    return max((extent + change) / extent, SMALLEST_FACTOR) if extent else 1.0
