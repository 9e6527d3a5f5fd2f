"""Kits: the tables of their columns, by which they are packed, and what is wrong with a packed one.

A kit is bodies as rows and nothing else. It is packed into whole numbers and numbers, column after column in the order
of SLOT_TABLE and NUMBER_TABLE: docs/kits.md has them all.
"""

import math
from typing import Annotated, NamedTuple

import numpy as np

from sandbox.physics.arrays import Flags, Floats, Slots
from sandbox.physics.breaking import MaterialLimits
from sandbox.physics.commands.changes import is_body
from sandbox.physics.constraints import AREA, BEND
from sandbox.physics.driving import Drives
from sandbox.physics.jit import inner_kernel
from sandbox.physics.joints.joint_set import DrivenWheels
from sandbox.physics.marks import ALL_GROUPS, LAW_HOOKE, SOLID_RIGHT, TERRAIN_GROUP
from sandbox.physics.state import BY_NAME, FINITE, NOT_NEGATIVE, ROLLING_RESISTANCE, SHARE, Range, State
from sandbox.physics.water.displacers import Water

# The parts of a kit. `bodies` has no columns, but a name each; `free_wheels`: wheels that pass through their mounts.
PART_NAMES = (
    "bodies", "particles", "springs", "constraints", "corners", "parts", "muscles", "hydraulics", "motors", "rims",
    "materials", "hulls", "free_wheels",
)  # fmt: skip
BODIES, PARTICLES, SPRINGS, CONSTRAINTS, CORNERS, PARTS, MUSCLES, HYDRAULICS, MOTORS, RIMS, MATERIALS, HULLS, FREE = (
    range(len(PART_NAMES))
)
COUNTED = len(PART_NAMES)
# What comes first of a packed kit's whole numbers: how many rows each part has; how many of its kind are in use in the
# world, for bodies the first free owner; how many a world holds at most, of muscles and hydraulics together those of
# limited force; the tick; the first particle of hands; the largest bit of the level's groups; then the columns.
MOST = 2 * COUNTED
TICK, FIRST_CURSOR, LEVEL_GROUPS, HEADER = range(3 * COUNTED, 3 * COUNTED + 4)
# Answers of `join` but for 0: there are too few rows for it, and limits of materials need rows as well; the world would
# have too many of the k-th part, TOO_MANY - k; the k-th of whole numbers and numbers, counted through, is out of its
# range, BAD_PLACE - k. Nothing was changed.
NO_ROWS, NO_LIMIT_ROWS, TOO_MANY, BAD_PLACE = -2, -3, -10, -100
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
(
    BODY, GROUP, COLLIDES, PINNED, ROLLS, END_A, END_B, LAW, MATERIAL, EDGE, KIND, SIZE, OF_MATERIAL, CORNER, MUSCLE,
    PERIOD, HYDRAULIC, MOVED_PART, RETURNS, HUB, TURNED_PART, RIM_SIZE, RIM, MATERIAL_SLOT, HULL_BODY, HULL_SPRING,
    HULL_TURNED, WHEEL, MOUNT, SLOT_COLUMNS,
) = range(len(SLOT_TABLE) + 1)  # fmt: skip
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
(
    X, Y, VX, VY, MASS, RADIUS, FRICTION, RESTITUTION, GRAVITY_SCALE, ROLLING, ANGLE, SPIN, REST, STIFFNESS, DAMPING,
    HOOKE_STIFFNESS, HOOKE_DAMPING, LOWEST_MODE, BELT, KEPT_AREA, OF_STIFFNESS, OF_DAMPING, OF_MODE, FORM_X, FORM_Y,
    VALUE, AMPLITUDE, PHASE, MUSCLE_FORCE, SHORTEST, LONGEST, RATE, FORCE, SPEED, TORQUE, TENSION, COMPRESSION,
    YIELDING, YIELD_SHARE, NUMBER_COLUMNS,
) = range(SLOT_COLUMNS, SLOT_COLUMNS + len(NUMBER_TABLE) + 1)  # fmt: skip
# The tables as kernels take them: of a column of slots its part, the least, the most and the part that it counts, -1:
# none; of one of numbers its part; of numbers the lowest, the highest, and whether NaN may be.
SLOT_BOUNDS = np.array(
    [[PART_NAMES.index(c.part), c.low, c.high, PART_NAMES.index(c.of) if c.of else -1] for c in SLOT_TABLE], np.int64
)
TABLE: Slots = np.append(SLOT_BOUNDS.reshape(-1), [PART_NAMES.index(c.part) for c in NUMBER_TABLE]).astype(np.int64)
RANGES: Floats = np.array(
    [[c.within.lowest, c.within.high, c.usual is not None and math.isnan(c.usual)] for c in NUMBER_TABLE], np.float64
).reshape(-1)


class KitScratch(NamedTuple):
    """Scratch: where each column begins; slots of both ends of springs; by particle and spring, who was there last."""

    at: Annotated[Slots, "columns"]
    a: Annotated[Slots, "springs"]
    b: Annotated[Slots, "springs"]
    seen: Annotated[Slots, "particles"]
    is_driven: Annotated[Flags, "springs"]


@inner_kernel
def find_columns(table: Slots, slots: Slots, at: Slots) -> None:
    """Find where each column begins; numbers are counted behind the whole numbers."""
    place = HEADER
    for c in range(NUMBER_COLUMNS):
        part = table[4 * c] if c < SLOT_COLUMNS else table[4 * SLOT_COLUMNS + c - SLOT_COLUMNS]
        if c == SLOT_COLUMNS:
            place = 0
        at[c] = place
        place += slots[part]


@inner_kernel
def first_out_of_range(table: Slots, ranges: Floats, slots: Slots, numbers: Floats, at: Slots) -> int:
    """The place of the first of slots and numbers, counted through, that is out of its column's range; -1: none."""
    for c in range(SLOT_COLUMNS):
        part, low, high = table[4 * c], table[4 * c + 1], table[4 * c + 2]
        if table[4 * c + 3] >= 0:
            high = slots[table[4 * c + 3]] - 1
        for k in range(at[c], at[c] + slots[part]):
            if not low <= slots[k] <= high:
                return k
    for c in range(NUMBER_COLUMNS - SLOT_COLUMNS):
        part, first = table[4 * SLOT_COLUMNS + c], at[SLOT_COLUMNS + c]
        for k in range(first, first + slots[part]):
            value = numbers[k]
            is_left_out = not value <= math.inf and ranges[3 * c + 2] != 0.0
            if not is_left_out and not ranges[3 * c] <= value <= ranges[3 * c + 1]:
                return slots.shape[0] + k
    return -1


@inner_kernel
def first_wrong(state: State, slots: Slots, numbers: Floats, work: KitScratch) -> int:
    """The first that does not fit the others, or the world; -1: none. Slots of ends of springs go into work."""
    at = work.at
    for k in range(slots[PARTICLES]):
        body, group = slots[at[BODY] + k], slots[at[GROUP] + k]
        if not (0 <= body < slots[BODIES] or -slots[PARTICLES] <= body < 0):
            return at[BODY] + k
        if group & (group - 1) != 0 or group == TERRAIN_GROUP:
            return at[GROUP] + k
    for k in range(slots[SPRINGS]):
        for end in range(2):
            place = at[END_A + end] + k
            given = slots[place]
            slot = slots[COUNTED + PARTICLES] + given if given >= 0 else -1 - given
            is_of_kit = 0 <= given < slots[PARTICLES]
            is_of_world = given < 0 and slot < slots[COUNTED + PARTICLES] and is_body(state, slots[FIRST_CURSOR], slot)
            if not is_of_kit and not is_of_world:
                return place
            if end == 0:
                work.a[k] = slot
            else:
                work.b[k] = slot
        if work.a[k] == work.b[k]:
            return at[END_B] + k
    return _first_wrong_corner(slots, numbers, work)


@inner_kernel
def form_of(slots: Slots, numbers: Floats, at: Slots, c: int, axis: int) -> float:
    """Where corner c is in the form, at rest: where its particle is placed, where nothing else is said."""
    form = numbers[at[FORM_X + axis] + c]
    return (form if form <= math.inf else numbers[at[X + axis] + slots[at[CORNER] + c]]) + 0.0


@inner_kernel
def _first_wrong_corner(slots: Slots, numbers: Floats, work: KitScratch) -> int:
    at, first = work.at, 0
    for k in range(slots[CONSTRAINTS]):
        size = slots[at[SIZE] + k]
        if size > slots[CORNERS] - first or (slots[at[KIND] + k] == BEND and size != 3):
            return at[SIZE] + k
        for c in range(first, first + size):
            particle = slots[at[CORNER] + c]
            if work.seen[particle] == k + 1:
                return at[CORNER] + c
            work.seen[particle] = k + 1
        for c in range(first, first + (2 if slots[at[KIND] + k] == BEND else 0)):
            dx = form_of(slots, numbers, at, c + 1, 0) - form_of(slots, numbers, at, c, 0)
            dy = form_of(slots, numbers, at, c + 1, 1) - form_of(slots, numbers, at, c, 1)
            if not math.sqrt(dx * dx + dy * dy) > 0.0:
                return at[CORNER] + c
        first += size
    return -1 if first == slots[CORNERS] else CORNERS


@inner_kernel
def first_wrong_drive(limits: MaterialLimits, slots: Slots, numbers: Floats, work: KitScratch) -> int:
    """The first of driven parts, hulls and materials that does not fit; -1: none."""
    at, rims, new = work.at, 0, slots[COUNTED + MATERIALS]
    for part in range(2):
        column = MUSCLE if part == 0 else HYDRAULIC
        for k in range(at[column], at[column] + slots[MUSCLES + part]):
            if work.is_driven[slots[k]]:
                return k
            work.is_driven[slots[k]] = True
    for k in range(slots[HYDRAULICS]):
        if numbers[at[SHORTEST] + k] > numbers[at[LONGEST] + k]:
            return slots.shape[0] + at[SHORTEST] + k
    for k in range(slots[MOTORS]):
        if slots[at[RIM_SIZE] + k] > slots[RIMS] - rims:
            return at[RIM_SIZE] + k
        rims += slots[at[RIM_SIZE] + k]
    if rims != slots[RIMS]:
        return RIMS
    for k in range(1, slots[HULLS]):
        if slots[at[HULL_BODY] + k] < slots[at[HULL_BODY] + k - 1]:
            return at[HULL_BODY] + k
    for k in range(slots[MATERIALS]):
        slot = slots[at[MATERIAL_SLOT] + k]
        if slot > new:
            return at[MATERIAL_SLOT] + k
        if slot == new:
            new += 1
        elif slot < slots[COUNTED + MATERIALS]:
            for c in range(4):
                if not _is_as_limited(limits, slot, c, numbers[at[TENSION + c] + k]):
                    return slots.shape[0] + at[TENSION + c] + k
    return -1


@inner_kernel
def _is_as_limited(limits: MaterialLimits, slot: int, c: int, value: float) -> bool:
    # Whether a material of the world has that limit; NaN: as it has.
    present = 0.0 if c == 3 else math.inf
    if slot < limits.tension.shape[0]:
        if c == 0:
            present = limits.tension[slot]
        elif c == 1:
            present = limits.compression[slot]
        elif c == 2:
            present = limits.yielding[slot]
        else:
            present = limits.yield_share[slot]
    return not value <= math.inf or value == present


@inner_kernel
def first_too_many(state: State, drives: Drives, slots: Slots, numbers: Floats, at: Slots) -> int:
    """The first part of which the world would have too many; -1: none."""
    for part in range(COUNTED):
        is_counted = part not in (MATERIALS, MUSCLES, BODIES)
        if is_counted and slots[COUNTED + part] + slots[part] > slots[MOST + part]:
            return part
    if _materials_then(slots, at) > slots[MOST + MATERIALS]:
        return MATERIALS
    limited = 0
    for k in range(slots[COUNTED + MUSCLES]):
        limited += 1 if drives.muscle_force[k] < math.inf else 0
    for k in range(slots[COUNTED + HYDRAULICS]):
        limited += 1 if drives.hydraulic_force[k] < math.inf else 0
    for k in range(slots[MUSCLES]):
        limited += 1 if numbers[at[MUSCLE_FORCE] + k] < math.inf else 0
    for k in range(slots[HYDRAULICS]):
        limited += 1 if numbers[at[FORCE] + k] < math.inf else 0
    if limited > slots[MOST + MUSCLES]:
        return MUSCLES
    wheels, bit = 0, first_free_bit(state, slots, at)
    for k in range(slots[FREE]):
        wheels += 1 if is_first_of_wheel(slots, at, k) else 0
    return FREE if wheels > 0 and (wheels > 62 or bit > ALL_GROUPS >> (wheels - 1)) else -1


@inner_kernel
def _materials_then(slots: Slots, at: Slots) -> int:
    # How many materials the world has once the kit has joined it.
    count = slots[COUNTED + MATERIALS]
    for k in range(slots[MATERIALS]):
        count = max(count, slots[at[MATERIAL_SLOT] + k] + 1)
    return count


@inner_kernel
def is_first_of_wheel(slots: Slots, at: Slots, k: int) -> bool:
    """Whether a row of free wheels is the first of its wheel."""
    return k == 0 or slots[at[WHEEL] + k] != slots[at[WHEEL] + k - 1]


@inner_kernel
def first_free_bit(state: State, slots: Slots, at: Slots) -> int:
    """The first bit that no group has of the level, of what is in the world, and of the kit."""
    used = slots[LEVEL_GROUPS]
    for p in range(slots[COUNTED + PARTICLES]):
        used = max(used, state.group[p])
    for k in range(slots[PARTICLES]):
        used = max(used, slots[at[GROUP] + k])
    bit = 1
    while bit <= used:
        bit = bit << 1
    return bit


@inner_kernel
def has_rows(state: State, drives: Drives, wheels: DrivenWheels, water: Water, slots: Slots) -> bool:
    """Whether the arrays of the state, driven parts and hulls have rows for it."""
    return (
        state.owner.shape[0] >= slots[COUNTED + PARTICLES] + slots[PARTICLES]
        and state.law.shape[0] >= slots[COUNTED + SPRINGS] + slots[SPRINGS]
        and state.constraint_kind.shape[0] >= slots[COUNTED + CONSTRAINTS] + slots[CONSTRAINTS]
        and state.corner_particle.shape[0] >= slots[COUNTED + CORNERS] + slots[CORNERS]
        and state.actuator_value.shape[0] >= slots[COUNTED + PARTS] + slots[PARTS]
        and drives.muscle.shape[0] >= slots[COUNTED + MUSCLES] + slots[MUSCLES]
        and drives.hydraulic.shape[0] >= slots[COUNTED + HYDRAULICS] + slots[HYDRAULICS]
        and wheels.hub.shape[0] >= slots[COUNTED + MOTORS] + slots[MOTORS]
        and wheels.rim.shape[0] >= slots[COUNTED + RIMS] + slots[RIMS]
        and water.hull.shape[0] >= slots[COUNTED + HULLS] + slots[HULLS]
    )


@inner_kernel
def has_limits(limits: MaterialLimits, slots: Slots, numbers: Floats, at: Slots) -> bool:
    """Whether any material of the world or of the kit breaks or yields."""
    for c in range(3):
        for k in range(at[TENSION + c], at[TENSION + c] + slots[MATERIALS]):
            if numbers[k] < math.inf:
                return True
    return limits.tension.shape[0] > 0


@inner_kernel
def has_limit_rows(limits: MaterialLimits, state: State, slots: Slots, at: Slots) -> bool:
    """Whether the limits of materials have rows for it."""
    return limits.tension.shape[0] >= _materials_then(slots, at) and limits.driven.shape[0] == state.law.shape[0]
