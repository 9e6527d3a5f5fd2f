"""Reads a R.U.B.E. scene: bodies that stand still become ground, the others stiff jellies, with their joints."""

import math
import struct
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from sandbox.bring.making import (
    BODY_LIMIT,
    DENSITY,
    LARGEST,
    Region,
    check_found,
    common_spacing,
    free_name,
    ground_of,
    jelly,
    solid_shapes,
)
from sandbox.bring.sketch import (
    FilledShape,
    Kind,
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
from sandbox.level.document.model import (
    ContactsDef,
    Level,
    NissenMaterial,
    ParticleDef,
    Settings,
    SpringDef,
    TerrainDef,
)
from sandbox.level.format.limits import COLLISION_GROUP_LIMIT, FORMAT, GRAVITY_LIMIT, SPEED_LIMIT, VERSION
from sandbox.level.format.quantities import replaced
from sandbox.level.kinds.bodies import expansion
from sandbox.level.kinds.body_def import BodyDef, FirmnessDef
from sandbox.level.kinds.jelly import CircleShape
from sandbox.level.plan.surfaces import DEFAULT_GROUP, TERRAIN_NAME

STATIC, KINEMATIC, DYNAMIC = 0, 1, 2
RIGID = FirmnessDef(sag=0.0)
# Bodies and fixtures of a scene.
SCENE_LIMIT = 2_000
MOVING_LIMIT = 300
# Particles of all that moves, but for small bodies: what is stiff needs few.
STIFF_PARTICLES = 600
# Rings of a disc (one of fewer stops at its corners), and corners of a circle of ground.
DISC_RINGS, ROUND = 4, 32
FRICTION_LIMIT = 100.0
GROUND, JELLY = "ground", "jelly"
Vector = tuple[float, float]
MATERIAL = "joint"
# Nearer than this to a particle, of the body's size, a joint is at that particle.
SAME = 1e-3


@dataclass(frozen=True)
class SceneBody:
    """A body of a scene: how it moves, where it is, and what its fixtures fill [m], as in the world."""

    name: str
    kind: int
    place: Vector
    angle: float
    velocity: Vector
    outlines: tuple[FilledShape, ...]
    lines: tuple[OpenLine, ...]
    circle: float | None
    density: float
    friction: float | None
    restitution: float | None

    def to_world(self, point: Vector) -> Vector:
        """A place in the body's own coordinates, in the world."""
        cosine, sine = math.cos(self.angle), math.sin(self.angle)
        x, y = point
        return self.place[0] + x * cosine - y * sine, self.place[1] + x * sine + y * cosine


@dataclass(frozen=True)
class Joint:
    """A joint of two bodies, by index; places [m]: of its anchors; collides: whether the two touch each other."""

    kind: str
    bodies: tuple[int, int]
    places: tuple[Vector, Vector]
    length: float
    collides: bool


@dataclass
class JoinedBodies:
    """Bodies, and what joins them; taken: ids that are in use; passing: pairs of bodies that do not touch."""

    bodies: list[BodyDef]
    taken: set[str]
    particles: list[ParticleDef] = field(default_factory=list)
    springs: list[SpringDef] = field(default_factory=list)
    welds: list[tuple[str, str]] = field(default_factory=list)
    passing: list[tuple[str, str]] = field(default_factory=list)


def level_of_rube(scene: Object, kind: Kind | None, width: float | None, name: str) -> tuple[Level, LeftOut]:
    """A level of a scene, in its own metres unless a width [m] is told. Raises Unreadable."""
    left_out = LeftOut()
    bodies = [_body(each, left_out) for each in _some(scene, "body")]
    scale = _scale(bodies, width)
    bodies = [_scaled(body, scale) for body in bodies]
    places = [ring for body in bodies for outline in body.outlines for ring in outline.rings]
    places += [line.points for body in bodies for line in body.lines]
    if any(np.max(np.abs(ring)) > LARGEST for ring in places):
        raise Unreadable(f"has places beyond {LARGEST:,.0f} m; give it a smaller width")
    taken: set[str] = set()
    owners: list[list[BodyDef]] = [[] for _ in bodies]
    terrain: list[TerrainDef] = []
    spacing = common_spacing(
        [
            sum(shape.polygon.area for shape in _shapes(body)) or 1e-6
            for body in bodies
            if body.kind == DYNAMIC and kind != GROUND
        ],
        STIFF_PARTICLES,
    )
    for index, body in enumerate(bodies):
        # Lines alone have no mass, so that nothing moves them.
        is_chain = bool(body.lines) and not body.outlines
        if kind == JELLY or (kind is None and body.kind == DYNAMIC and not is_chain):
            owners[index] = _jellies(body, name, spacing, taken, left_out)
        else:
            for piece in ground_of(_shapes(body), body.lines, name, left_out):
                own, touch = free_name(body.name or name, name, taken), (body.friction, body.restitution)
                terrain.append(replaced(piece, id=own, friction=touch[0], restitution=touch[1]))
    if sum(map(len, owners)) > MOVING_LIMIT:
        raise Unreadable(f"has more than {MOVING_LIMIT} bodies that move; make it smaller")
    found = JoinedBodies([body for made in owners for body in made], taken)
    for joint in _joints(scene, bodies, scale, left_out):
        one, other = (owners[index][0] if owners[index] else None for index in joint.bodies)
        _join(found, joint, one, other)
    _let_pass(found, left_out)
    if objects(scene, "image"):
        left_out.add("image", len(objects(scene, "image")))
    gravity = _vector(scene, "gravity", GRAVITY_LIMIT)
    level = Level(
        format=FORMAT, version=VERSION, name=name, contacts=ContactsDef(), settings=Settings(gravity=gravity),
        materials={MATERIAL: NissenMaterial(stiffness=1.0, damping=1.0)} if found.springs else {},
    )  # fmt: skip
    level = replaced(
        level, terrain=tuple(terrain), bodies=tuple(found.bodies), particles=tuple(found.particles),
        springs=tuple(found.springs), welds=tuple(found.welds),
    )  # fmt: skip
    check_found(level.bodies or level.terrain, left_out)
    return level, left_out


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
        text(body, "name"), kind, _vector(body, "position", 1e6), _real(body, "angle"),
        _vector(body, "linearVelocity", SPEED_LIMIT), (), (), None, 0.0, None, None,
    )  # fmt: skip
    if abs(made.angle) > 1e6:
        raise Unreadable("angle: has turned more than a million radians")
    if kind == DYNAMIC and _real(body, "angularVelocity"):
        left_out.add("turning rate of a body")
    outlines: list[FilledShape] = []
    lines: list[OpenLine] = []
    fixtures = _some(body, "fixture")
    solid = [each for each in fixtures if not each.get("sensor")]
    if len(solid) < len(fixtures):
        left_out.add("sensor", len(fixtures) - len(solid))
    for fixture in solid:
        ring, closed = _fixture(fixture, left_out)
        placed = np.array([made.to_world((x, y)) for x, y in ring.tolist()]).reshape(-1, 2)
        if closed and len(placed) > 2:
            outlines.append(FilledShape((placed,), "nonzero", None, made.name))
        elif len(placed) > 1:
            lines.append(OpenLine(placed, 0.0, None, made.name))
    circle = None
    if len(solid) == 1 and isinstance(solid[0].get("circle"), dict) and outlines:
        circle = _real(solid[0]["circle"], "radius")
    first: Object = solid[0] if solid else {}
    return replace(
        made, outlines=tuple(outlines), lines=tuple(lines), circle=circle, density=_real(first, "density"),
        friction=_within(first, "friction", FRICTION_LIMIT), restitution=_within(first, "restitution", 1.0),
    )  # fmt: skip


def _fixture(fixture: Object, left_out: LeftOut) -> tuple[Ring, bool]:
    """Points of a fixture in its body's coordinates, and whether they go around something solid."""
    for key in ("polygon", "chain", "loop", "edge"):
        part = fixture.get(key)
        if not isinstance(part, dict):
            continue
        if key == "edge":
            return np.array([_vector(part, "vertex1", 1e6), _vector(part, "vertex2", 1e6)]), False
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
        radius, (x, y) = _real(circle, "radius"), _vector(circle, "center", 1e6)
        if 0.0 < radius < 1e6:
            turn = np.arange(ROUND) * (math.tau / ROUND)
            return np.stack([x + radius * np.cos(turn), y + radius * np.sin(turn)], axis=1), True
    left_out.add("fixture that cannot be read")
    return np.zeros((0, 2)), False


def _scale(bodies: Sequence[SceneBody], width: float | None) -> float:
    if width is None:
        return 1.0
    rings = [ring for body in bodies for outline in body.outlines for ring in outline.rings]
    rings += [line.points for body in bodies for line in body.lines]
    across = float(np.ptp(np.concatenate(rings)[:, 0])) if rings else 0.0
    if across <= 0.0:
        raise Unreadable("has no outline to bring in")
    return width / across


def _scaled(body: SceneBody, scale: float) -> SceneBody:
    if scale == 1.0:
        return body

    def larger(ring: NDArray[np.float64]) -> NDArray[np.float64]:
        return ring * scale

    return replace(
        body, place=(body.place[0] * scale, body.place[1] * scale),
        outlines=tuple(replace(each, rings=tuple(map(larger, each.rings))) for each in body.outlines),
        lines=tuple(replace(each, points=larger(each.points)) for each in body.lines),
        circle=None if body.circle is None else body.circle * scale,
    )  # fmt: skip


def _jellies(body: SceneBody, base: str, spacing: float, taken: set[str], left_out: LeftOut) -> list[BodyDef]:
    """The jellies of a body: one for each part of it that is apart from the others, the largest first."""
    if body.lines:
        left_out.add("chain of a body that moves", len(body.lines))
    density = body.density if body.density > 0.0 else DENSITY
    shapes = _shapes(body)
    if len(shapes) > 1:
        left_out.add("part of a body that is apart from the rest (it came in as one of its own)", len(shapes) - 1)
    made: list[BodyDef] = []
    for shape in shapes[:BODY_LIMIT]:
        name = free_name(body.name or base, base, taken)
        found = jelly(shape, name, spacing, RIGID, density)
        if found is None:
            left_out.add("body too fine for a mesh")
            continue
        if body.circle is not None:
            # One that rolls as a whole, as heavy as one of another mesh.
            even = body.circle / DISC_RINGS
            mass = min(1e9, max(1e-9, found.particle_mass * (even / found.spacing) ** 2))
            found = replaced(
                found, shape=CircleShape(circle=body.circle), holes=(), spacing=even, particle_mass=mass,
                particle_radius=min(0.05, even / 8.0),
            )  # fmt: skip
        made.append(replaced(found, velocity=body.velocity, friction=body.friction, restitution=body.restitution))
    return made


def _shapes(body: SceneBody) -> list[Region]:
    drawing = Sketch("jelly", list(body.outlines))
    check_points(drawing)
    return solid_shapes(drawing)


def _joints(scene: Object, bodies: Sequence[SceneBody], scale: float, left_out: LeftOut) -> list[Joint]:
    found = []
    for each in _some(scene, "joint"):
        kind = text(each, "type")
        ends = whole(each, "bodyA"), whole(each, "bodyB")
        if kind not in ("revolute", "weld", "distance"):
            left_out.add(f"{kind[:20] or 'nameless'} joint")
            continue
        if not all(0 <= index < len(bodies) for index in ends) or ends[0] == ends[1]:
            left_out.add("joint of a body that is not there")
            continue
        for key, word in (("enableMotor", "motor of a joint"), ("enableLimit", "limit of a joint")):
            if each.get(key) is True:
                left_out.add(word)
        if kind == "distance" and _real(each, "frequency"):
            left_out.add("softness of a distance joint")
        anchors = [_vector(each, key, 1e6) for key in ("anchorA", "anchorB")]
        places = tuple(
            bodies[index].to_world((x * scale, y * scale)) for index, (x, y) in zip(ends, anchors, strict=True)
        )
        collides = each.get("collideConnected") is True
        found.append(Joint(kind, ends, (places[0], places[1]), max(0.0, _real(each, "length")) * scale, collides))
    return found


def _join(found: JoinedBodies, joint: Joint, one: BodyDef | None, other: BodyDef | None) -> None:
    """Join two bodies, None = ground; a joint of what does not move is none."""
    held = [body for body in (one, other) if body is not None]
    if not held:
        return
    if joint.kind == "distance":
        ends = [_pin(found, place, [body]) for place, body in zip(joint.places, (one, other), strict=True)]
        length = joint.length or None
        found.springs.append(SpringDef(a=ends[0], b=ends[1], rest_length=length, material=MATERIAL))
    else:
        _pin(found, joint.places[0], [one, other])
        if joint.kind == "weld":
            # One more, half way to the farthest particle, lets nothing turn.
            places, first = expansion(min(held, key=lambda body: len(expansion(body).mass))).position, joint.places[0]
            farthest = places[int(np.argmax(np.hypot(*(places - np.array(first)).T)))]
            x, y = (0.5 * (farthest + np.array(first))).tolist()
            _pin(found, (x, y), [one, other])
    if len(held) == 2 and not joint.collides:
        found.passing.append((held[0].id, held[1].id))


def _pin(found: JoinedBodies, place: Vector, bodies: list[BodyDef | None]) -> str:
    """A particle at a place that stiff springs hold to bodies; ground pins it. Gives its id."""
    count = len(found.particles) + 1
    while (name := f"joint {count}") in found.taken:
        count += 1
    found.taken.add(name)
    held = [body for body in bodies if body is not None]
    mass = min((float(np.min(expansion(body).mass)) for body in held), default=1.0)
    pinned = None in bodies
    found.particles.append(ParticleDef(id=name, position=place, mass=mass, radius=0.03, pinned=pinned, collides=False))
    for body in held:
        places = expansion(body).position
        away = np.hypot(*(places - np.array(place)).T)
        near = _corners_around(body, place)
        nearest = int(np.argmin(away))
        if away[nearest] <= SAME * float(np.max(np.ptp(places, axis=0))) and not pinned:
            found.welds.append((f"{body.id}.{nearest}", name))
            continue
        for index in near:
            if away[index] > 0.0:
                found.springs.append(SpringDef(a=name, b=f"{body.id}.{index}", material=MATERIAL))
            else:
                found.welds.append((f"{body.id}.{index}", name))
    return name


def _corners_around(body: BodyDef, place: Vector) -> list[int]:
    """Corners of the triangle of a body whose middle is nearest to a place."""
    made = expansion(body)
    triangles = made.polygons()
    if not len(triangles):
        return np.argsort(np.hypot(*(made.position - np.array(place)).T), kind="stable")[:3].tolist()
    middle = made.position[triangles].mean(axis=1)
    nearest = int(np.argmin(np.hypot(*(middle - np.array(place)).T)))
    return [int(index) for index in triangles[nearest]]


def _let_pass(found: JoinedBodies, left_out: LeftOut) -> None:
    """Give joined bodies a collision group each, so that they pass through each other."""
    partners: dict[str, set[str]] = {}
    for one, other in found.passing:
        partners.setdefault(one, set()).add(other)
        partners.setdefault(other, set()).add(one)
    if len(partners) > COLLISION_GROUP_LIMIT - 2 or partners.keys() & {DEFAULT_GROUP, TERRAIN_NAME}:
        left_out.add("pair of joined bodies that now touch", len(found.passing))
        return
    everything = {TERRAIN_NAME, DEFAULT_GROUP, *partners}
    for index, body in enumerate(found.bodies):
        if body.id in partners:
            touched = tuple(sorted(everything - partners[body.id] - {body.id}))
            found.bodies[index] = replaced(body, collision_group=body.id, collides=touched)


def _within(holder: Object, key: str, most: float) -> float | None:
    return min(most, max(0.0, _real(holder, key))) if key in holder else None


def _vector(holder: Object, key: str, most: float) -> Vector:
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


def _real(holder: Object, key: str) -> float:
    """A number, also one that R.U.B.E. has written as the eight digits of its bits. Raises Unreadable."""
    value = holder.get(key, 0.0)
    if isinstance(value, str) and len(value) == 8:
        try:
            value = struct.unpack(">f", bytes.fromhex(value))[0]
        except ValueError:
            raise Unreadable(f"{key}: is no number") from None
    return number({key: value}, key)
