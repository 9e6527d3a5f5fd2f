"""What is wrong with a packed kit: the first number out of its range, or that fits neither the others nor the world."""

import math
from typing import Annotated, NamedTuple

from sandbox.physics.arrays import Flags, Floats, Slots
from sandbox.physics.breaking import MaterialLimits
from sandbox.physics.collision.filter import ALL_GROUPS, TERRAIN_GROUP
from sandbox.physics.commands.command import is_body
from sandbox.physics.constraints import BEND
from sandbox.physics.driving import Drives
from sandbox.physics.jit import inner_kernel
from sandbox.physics.joints.motors import DrivenWheels
from sandbox.physics.kits.kit import (
    BODIES,
    BODY,
    CONSTRAINTS,
    CORNER,
    CORNERS,
    COUNTED,
    END_A,
    END_B,
    FIRST_CURSOR,
    FORCE,
    FORM_X,
    FREE,
    GROUP,
    HEADER,
    HULL_BODY,
    HULLS,
    HYDRAULIC,
    HYDRAULICS,
    KIND,
    LEVEL_GROUPS,
    LONGEST,
    MATERIAL_SLOT,
    MATERIALS,
    MOST,
    MOTORS,
    MUSCLE,
    MUSCLE_FORCE,
    MUSCLES,
    NUMBER_COLUMNS,
    PARTICLES,
    PARTS,
    RIM_SIZE,
    RIMS,
    SHORTEST,
    SIZE,
    SLOT_COLUMNS,
    SPRINGS,
    TENSION,
    WHEEL,
    X,
)
from sandbox.physics.state import State
from sandbox.physics.water.displacers import Water


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
def has_rows(state: State, slots: Slots) -> bool:
    """Whether the arrays of the state have rows for it."""
    return (
        state.owner.shape[0] >= slots[COUNTED + PARTICLES] + slots[PARTICLES]
        and state.law.shape[0] >= slots[COUNTED + SPRINGS] + slots[SPRINGS]
        and state.constraint_kind.shape[0] >= slots[COUNTED + CONSTRAINTS] + slots[CONSTRAINTS]
        and state.corner_particle.shape[0] >= slots[COUNTED + CORNERS] + slots[CORNERS]
        and state.actuator_value.shape[0] >= slots[COUNTED + PARTS] + slots[PARTS]
    )


@inner_kernel
def has_driven_rows(drives: Drives, wheels: DrivenWheels, water: Water, slots: Slots) -> bool:
    """Whether driven parts and hulls have rows for it."""
    return (
        drives.muscle.shape[0] >= slots[COUNTED + MUSCLES] + slots[MUSCLES]
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
