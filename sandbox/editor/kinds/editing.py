"""BodyEditing: what the editor adds to a kind of body, and PlaneMap: the maps of the plane that it follows."""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, ClassVar, Generic, TypeVar

from sandbox.editor.tools.drawing_tool import EditorTool
from sandbox.level.kinds.body_def import BodyDef
from sandbox.level.kinds.geometry import turn

Point = tuple[float, float]


@dataclass(frozen=True)
class PlaneMap:
    """A map of the plane about a fixed centre [m]: a turn by angle [rad], or a scale by sx, sy (negative: mirrored)."""

    centre: Point
    angle: float = 0.0
    sx: float = 1.0
    sy: float = 1.0

    @property
    def is_even(self) -> bool:
        """Whether the motion keeps angles."""
        return abs(self.sx) == abs(self.sy)

    @property
    def is_mirror(self) -> bool:
        """Whether the motion turns right into left."""
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
        """The image of a direction [rad], between half a turn back and half a turn on."""
        if self.is_mirror:
            angle = math.pi - angle if self.sx < 0.0 else -angle
        angle += self.angle
        return angle if abs(angle) <= math.pi else math.remainder(angle, 2.0 * math.pi)


def mapped_velocity(velocity: Point, motion: PlaneMap) -> Point:
    """A velocity [m/s] after a motion, which scales lengths alone."""
    # Turned or mirrored things go where they then look.
    direction = PlaneMap((0.0, 0.0), motion.angle, math.copysign(1.0, motion.sx), math.copysign(1.0, motion.sy))
    return velocity if velocity == (0.0, 0.0) else direction.vector(velocity)


def stretch(a: Point, b: Point, motion: PlaneMap) -> float:
    """How much farther apart two places [m] are after a motion; of one and the same place, as lengths in all."""
    if motion.is_even or a == b:
        return motion.factor
    return math.dist(motion.point(a), motion.point(b)) / math.dist(a, b)


Body = TypeVar("Body", bound=BodyDef)


class BodyEditing(Generic[Body]):
    """One body of a kind in the editor: where it goes when the plane is moved, and how its kind is drawn."""

    # Tools that draw such a body, in the order of the palette.
    tools: ClassVar[tuple[EditorTool, ...]] = ()
    # Fields that its form does not depend on, beside those of every body.
    formless: ClassVar[frozenset[str]] = frozenset()
    # Whether every body of the kind can be made longer without being made higher as much.
    stretches: ClassVar[bool] = False

    def __init__(self, body: Body) -> None:
        self.body = body

    @property
    def noun(self) -> str:
        """The name in messages of a body that cannot be stretched."""
        return self.body.type

    def can_stretch(self) -> bool:
        """Whether the body can be made longer without being made higher as much."""
        return self.stretches

    def mapped(self, motion: PlaneMap) -> dict[str, Any]:
        """The fields that a motion changes, other than pose and velocity.

        motion: even where the body cannot be stretched.
        """
        raise NotImplementedError

    def lies_askew(self, motion: PlaneMap) -> bool:
        """Whether no fields can say where a motion takes it, so that it needs a pose."""
        return False

    def with_field(self, field: str, value: Any) -> dict[str, Any]:
        """The fields that change where one of them gets a new value."""
        return {field: value}


def mapped_centre(body: Any, motion: PlaneMap) -> dict[str, Any]:
    """Place and angle of a round body after a motion."""
    return {"position": motion.point(body.position), "angle": motion.turned(body.angle)}
