"""Kits: bodies as rows, with their names and forms, that join a running world; see docs/kits.md."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from sandbox.level.assembly.build_world import JoinedLevel, LevelWorld
from sandbox.level.document.model import Level
from sandbox.level.format.limits import (
    MATERIAL_LIMIT,
    MOTOR_LIMIT,
    PARTICLE_LIMIT,
    SPRING_LIMIT,
    most_limited,
)
from sandbox.level.plan.surfaces import group_bits
from sandbox.physics.commands.command import ADD_BODY, PROGRAM
from sandbox.physics.constraints import AREA
from sandbox.physics.driving import drives_of
from sandbox.physics.keeping.equipment import FirmBody
from sandbox.physics.kits.joining import Packed, join_kit, pack, rows_of
from sandbox.physics.kits.kit_kernels import COUNTED
from sandbox.physics.world import World


class KitNames(NamedTuple):
    """Names of a kit's rows: body and text of each particle and spring, and of second names with their particles.

    The text of a spring of no body, -1, is not used. parts: the body of each driven part, or -1 - the number of the
    spring of no body that it is.
    """

    particles: tuple[tuple[int, str], ...]
    springs: tuple[tuple[int, str], ...]
    second: tuple[tuple[int, str, int], ...]
    parts: tuple[int, ...]


class Kit(NamedTuple):
    """Bodies as rows: how many they are, columns by part, names, areas and forms of bodies in the kit's own slots.

    areas: body, and constraints; forms: body, and its form. level: the one of which they are drawn, and definition:
    what a command said of them.
    """

    bodies: int
    columns: Mapping[str, Mapping[str, Any]]
    names: KitNames
    areas: tuple[tuple[int, range], ...]
    forms: tuple[tuple[int, FirmBody], ...]
    level: Level
    definition: Mapping[str, Any]


def join(world: LevelWorld, kit: Kit, giver: int = PROGRAM) -> None:
    """Add a kit to a world at its present tick. Raises KitError and Refused, and changes nothing then."""
    packed = packed_for(world, kit)
    first = dict(zip(packed.counts, packed.slots[COUNTED : 2 * COUNTED].tolist(), strict=True))
    bodies, particle_names, spring_names, part_names = _world_names(world, kit.names, kit.bodies)
    join_kit(world, packed, giver, ADD_BODY)
    world.actuators = replace(world.actuators, names=(*world.actuators.names, *part_names))
    second = tuple((f"{bodies[body]}.{text}", slot + first["particles"]) for body, text, slot in kit.names.second)
    joined = JoinedLevel(
        kit.definition, bodies, first["particles"], first["springs"], first["parts"], particle_names, spring_names,
        second, kit.level,
    )  # fmt: skip
    world.name_slots(joined.particle_names, joined.spring_names)
    for name, slot in second:
        world.name_particle(slot, name)
    constraint = first["constraints"]
    world.area_names += tuple(bodies[body] for body, _ in kit.areas)
    world.area_constraints += tuple(range(each.start + constraint, each.stop + constraint) for _, each in kit.areas)
    world.forms += tuple(
        FirmBody(bodies[body], form.shape, form.springs + first["springs"], form.constraints + constraint)
        for body, form in kit.forms
    )
    world.joined += (joined,)


def join_loose(world: LevelWorld, columns: Mapping[str, Mapping[str, Any]], giver: int, kind: int) -> None:
    """Add particles and springs of no body, by that kind of command. Raises KitError and Refused."""
    packed = _packed(world, columns, 0, rows_of("particles", columns.get("particles", {})))
    particles = world.particle_naming.unused("+.", packed.counts["particles"])
    springs = world.spring_naming.unused("+:", packed.counts["springs"])
    join_kit(world, packed, giver, kind)
    world.name_slots(particles, springs)


def packed_for(world: LevelWorld, kit: Kit) -> Packed:
    """A kit as the kernel takes it, for a world at its present tick. Raises KitError."""
    return _packed(world, kit.columns, kit.bodies, len(kit.names.particles))


def _packed(world: LevelWorld, columns: Mapping[str, Mapping[str, Any]], bodies: int, added: int) -> Packed:
    particles = world.particle_count + added
    most = {
        "particles": PARTICLE_LIMIT, "springs": SPRING_LIMIT, "motors": MOTOR_LIMIT, "materials": MATERIAL_LIMIT + 1,
        "muscles": most_limited(particles),
    }  # fmt: skip
    return pack(world, columns, bodies, max(group_bits(world.level).values()), most)


def _world_names(
    world: World, names: KitNames, count: int
) -> tuple[tuple[str, ...], tuple[str, ...], tuple[str, ...], tuple[str, ...]]:
    """The world's names of the bodies of a kit, its particles, springs and driven parts."""
    first = sum(len(joined.names) for joined in world.joined) + 1
    bodies = tuple(f"+{number}" for number in range(first, first + count))
    free = world.spring_naming.unused("+:", sum(body < 0 for body, _ in names.springs))
    parts = tuple(bodies[part] if part >= 0 else free[-1 - part] for part in names.parts)
    loose = world.particle_naming.unused("+.", sum(body < 0 for body, _ in names.particles))
    return bodies, _row_names(names.particles, bodies, ".", loose), _row_names(names.springs, bodies, ":", free), parts


def _row_names(
    rows: Iterable[tuple[int, str]], bodies: Sequence[str], mark: str, loose: Iterable[str]
) -> tuple[str, ...]:
    """The names of rows of bodies, and loose ones, in order, of those of no body."""
    free = iter(loose)
    return tuple(f"{bodies[body]}{mark}{text}" if body >= 0 else next(free) for body, text in rows)


def columns_of(built: World, particles: Mapping[str, Any], free: Iterable[tuple[int, Iterable[int]]]) -> dict[str, Any]:
    """The columns of all in a built world but its hands, as arrays.

    particles: further columns of those; free: wheels that pass through their mounts, by the numbers of their bodies.
    """
    n, m = built.grab_particle, built.grab_spring
    drives, motors, limits = drives_of(built.actuators), built.actuators.motors, built.limits
    rows = [(wheel, mount) for wheel, mounts in free for mount in sorted(mounts)]
    wheels, mounts = np.array(rows, np.int64).reshape(-1, 2).T
    names = ("friction", "restitution", "gravity_scale", "rolling", "angle", "spin", "mass", "radius", "rolls")
    x, y = built.position[:n].T
    vx, vy = built.velocity[:n].T
    (form_x, form_y), rest = built.corner_form.T, built.constraint_rest
    rest = np.where((built.constraint_kind == AREA)[:, None], rest, np.nan)
    kinds = (
        "stiffness",
        "damping",
        "hooke_stiffness",
        "hooke_damping",
        "lowest_mode",
        "belt",
        "law",
        "edge",
        "material",
    )
    return {
        "particles": {name: getattr(built, name)[:n] for name in names}
        | {"x": x, "y": y, "vx": vx, "vy": vy, "pinned": built.inverse_mass[:n] == 0.0, "body": built.owner[:n]}
        | dict(particles),
        "springs": {name: getattr(built, name)[:m] for name in kinds}
        | {"a": built.particle_a[:m], "b": built.particle_b[:m], "rest_length": built.natural_length[:m]},
        "constraints": {
            "kind": built.constraint_kind, "corners": built.constraint_corners, "material": built.constraint_material,
            "area": np.where(rest[:, 0] == rest[:, 1], np.nan, rest[:, 0]), "stiffness": built.constraint_stiffness,
            "damping": built.constraint_damping, "lowest_mode": built.constraint_lowest_mode,
        },
        "corners": {"particle": built.corner_particle, "x": form_x, "y": form_y},
        "parts": {"value": built.actuator_value},
        "muscles": {
            "spring": drives.muscle, "period": drives.period, "amplitude": drives.amplitude, "phase": drives.phase,
            "force": drives.muscle_force,
        },
        "hydraulics": {
            "spring": drives.hydraulic, "part": drives.part, "returns": drives.returns, "shortest": drives.shortest,
            "longest": drives.longest, "rate": drives.rate, "force": drives.hydraulic_force,
        },
        "motors": {
            "hub": motors.hub, "part": motors.part, "rim": np.diff(motors.rim_start), "speed": motors.speed,
            "torque": motors.torque,
        },
        "rims": {"particle": motors.rim},
        "materials": {
            "name": list(built.material_names), "tension": limits.tension, "compression": limits.compression,
            "yielding": limits.yielding, "yield_share": limits.yield_share,
        },
        "hulls": dict(zip(("body", "spring", "turned"), built.hulls.T, strict=True)),
        "free_wheels": {"wheel": wheels, "mount": mounts},
    }  # fmt: skip
