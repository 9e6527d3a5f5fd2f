"""Where a single definition goes when the plane is moved, turned, scaled or mirrored, kind by kind."""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np

from sandbox.editor.document import EditError, subject
from sandbox.level.format.model import ParticleDef, TerrainDef
from sandbox.level.format.quantities import replaced
from sandbox.level.kinds.bodies import AnyBody, expansion
from sandbox.level.kinds.bridge import BridgeDef
from sandbox.level.kinds.geometry import Points, turn
from sandbox.level.kinds.girder import GirderDef
from sandbox.level.kinds.jelly import BoxShape, CircleShape, JellyDef, PolygonShape
from sandbox.level.kinds.mesh import MeshDef
from sandbox.level.kinds.ring import RingDef
from sandbox.level.kinds.rope import RopeDef
from sandbox.level.kinds.web import WebDef
from sandbox.level.kinds.wheel import WheelDef

Point = tuple[float, float]

# Angles this close to a quarter turn [rad] count as one: a box at it can be stretched along its sides.
SQUARE = 1e-9


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
        """Where a vector goes."""
        cosine, sine = turn(self.angle)
        x, y = self.sx * vector[0], self.sy * vector[1]
        return x * cosine - y * sine, x * sine + y * cosine

    def point(self, point: Point) -> Point:
        """Where a point [m] goes."""
        x, y = self.vector((point[0] - self.centre[0], point[1] - self.centre[1]))
        return self.centre[0] + x, self.centre[1] + y

    def points(self, points: Iterable[Point]) -> tuple[Point, ...]:
        """Where points [m] go."""
        return tuple(self.point(point) for point in points)

    def turned(self, angle: float) -> float:
        """What a direction [rad] becomes, between half a turn back and half a turn on; of a mirror, its image."""
        if self.is_mirror:
            angle = math.pi - angle if self.sx < 0.0 else -angle
        angle += self.angle
        return angle if abs(angle) <= math.pi else math.remainder(angle, 2.0 * math.pi)


Placed = TypeVar("Placed", AnyBody, TerrainDef)


def shifted(body: Placed, dx: float, dy: float) -> Placed:
    """A body or piece of terrain moved by dx, dy [m]."""
    changes: dict[str, Any] = {}
    for name in ("start", "end", "position"):
        if name in body.__dict__:
            x, y = body.__dict__[name]
            changes[name] = (x + dx, y + dy)
    for name in ("particles", "pose", "polyline", "polygon"):
        points = body.__dict__.get(name)
        if points is not None:
            changes[name] = tuple([(x + dx, y + dy) for x, y in points])
    return replaced(body, **changes)


def mapped_particle(particle: ParticleDef, motion: Motion) -> ParticleDef:
    """A loose particle, its place and start velocity mapped; its disc grows with a scale."""
    return replaced(
        particle,
        position=motion.point(particle.position),
        radius=particle.radius * motion.factor,
        velocity=_velocity(particle.velocity, motion),
    )


def mapped_terrain(piece: TerrainDef, motion: Motion) -> TerrainDef:
    """A piece of terrain with its corners mapped."""
    polyline, polygon = (corners and motion.points(corners) for corners in (piece.polyline, piece.polygon))
    return replaced(piece, polyline=polyline, polygon=polygon)


def mapped_body(body: AnyBody, motion: Motion) -> tuple[AnyBody, Points]:
    """A body mapped, and where the particles of its old form lie in the new one [m] (n, 2).

    Where the parameters of its kind cannot say what becomes of it, its pose does. Raises EditError for a stretch that
    bends it.
    """
    form = expansion(body).form
    image = np.array(motion.points(map(tuple, form.tolist())))
    pose = None if body.pose is None else motion.points(body.pose)
    if isinstance(body, BridgeDef) and motion.angle != 0.0:
        # The lower row of a bridge lies straight below, however it is turned: its start does not.
        middle = tuple(((form.min(axis=0) + form.max(axis=0)) / 2.0).tolist())
        goes = motion.point(middle)
        aside = shifted(replaced(body, pose=None), goes[0] - middle[0], goes[1] - middle[1])
        start = pose if pose is not None else tuple(map(tuple, image.tolist()))
        return replaced(aside, pose=start, velocity=_velocity(body.velocity, motion)), expansion(aside).form
    changes = _changes(body, motion)
    if pose is not None:
        changes["pose"] = pose
    return replaced(body, velocity=_velocity(body.velocity, motion), **changes), image


def can_stretch(body: AnyBody) -> bool:
    """Whether a body can be made longer without being made higher as much."""
    match body:
        case RopeDef() | BridgeDef() | MeshDef():
            return True
        case GirderDef():
            return body.start[0] == body.end[0] or body.start[1] == body.end[1]
        case JellyDef() if not isinstance(body.shape, CircleShape):
            return abs(math.remainder(body.angle, math.pi / 2.0)) <= SQUARE
    return False


def _velocity(velocity: Point, motion: Motion) -> Point:
    # A scale is of lengths alone; turned or mirrored things go where they then look.
    direction = Motion((0.0, 0.0), motion.angle, math.copysign(1.0, motion.sx), math.copysign(1.0, motion.sy))
    return velocity if velocity == (0.0, 0.0) else direction.vector(velocity)


def _changes(body: AnyBody, motion: Motion) -> dict[str, Any]:
    """The fields of a body that a motion alters."""
    if not motion.is_even and not can_stretch(body):
        raise EditError(f"{subject(body)}: a {_KINDS.get(body.type, body.type)} can only be scaled evenly")
    match body:
        case RopeDef():
            ends = {"start": motion.point(body.start), "end": motion.point(body.end)}
            if body.rest_length is None:
                return ends
            return ends | {"rest_length": body.rest_length * stretch(body.start, body.end, motion)}
        case BridgeDef():
            drop = -body.height if motion.sy < 0.0 else 0.0
            start, end = ((x, y + drop) for x, y in (body.start, body.end))
            return {"start": motion.point(start), "end": motion.point(end), "height": body.height * abs(motion.sy)}
        case GirderDef():
            start, end = motion.point(body.start), motion.point(body.end)
            if motion.is_mirror:
                start, end = end, start
            across = motion.factor if motion.is_even else abs(motion.sy if body.start[1] == body.end[1] else motion.sx)
            pins = {"start": "end", "end": "start"} if motion.is_mirror else {}
            pin = tuple(pins.get(name, name) for name in body.pin)
            return {"start": start, "end": end, "height": body.height * across, "pin": pin}
        case WebDef():
            return _centred(body, motion) | {"radius": body.radius * motion.factor}
        case RingDef():
            return _centred(body, motion) | {"radius": body.radius * motion.factor}
        case WheelDef():
            sizes = {"radius": body.radius * motion.factor, "thickness": body.thickness * motion.factor}
            return _centred(body, motion) | sizes | _turned_motor(body, motion)
        case JellyDef():
            return _jelly(body, motion)
        case MeshDef():
            velocities = body.velocities and tuple(_velocity(velocity, motion) for velocity in body.velocities)
            return {"particles": motion.points(body.particles), "velocities": velocities}
    return {}


_KINDS = {"jelly": "jelly that is round or turned", "girder": "slanting girder"}


def stretch(a: Point, b: Point, motion: Motion) -> float:
    """How much farther apart two places [m] are after a motion; of one and the same place, as lengths in all."""
    if motion.is_even or a == b:
        return motion.factor
    return math.dist(motion.point(a), motion.point(b)) / math.dist(a, b)


def _centred(body: WebDef | WheelDef | RingDef | JellyDef, motion: Motion) -> dict[str, Any]:
    return {"position": motion.point(body.position), "angle": motion.turned(body.angle)}


def _turned_motor(body: WheelDef, motion: Motion) -> dict[str, Any]:
    """A motor turns the other way in a mirror."""
    if body.motor is None or not motion.is_mirror:
        return {}
    return {"motor": replaced(body.motor, speed=-body.motor.speed)}


def _jelly(body: JellyDef, motion: Motion) -> dict[str, Any]:
    result = _centred(body, motion) | {"spacing": body.spacing * motion.factor}
    if motion.is_mirror:
        # The shape itself is mirrored in its own frame, so that the grid lies as it did.
        result["angle"] = -body.angle
    across, up = abs(motion.sx), abs(motion.sy)
    if not motion.is_even and round(body.angle / (math.pi / 2.0)) % 2:
        across, up = up, across
    if isinstance(body.shape, BoxShape):
        result["shape"] = BoxShape.model_construct(box=(body.shape.box[0] * across, body.shape.box[1] * up))
    elif isinstance(body.shape, CircleShape):
        result["shape"] = CircleShape.model_construct(circle=body.shape.circle * motion.factor)
    else:
        across, up = math.copysign(across, motion.sx), math.copysign(up, motion.sy)
        corners = tuple((x * across, y * up) for x, y in body.shape.polygon)
        result["shape"] = PolygonShape.model_construct(polygon=corners)
    return result
