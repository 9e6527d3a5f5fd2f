"""Joints between jellies: loose particles that stiff springs hold to both."""

from dataclasses import dataclass, field

import numpy as np

from sandbox.bring.sketch import LeftOut
from sandbox.level.document.model import Material, NissenMaterial, ParticleDef, SpringDef
from sandbox.level.format.limits import COLLISION_GROUP_LIMIT
from sandbox.level.format.quantities import replaced
from sandbox.level.kinds.bodies import expansion
from sandbox.level.kinds.body_def import BodyDef
from sandbox.level.plan.surfaces import DEFAULT_GROUP, TERRAIN_NAME

MATERIAL = "joint"
# Nearer than this to a particle, of the body's size, a joint is at that particle.
SAME = 1e-3
Vector = tuple[float, float]


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

    @property
    def materials(self) -> dict[str, Material]:
        """What the springs are made of."""
        return {MATERIAL: NissenMaterial(stiffness=1.0, damping=1.0)} if self.springs else {}


def joined(found: JoinedBodies, joint: Joint, one: BodyDef | None, other: BodyDef | None) -> None:
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
            _pin(found, _second(joint.places[0], min(held, key=lambda body: len(expansion(body).mass))), [one, other])
    if len(held) == 2 and not joint.collides:
        found.passing.append((held[0].id, held[1].id))


def _pin(found: JoinedBodies, place: Vector, bodies: list[BodyDef | None]) -> str:
    """A particle at a place that stiff springs hold to bodies; ground pins it. Gives its id."""
    number = len(found.particles) + 1
    while (name := f"joint {number}") in found.taken:
        number += 1
    found.taken.add(name)
    held = [body for body in bodies if body is not None]
    mass = min((float(np.min(expansion(body).mass)) for body in held), default=1.0)
    pinned = None in bodies
    found.particles.append(ParticleDef(id=name, position=place, mass=mass, radius=0.03, pinned=pinned, collides=False))
    for body in held:
        places = expansion(body).position
        away = np.hypot(*(places - np.array(place)).T)
        near = _corners(body, place)
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


def _corners(body: BodyDef, place: Vector) -> list[int]:
    """Corners of the triangle of a body whose middle is nearest to a place."""
    made = expansion(body)
    triangles = made.polygons()
    if not len(triangles):
        return np.argsort(np.hypot(*(made.position - np.array(place)).T), kind="stable")[:3].tolist()
    middle = made.position[triangles].mean(axis=1)
    nearest = int(np.argmin(np.hypot(*(middle - np.array(place)).T)))
    return [int(index) for index in triangles[nearest]]


def _second(place: Vector, body: BodyDef) -> Vector:
    """A place of a body apart from another one, for a joint that lets nothing turn."""
    places = expansion(body).position
    away = np.hypot(*(places - np.array(place)).T)
    x, y = (0.5 * (places[int(np.argmax(away))] + np.array(place))).tolist()
    return x, y


def let_pass(found: JoinedBodies, left_out: LeftOut) -> None:
    """Let joined bodies pass through each other, by a collision group for each."""
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
