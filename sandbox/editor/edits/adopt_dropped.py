"""Adopting what was dropped into a run: it becomes ordinary bodies and particles of the level."""

from dataclasses import replace
from typing import Any

import numpy as np

from sandbox.editor.document import Document, EditError, checked
from sandbox.editor.edits.names import free_ids, owner_of, renamed, taken_ids
from sandbox.level.document.model import Level, ParticleDef
from sandbox.level.format.limits import COORDINATE_LIMIT, DEFAULT_MATERIAL
from sandbox.level.format.look import look_when_added
from sandbox.level.format.quantities import replaced
from sandbox.level.kinds.body_def import BodyDef
from sandbox.physics.keeping.equipment import Joined
from sandbox.physics.world import World

Shift = tuple[float, float]
# How the names begin of loose particles that commands add.
ADDED_PARTICLE = "+."


def keep_added(document: Document, world: World) -> Document:
    """Take over the bodies and balls that joined the played world and are still there. Raises EditError.

    They start at rest as they stand now, in their looks; what was pinned and cut stays so.
    """
    level = document.level
    for joined in world.joined:
        level = _with_joined(level, world, joined)
    level = _with_balls(level, world)
    return document if level is document.level else replace(document, level=checked(level))


def _with_joined(level: Level, world: World, joined: Joined) -> Level:
    source: Level = joined.source
    found = [(body, name, _particles(world, name)) for body, name in zip(source.bodies, joined.names, strict=True)]
    staying = [(body, name, slots) for body, name, slots in found if _is_there(world, name, slots)]
    if not staying:
        return level
    slots = np.unique(np.concatenate([slots for _, _, slots in staying]))
    slots = slots[world.particle_active[slots]]
    if not np.all(np.abs(world.position[slots]) <= COORDINATE_LIMIT):
        raise EditError("something has flown out of the world; go back to before it did")
    x, y = (world.position[slots] - world.origin[slots]).mean(axis=0).tolist()
    ids = free_ids(taken_ids(level), [_base(body) for body, _, _ in staying])
    new = {body.id: free for (body, _, _), free in zip(staying, ids, strict=True)}
    bodies = tuple(
        _kept(replaced(body, id=new[body.id]), (x, y), world.position[own], _held(world, own), _cut(world, name, body))
        for body, name, own in staying
    )
    rewire = renamed(new)

    def stay(*references: str) -> bool:
        return all(owner_of(reference) in new for reference in references)

    welds = tuple((str(rewire(a)), str(rewire(b))) for a, b in source.welds if stay(a, b))
    springs = tuple(
        replaced(each, a=rewire(each.a), b=rewire(each.b)) for each in source.springs if stay(each.a, each.b)
    )
    used = {body.material for body in bodies} | {spring.material for spring in springs}
    materials = {name: material for name, material in source.materials.items() if name in used - {DEFAULT_MATERIAL}}
    return replaced(
        level,
        bodies=(*level.bodies, *bodies),
        welds=(*level.welds, *welds),
        springs=(*level.springs, *springs),
        materials=materials | level.materials,
    )


def _is_there(world: World, name: str, slots: Any) -> bool:
    """Whether a body still has a particle that is no other body's."""
    own = [slot for slot in slots.tolist() if world.particle_names[slot].startswith(f"{name}.")]
    return bool(world.particle_active[own].any())


def _base(body: BodyDef) -> str:
    return body.type if body.id.startswith("body ") else body.id


def _particles(world: World, name: str) -> Any:
    """Slots of a body's particles, those included that are one with particles of others."""
    found, number = [], 0
    while True:
        try:
            found.append(world.particle_slot(f"{name}.{number}"))
        except KeyError:
            return np.array(found, dtype=np.int64)
        number += 1


def _held(world: World, slots: Any) -> tuple[int, ...]:
    return tuple(np.flatnonzero(world.inverse_mass[slots] == 0.0).tolist())


def _cut(world: World, name: str, body: BodyDef) -> tuple[int, ...]:
    """Numbers of a body's springs that are broken or were cut."""
    numbers = set(body.cut)
    for slot, spring in enumerate(world.spring_names):
        if spring.startswith(f"{name}:") and not world.spring_active[slot]:
            numbers.add(int(spring.rpartition(":")[2]))
    return tuple(sorted(numbers))


def _kept(body: BodyDef, shift: Shift, pose: Any, pinned: tuple[int, ...], cut: tuple[int, ...]) -> BodyDef:
    """A body at rest and moved by [m], its particles at the places pose [m] (n, 2), some held, some springs cut."""
    changes: dict[str, Any] = {"velocity": (0.0, 0.0), "pinned": pinned, "cut": cut}
    for name in ("position", "start", "end"):
        if name in type(body).model_fields:
            x, y = getattr(body, name)
            changes[name] = (x + shift[0], y + shift[1])
    points = getattr(body, "particles", None)
    if points is not None:
        changes["particles"] = tuple((x + shift[0], y + shift[1]) for x, y in points)
    return replaced(body, **changes, pose=tuple((x, y) for x, y in pose.tolist()))


def _with_balls(level: Level, world: World) -> Level:
    """The level with the loose particles that were added."""
    slots = [
        slot for slot, name in enumerate(world.particle_names)
        if name.startswith(ADDED_PARTICLE) and world.particle_active[slot]
    ]  # fmt: skip
    if not slots:
        return level
    ids = free_ids(taken_ids(level), ["ball"] * len(slots))
    balls = tuple(
        ParticleDef(
            id=name,
            position=(float(world.position[slot, 0]), float(world.position[slot, 1])),
            mass=float(world.mass[slot]),
            radius=float(world.radius[slot]),
            pinned=bool(world.inverse_mass[slot] == 0.0),
            friction=float(world.friction[slot]) if level.has_contacts else None,
            restitution=float(world.restitution[slot]) if level.has_contacts else None,
            look=look_when_added(number, float(world.radius[slot])),
        )
        for number, (name, slot) in enumerate(zip(ids, slots, strict=True))
    )
    return replaced(level, particles=(*level.particles, *balls))
