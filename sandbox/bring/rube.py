"""Reads a R.U.B.E. scene: bodies that stand still become ground, the others stiff bodies, with their joints.

A body has the mass of all its fixtures, each with its own density, and gravity, filters and motors as the scene says.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

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
)
from sandbox.bring.rube_scene import (
    DYNAMIC,
    Filter,
    Fixture,
    Joint,
    SceneBody,
    Vector,
    scene_bodies,
    scene_joints,
    vector_of,
)
from sandbox.bring.sketch import Kind, LeftOut, Object, Unreadable, objects
from sandbox.level.document.model import (
    ContactsDef,
    Level,
    NissenMaterial,
    ParticleDef,
    Settings,
    SpringDef,
    TerrainDef,
)
from sandbox.level.format.actuator_defs import MotorDef
from sandbox.level.format.limits import COLLISION_GROUP_LIMIT, FORMAT, GRAVITY_LIMIT, VERSION
from sandbox.level.format.quantities import replaced, significant
from sandbox.level.kinds.bodies import expansion
from sandbox.level.kinds.body_def import BodyDef, FirmnessDef
from sandbox.level.kinds.jelly import CircleShape, JellyDef
from sandbox.level.kinds.mesh import MeshDef
from sandbox.level.kinds.wheel import WheelDef
from sandbox.level.plan.surfaces import DEFAULT_GROUP, TERRAIN_NAME
from sandbox.physics.geometry.segment import doubled_areas

RIGID = FirmnessDef(sag=0.0)
MOVING_LIMIT = 300
# Particles of all that moves, but for small bodies: what is stiff needs few.
STIFF_PARTICLES = 600
# Rings of a disc: one of fewer stops at its corners.
DISC_RINGS = 4
JELLY = "jelly"
MATERIAL = "joint"
# Nearer than this to a particle, of the body's size, a joint is at that particle.
SAME = 1e-3
# A hinge as near to the middle of a disc as this, of its radius, is its axle.
AXLE = 0.05
# Spokes of a wheel with a motor, and its rim; the hub has what the rim leaves of the moment of inertia of a disc.
SPOKES, RIM = 24, 0.3
# What stands still and holds a hinge becomes a body only if it is no larger than so many times what moves.
BRACKET = 20.0
# Digits of places and masses in a file.
FINEST = 6


@dataclass
class JoinedBodies:
    """Bodies with their filters, by id, and what joins them; taken: ids that are in use; passing: pairs that do not
    touch, by id.
    """

    bodies: list[BodyDef] = field(default_factory=list)
    taken: set[str] = field(default_factory=set)
    filters: dict[str, Filter] = field(default_factory=dict)
    particles: list[ParticleDef] = field(default_factory=list)
    springs: list[SpringDef] = field(default_factory=list)
    welds: list[tuple[str, str]] = field(default_factory=list)
    passing: list[tuple[str, str]] = field(default_factory=list)

    def add(self, made: Sequence[BodyDef], body: SceneBody) -> None:
        """Add the bodies that one of the scene became."""
        self.bodies += made
        self.filters |= {each.id: body.solid[0].filter for each in made}


def level_of_rube(scene: Object, kind: Kind | None, width: float | None, name: str) -> tuple[Level, LeftOut]:
    """A level of a scene, in its own metres unless a width [m] is told. Raises Unreadable."""
    left_out = LeftOut()
    bodies, scale = scene_bodies(scene, width, left_out)
    if any(np.max(np.abs(each.ring)) > LARGEST for body in bodies for each in body.fixtures):
        raise Unreadable(f"has places beyond {LARGEST:,.0f} m; give it a smaller width")
    # Lines alone have no mass, so that nothing moves them.
    moving = [kind == JELLY or (kind is None and body.kind == DYNAMIC and bool(body.solid)) for body in bodies]
    areas = [sum(shape.polygon.area for shape in body.shapes) or 1e-6 for k, body in enumerate(bodies) if moving[k]]
    spacing = common_spacing(areas, STIFF_PARTICLES)
    joints = scene_joints(scene, bodies, scale, left_out)
    brackets = _brackets(joints, bodies, moving, BRACKET * max(areas, default=0.0)) if kind is None else set()
    motors = _motors(joints, bodies, moving, left_out)
    found = JoinedBodies()
    terrain: list[TerrainDef] = []
    owners: list[BodyDef | None] = []
    for index, body in enumerate(bodies):
        made: list[BodyDef] = []
        if moving[index] or index in brackets:
            made = _bodies(body, name, spacing, motors.get(index), found.taken, left_out)
            if index in brackets:
                made = [replaced(each, pinned=tuple(range(len(expansion(each).mass)))) for each in made]
            found.add(made, body)
        else:
            terrain += _ground(body, name, found.taken, left_out)
        owners.append(made[0] if made else None)
    if len(found.bodies) > MOVING_LIMIT:
        raise Unreadable(f"has more than {MOVING_LIMIT} bodies that move; make it smaller")
    for joint in joints:
        one, other = (owners[index] for index in joint.bodies)
        _join(found, joint, one, other)
    still = {each.filter for k, body in enumerate(bodies) if owners[k] is None for each in body.fixtures}
    _let_pass(found, still, left_out)
    if objects(scene, "image"):
        left_out.add("image", len(objects(scene, "image")))
    level = Level(
        format=FORMAT, version=VERSION, name=name, contacts=ContactsDef(),
        settings=Settings(gravity=vector_of(scene, "gravity", GRAVITY_LIMIT)),
        materials={MATERIAL: NissenMaterial(stiffness=1.0, damping=1.0)} if found.springs else {},
    )  # fmt: skip
    level = replaced(
        level, terrain=tuple(terrain), bodies=tuple(found.bodies), particles=tuple(found.particles),
        springs=tuple(found.springs), welds=tuple(found.welds),
    )  # fmt: skip
    check_found(level.bodies or level.terrain, left_out)
    return level, left_out


def _ground(body: SceneBody, base: str, taken: set[str], left_out: LeftOut) -> list[TerrainDef]:
    """The ground of a body: fixtures of one friction and restitution are united."""
    made: list[TerrainDef] = []
    for touch in dict.fromkeys((each.friction, each.restitution) for each in body.fixtures):
        alike = tuple(each for each in body.fixtures if (each.friction, each.restitution) == touch)
        part = replace(body, fixtures=alike)
        for piece in ground_of(part.shapes, part.lines, base, left_out):
            own = free_name(body.name or base, base, taken)
            made.append(replaced(piece, id=own, friction=touch[0], restitution=touch[1]))
    return made


def _bodies(
    body: SceneBody, base: str, spacing: float, motor: MotorDef | None, taken: set[str], left_out: LeftOut
) -> list[BodyDef]:
    """The bodies that one becomes: one for each part of it that is apart from the others, the largest first."""
    if body.lines:
        left_out.add("chain of a body that moves", len(body.lines))
    for key in ("friction", "restitution", "filter"):
        if len({getattr(each, key) for each in body.solid}) > 1:
            left_out.add(f"{key} of a fixture (a body has one)")
    shapes = body.shapes
    if len(shapes) > 1:
        left_out.add("part of a body that is apart from the rest (it came in as one of its own)", len(shapes) - 1)
    made: list[BodyDef] = []
    for shape in shapes[:BODY_LIMIT]:
        found = jelly(shape, free_name(body.name or base, base, taken), spacing, RIGID)
        if found is None:
            left_out.add("body too fine for a mesh")
            continue
        if body.circle is not None:
            # One that rolls as a whole.
            even = body.circle / DISC_RINGS
            round_one = {"shape": CircleShape(circle=body.circle), "holes": (), "spacing": even}
            found = replaced(found, **round_one, particle_radius=min(0.05, even / 8.0))
        heavy = _weighed(found, shape, body.solid)
        if motor is not None and body.circle is not None:
            heavy = _wheel(heavy, body.circle, motor)
        touch = {"friction": body.solid[0].friction, "restitution": body.solid[0].restitution}
        made.append(replaced(heavy, velocity=body.velocity, gravity_scale=body.gravity_scale, **touch))
    return made


def _weighed(found: JellyDef, shape: Region, fixtures: Sequence[Fixture]) -> BodyDef:
    """A jelly with the mass of its fixtures; where these are not equally dense, a mesh whose particles differ."""
    import shapely

    parts = [shapely.Polygon(each.ring).buffer(0.0) for each in fixtures]
    own = [k for k, part in enumerate(parts) if part.intersection(shape.polygon).area > 0.5 * part.area]
    dense = [fixtures[k].density for k in own]
    dense = dense if any(dense) else [DENSITY] * len(own)
    radius = found.shape.circle if isinstance(found.shape, CircleShape) else None
    areas = [math.pi * radius**2 if radius else parts[k].area for k in own]
    total = sum(area * density for area, density in zip(areas, dense, strict=True))
    made = expansion(found)
    # What overlaps is heavier there.
    if len(set(dense)) == 1 and sum(parts[k].area for k in own) < 1.01 * shape.polygon.area:
        return replaced(found, particle_mass=min(1e9, max(1e-9, total / len(made.mass))))
    triangles, places = made.polygons(), made.position
    middles = shapely.points(places[triangles].mean(axis=1))
    density = np.sum(
        [value * shapely.intersects(parts[k], middles) for k, value in zip(own, dense, strict=True)], axis=0
    )
    third = np.abs(doubled_areas(*places[triangles.T])) * np.maximum(density, 1e-3 * np.max(density))
    mass = np.bincount(triangles.reshape(-1), np.repeat(third, 3), minlength=len(places))
    mass = np.clip(mass * (total / float(mass.sum())), 1e-9, 1e9)
    return MeshDef(
        type="mesh", id=found.id, particles=tuple((x, y) for x, y in np.round(places, FINEST).tolist()),
        springs=tuple((a, b) for a, b in made.pairs.tolist()),
        triangles=tuple((a, b, c) for a, b, c in triangles.tolist()),
        masses=tuple(significant(value, FINEST) for value in mass.tolist()), firmness=found.firmness,
        particle_radius=found.particle_radius, look=found.look,
    )  # fmt: skip


def _wheel(disc: BodyDef, radius: float, motor: MotorDef) -> BodyDef:
    """A wheel in the place of a disc, of its mass and moment of inertia."""
    made = expansion(disc)
    mass = float(made.mass.sum())
    x, y = np.average(made.position, axis=0, weights=made.mass).tolist()
    # SPOKES m (R^2 + r^2) = M R^2 / 2
    of_rim = 0.5 * mass / (SPOKES * (1.0 + (1.0 - RIM) ** 2))
    return WheelDef(
        type="wheel", id=disc.id, position=(round(x, FINEST), round(y, FINEST)), radius=radius, thickness=RIM * radius,
        segments=SPOKES, particle_mass=of_rim, hub_mass=mass - 2 * SPOKES * of_rim, motor=motor, firmness=disc.firmness,
        particle_radius=disc.particle_radius, touches_mount=False,
    )  # fmt: skip


def _brackets(joints: Sequence[Joint], bodies: Sequence[SceneBody], moving: Sequence[bool], most: float) -> set[int]:
    """Bodies that stand still and are held by joints in what may not touch them: they are no ground but bodies."""
    found: set[int] = set()
    for joint in joints:
        for index, other in (joint.bodies, joint.bodies[::-1]):
            if joint.collides or moving[index] or not moving[other] or bodies[index].lines:
                continue
            shapes = bodies[index].shapes
            fits = len(shapes) == 1 and shapes[0].polygon.area <= most
            if fits and any(shapes[0].polygon.intersects(each.polygon) for each in bodies[other].shapes):
                found.add(index)
    return found


def _motors(
    joints: Sequence[Joint], bodies: Sequence[SceneBody], moving: Sequence[bool], left_out: LeftOut
) -> dict[int, MotorDef]:
    """The motors of discs that a joint turns about their middles, by body."""
    found: dict[int, MotorDef] = {}
    for joint in joints:
        if joint.motor is None:
            continue
        speed, torque = joint.motor
        for index, place, way in zip(joint.bodies[::-1], joint.places[::-1], (1.0, -1.0), strict=True):
            radius = bodies[index].circle
            if not radius or not moving[index] or index in found:
                continue
            x, y = bodies[index].fixtures[0].ring.mean(axis=0).tolist()
            if math.hypot(place[0] - x, place[1] - y) <= AXLE * radius:
                found[index] = MotorDef(speed=max(-1e4, min(1e4, way * speed)), torque=min(1e12, max(0.0, torque)))
                break
        else:
            left_out.add("motor of a joint that is no axle of a disc")
    return found


def _join(found: JoinedBodies, joint: Joint, one: BodyDef | None, other: BodyDef | None) -> None:
    """Join two bodies, None = ground; a joint of what does not move is none."""
    both = [body for body in (one, other) if body is not None]
    if len(both) == 2 and not joint.collides:
        found.passing.append((both[0].id, both[1].id))
    # What is pinned all over holds as ground does.
    one, other = (None if body is None or body.pinned else body for body in (one, other))
    held = [body for body in (one, other) if body is not None]
    if not held:
        return
    if joint.kind == "distance":
        ends = [_pin(found, place, [body]) for place, body in zip(joint.places, (one, other), strict=True)]
        found.springs.append(SpringDef(a=ends[0], b=ends[1], rest_length=joint.length or None, material=MATERIAL))
        return
    # A wheel slides along an axis; where it is, it turns.
    first = joint.places[1] if joint.kind == "wheel" else joint.places[0]
    _pin(found, first, [one, other])
    if joint.kind == "weld":
        # One more, half way to the farthest particle, lets nothing turn.
        places = expansion(min(held, key=lambda body: len(expansion(body).mass))).position
        farthest = places[int(np.argmax(np.hypot(*(places - np.array(first)).T)))]
        x, y = (0.5 * (farthest + np.array(first))).tolist()
        _pin(found, (x, y), [one, other])


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


def _let_pass(found: JoinedBodies, still: set[Filter], left_out: LeftOut) -> None:
    """Give bodies collision groups, so that what is joined, and what filters keep apart, does not touch.

    still: filters of the ground.
    """
    partners: dict[str, set[str]] = {}
    for one, other in found.passing:
        partners.setdefault(one, set()).add(other)
        partners.setdefault(other, set()).add(one)
    # A group for each of those that pass through another one, and one for all others of a filter.
    filters: dict[str, Filter] = {DEFAULT_GROUP: Filter()}
    group_of: dict[str, str] = {}
    for name, own in found.filters.items():
        alike = next((group for group, each in filters.items() if each == own and group not in partners), None)
        group = name if name in partners else alike or f"filter {len(filters)}"
        filters[group], group_of[name] = own, group
    if len(filters) > COLLISION_GROUP_LIMIT - 1 or found.filters.keys() & {DEFAULT_GROUP, TERRAIN_NAME}:
        left_out.add("pair of bodies that now touch", max(1, len(found.passing)))
        return
    for index, body in enumerate(found.bodies):
        own, group = found.filters[body.id], group_of[body.id]
        meets = {own.meets(each) for each in still}
        if len(meets) > 1:
            left_out.add("filter between a body and a part of the ground (they touch)")
        touched = [
            name
            for name, each in filters.items()
            if own.meets(each) and name not in partners.get(body.id, ()) and not (name == group == body.id)
        ]
        if meets != {False}:
            touched.append(TERRAIN_NAME)
        if group != DEFAULT_GROUP or TERRAIN_NAME not in touched:
            found.bodies[index] = replaced(body, collision_group=group, collides=tuple(sorted(touched)))
