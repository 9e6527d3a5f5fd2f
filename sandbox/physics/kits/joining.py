"""Joining: a kit is packed, the world gets rows for it, and the kernel appends it.

A kit is bodies as rows and nothing else. It is packed into whole numbers and numbers, column after column in the order
of SLOT_TABLE and NUMBER_TABLE: docs/kits.md has them all.
"""

import math
from collections.abc import Mapping
from dataclasses import astuple, fields, replace
from typing import Any, NamedTuple

import numpy as np

from sandbox.physics.arena import NO_ARENA
from sandbox.physics.arrays import Floats, Slots, empty
from sandbox.physics.breaking import MaterialLimits, StrainLimits, unlimited
from sandbox.physics.commands.command import DENIED
from sandbox.physics.commands.command_table import RefusedCommand
from sandbox.physics.constraints import AREA, BEND
from sandbox.physics.driving import Actuators, drives_of
from sandbox.physics.jit import bundle
from sandbox.physics.joints.joint_set import wheels_of
from sandbox.physics.keeping.arguments import FARTHEST
from sandbox.physics.keeping.growing import grow
from sandbox.physics.kits.kit_kernels import (
    BAD_PLACE,
    HEADER,
    MOST,
    NO_LIMIT_ROWS,
    NO_ROWS,
    NUMBER_COLUMNS,
    PART_NAMES,
    PARTICLES,
    SLOT_COLUMNS,
    TOO_MANY,
    Joinable,
    join,
)
from sandbox.physics.marks import ALL_GROUPS, LAW_HOOKE, SOLID_RIGHT
from sandbox.physics.state import BY_NAME, FINITE, NOT_NEGATIVE, ROLLING_RESISTANCE, SHARE, Family, Range
from sandbox.physics.water.displacers import HULL_NUMBERS, Water
from sandbox.physics.world import World

FAR = 2**53


class SlotColumn(NamedTuple):
    """A column of whole numbers: its part and name, the least and the most, or the part whose rows it counts.

    usual: of a row that says nothing; None: each row says it.
    """

    part: str
    name: str
    low: int
    high: int
    of: str = ""
    usual: int | None = None


class NumberColumn(NamedTuple):
    """A column of numbers: its part and name, its range, its unit, and what a row has that says nothing.

    usual: NaN = as placed, or as the world has it; None: each row says it.
    """

    part: str
    name: str
    within: Range
    unit: str
    usual: float | None = None


def _state(part: str, name: str, column: str, usual: float | None = None) -> NumberColumn:
    """A column with the range and the unit of one of the table of state."""
    found = BY_NAME[column]
    return NumberColumn(part, name, found.within or FINITE, found.unit, usual)


SLOT_TABLE = (
    SlotColumn("particles", "body", -FAR, FAR),
    SlotColumn("particles", "group", 0, ALL_GROUPS),
    SlotColumn("particles", "collides", 0, ALL_GROUPS),
    SlotColumn("particles", "pinned", 0, 1, usual=0),
    SlotColumn("particles", "rolls", 0, 1, usual=1),
    SlotColumn("springs", "a", -FAR, FAR),
    SlotColumn("springs", "b", -FAR, FAR),
    SlotColumn("springs", "law", 0, LAW_HOOKE, usual=0),
    SlotColumn("springs", "material", 0, 0, "materials", usual=0),
    SlotColumn("springs", "edge", 0, SOLID_RIGHT, usual=0),
    SlotColumn("constraints", "kind", AREA, BEND, usual=AREA),
    SlotColumn("constraints", "corners", 3, FAR, usual=3),
    SlotColumn("constraints", "material", -1, 0, "materials", usual=0),
    SlotColumn("corners", "particle", 0, 0, "particles"),
    SlotColumn("muscles", "spring", 0, 0, "springs"),
    SlotColumn("muscles", "period", 2, 1_000_000),
    SlotColumn("hydraulics", "spring", 0, 0, "springs"),
    SlotColumn("hydraulics", "part", 0, 0, "parts"),
    SlotColumn("hydraulics", "returns", 0, 1, usual=0),
    SlotColumn("motors", "hub", 0, 0, "particles"),
    SlotColumn("motors", "part", 0, 0, "parts"),
    SlotColumn("motors", "rim", 0, FAR),
    SlotColumn("rims", "particle", 0, 0, "particles"),
    SlotColumn("materials", "slot", 0, FAR),
    SlotColumn("hulls", "body", 0, 0, "bodies"),
    SlotColumn("hulls", "spring", 0, 0, "springs"),
    SlotColumn("hulls", "turned", 0, 1, usual=0),
    SlotColumn("free_wheels", "wheel", 0, 0, "bodies"),
    SlotColumn("free_wheels", "mount", 0, 0, "bodies"),
)
_LENGTH, _STRAIN, _FORCE = Range(0.0, 1e18), Range(0.0, math.inf), Range(0.0, math.inf, is_above=True)
NUMBER_TABLE = (
    _state("particles", "x", "position"),
    _state("particles", "y", "position"),
    _state("particles", "vx", "velocity", 0.0),
    _state("particles", "vy", "velocity", 0.0),
    _state("particles", "mass", "mass", 1.0),
    _state("particles", "radius", "radius", 0.05),
    _state("particles", "friction", "friction", 0.0),
    _state("particles", "restitution", "restitution", 0.0),
    _state("particles", "gravity_scale", "gravity_scale", 1.0),
    _state("particles", "rolling", "rolling", ROLLING_RESISTANCE),
    _state("particles", "angle", "angle", 0.0),
    _state("particles", "spin", "spin", 0.0),
    _state("springs", "rest_length", "rest_length", math.nan),
    _state("springs", "stiffness", "stiffness", 0.5),
    _state("springs", "damping", "damping", 0.9),
    _state("springs", "hooke_stiffness", "hooke_stiffness", 0.0),
    _state("springs", "hooke_damping", "hooke_damping", 0.0),
    _state("springs", "lowest_mode", "lowest_mode", 0.0),
    NumberColumn("springs", "belt", FINITE, "m/s", 0.0),
    NumberColumn("constraints", "area", FINITE, "m^2", math.nan),
    _state("constraints", "stiffness", "constraint_stiffness", 0.5),
    _state("constraints", "damping", "constraint_damping", 0.9),
    _state("constraints", "lowest_mode", "constraint_lowest_mode", 0.0),
    _state("corners", "x", "corner_form", math.nan),
    _state("corners", "y", "corner_form", math.nan),
    NumberColumn("parts", "value", Range(-1.0, 1.0), "1", 0.0),
    NumberColumn("muscles", "amplitude", Range(0.0, 0.9), "1"),
    NumberColumn("muscles", "phase", Range(0.0, 1.0), "1", 0.0),
    NumberColumn("muscles", "force", _FORCE, "N", math.inf),
    NumberColumn("hydraulics", "shortest", NOT_NEGATIVE, "m"),
    NumberColumn("hydraulics", "longest", NOT_NEGATIVE, "m"),
    NumberColumn("hydraulics", "rate", NOT_NEGATIVE, "m/s"),
    NumberColumn("hydraulics", "force", _FORCE, "N", math.inf),
    NumberColumn("motors", "speed", FINITE, "rad/s"),
    NumberColumn("motors", "torque", NOT_NEGATIVE, "N m"),
    NumberColumn("materials", "tension", _STRAIN, "1", math.nan),
    NumberColumn("materials", "compression", _STRAIN, "1", math.nan),
    NumberColumn("materials", "yielding", _STRAIN, "1", math.nan),
    NumberColumn("materials", "yield_share", SHARE, "1", math.nan),
)
# The tables as kernels take them: of a column of slots its part, the least, the most and the part that it counts, -1:
# none; of one of numbers its part; of numbers the lowest, the highest, and whether NaN may be.
SLOT_BOUNDS = np.array(
    [[PART_NAMES.index(c.part), c.low, c.high, PART_NAMES.index(c.of) if c.of else -1] for c in SLOT_TABLE], np.int64
)
assert (len(SLOT_TABLE), len(SLOT_TABLE) + len(NUMBER_TABLE)) == (SLOT_COLUMNS, NUMBER_COLUMNS)
TABLE: Slots = np.append(SLOT_BOUNDS.reshape(-1), [PART_NAMES.index(c.part) for c in NUMBER_TABLE]).astype(np.int64)
RANGES: Floats = np.array(
    [[c.within.lowest, c.within.high, c.usual is not None and math.isnan(c.usual)] for c in NUMBER_TABLE], np.float64
).reshape(-1)


# Why a kit cannot join; {} = what of it, and what is wrong.
NOT_A_TABLE, NOT_ROWS = "{}: a table of columns is needed", "{}: a list of {} rows is needed"
NOT_WHOLE, NOT_A_NUMBER = "{}: a whole number is needed", "{}: a number is needed"
UNKNOWN, MISSING = "{}: kits have no such thing", "{}: is missing; it has no default"
OUT_OF_RANGE, DOES_NOT_FIT = "{}: {} is not {}", "{}: {} does not fit"
NO_PARTICLE = "{}: there is no particle {}"
TOO_MUCH = "a world holds at most {:,} {}; this would make {:,}"
TOO_MANY_WHEELS = "there are too many wheels that do not touch their mounts"
NOUNS = {"muscles": "springs of limited force"}
# A number that is out of every range.
HUGE = 1e300
# Columns of ends, which may be particles of the world by their names, and of 64 bits, which JSON says as text.
ENDS, BITS = (("springs", "a"), ("springs", "b")), ("group", "collides")
_FAMILIES = {
    "particles": Family.PARTICLE, "springs": Family.SPRING, "constraints": Family.CONSTRAINT,
    "corners": Family.CORNER, "parts": Family.ACTUATOR,
}  # fmt: skip
Columns = Mapping[str, Any]
Counts = dict[str, int]


class KitError(ValueError):
    """A kit that cannot join, in a line."""


class Packed(NamedTuple):
    """A kit as the kernel takes it; how many rows each part has; the names of the world's materials from then on."""

    slots: Slots
    numbers: Floats
    counts: Counts
    material_names: tuple[str, ...]


def pack(world: World, kit: Columns, bodies: int, group_bits: int, most: Mapping[str, int]) -> Packed:
    """Pack the columns of a kit for a world at its present tick.

    A column is a list, or one value for all rows; None: as usual. Materials go by `name`, ends of springs in the world
    by theirs. group_bits: the largest bit of the groups of the world's level; most: of parts, that a world holds.
    Raises KitError.
    """
    stranger = next((name for name in kit if name not in PART_NAMES[PARTICLES:]), None)
    if stranger is not None:
        raise KitError(UNKNOWN.format(stranger))
    names = _material_names(kit.get("materials", {}))
    known = tuple(dict.fromkeys((*world.material_names, *names)))
    given = dict(kit) | {"materials": _table(kit, "materials") | {"slot": [known.index(name) for name in names]}}
    given["materials"].pop("name", None)
    counts = {name: rows_of(name, _table(given, name)) for name in PART_NAMES} | {"bodies": bodies}
    slots = [_slots(world, each, _column(given, each, counts)) for each in SLOT_TABLE]
    numbers = [_numbers(each, _column(given, each, counts)) for each in NUMBER_TABLE]
    limits = [most.get(name, FARTHEST) for name in PART_NAMES]
    header = [*counts.values(), *_in_use(world).values(), *limits, world.tick, world.grab_particle, group_bits]
    return Packed(np.concatenate([np.array(header, np.int64), *slots]), np.concatenate(numbers), counts, known)


def _in_use(world: World) -> Counts:
    """How many rows of each part a world has; of bodies the first free owner."""
    driven, owner = world.actuators, int(world.owner.max(initial=-1)) + 1
    rows = (
        owner, world.particle_count, world.spring_count, world.constraint_count, len(world.corner_particle),
        len(world.actuator_value), len(driven.muscles.spring), len(driven.hydraulics.spring), len(driven.motors.hub),
        len(driven.motors.rim), len(world.material_names), len(world.hulls), 0,
    )  # fmt: skip
    return dict(zip(PART_NAMES, rows, strict=True))


def _table(kit: Columns, part: str) -> dict[str, Any]:
    columns = kit.get(part, {})
    if not isinstance(columns, Mapping):
        raise KitError(NOT_A_TABLE.format(part))
    known = [each.name for each in (*SLOT_TABLE, *NUMBER_TABLE) if each.part == part] + ["name"] * (part == "materials")
    stranger = next((name for name in columns if name not in known), None)
    if stranger is not None:
        raise KitError(UNKNOWN.format(f"{part}.{stranger}"))
    return dict(columns)


def _material_names(columns: Any) -> list[str]:
    names = columns.get("name", []) if isinstance(columns, Mapping) else []
    if not _is_rows(names) or not all(isinstance(name, str) for name in names) or len(set(names)) != len(names):
        raise KitError(NOT_ROWS.format("materials.name", "different"))
    return list(names)


def _is_rows(column: Any) -> bool:
    return isinstance(column, list | tuple | np.ndarray)


def rows_of(part: str, columns: Any) -> int:
    """How many rows a part has: as many as its first column that is a list. Raises KitError."""
    if not isinstance(columns, Mapping):
        raise KitError(NOT_A_TABLE.format(part))
    count = next((len(column) for column in columns.values() if _is_rows(column)), 0)
    if count == 0 and any(not _is_rows(column) for column in columns.values()):
        raise KitError(NOT_ROWS.format(part, "some"))
    return count


def _column(kit: Columns, column: SlotColumn | NumberColumn, counts: Counts) -> Any:
    """Values of a column; usual ones where a kit has none."""
    place, count = f"{column.part}.{column.name}", counts[column.part]
    given: Any = kit.get(column.part, {}).get(column.name)
    if given is None:
        given = column.usual
    if given is None and count:
        raise KitError(MISSING.format(place))
    if not _is_rows(given):
        return [given] * count
    if len(given) != count:
        raise KitError(NOT_ROWS.format(place, count))
    return given if isinstance(given, np.ndarray) else [column.usual if each is None else each for each in given]


def _slots(world: World, column: SlotColumn, values: Any) -> Slots:
    if isinstance(values, np.ndarray) and values.dtype.kind in "bi":
        return values.astype(np.int64)
    found = []
    for k, value in enumerate(values):
        place = f"{column.part}.{column.name}.{k}"
        if isinstance(value, str) and (column.part, column.name) in ENDS:
            try:
                value = -1 - world.particle_slot(value)
            except KeyError:
                raise KitError(NO_PARTICLE.format(place, value[:60])) from None
        elif isinstance(value, str) and column.name in BITS and value.isascii() and value.isdigit():
            value = int(value[:20])
        if isinstance(value, float) and value.is_integer():
            value = int(value)
        if isinstance(value, bool) or not isinstance(value, int):
            raise KitError(NOT_WHOLE.format(place))
        found.append(max(-FARTHEST, min(value, FARTHEST)))
    return np.array(found, np.int64)


def _numbers(column: NumberColumn, values: Any) -> Floats:
    if isinstance(values, np.ndarray) and values.dtype.kind == "f":
        return values
    found = []
    for k, value in enumerate(values):
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise KitError(NOT_A_NUMBER.format(f"{column.part}.{column.name}.{k}"))
        # JSON may say a whole number that no float is as large as.
        found.append(math.inf if abs(value) > HUGE else float(value))
    return np.array(found, np.float64)


def join_kit(world: World, packed: Packed, giver: int, kind: int) -> None:
    """Add a packed kit to a world: rows, driven parts, limits and hulls, without names.

    giver, kind: who adds it by which command. Raises KitError and RefusedCommand.
    """
    check_kit(world, packed, giver, kind)
    counts = packed.counts
    for part, family in _FAMILIES.items():
        grow(world, family, counts[part], {})
    driven = _with_rows(world.actuators, counts)
    limits = world.limits
    if more := len(packed.material_names) - len(world.material_names):
        pairs = zip(astuple(limits), astuple(unlimited(more)), strict=True)
        limits = StrainLimits(*map(np.concatenate, pairs))
    world.hulls = np.concatenate([world.hulls, np.zeros((counts["hulls"], HULL_NUMBERS), np.int64)])
    if _call(driven, limits, world, packed, giver, kind) != 0:
        raise AssertionError("a kit that had no rows found none")
    world.actuators, world.limits, world.material_names = _settled(driven), limits, packed.material_names
    world.topology_version += 1


def check_kit(world: World, packed: Packed, giver: int, kind: int) -> None:
    """Raise KitError or RefusedCommand, if a packed kit could not join a world."""
    answer = _call(world.actuators, world.limits, world, packed, giver, kind)
    if answer <= -DENIED:
        raise RefusedCommand.of_denied(answer, "particle", -answer % DENIED)
    if answer not in (0, NO_ROWS, NO_LIMIT_ROWS):
        raise KitError(_words(world, packed, answer))


def _call(
    actuators: Actuators, limits: StrainLimits, world: World, packed: Packed, giver: int, kind: int
) -> int:  # fmt: skip
    count = world.spring_count
    of_materials = MaterialLimits(
        limits.tension, limits.compression, limits.yielding, limits.yield_share, np.zeros(count, np.bool_),
        np.zeros(count, np.int64),
    )  # fmt: skip
    pointer = bundle(
        Joinable(
            world.commanded, drives_of(actuators), wheels_of(actuators), of_materials,
            empty(Water)._replace(pool=world.water, hull=world.hulls),
        )
    )  # fmt: skip
    arena = np.zeros(1, np.int64)
    while (answer := join(pointer, arena, giver, kind, TABLE, RANGES, *packed[:2])) == NO_ARENA:
        arena = np.zeros(int(arena[0]), np.int64)
    return answer


def _with_rows(present: Actuators, counts: Counts) -> Actuators:
    """Driven parts with rows for those of a kit, which the kernel fills in."""

    def longer(part: Any, count: int, **others: Any) -> Any:
        arrays = {each.name: getattr(part, each.name) for each in fields(part)} | others
        grown = {name: np.concatenate([array, np.zeros(count, array.dtype)]) for name, array in arrays.items()}
        return replace(part, **grown)

    drives, motors = drives_of(present), present.motors
    return Actuators(
        present.names,
        longer(present.muscles, counts["muscles"], force=drives.muscle_force),
        longer(present.hydraulics, counts["hydraulics"], force=drives.hydraulic_force),
        replace(longer(motors, counts["motors"]), rim=np.concatenate([motors.rim, np.zeros(counts["rims"], np.int64)])),
    )


def _settled(driven: Actuators) -> Actuators:
    """Driven parts without forces where none is limited."""
    muscles, hydraulics = driven.muscles, driven.hydraulics
    none: Floats = np.zeros(0)
    return replace(
        driven,
        muscles=muscles if np.isfinite(muscles.force).any() else replace(muscles, force=none),
        hydraulics=hydraulics if np.isfinite(hydraulics.force).any() else replace(hydraulics, force=none),
    )


def _words(world: World, packed: Packed, answer: int) -> str:
    """Why a kit cannot join, by the kernel's answer."""
    if answer > BAD_PLACE:
        part = PART_NAMES[TOO_MANY - answer]
        if part == "free_wheels":
            return TOO_MANY_WHEELS
        noun, most = NOUNS.get(part, part), packed.slots[MOST + TOO_MANY - answer]
        return TOO_MUCH.format(most - (part == "materials"), noun, _would_be(world, packed, part))
    place = BAD_PLACE - answer
    if place < HEADER:
        return DOES_NOT_FIT.format(PART_NAMES[place], packed.counts[PART_NAMES[place]])
    value: float = packed.slots[place] if place < len(packed.slots) else packed.numbers[place - len(packed.slots)]
    place -= HEADER
    columns: tuple[SlotColumn | NumberColumn, ...] = (*SLOT_TABLE, *NUMBER_TABLE)
    for column in columns:
        if place < packed.counts[column.part]:
            break
        place -= packed.counts[column.part]
    where = f"{column.part}.{column.name}.{place}"
    within = column.within if isinstance(column, NumberColumn) else Range(column.low, column.high)
    if within.lowest <= value <= within.high or (isinstance(column, SlotColumn) and column.of):
        return DOES_NOT_FIT.format(where, f"{value:g}")
    return OUT_OF_RANGE.format(where, f"{value:g}", within)


def _would_be(world: World, packed: Packed, part: str) -> int:
    if part == "materials":
        return len(packed.material_names) - 1
    if part != "muscles":
        return _in_use(world)[part] + packed.counts[part]
    drives = drives_of(world.actuators)
    forces = [drives.muscle_force, drives.hydraulic_force]
    at = len(packed.numbers)
    for column in reversed(NUMBER_TABLE):
        count = packed.counts[column.part]
        if column.name == "force":
            forces.append(packed.numbers[at - count : at])
        at -= count
    return sum(int(np.isfinite(each).sum()) for each in forces)
