"""What joins a running world: the commands that add a part, at a size, or a copy of a thing, or why none can."""

from dataclasses import fields
from typing import Any

import numpy as np

from sandbox.editor.document import Document, EditError
from sandbox.editor.edits.bake import keep_added_things, keep_coefficients, keep_cuts, keep_masses, keep_pins, keep_pose
from sandbox.editor.edits.copying import fragment, inserted, shifted
from sandbox.editor.edits.moving import scale_exactly
from sandbox.editor.edits.names import owner_of, rewired, with_owner
from sandbox.editor.items import items_of
from sandbox.editor.panel.field_info import fields_of
from sandbox.level.assembly.build_world import LevelWorld
from sandbox.level.assembly.joining import Joiners
from sandbox.level.document.canonical import level_text
from sandbox.level.document.model import HydraulicDef, Level, Material, ParticleDef
from sandbox.level.format.level_error import LevelError, one_line, shown
from sandbox.level.format.limits import BODY_RADIUS
from sandbox.level.format.look import BodyLook
from sandbox.level.format.quantities import Description, Point, replaced
from sandbox.level.kinds.bodies import AnyBody, expansion
from sandbox.level.kinds.mesh import MeshDef
from sandbox.level.reading.parse import parse_level
from sandbox.session.commands import AddBody, AddParticle, Command

# What of a run a copy of one of its things takes over.
KEEPERS = (keep_coefficients, keep_masses, keep_pose, keep_pins, keep_cuts, keep_added_things)
# What a loose particle has that its command says, and what only the editor or the eye knows.
SAID = frozenset(field.name for field in fields(AddParticle))
UNSEEN = frozenset(("id", "group", "extras", "angle"))
# What it has that does nothing while a spring holds it.
OF_FREE_DISCS = frozenset(("rolls", "rolling", "spin"))


# How often a quantity takes up the factor of lengths, by its unit: times stay as they are, so forces go with masses.
POWERS = {"kg": 2, "N": 2, "N/m": 2, "N s/m": 2, "N m": 3}


def joining_commands(part: Level, world: LevelWorld, at: Point, velocity: Point = (0.0, 0.0)) -> tuple[Command, ...]:
    """The commands that add a part with its origin at a point [m], thrown at a velocity [m/s]; one gesture.

    Materials of the same name and values are shared, others get a name of their own; what was made for another tick
    rate moves per second alike. Raises EditError, with one line, where commands cannot add all of it.
    """
    source, known = world.level, world.materials
    bare = Level(
        format=source.format, version=source.version, name=source.name, settings=source.settings, materials=known,
        contacts=source.contacts,
    )  # fmt: skip
    joined, _ = inserted(bare, [shifted(_able_to_join(part), *at)])
    commands: list[Command] = []
    if joined.bodies:
        add = _add_body(joined, known, velocity)
        try:
            Joiners(world, {name: value for name, value in vars(add).items() if value is not None}).check_room(world)
        except LevelError as error:
            raise EditError(one_line(error.faults[0])) from None
        commands.append(add)
    return *commands, *(_add_particle(each, velocity) for each in joined.particles)


def copying_commands(level: Level, world: LevelWorld, particle: int, by: Point) -> tuple[Command, ...]:
    """The commands that add a copy of what a particle of a run of a level belongs to, moved by [m]; one gesture.

    With it go the bodies that are welded to it, and their springs. It has the pose, masses, pins and cuts that it has
    now, and no velocity. Raises EditError, with one line, where commands cannot add it.
    """
    document = Document(level)
    for keeper in KEEPERS:
        document = keeper(document, world)
    level = document.level
    x, y = world.position[particle].tolist()
    first = _owner_at(level, (x, y))
    if first is None:
        raise EditError("there is nothing here that can be copied")
    chosen = _joined_to(level, first)
    part = fragment(Document(level, frozenset(item for item in items_of(level) if item.key in chosen)))
    at_rest = tuple(replaced(body, velocity=(0.0, 0.0)) for body in part.bodies)
    loose = tuple(replaced(each, velocity=(0.0, 0.0)) for each in part.particles)
    return joining_commands(replaced(part, bodies=at_rest, particles=loose), world, by)


def _able_to_join(part: Level) -> Level:
    """The part with its loose particles that springs or welds hold as bodies. Raises EditError where it cannot join."""
    if part.terrain:
        raise EditError(f"{shown(part.name)} has terrain, which cannot join a run; build it into a level")
    named = {owner_of(name) for pair in ((each.a, each.b) for each in part.springs) for name in pair}
    named |= {owner_of(name) for pair in part.welds for name in pair}
    held = [particle for particle in part.particles if particle.id in named]
    for particle in part.particles:
        unsaid = _unsaid(particle, particle.id in named)
        if unsaid:
            raise EditError(f"{shown(particle.id)} is a loose particle with {unsaid}, which cannot join a run")
    ids = {particle.id for particle in held}
    part, _ = rewired(part, lambda name: with_owner(f"{name}.0", name) if name in ids else name)
    loose = tuple(particle for particle in part.particles if particle.id not in ids)
    return replaced(part, bodies=(*part.bodies, *map(_as_mesh, held)), particles=loose)


def _unsaid(particle: ParticleDef, is_held: bool) -> str:
    """The first field of a particle that the command AddParticle cannot set; empty where there is none."""
    said = SAID | UNSEEN
    if is_held:
        said |= OF_FREE_DISCS | frozenset(MeshDef.model_fields)
    for name, field in ParticleDef.model_fields.items():
        if name not in said and getattr(particle, name) != field.default:
            return name.replace("_", " ")
    return ""


def _as_mesh(particle: ParticleDef) -> MeshDef:
    """A body of a single particle."""
    same = ("id", "velocity", "gravity_scale", "friction", "restitution", "collides", "collision_group", "group")
    return MeshDef(
        type="mesh",
        particles=(particle.position,),
        masses=(particle.mass,),
        particle_radius=particle.radius,
        pinned=(0,) if particle.pinned else (),
        # What ball it is, no body says.
        look=None if particle.look is None else BodyLook(colour=particle.look.colour),
        **{name: getattr(particle, name) for name in same},
    )


def _add_body(level: Level, known: dict[str, Material], velocity: Point) -> AddBody:
    first, *others = (_said(replaced(body, velocity=_sum(body.velocity, velocity))) for body in level.bodies)
    users = {body.material for body in level.bodies} | {spring.material for spring in level.springs}
    new = {name: _said(each) for name, each in level.materials.items() if name in users and name not in known}
    springs = tuple(map(_said, level.springs))
    return AddBody(first, tuple(others) or None, springs or None, level.welds or None, new or None)


def _add_particle(particle: ParticleDef, velocity: Point) -> AddParticle:
    values = {name: getattr(particle, name) for name in SAID}
    return AddParticle(**values | {"velocity": None if particle.pinned else _sum(particle.velocity, velocity)})


def _sum(one: Point, other: Point) -> Point:
    return one[0] + other[0], one[1] + other[1]


def _said(part: Description) -> dict[str, Any]:
    """The fields of a definition that a level file has to write, those at their defaults left out."""
    said: dict[str, Any] = part.model_dump(mode="json", exclude_defaults=True)
    return said


def _owner_at(level: Level, place: Point) -> str | None:
    """The id of a body or loose particle with a particle just at a place [m]."""
    bodies = ((body.id, expansion(body).position) for body in level.bodies)
    loose = ((particle.id, np.array([particle.position])) for particle in level.particles)
    found = (name for name, position in (*bodies, *loose) if (position == np.array(place)).all(axis=1).any())
    return next(found, None)


def _joined_to(level: Level, first: str) -> set[str]:
    """The ids of what welds and springs join to a thing, itself included."""
    pairs = [*level.welds, *((spring.a, spring.b) for spring in level.springs)]
    links = [{owner_of(reference) for reference in pair} for pair in pairs]
    found, grown = {first}, True
    while grown:
        more = found.union(*(link for link in links if link & found))
        grown, found = len(more) > len(found), more
    return found


def sized(part: Level, factor: float) -> Level:
    """A part whose lengths are `factor` times as large about its origin, as the editor scales them.

    Masses go with its area, forces and torques with these, so that it drives and swings as it did, in the same time;
    start velocities stay. Raises EditError where that is beyond a limit.
    """
    if factor == 1.0:
        return part
    scaled = scale_exactly(Document(part, frozenset(items_of(part))), factor).level
    made = replaced(
        scaled,
        materials={name: _heavier(each, factor) for name, each in scaled.materials.items()},
        bodies=tuple(_heavier(_with_masses(body, factor), factor) for body in scaled.bodies),
        particles=tuple(_heavier(each, factor) for each in scaled.particles),
        springs=tuple(_heavier(each, factor) for each in scaled.springs),
    )
    try:
        return parse_level(level_text(made).encode(), part.name)
    except LevelError as error:
        raise EditError(one_line(error.faults[0])) from None


def _with_masses(body: AnyBody, factor: float) -> AnyBody:
    """A body that says the radius of its particles, and their masses, where these go without saying else."""
    radius = BODY_RADIUS if body.particle_radius is None else body.particle_radius
    more: dict[str, Any] = {}
    if isinstance(body, MeshDef) and body.masses is None:
        more["masses"] = (1.0,) * len(body.particles)
    return replaced(body, particle_radius=factor * radius, **more)


def _heavier(part: Any, factor: float) -> Any:
    """A description with its masses and forces, and those of what it holds, for lengths this many times as large."""
    changes: dict[str, Any] = {}
    model: type[Description] = type(part)
    known = fields_of(model)
    for name, value in part.__dict__.items():
        power = POWERS.get(known[name].unit, 0)
        if isinstance(part, HydraulicDef) and name == "rate":
            power = 1
        if isinstance(value, Description):
            changes[name] = _heavier(value, factor)
        elif power and value is not None:
            times = factor**power
            changes[name] = tuple(times * each for each in value) if isinstance(value, tuple) else times * value
    return replaced(part, **changes)
