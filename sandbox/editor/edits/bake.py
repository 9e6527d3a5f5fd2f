"""Baking: what a played world leaves in its level where the maker wants it: coefficients, pose, cuts, what joined."""

from dataclasses import replace
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from sandbox.editor.document import Document, EditError, checked
from sandbox.editor.edits.fields import set_setting
from sandbox.editor.edits.materials import set_material
from sandbox.editor.edits.names import free_ids, owner_of, renamed, taken_ids
from sandbox.editor.edits.placing import repinned, without_springs
from sandbox.editor.items import Definition, Selection, changed, items_of, with_same
from sandbox.editor.panel.field_info import fields_of
from sandbox.editor.scene import Mask, Scene, Slots, make_scene
from sandbox.editor.tools.snap import PLACE_DECIMALS, SHOWN_DECIMALS
from sandbox.level.assembly.build_world import JoinedLevel, LevelWorld
from sandbox.level.document.model import (
    CHANGEABLE_SETTINGS,
    Level,
    Material,
    NissenMaterial,
    ParticleDef,
    Settings,
    SpringDef,
)
from sandbox.level.format.limits import COORDINATE_LIMIT, DEFAULT_MATERIAL
from sandbox.level.format.look import look_when_added
from sandbox.level.format.quantities import Description, replaced, significant
from sandbox.level.kinds.bodies import AnyBody
from sandbox.level.kinds.body_def import BodyDef, FirmnessDef
from sandbox.level.kinds.geometry import Points
from sandbox.level.kinds.mesh import MeshDef
from sandbox.level.kinds.wheel import WheelDef
from sandbox.level.plan.surfaces import DEFAULT_GROUP, group_bits
from sandbox.physics.equation import of_body, of_springs
from sandbox.physics.keeping.equipment import FirmBody
from sandbox.physics.softness.firmness import FirmnessRange
from sandbox.physics.world import World

Part = TypeVar("Part", bound=Description)


Shift = tuple[float, float]
# How the names begin of loose particles that commands add.
ADDED_PARTICLE, ADDED_SPRING = "+.", "+:"
# What springs that commands added are of in the level: what gives way is drawn as a coil, what does not as a rod.
COIL, ROD, FIRM = "added coil", "added rod", 0.85

# Digits of how many times as heavy a body is; what differs by less is rounding.
MASS_DIGITS = 9
_ANOTHER = "what was played is not the level as it is now"


def keep_coefficients(document: Document, world: World) -> Document:
    """Take over Cs and Cd of every material as the played world has them, and firmness. Raises EditError."""
    _slots(make_scene(document.level), world)
    document, is_firm = _keep_firmness(document, world)
    for number, name in enumerate(world.material_names):
        springs = np.flatnonzero((world.material == number) & ~is_firm)
        material = document.level.material(name)
        if not len(springs) or not isinstance(material, NissenMaterial):
            continue
        stiffness, damping = float(world.stiffness[springs[0]]), float(world.damping[springs[0]])
        played = replaced(material, stiffness=stiffness, damping=damping)
        if played != material:
            document = set_material(document, name, played)
    return document


def _keep_firmness(document: Document, world: World) -> tuple[Document, Mask]:
    """Take over the firmness of every body; and which springs (m,) have their Cs and Cd from one."""
    level, is_firm = document.level, world.lowest_mode > 0.0
    forms = {form.name: form for form in world.forms}

    def kept(body: AnyBody) -> AnyBody:
        form = forms.get(body.id)
        new = body if form is None else as_firm(body, form, world, level.settings)
        if form is not None and new is body and body.firmness is not None:
            is_firm[form.springs] = True
        return new

    new = with_same(level, bodies=tuple(map(kept, level.bodies)))
    return (document if new is level else replace(document, level=checked(new))), is_firm


def as_firm(body: AnyBody, form: FirmBody, world: World, settings: Settings) -> AnyBody:
    """A body as firm as it is in a played world, by its form there; the same one where that is what it says."""
    reach = FirmnessRange.of(form.shape, settings.gravity, settings.tick_rate)
    mode = float(world.lowest_mode[form.springs[0]])
    present = float(world.stiffness[form.springs[0]]), float(world.damping[form.springs[0]])
    if body.firmness is not None:
        pair = reach.coefficients(body.firmness.asked)
        if present == (pair if pair == (1.0, 1.0) else of_springs(*pair, reach.lowest_mode)):
            return body
    if mode == 0.0:
        return body if body.firmness is None else replaced(body, firmness=None)
    near = reach.wobble_of(*of_body(*present, mode))
    return replaced(body, firmness=FirmnessDef(hz=near.hz, ratio=near.ratio))


def keep_settings(document: Document, world: World) -> Document:
    """Take over gravity, solver and whatever else was set of the whole world while it ran. Raises EditError."""
    for name in CHANGEABLE_SETTINGS:
        played = getattr(world.settings, name)
        if played != getattr(document.level.settings, name):
            document = set_setting(document, name, played)
    return document


def keep_pose(document: Document, world: World) -> Document:
    """Start everything where it is in the played world; all rest lengths stay. Raises EditError."""
    scene = make_scene(document.level)
    slots = _slots(scene, world)
    now = world.position[slots]
    if not np.all(np.abs(now) <= COORDINATE_LIMIT):
        raise EditError("something has flown out of the world; go back to before it did")
    return _posed(document, scene, now, world.angle[slots])


def begin_at_rest(document: Document, position: Points, falling: Selection = frozenset()) -> Document:
    """Start everything where a forecast has it, and at rest; all rest lengths stay. Raises EditError.

    position [m] (n, 2): by the particles of the level's Scene. falling: items that stay as they are.
    """
    level = document.level
    still = frozenset(items_of(level)) - falling
    level = changed(level, still, _at_rest)
    scene = make_scene(level)
    angle = np.array([*[0.0] * (len(position) - len(level.particles)), *(part.angle for part in level.particles)])
    # To micrometres, so that a file has no more digits than mean something.
    return _posed(replace(document, level=level), scene, np.round(position, PLACE_DECIMALS) + 0.0, angle)


def _at_rest(part: Definition) -> Definition:
    """A body or particle that does not move at the start."""
    still = {"velocity": (0.0, 0.0), "velocities": None, "spin": 0.0}
    changes = {name: value for name, value in still.items() if part.__dict__.get(name, value) != value}
    return replaced(part, **changes) if changes else part


def _posed(document: Document, scene: Scene, now: Points, angle: Points) -> Document:
    """The document with everything at places [m] (n, 2) and turned by angles [rad] (n,), by the scene's particles."""
    level = document.level
    moved = np.any(now != scene.position, axis=1)
    turned = angle != [*[0.0] * (len(angle) - len(level.particles)), *(particle.angle for particle in level.particles)]
    firsts = np.cumsum([0, *scene.parts.bodies.counts]).tolist()

    def posed(index: int, body: AnyBody) -> AnyBody:
        mine = slice(firsts[index], firsts[index + 1])
        if not np.any(moved[mine]):
            return body
        return replaced(body, pose=_points(now[mine]), **_followed(body, scene.position[mine], now[mine]))

    def placed(index: int, particle: ParticleDef) -> ParticleDef:
        slot = firsts[-1] + index
        if turned[slot]:
            particle = replaced(particle, angle=float(angle[slot]))
        return replaced(particle, position=_points(now[slot : slot + 1])[0]) if moved[slot] else particle

    def measured(index: int, spring: SpringDef) -> SpringDef:
        slot = len(scene.rest_length) - len(level.springs) + index
        ends = [scene.particle_a[slot], scene.particle_b[slot]]
        if spring.rest_length is not None or not np.any(moved[ends]):
            return spring
        if scene.rest_length[slot] > COORDINATE_LIMIT:
            raise EditError(f"the spring :{index} is too long to keep its rest length")
        return replaced(spring, rest_length=float(scene.rest_length[slot]))

    level = with_same(
        level,
        bodies=tuple(posed(index, body) for index, body in enumerate(level.bodies)),
        particles=tuple(placed(index, particle) for index, particle in enumerate(level.particles)),
        springs=tuple(measured(index, spring) for index, spring in enumerate(level.springs)),
    )
    return document if level is document.level else replace(document, level=checked(level))


def _points(points: Points) -> tuple[tuple[float, float], ...]:
    return tuple((x, y) for x, y in points.tolist())


def _followed(body: AnyBody, before: Points, now: Points) -> dict[str, Any]:
    """The new position of a body that has one: it moves with the middle of its pose."""
    if "position" not in body.__dict__:
        return {}
    middles = [(points.min(axis=0) + points.max(axis=0)) / 2.0 for points in (before, now)]
    shift = (middles[1] - middles[0]).tolist()
    x, y = (round(a + by, SHOWN_DECIMALS) + 0.0 for a, by in zip(body.__dict__["position"], shift, strict=True))
    return {"position": (x, y)}


def keep_cuts(document: Document, world: World) -> Document:
    """Leave out the springs that were cut while playing, once: springs are told by their numbers. Raises EditError."""
    scene = make_scene(document.level)
    _slots(scene, world)
    springs = [scene.spring_name(spring) for spring in range(len(scene.rest_length))]
    if world.spring_names[: len(springs)] != springs:
        raise EditError(_ANOTHER)
    cut: dict[str, set[int]] = {}
    gone: set[int] = set()
    for spring in np.flatnonzero(~world.spring_active[: len(scene.rest_length)]).tolist():
        kind, key = scene.items[int(scene.spring_item[spring])]
        (cut.setdefault(str(key), set()) if kind == "body" else gone).add(int(scene.number[spring]))
    return without_springs(document, cut, gone) if cut or gone else document


def keep_pins(document: Document, world: World) -> Document:
    """Hold the particles that are held in the played world, and no others. Raises EditError."""
    scene = make_scene(document.level)
    held: Mask = world.inverse_mass[_slots(scene, world)] == 0.0
    differs = held != scene.pinned
    # Of welded particles the first is held for all of them; none may be where all are let go.
    pins = {
        slot: bool(held[slot])
        for slot in np.flatnonzero(differs).tolist()
        if not held[slot] or scene.first_of_weld[slot] == slot
    }
    return replace(document, level=repinned(document.level, scene, pins)) if pins else document


def keep_masses(document: Document, world: World) -> Document:
    """Let everything weigh what it does in the played world. Raises EditError."""
    level, scene = document.level, make_scene(document.level)
    times = times_as_heavy(scene, world.mass[_slots(scene, world)])
    count = len(level.bodies)
    new = with_same(
        level,
        bodies=tuple(map(heavier, level.bodies, times[:count])),
        particles=tuple(map(heavier, level.particles, times[count:])),
    )
    return document if new is level else replace(document, level=checked(new))


def times_as_heavy(scene: Scene, mass: NDArray[np.float64]) -> list[float]:
    """How many times as heavy bodies, then loose particles, of a scene are whose particles weigh so much [kg] (n,) now.

    Of particles that are one all weigh what that does.
    """
    own = np.zeros(len(scene.mass))
    np.add.at(own, scene.first_of_weld, scene.mass)
    ratio = mass / own[scene.first_of_weld]
    # A particle that is one with another body's may have got heavier with that.
    bodies = np.split(ratio, np.cumsum(scene.parts.bodies.counts))
    loose = bodies.pop()
    return [significant(float(value), MASS_DIGITS) for value in (*map(np.median, bodies), *loose)]


def heavier(part: Part, factor: float) -> Part:
    """A body or particle that weighs so many times as much; the same one where that is once."""
    if factor == 1.0:
        return part
    changes: dict[str, Any] = {}
    for field, value in part.__dict__.items():
        if fields_of(type(part))[field].unit == "kg" and value is not None:
            changes[field] = tuple(factor * each for each in value) if isinstance(value, tuple) else factor * value
    if isinstance(part, MeshDef) and part.masses is None:
        changes["masses"] = (factor,) * len(part.particles)
    return replaced(part, **changes)


def _slots(scene: Scene, world: World) -> Slots:
    """The world's particle for each of the scene (n,). Raises EditError for a world of another level."""
    stays = scene.first_of_weld == np.arange(len(scene.mass))
    names = [scene.names(slot) for slot in np.flatnonzero(stays).tolist()]
    if world.particle_names[: len(names)] != names:
        raise EditError(_ANOTHER)
    slots: Slots = (np.cumsum(stays) - 1)[scene.first_of_weld]
    return slots


def keep_added(document: Document, world: LevelWorld) -> Document:
    """Take over the bodies, balls and springs that joined the played world and are still there. Raises EditError.

    They start at rest as they stand now, in their looks; what was pinned and cut stays so.
    """
    level, names = _with_things(document.level, world)
    level = _with_springs(_with_groups(level, world, names), world, names)
    return document if level is document.level else replace(document, level=checked(level))


def keep_added_things(document: Document, world: LevelWorld) -> Document:
    """Keep bodies added in play, as `keep_added`, without springs that join them to others. Raises EditError."""
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


def _with_groups(level: Level, world: LevelWorld, names: dict[str, str]) -> Level:
    """The level whose added bodies touch what they touch in the world: what passes another does so there."""
    bits = group_bits(world.level)
    first = {new: _particles(world, name)[0] for name, new in names.items() if len(_particles(world, name))}
    group, collides = ({new: int(rows[slot]) for new, slot in first.items()} for rows in (world.group, world.collides))
    # Wheels that pass their mounts say so themselves.
    wheels = {body.id for body in level.bodies if isinstance(body, WheelDef) and not body.touches_mount}
    passing = [each for each in collides.values() if each & bits[DEFAULT_GROUP]]
    bits |= {
        new: bit for new, bit in group.items()
        if new not in wheels and bit not in bits.values() and any(each & bit == 0 for each in passing)
    }  # fmt: skip
    named = {bit: name for name, bit in bits.items() if name != DEFAULT_GROUP}
    bodies = []
    for body in level.bodies:
        touched = tuple(name for name, bit in bits.items() if collides.get(body.id, -1) & bit)
        more: dict[str, Any] = {"collides": touched} if len(touched) < len(bits) else {}
        more |= {"collision_group": named[group[body.id]]} if group.get(body.id) in named else {}
        bodies.append(replaced(body, **more) if more else body)
    return replaced(level, bodies=tuple(bodies)) if level.has_contacts else level


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
    # What cuts have added is of bodies: a level keeps that springs are cut, and not where.
    is_loose = world.particle_active & (world.split_from < 0)
    slots = [
        slot for slot, name in enumerate(world.particle_names) if name.startswith(ADDED_PARTICLE) and is_loose[slot]
    ]
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
    is_split = world.split_from >= 0
    is_added = world.spring_active & ~(world.is_split | is_split[world.particle_a] | is_split[world.particle_b])
    for slot, name in enumerate(world.spring_names):
        if not name.startswith(ADDED_SPRING) or name in of_bodies or not is_added[slot]:
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
    """The name in the level of a particle of the world."""
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
