"""flat(level): a level as FlatLevel, and its text."""

import json
from collections.abc import Iterable
from typing import Any, Literal

import numpy as np

from sandbox.export.flat_model import (
    FlatArea,
    FlatBend,
    FlatBody,
    FlatHydraulic,
    FlatLevel,
    FlatMaterial,
    FlatMotor,
    FlatMuscle,
    FlatParticle,
    FlatSurface,
    FlatTerrain,
)
from sandbox.export.flat_springs import flat_springs
from sandbox.export.outlines import outlines_of
from sandbox.level.assembly.build_world import build_world
from sandbox.level.document.model import ContactsDef, Level, NissenMaterial, ParticleDef
from sandbox.level.format.limits import DEFAULT_MATERIAL
from sandbox.physics.arrays import Floats
from sandbox.physics.collision.filter import TERRAIN_GROUP
from sandbox.physics.constraints import AREA
from sandbox.physics.world import World

# Keys of the text whose items go one to a line.
LISTED = (
    "materials", "surfaces", "bodies", "particles", "springs", "areas", "bends", "terrain", "muscles", "hydraulics",
    "motors",
)  # fmt: skip


def flat(level: Level) -> FlatLevel:
    """The level as it begins, expanded. Raises LevelError for one that is not sound."""
    world = build_world(level)
    settings, count = level.settings, _particle_count(world)
    steps, springs = flat_springs(world, level)
    surfaces, surface_of = _surfaces(world, count)
    materials = {DEFAULT_MATERIAL: NissenMaterial(), **level.materials}
    return FlatLevel(
        format="spring-sandbox/flat",
        version=1,
        name=level.name,
        rate=settings.tick_rate,
        steps=steps,
        solver=settings.solver,
        substeps=settings.substeps,
        gravity=_pair(settings.gravity),
        wind=_pair(settings.wind),
        drag=settings.drag + 0.0,
        contacts=level.has_contacts,
        view=level.view,
        look=level.look,
        extras=level.extras,
        materials={
            name: FlatMaterial(**{field: getattr(each, field) for field in FlatMaterial.model_fields})
            for name, each in materials.items()
        },
        surfaces=surfaces,
        bodies=tuple(
            FlatBody(
                id=body.id, type=body.type, material=body.material, outlines=outlines_of(world, body), look=body.look,
                extras=body.extras,
            )
            for body in level.bodies
        ),
        particles=tuple(_particle(world, level, slot, surface_of[slot]) for slot in range(count)),
        springs=springs,
        areas=tuple(_areas(world)),
        bends=tuple(_bends(world)),
        terrain=tuple(_terrain(level)),
        **_drives(world),
    )  # fmt: skip


def flat_text(level: FlatLevel) -> str:
    """A flat level as the text of its file: defaults left out, an item a line, numbers with all their digits."""
    data = level.model_dump(mode="json", exclude_defaults=True)
    lines = []
    for key, value in data.items():
        if key in LISTED and value:
            lines.append(f"  {json.dumps(key)}: {_listed(value)}")
        else:
            lines.append(f"  {json.dumps(key)}: {_line(value)}")
    return "{\n" + ",\n".join(lines) + "\n}\n"


def _listed(value: Any) -> str:
    if isinstance(value, dict):
        items = [f"{_line(name)}: {_line(item)}" for name, item in value.items()]
        return "{\n    " + ",\n    ".join(items) + "\n  }"
    return "[\n    " + ",\n    ".join(map(_line, value)) + "\n  ]"


def _line(value: Any) -> str:
    return json.dumps(value, ensure_ascii=False, allow_nan=False)


def _pair(values: Any) -> tuple[float, float]:
    # Adding 0.0 turns -0.0, which means nothing here, into 0.0.
    x, y = values
    return float(x) + 0.0, float(y) + 0.0


def _particle_count(world: World) -> int:
    return world.grab_particle if world.grab_particle >= 0 else world.particle_count


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
        name=world.particle_names[slot],
        position=_pair(world.position[slot]),
        velocity=_pair(world.velocity[slot]),
        mass=float(world.mass[slot]),
        radius=float(world.radius[slot]),
        pinned=bool(world.inverse_mass[slot] == 0.0),
        body=None if loose is not None else owner,
        surface=surface,
        gravity_scale=float(world.gravity_scale[slot]),
        spin=float(world.spin[slot]),
        look=None if loose is None else loose.look,
        extras={} if loose is None else loose.extras,
    )


def _corners(world: World, constraint: int) -> list[int]:
    first = world.constraint_first[constraint]
    corners: list[int] = world.corner_particle[first : first + world.constraint_corners[constraint]].tolist()
    return corners


def _areas(world: World) -> Iterable[FlatArea]:
    for number in np.flatnonzero(world.constraint_active & (world.constraint_kind == AREA)).tolist():
        yield FlatArea(
            particles=tuple(_corners(world, number)),
            area=float(world.constraint_rest[number, 0]),
            Cs=float(world.constraint_stiffness[number]),
            Cd=float(world.constraint_damping[number]),
        )


def _bends(world: World) -> Iterable[FlatBend]:
    for number in np.flatnonzero(world.constraint_active & (world.constraint_kind != AREA)).tolist():
        a, middle, b = _corners(world, number)
        cosine, sine = _pair(world.constraint_rest[number])
        yield FlatBend(
            particles=(a, middle, b),
            cosine=cosine,
            sine=sine,
            Cs=float(world.constraint_stiffness[number]),
            Cd=float(world.constraint_damping[number]),
        )


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
