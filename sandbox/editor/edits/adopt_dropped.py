"""Adopting what was added to a run: it becomes ordinary bodies, particles and springs of the level."""

from dataclasses import replace
from typing import Any

import numpy as np

from sandbox.editor.document import Document, EditError, checked
from sandbox.editor.edits.bake import as_firm, heavier, times_as_heavy
from sandbox.editor.edits.names import free_ids, owner_of, renamed, taken_ids
from sandbox.editor.scene import make_scene
from sandbox.level.assembly.build_world import JoinedLevel, LevelWorld
from sandbox.level.document.model import Level, Material, NissenMaterial, ParticleDef, SpringDef
from sandbox.level.format.limits import COORDINATE_LIMIT, DEFAULT_MATERIAL
from sandbox.level.format.look import look_when_added
from sandbox.level.format.quantities import replaced
from sandbox.level.kinds.body_def import BodyDef
from sandbox.level.kinds.mesh import MeshDef

Shift = tuple[float, float]
# How the names begin of loose particles that commands add.
ADDED_PARTICLE, ADDED_SPRING = "+.", "+:"
# What springs that commands added are of in the level: what gives way is drawn as a coil, what does not as a rod.
COIL, ROD, FIRM = "added coil", "added rod", 0.85


def keep_added(document: Document, world: LevelWorld) -> Document:
    """Take over the bodies, balls and springs that joined the played world and are still there. Raises EditError.

    They start at rest as they stand now, in their looks; what was pinned and cut stays so.
    """
    level, names = _with_things(document.level, world)
    level = _with_springs(level, world, names)
    return document if level is document.level else replace(document, level=checked(level))


def keep_added_things(document: Document, world: LevelWorld) -> Document:
    """As `keep_added`, without the springs that join them to others. Raises EditError."""
    level, _ = _with_things(document.level, world)
    return document if level is document.level else replace(document, level=checked(level))


def _with_things(level: Level, world: LevelWorld) -> tuple[Level, dict[str, str]]:
    """The level with bodies and balls that were added, and what each is called there by its name in the world."""
    names: dict[str, str] = {}
    for joined in world.joined:
        level = _with_joined(level, world, joined, names)
    return _with_balls(level, world, names), names


def _with_joined(level: Level, world: LevelWorld, joined: JoinedLevel, names: dict[str, str]) -> Level:
    source = joined.level
    found = [(body, name, _particles(world, name)) for body, name in zip(source.bodies, joined.names, strict=False)]
    staying = [(body, name, slots) for body, name, slots in found if _is_there(world, name, slots)]
    if not staying:
        return level
    slots = np.unique(np.concatenate([slots for _, _, slots in staying]))
    slots = slots[world.particle_active[slots]]
    if not np.all(np.abs(world.position[slots]) <= COORDINATE_LIMIT):
        raise EditError("something has flown out of the world; go back to before it did")
    x, y = (world.position[slots] - world.origin[slots]).mean(axis=0).tolist()
    times = times_as_heavy(make_scene(source), world.mass[np.concatenate([slots for _, _, slots in found])])
    of_body = dict(zip([body.id for body in source.bodies], times, strict=True))
    ids = free_ids(taken_ids(level), [_base(body) for body, _, _ in staying])
    new = {body.id: free for (body, _, _), free in zip(staying, ids, strict=True)}
    names |= {name: new[body.id] for body, name, _ in staying}
    bodies = tuple(
        _kept(each, (x, y), world.position[own], _held(world, own), _cut(world, name, body))
        for body, name, own in staying
        for each in [_as_played(replaced(body, id=new[body.id]), world, name, of_body[body.id])]
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


def _as_played(body: BodyDef, world: LevelWorld, name: str, times: float) -> BodyDef:
    """A body so many times as heavy, and as firm as the one of that name in a world."""
    form = next((form for form in world.forms if form.name == name), None)
    body = heavier(body, times)
    return body if form is None else as_firm(body, form, world, world.level.settings)


def _is_there(world: LevelWorld, name: str, slots: Any) -> bool:
    """Whether a body still has a particle that is no other body's."""
    own = [slot for slot in slots.tolist() if world.particle_names[slot].startswith(f"{name}.")]
    return bool(world.particle_active[own].any())


def _base(body: BodyDef) -> str:
    return body.type if body.id.startswith("body ") else body.id


def _particles(world: LevelWorld, name: str) -> Any:
    """Slots of a body's particles, those included that are one with particles of others."""
    found, number = [], 0
    while True:
        try:
            found.append(world.particle_slot(f"{name}.{number}"))
        except KeyError:
            return np.array(found, dtype=np.int64)
        number += 1


def _held(world: LevelWorld, slots: Any) -> tuple[int, ...]:
    return tuple(np.flatnonzero(world.inverse_mass[slots] == 0.0).tolist())


def _cut(world: LevelWorld, name: str, body: BodyDef) -> tuple[int, ...]:
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


def _with_balls(level: Level, world: LevelWorld, names: dict[str, str]) -> Level:
    """The level with the loose particles that were added."""
    slots = [
        slot for slot, name in enumerate(world.particle_names)
        if name.startswith(ADDED_PARTICLE) and world.particle_active[slot]
    ]  # fmt: skip
    if not slots:
        return level
    ids = free_ids(taken_ids(level), ["ball"] * len(slots))
    names |= {world.particle_names[slot]: name for slot, name in zip(slots, ids, strict=True)}
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


def _with_springs(level: Level, world: LevelWorld, names: dict[str, str]) -> Level:
    """The level with the springs that were added one by one; names: see `_with_things`."""
    of_bodies = {name for joined in world.joined for name in joined.spring_names}
    materials, springs = dict(level.materials), list(level.springs)
    for slot, name in enumerate(world.spring_names):
        if not name.startswith(ADDED_SPRING) or name in of_bodies or not world.spring_active[slot]:
            continue
        ends = [_reference(world.particle_names[end[slot]], names) for end in (world.particle_a, world.particle_b)]
        material = NissenMaterial(stiffness=float(world.stiffness[slot]), damping=float(world.damping[slot]))
        own = next((body.material for body in level.bodies if _goes_on(body, ends, material, level)), None)
        if own is None:
            own = _named(materials, ROD if material.stiffness >= FIRM else COIL, material)
        a, b = ends
        springs.append(SpringDef(a=a, b=b, material=own, rest_length=float(world.rest_length[slot])))
    if len(springs) == len(level.springs):
        return level
    return replaced(level, materials=materials, springs=tuple(springs))


def _reference(name: str, names: dict[str, str]) -> str:
    """What a particle of the world is called in the level."""
    owner, _, rest = name.partition(".")
    return names.get(name) or f"{names.get(owner, owner)}.{rest}" if rest else name


def _goes_on(body: BodyDef, ends: list[str], material: NissenMaterial, level: Level) -> bool:
    """Whether a spring ties a strand: it ends at it, and is of what that is of."""
    is_strand = isinstance(body, MeshDef) and not body.triangles and body.id in map(owner_of, ends)
    return is_strand and material == level.materials.get(body.material)


def _named(materials: dict[str, Material], base: str, material: NissenMaterial) -> str:
    """The name of a material, which is added where there is none of its values."""
    found = next((name for name, each in materials.items() if name.startswith(base) and each == material), None)
    if found is not None:
        return found
    (name,) = free_ids(set(materials), [base])
    materials[name] = material
    return name
