"""A R.U.B.E. scene as it is: its bodies with their fixtures, and its joints, in metres of the world."""

import math
import struct
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from sandbox.bring.making import Region, solid_shapes
from sandbox.bring.sketch import (
    FilledShape,
    LeftOut,
    Object,
    OpenLine,
    Ring,
    Sketch,
    Unreadable,
    check_points,
    number,
    objects,
    text,
    whole,
)
from sandbox.level.format.limits import SPEED_LIMIT

STATIC, KINEMATIC, DYNAMIC = 0, 1, 2
# Bodies and fixtures of a scene.
SCENE_LIMIT = 2_000
# Corners of a circle.
ROUND = 32
FRICTION_LIMIT = 100.0
Vector = tuple[float, float]


class Filter(NamedTuple):
    """What may touch what, as Box2D has it."""

    category: int = 1
    mask: int = 0xFFFF
    group: int = 0

    def meets(self, other: "Filter") -> bool:
        """Whether the two may touch."""
        if self.group == other.group != 0:
            return self.group > 0
        return bool(self.category & other.mask) and bool(other.category & self.mask)


@dataclass(frozen=True)
class Fixture:
    """A fixture: its points [m], as in the world, whether they go around something solid, and what it is made of.

    radius [m]: of a circle; density [kg/m^2].
    """

    ring: Ring
    is_closed: bool
    radius: float | None
    density: float
    friction: float | None
    restitution: float | None
    filter: Filter


@dataclass(frozen=True)
class SceneBody:
    """A body of a scene: how it moves, where it is, and its fixtures."""

    name: str
    kind: int
    place: Vector
    angle: float
    velocity: Vector
    gravity_scale: float
    fixtures: tuple[Fixture, ...]

    def to_world(self, point: Vector) -> Vector:
        """A place in the body's own coordinates, in the world."""
        cosine, sine = math.cos(self.angle), math.sin(self.angle)
        x, y = point
        return self.place[0] + x * cosine - y * sine, self.place[1] + x * sine + y * cosine

    @property
    def solid(self) -> list[Fixture]:
        """The fixtures that go around something."""
        return [each for each in self.fixtures if each.is_closed]

    @property
    def lines(self) -> list[OpenLine]:
        """Those that do not."""
        return [OpenLine(each.ring, 0.0, None, self.name) for each in self.fixtures if not each.is_closed]

    @property
    def circle(self) -> float | None:
        """The radius [m] of what is one disc."""
        return self.fixtures[0].radius if len(self.fixtures) == 1 else None

    @cached_property
    def shapes(self) -> list[Region]:
        """The connected regions that it fills, the largest first."""
        drawing = Sketch("jelly", [FilledShape((each.ring,), "nonzero", None, self.name) for each in self.solid])
        check_points(drawing)
        return solid_shapes(drawing)


@dataclass(frozen=True)
class Joint:
    """A joint of two bodies, by index; places [m]: of its anchors; collides: whether the two touch each other.

    motor: the speed [rad/s] of the second body beside the first, and the most torque [N m].
    """

    kind: str
    bodies: tuple[int, int]
    places: tuple[Vector, Vector]
    length: float
    collides: bool
    motor: tuple[float, float] | None


def scene_bodies(scene: Object, width: float | None, left_out: LeftOut) -> tuple[list[SceneBody], float]:
    """The bodies of a scene, and by what they were made larger for a width [m]. Raises Unreadable."""
    bodies = [_body(each, left_out) for each in _some(scene, "body")]
    scale = _scale(bodies, width)
    return [_scaled(body, scale) for body in bodies], scale


def _some(scene: Object, key: str) -> list[Object]:
    found = objects(scene, key)
    if len(found) > SCENE_LIMIT:
        raise Unreadable(f"has more than {SCENE_LIMIT:,} items of {key}; make it smaller")
    return found


def _body(body: Object, left_out: LeftOut) -> SceneBody:
    kind = whole(body, "type")
    if kind == KINEMATIC:
        left_out.add("motion of a kinematic body (it stands still)")
    made = SceneBody(
        text(body, "name"), kind, vector_of(body, "position", 1e6), _real(body, "angle"),
        vector_of(body, "linearVelocity", SPEED_LIMIT), max(-1e3, min(1e3, _real(body, "gravityScale", 1.0))), (),
    )  # fmt: skip
    if abs(made.angle) > 1e6:
        raise Unreadable("angle: has turned more than a million radians")
    if body.get("active") is False:
        left_out.add("body that is not active")
        return made
    if kind == DYNAMIC:
        for key, words in (
            ("angularVelocity", "turning rate of a body"), ("linearDamping", "damping of a body"),
            ("angularDamping", "damping of the turning of a body"),
        ):  # fmt: skip
            if _real(body, key):
                left_out.add(words)
        if body.get("fixedRotation") is True:
            left_out.add("body that may not turn (it does here)")
    fixtures = _some(body, "fixture")
    solid = [each for each in fixtures if not each.get("sensor")]
    if len(solid) < len(fixtures):
        left_out.add("sensor", len(fixtures) - len(solid))
    found: list[Fixture] = []
    for fixture in solid:
        ring, closed = _fixture(fixture, left_out)
        placed = np.array([made.to_world((x, y)) for x, y in ring.tolist()]).reshape(-1, 2)
        if len(placed) > 1:
            found.append(_made_of(fixture, placed, closed and len(placed) > 2))
    return replace(made, fixtures=tuple(found))


def _made_of(fixture: Object, placed: Ring, closed: bool) -> Fixture:
    circle = fixture.get("circle")
    radius = _real(circle, "radius") if isinstance(circle, dict) else None
    keys = (("filter-categoryBits", 1), ("filter-maskBits", 0xFFFF), ("filter-groupIndex", 0))
    return Fixture(
        placed, closed, radius, max(0.0, _real(fixture, "density")), _within(fixture, "friction", FRICTION_LIMIT),
        _within(fixture, "restitution", 1.0), Filter(*(whole(fixture, key, usual) for key, usual in keys)),
    )  # fmt: skip


def _fixture(fixture: Object, left_out: LeftOut) -> tuple[Ring, bool]:
    """Points of a fixture in its body's coordinates, and whether they go around something solid."""
    for key in ("polygon", "chain", "loop", "edge"):
        part = fixture.get(key)
        if not isinstance(part, dict):
            continue
        if key == "edge":
            return np.array([vector_of(part, "vertex1", 1e6), vector_of(part, "vertex2", 1e6)]), False
        vertices = part.get("vertices")
        if not isinstance(vertices, dict):
            break
        rows = [_row(vertices, axis) for axis in ("x", "y")]
        if len(rows[0]) != len(rows[1]):
            break
        ring = np.array(rows, dtype=np.float64).T.reshape(-1, 2)
        if key == "loop" and len(ring):
            ring = np.concatenate([ring, ring[:1]])
        return ring, key == "polygon"
    circle = fixture.get("circle")
    if isinstance(circle, dict):
        radius, (x, y) = _real(circle, "radius"), vector_of(circle, "center", 1e6)
        if 0.0 < radius < 1e6:
            turn = np.arange(ROUND) * (math.tau / ROUND)
            return np.stack([x + radius * np.cos(turn), y + radius * np.sin(turn)], axis=1), True
    left_out.add("fixture that cannot be read")
    return np.zeros((0, 2)), False


def _scale(bodies: Sequence[SceneBody], width: float | None) -> float:
    if width is None:
        return 1.0
    rings = [each.ring for body in bodies for each in body.fixtures]
    across = float(np.ptp(np.concatenate(rings)[:, 0])) if rings else 0.0
    if across <= 0.0:
        raise Unreadable("has no outline to bring in")
    return width / across


def _scaled(body: SceneBody, scale: float) -> SceneBody:
    if scale == 1.0:
        return body
    fixtures = [
        replace(each, ring=each.ring * scale, radius=None if each.radius is None else each.radius * scale)
        for each in body.fixtures
    ]
    return replace(body, place=(body.place[0] * scale, body.place[1] * scale), fixtures=tuple(fixtures))


def scene_joints(scene: Object, bodies: Sequence[SceneBody], scale: float, left_out: LeftOut) -> list[Joint]:
    found = []
    for each in _some(scene, "joint"):
        kind = text(each, "type")
        ends = whole(each, "bodyA"), whole(each, "bodyB")
        if kind not in ("revolute", "weld", "distance", "wheel"):
            left_out.add(f"{kind[:20] or 'nameless'} joint")
            continue
        if not all(0 <= index < len(bodies) for index in ends) or ends[0] == ends[1]:
            left_out.add("joint of a body that is not there")
            continue
        if each.get("enableLimit") is True:
            left_out.add("limit of a joint")
        if kind in ("distance", "wheel") and (_real(each, "frequency") or _real(each, "springFrequency")):
            left_out.add(f"softness of a {kind} joint")
        anchors = [vector_of(each, key, 1e6) for key in ("anchorA", "anchorB")]
        places = tuple(
            bodies[index].to_world((x * scale, y * scale)) for index, (x, y) in zip(ends, anchors, strict=True)
        )
        collides = each.get("collideConnected") is True
        length = max(0.0, _real(each, "length")) * scale
        is_driven = each.get("enableMotor") is True and kind in ("revolute", "wheel")
        motor = (_real(each, "motorSpeed"), _real(each, "maxMotorTorque")) if is_driven else None
        found.append(Joint(kind, ends, (places[0], places[1]), length, collides, motor))
    return found


def _within(holder: Object, key: str, most: float) -> float | None:
    return min(most, max(0.0, _real(holder, key))) if key in holder else None


def vector_of(holder: Object, key: str, most: float) -> Vector:
    """A vector; R.U.B.E. writes 0 for one without length. Raises Unreadable."""
    value = holder.get(key, 0)
    if not isinstance(value, dict):
        value = {"x": _real(holder, key), "y": 0.0} if value else {}
    x, y = _real(value, "x"), _real(value, "y")
    if max(abs(x), abs(y)) > most:
        raise Unreadable(f"{key}: is beyond {most:,.0f}")
    return x, y


def _row(holder: Object, key: str) -> list[float]:
    value = holder.get(key)
    if not isinstance(value, list) or len(value) > 10_000:
        raise Unreadable(f"vertices: {key} is no list of numbers, or one of more than 10,000")
    return [_real({key: item}, key) for item in value]


def _real(holder: Object, key: str, default: float = 0.0) -> float:
    """A number, also one that R.U.B.E. has written as the eight digits of its bits. Raises Unreadable."""
    value = holder.get(key, default)
    if isinstance(value, str) and len(value) == 8:
        try:
            value = struct.unpack(">f", bytes.fromhex(value))[0]
        except ValueError:
            raise Unreadable(f"{key}: is no number") from None
    return number({key: value}, key)
