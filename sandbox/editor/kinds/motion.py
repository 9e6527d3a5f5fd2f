"""Motion: a map of the plane that moves, turns, scales or mirrors what is selected."""

import math
from collections.abc import Iterable
from dataclasses import dataclass

from sandbox.level.kinds.geometry import turn

Point = tuple[float, float]


@dataclass(frozen=True)
class Motion:
    """A map of the plane about a fixed centre [m]: a turn by angle [rad], or a scale by sx, sy (negative: mirrored)."""

    centre: Point
    angle: float = 0.0
    sx: float = 1.0
    sy: float = 1.0

    @property
    def is_even(self) -> bool:
        """Whether it keeps angles."""
        return abs(self.sx) == abs(self.sy)

    @property
    def is_mirror(self) -> bool:
        """Whether it turns right into left."""
        return self.sx * self.sy < 0.0

    @property
    def factor(self) -> float:
        """How much longer things become, on the mean of both axes."""
        return math.sqrt(abs(self.sx * self.sy))

    def vector(self, vector: Point) -> Point:
        """A vector after the motion."""
        cosine, sine = turn(self.angle)
        x, y = self.sx * vector[0], self.sy * vector[1]
        return x * cosine - y * sine, x * sine + y * cosine

    def point(self, point: Point) -> Point:
        """A point [m] after the motion."""
        x, y = self.vector((point[0] - self.centre[0], point[1] - self.centre[1]))
        return self.centre[0] + x, self.centre[1] + y

    def points(self, points: Iterable[Point]) -> tuple[Point, ...]:
        """Points [m] after the motion."""
        return tuple(self.point(point) for point in points)

    def turned(self, angle: float) -> float:
        """What a direction [rad] becomes, between half a turn back and half a turn on; of a mirror, its image."""
        if self.is_mirror:
            angle = math.pi - angle if self.sx < 0.0 else -angle
        angle += self.angle
        return angle if abs(angle) <= math.pi else math.remainder(angle, 2.0 * math.pi)


def mapped_velocity(velocity: Point, motion: Motion) -> Point:
    """A velocity [m/s] after a motion, which scales lengths alone."""
    # Turned or mirrored things go where they then look.
    direction = Motion((0.0, 0.0), motion.angle, math.copysign(1.0, motion.sx), math.copysign(1.0, motion.sy))
    return velocity if velocity == (0.0, 0.0) else direction.vector(velocity)


def stretch(a: Point, b: Point, motion: Motion) -> float:
    """How much farther apart two places [m] are after a motion; of one and the same place, as lengths in all."""
    if motion.is_even or a == b:
        return motion.factor
    return math.dist(motion.point(a), motion.point(b)) / math.dist(a, b)
