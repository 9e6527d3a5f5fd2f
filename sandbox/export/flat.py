"""flat(level): a level expanded, as other programs read it: nothing refers to anything but by index or name.

FlatLevel is format 1 of spring-sandbox/flat. Additions keep the number; a reader ignores keys that it does not know.
Springs have Cs and Cd as the level has them, and k and c for engines that add forces.
"""

import json
import math
from collections.abc import Iterable
from typing import Any, Literal

import numpy as np
from pydantic import Field

from sandbox.export.engines import MOST_STEPS, SLOW, as_in_solver
from sandbox.level.assembly.build_world import build_world
from sandbox.level.document.model import ContactsDef, Level, NissenMaterial, ParticleDef
from sandbox.level.format.limits import DEFAULT_MATERIAL
from sandbox.level.format.look import BodyLook, LevelLook, ParticleLook
from sandbox.level.format.quantities import Description, unit
from sandbox.level.format.shipped import shipped_folder
from sandbox.level.kinds.bodies import expansion
from sandbox.level.kinds.body_def import BodyDef
from sandbox.level.things.outlines import directed_loops, plain_lines
from sandbox.physics.analysis.energy import reduced_masses
from sandbox.physics.analysis.stability import BOUND, effective_count
from sandbox.physics.arrays import Floats
from sandbox.physics.constraints import AREA
from sandbox.physics.equation import HIGHEST_COEFFICIENT
from sandbox.physics.marks import LAW_HOOKE, NO_EDGE, SOLID_LEFT, SOLID_RIGHT, TERRAIN_GROUP
from sandbox.physics.softness.firmness import LARGEST_READ, lowest_mode_of
from sandbox.physics.substeps import substep_time
from sandbox.physics.world import World

Place = tuple[float, float]
Indices = tuple[int, ...]
METRES, NUMBER = unit("m"), unit("1")
BELT = "How fast its surface runs, to the right of who stands on it."
# Keys of the text whose items go one to a line.
LISTED = (
    "materials", "surfaces", "bodies", "particles", "springs", "areas", "bends", "terrain", "muscles", "hydraulics",
    "motors",
)  # fmt: skip
# The example that reads flat levels.
READER = "read_flat_pymunk.py"
# The line of the example in whose place the level goes, and how it is run without and with one.
NO_DATA = "DATA = None  # a level that this program carries with it\n"
USAGE, OWN_USAGE = f"python {READER} LEVEL.json [SECONDS", "python THIS_FILE [SECONDS"


class FlatParticle(Description):
    """A particle; others refer to it by its place in the list, from 0."""

    name: str = Field(description="Its first name in the level.")
    position: Place = Field(description="Where it starts.", json_schema_extra=METRES)
    velocity: Place = Field(default=(0.0, 0.0), description="How it starts.", json_schema_extra=unit("m/s"))
    mass: float = Field(description="Its mass, pinned or not.", json_schema_extra=unit("kg"))
    radius: float = Field(description="Of its disc.", json_schema_extra=METRES)
    pinned: bool = Field(default=False, description="Whether it is held where it is.")
    body: int | None = Field(default=None, description="Index of its body; null = a loose particle.")
    surface: int = Field(description="Index of what it is like to the touch.")
    gravity_scale: float = Field(default=1.0, description="Times that gravity pulls at it.", json_schema_extra=NUMBER)
    spin: float = Field(default=0.0, description="How fast its disc turns.", json_schema_extra=unit("rad/s"))
    look: ParticleLook | None = Field(default=None, description="How it looks; null = automatic.")
    extras: dict[str, Any] = Field(default={}, description="Data of other tools.")


class FlatSurface(Description):
    """What particles are like to the touch; those of one body never touch each other."""

    friction: float = Field(description="Of two that touch the geometric mean counts.", json_schema_extra=NUMBER)
    restitution: float = Field(description="Of two that touch the larger counts.", json_schema_extra=NUMBER)
    group: int = Field(description="Number of its group, from 0, which is that of terrain.")
    touches: Indices = Field(description="Numbers of the groups in this file that it touches, terrain's 0 included.")


class FlatSpring(Description):
    """A spring. Cs and Cd hold in the sandbox's solver; k and c are what F = -k x - c u needs for the same motion."""

    name: str = Field(description="Its name in the level.")
    a: int = Field(description="Particle at its first end, by index.")
    b: int = Field(description="Particle at its second end.")
    rest_length: float = Field(description="Where it pulls and pushes nothing.", json_schema_extra=METRES)
    Cs: float | None = Field(description="Stiffness of a tick; null = Hooke's spring.", json_schema_extra=NUMBER)
    Cd: float | None = Field(description="Damping of a tick; null = Hooke's spring.", json_schema_extra=NUMBER)
    k: float = Field(description="Spring constant.", json_schema_extra=unit("N/m"))
    c: float = Field(description="Damping constant, at `rate * steps`.", json_schema_extra=unit("N s/m"))
    rod: bool = Field(default=False, description="Whether it is too stiff to be added as a force: take a rigid joint.")
    edge: bool = Field(default=False, description="Whether it is a line that particles of others touch.")
    belt: float = Field(default=0.0, description=BELT, json_schema_extra=unit("m/s"))
    material: str = Field(description="Name of its material.")
    extras: dict[str, Any] = Field(default={}, description="Data of other tools.")


class FlatArea(Description):
    """A polygon of particles that keeps its area, counter-clockwise."""

    particles: Indices = Field(description="Its corners, by index.")
    area: float = Field(description="The area that it wants.", json_schema_extra=unit("m^2"))
    Cs: float = Field(description="Stiffness of a tick.", json_schema_extra=NUMBER)
    Cd: float = Field(description="Damping of a tick.", json_schema_extra=NUMBER)


class FlatBend(Description):
    """Two links that keep the angle between them."""

    particles: tuple[int, int, int] = Field(description="One end, the middle, the other end, by index.")
    cosine: float = Field(description="Of the angle between the links at rest.", json_schema_extra=NUMBER)
    sine: float = Field(description="Of that angle, above 0 to the left.", json_schema_extra=NUMBER)
    Cs: float = Field(description="Stiffness of a tick.", json_schema_extra=NUMBER)
    Cd: float = Field(description="Damping of a tick.", json_schema_extra=NUMBER)


class FlatTerrain(Description):
    """A piece that never moves."""

    id: str = Field(description="Its name; that of walls is `walls`.")
    kind: Literal["line", "solid", "hollow"] = Field(
        description="A line with two sides, a polygon solid inside, or one that is solid outside: walls."
    )
    corners: tuple[Place, ...] = Field(description="In order; polygons are closed.", json_schema_extra=METRES)
    friction: float = Field(description="Friction.", json_schema_extra=NUMBER)
    restitution: float = Field(description="Restitution.", json_schema_extra=NUMBER)
    belt: float = Field(default=0.0, description=BELT, json_schema_extra=unit("m/s"))
    extras: dict[str, Any] = Field(default={}, description="Data of other tools.")


class FlatOutline(Description):
    """Particles along the rim of a body, counter-clockwise about what is solid; or along a rope."""

    particles: Indices = Field(description="By index, in order.")
    closed: bool = Field(description="Whether the last is joined to the first.")


class FlatBody(Description):
    """A body of the level."""

    id: str = Field(description="Its name.")
    type: str = Field(description="Kind of body.")
    material: str = Field(description="Name of its material.")
    outlines: tuple[FlatOutline, ...] = Field(default=(), description="Its rim, and those of holes.")
    look: BodyLook | None = Field(default=None, description="How it looks; null = automatic.")
    extras: dict[str, Any] = Field(default={}, description="Data of other tools.")


class FlatMaterial(Description):
    """A material; null = never."""

    tension_limit: float | None = Field(default=None, description="Strain that breaks it.", json_schema_extra=NUMBER)
    compression_limit: float | None = Field(
        default=None, description="Strain that breaks it, squeezed, above 0.", json_schema_extra=NUMBER
    )
    yield_strain: float | None = Field(
        default=None, description="Strain beyond which its rest length follows.", json_schema_extra=NUMBER
    )
    yield_limit: float = Field(default=0.25, description="At most by this share.", json_schema_extra=NUMBER)
    look: BodyLook | None = Field(default=None, description="How it looks; null = automatic.")


class FlatMuscle(Description):
    """A spring whose rest length follows a wave of two parabolas a period."""

    spring: int = Field(description="By index.")
    amplitude: float = Field(description="Share of the rest length.", json_schema_extra=NUMBER)
    period: int = Field(description="From one swing to the next.", json_schema_extra=unit("tick"))
    phase: float = Field(description="Part of a period that it is ahead.", json_schema_extra=NUMBER)
    force: float | None = Field(default=None, description="Largest force; null = any.", json_schema_extra=unit("N"))


class FlatHydraulic(Description):
    """A spring whose rest length goes from one length to another while it is driven."""

    spring: int = Field(description="By index.")
    shortest: float = Field(description="Least rest length.", json_schema_extra=METRES)
    longest: float = Field(description="Largest rest length.", json_schema_extra=METRES)
    rate: float = Field(description="How fast it grows at a value of 1.", json_schema_extra=unit("m/s"))
    value: float = Field(description="How it is driven at the start, -1..1.", json_schema_extra=NUMBER)
    force: float | None = Field(default=None, description="Largest force; null = any.", json_schema_extra=unit("N"))
    returns: bool = Field(
        default=False, description="Whether it goes back to the length where it began, as fast, while its value is 0."
    )


class FlatMotor(Description):
    """A motor, which turns particles about a hub."""

    hub: int = Field(description="By index.")
    rim: Indices = Field(description="By index.")
    speed: float = Field(description="At a value of 1, anticlockwise.", json_schema_extra=unit("rad/s"))
    torque: float = Field(description="Largest torque.", json_schema_extra=unit("N m"))
    value: float = Field(description="How it is driven at the start, -1..1.", json_schema_extra=NUMBER)


class FlatLevel(Description):
    """A level expanded to particles and springs. Units are SI, y points up."""

    format: Literal["spring-sandbox/flat"] = Field(description="Says that this is a flat level.")
    version: Literal[1] = Field(description="Version of the format.")
    name: str = Field(description="Title of the level.")
    rate: int = Field(description="Ticks in a second, of which Cs and Cd are.", json_schema_extra=unit("1/s"))
    steps: int = Field(description="Steps of a tick with which forces of k and c can be added one by one.")
    solver: str = Field(description="The level's solver, for which Cs and Cd hold.")
    substeps: int | Literal["auto"] = Field(description="Its substeps of a tick.")
    gravity: Place = Field(description="Gravity.", json_schema_extra=unit("m/s^2"))
    wind: Place = Field(default=(0.0, 0.0), description="Velocity of the air.", json_schema_extra=unit("m/s"))
    drag: float = Field(default=0.0, description="Rate at which all takes it on.", json_schema_extra=unit("1/s"))
    contacts: bool = Field(description="Whether anything touches anything.")
    view: tuple[float, float, float, float] | None = Field(
        default=None, description="Left, bottom, right, top; null = everything.", json_schema_extra=METRES
    )
    look: LevelLook | None = Field(default=None, description="How it looks; null = automatic.")
    extras: dict[str, Any] = Field(default={}, description="Data of other tools.")
    materials: dict[str, FlatMaterial] = Field(description="Materials by name.")
    surfaces: tuple[FlatSurface, ...] = Field(description="Surfaces.")
    bodies: tuple[FlatBody, ...] = Field(description="Bodies.")
    particles: tuple[FlatParticle, ...] = Field(description="Particles.")
    springs: tuple[FlatSpring, ...] = Field(description="Springs.")
    areas: tuple[FlatArea, ...] = Field(default=(), description="Areas that are kept.")
    bends: tuple[FlatBend, ...] = Field(default=(), description="Angles that are kept.")
    terrain: tuple[FlatTerrain, ...] = Field(default=(), description="Terrain, and walls last.")
    muscles: tuple[FlatMuscle, ...] = Field(default=(), description="Muscles.")
    hydraulics: tuple[FlatHydraulic, ...] = Field(default=(), description="Hydraulics.")
    motors: tuple[FlatMotor, ...] = Field(default=(), description="Motors.")


def flat_schema() -> dict[str, Any]:
    """JSON Schema (2020-12) of a flat level; `unit` on a property is its unit."""
    title = "Spring Sandbox flat level"
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **FlatLevel.model_json_schema(), "title": title}


def flat(level: Level) -> FlatLevel:
    """The level as it begins, expanded. Raises LevelError for one that is not sound."""
    world = build_world(level)
    settings, count = level.settings, world.grab_particle if world.grab_particle >= 0 else world.particle_count
    steps, springs = _flat_springs(world, level)
    surfaces, surface_of = _surfaces(world, count)
    materials = {DEFAULT_MATERIAL: NissenMaterial(), **level.materials}
    return FlatLevel(
        format="spring-sandbox/flat", version=1, name=level.name, rate=settings.tick_rate, steps=steps,
        solver=settings.solver, substeps=settings.substeps, gravity=_pair(settings.gravity),
        wind=_pair(settings.wind), drag=settings.drag + 0.0, contacts=level.has_contacts, view=level.view,
        look=level.look, extras=level.extras,
        materials={
            name: FlatMaterial(**{field: getattr(each, field) for field in FlatMaterial.model_fields})
            for name, each in materials.items()
        },
        surfaces=surfaces,
        bodies=tuple(
            FlatBody(
                id=body.id, type=body.type, material=body.material, outlines=_outlines_of(world, body), look=body.look,
                extras=body.extras,
            )
            for body in level.bodies
        ),
        particles=tuple(_particle(world, level, slot, surface_of[slot]) for slot in range(count)),
        springs=springs, areas=tuple(_areas(world)), bends=tuple(_bends(world)), terrain=tuple(_terrain(level)),
        **_drives(world),
    )  # fmt: skip


def _surfaces(world: World, count: int) -> tuple[tuple[FlatSurface, ...], list[int]]:
    """The surfaces that there are, and which of them each particle has."""
    # Numbered without gaps: other engines have bits for 32 of them.
    used = sorted({TERRAIN_GROUP, *world.group[:count].tolist()} - {0})
    found: dict[FlatSurface, int] = {}
    numbers = []
    columns = (world.friction, world.restitution, world.group, world.collides)
    for friction, restitution, group, collides in zip(*(each[:count].tolist() for each in columns), strict=True):
        touched = tuple(number for number, bit in enumerate(used) if bit & collides)
        number = used.index(group) if group else 0
        touch = friction + 0.0, restitution + 0.0
        surface = FlatSurface(friction=touch[0], restitution=touch[1], group=number, touches=touched)
        numbers.append(found.setdefault(surface, len(found)))
    return tuple(found), numbers


def _particle(world: World, level: Level, slot: int, surface: int) -> FlatParticle:
    owner = int(world.owner[slot])
    loose: ParticleDef | None = level.particles[owner - len(level.bodies)] if owner >= len(level.bodies) else None
    return FlatParticle(
        name=world.particle_names[slot], position=_pair(world.position[slot]), velocity=_pair(world.velocity[slot]),
        mass=float(world.mass[slot]), radius=float(world.radius[slot]), pinned=bool(world.inverse_mass[slot] == 0.0),
        body=None if loose is not None else owner, surface=surface, gravity_scale=float(world.gravity_scale[slot]),
        spin=float(world.spin[slot]), look=None if loose is None else loose.look,
        extras={} if loose is None else loose.extras,
    )  # fmt: skip


def _flat_springs(world: World, level: Level) -> tuple[int, tuple[FlatSpring, ...]]:
    """Steps of a tick with which k and c can be added, and the springs of a level in the order of their slots."""
    count = world.grab_spring if world.grab_spring >= 0 else world.spring_count
    k, c = _constants(world, count)
    tick, reduced = 1.0 / world.settings.tick_rate, reduced_masses(world)[:count]
    strength = np.divide(k * tick * tick, reduced, out=np.zeros(count), where=reduced > 0.0)
    steps = np.floor(np.sqrt(strength * effective_count(world)[:count] / BOUND)).astype(np.int64) + 1
    nissen = world.law[:count] != LAW_HOOKE
    rods = nissen & ((steps > MOST_STEPS) | (world.damping[:count] > HIGHEST_COEFFICIENT))
    loose = {f":{number}": spring.extras for number, spring in enumerate(level.springs)}
    edges = world.edge[:count] != NO_EDGE if level.has_contacts else np.zeros(count, dtype=np.bool_)
    # That of a muscle is where its wave has put it already.
    lengths = world.rest_length[:count].copy()
    muscles = world.actuators.muscles.spring
    lengths[muscles] = world.natural_length[muscles]
    springs = tuple(
        FlatSpring(
            name=name, a=int(world.particle_a[slot]), b=int(world.particle_b[slot]), rest_length=float(lengths[slot]),
            Cs=float(world.stiffness[slot]) if nissen[slot] else None,
            Cd=float(world.damping[slot]) if nissen[slot] else None,
            # Logarithms differ in their last digits between machines; files do not.
            k=float(f"{k[slot]:.12g}"), c=float(f"{c[slot]:.12g}"), rod=bool(rods[slot]), edge=bool(edges[slot]),
            belt=float(world.belt[slot]), material=world.material_names[world.material[slot]],
            extras=loose.get(name, {}),
        )
        for slot, name in enumerate(world.spring_names[:count])
    )  # fmt: skip
    return int(steps[~rods].max(initial=1)), springs


def _constants(world: World, count: int) -> tuple[Floats, Floats]:
    """k [N/m] and c [N s/m] of the first this many springs (count,)."""
    modes = np.zeros(world.spring_count)
    for body in world.forms:
        if len(body.shape.mass) <= LARGEST_READ:
            modes[body.springs] = lowest_mode_of(body.shape)
    alone = effective_count(world) <= 1.0
    known: dict[tuple[float, ...], tuple[float, float]] = {}
    reduced, h = reduced_masses(world), substep_time(world.settings)
    k, c = world.hooke_stiffness[:count].copy(), world.hooke_damping[:count].copy()
    for slot in np.flatnonzero(world.law[:count] != LAW_HOOKE).tolist():
        single = bool(alone[slot])
        eigenvalue = float(modes[slot]) or (1.0 if single else SLOW)
        pair = float(world.stiffness[slot]), float(world.damping[slot])
        key = *pair, eigenvalue, float(world.lowest_mode[slot]), single
        if key not in known:
            known[key] = as_in_solver(world, slot, eigenvalue, single)
        restoring, decay = known[key]
        k[slot], c[slot] = restoring * reduced[slot] / (h * h), decay * reduced[slot] / h
    assert all(map(math.isfinite, (*k.tolist(), *c.tolist())))
    return k, c


def _outlines_of(world: World, body: BodyDef) -> tuple[FlatOutline, ...]:
    """The rims of a body of the world's level, with what is solid on the left; of a rope or a ring, its line.

    Nothing of a body whose springs are no rim, such as a truss.
    """
    made = expansion(body)
    pairs, edges = made.pairs, made.edges
    ways = np.concatenate([pairs[edges == SOLID_LEFT], pairs[edges == SOLID_RIGHT][:, ::-1]])
    found = list(directed_loops(ways.tolist()) if len(ways) else plain_lines(pairs.tolist()))
    slots = [world.particle_slot(f"{body.id}.{number}") for number in range(len(made.mass))]
    return tuple(
        FlatOutline(particles=tuple(slots[number] for number in numbers), closed=closed) for numbers, closed in found
    )


def _areas(world: World) -> Iterable[FlatArea]:
    for number in np.flatnonzero(world.constraint_active & (world.constraint_kind == AREA)).tolist():
        yield FlatArea(
            particles=tuple(_corners(world, number)), area=float(world.constraint_rest[number, 0]),
            Cs=float(world.constraint_stiffness[number]), Cd=float(world.constraint_damping[number]),
        )  # fmt: skip


def _bends(world: World) -> Iterable[FlatBend]:
    for number in np.flatnonzero(world.constraint_active & (world.constraint_kind != AREA)).tolist():
        a, middle, b = _corners(world, number)
        cosine, sine = _pair(world.constraint_rest[number])
        yield FlatBend(
            particles=(a, middle, b), cosine=cosine, sine=sine, Cs=float(world.constraint_stiffness[number]),
            Cd=float(world.constraint_damping[number]),
        )  # fmt: skip


def _corners(world: World, constraint: int) -> list[int]:
    first = world.constraint_first[constraint]
    corners: list[int] = world.corner_particle[first : first + world.constraint_corners[constraint]].tolist()
    return corners


def _terrain(level: Level) -> Iterable[FlatTerrain]:
    usual = level.contacts or ContactsDef()

    def surface(piece: Any) -> dict[str, Any]:
        return {
            name: (getattr(usual, name) if getattr(piece, name) is None else getattr(piece, name)) + 0.0
            for name in ("friction", "restitution")
        }

    for piece in level.terrain:
        kind: Literal["line", "solid"] = "line" if piece.polyline is not None else "solid"
        places = tuple(_pair(corner) for corner in piece.polyline or piece.polygon or ())
        yield FlatTerrain(
            id=piece.id, kind=kind, corners=places, **surface(piece), belt=piece.belt + 0.0, extras=piece.extras
        )
    if level.walls is not None:
        left, bottom, right, top = level.walls.box
        corners = ((left, bottom), (right, bottom), (right, top), (left, top))
        yield FlatTerrain(id="walls", kind="hollow", corners=corners, **surface(level.walls))


def _drives(world: World) -> dict[str, Any]:
    driven = world.actuators
    muscles, hydraulics, motors = driven.muscles, driven.hydraulics, driven.motors
    value = world.actuator_value
    return {
        "muscles": tuple(
            FlatMuscle(
                spring=int(muscles.spring[k]), amplitude=float(muscles.amplitude[k]), period=int(muscles.period[k]),
                phase=float(muscles.phase[k]), force=_force(muscles.force, k),
            )
            for k in range(len(muscles.spring))
        ),
        "hydraulics": tuple(
            FlatHydraulic(
                spring=int(hydraulics.spring[k]), shortest=float(hydraulics.shortest[k]),
                longest=float(hydraulics.longest[k]), rate=float(hydraulics.rate[k]),
                value=float(value[hydraulics.part[k]]), force=_force(hydraulics.force, k),
                returns=bool(hydraulics.returns[k]),
            )
            for k in range(len(hydraulics.spring))
        ),
        "motors": tuple(
            FlatMotor(
                hub=int(motors.hub[k]), rim=tuple(motors.rim[motors.rim_start[k] : motors.rim_start[k + 1]].tolist()),
                speed=float(motors.speed[k]), torque=float(motors.torque[k]), value=float(value[motors.part[k]]),
            )
            for k in range(len(motors.hub))
        ),
    }  # fmt: skip


def _force(forces: Floats, number: int) -> float | None:
    return float(forces[number]) if len(forces) and np.isfinite(forces[number]) else None


def _pair(values: Any) -> tuple[float, float]:
    # Adding 0.0 turns -0.0, which means nothing here, into 0.0.
    x, y = values
    return float(x) + 0.0, float(y) + 0.0


def flat_text(level: FlatLevel) -> str:
    """A flat level as the text of its file: defaults left out, an item a line, numbers with all their digits."""
    data = level.model_dump(mode="json", exclude_defaults=True)
    lines = [
        f"  {json.dumps(key)}: {_listed(value) if key in LISTED and value else _line(value)}"
        for key, value in data.items()
    ]
    return "{\n" + ",\n".join(lines) + "\n}\n"


def _listed(value: Any) -> str:
    if isinstance(value, dict):
        items = [f"{_line(name)}: {_line(item)}" for name, item in value.items()]
        return "{\n    " + ",\n    ".join(items) + "\n  }"
    return "[\n    " + ",\n    ".join(map(_line, value)) + "\n  ]"


def _line(value: Any) -> str:
    return json.dumps(value, ensure_ascii=False, allow_nan=False)


def pymunk_program(level: FlatLevel) -> str:
    """The program; it needs pymunk and nothing of the sandbox, prints places, and has `run` for who imports it."""
    source = (shipped_folder("docs/examples/flat") / READER).read_text(encoding="utf-8")
    lines = "\n".join(f"    {line!r}" for line in flat_text(level).splitlines())
    assert NO_DATA in source and USAGE in source
    return source.replace(USAGE, OWN_USAGE).replace(NO_DATA, f"DATA = json.loads(\n{lines}\n)\n")
