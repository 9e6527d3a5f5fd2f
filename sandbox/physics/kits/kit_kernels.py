"""JOIN: lets a packed kit join a world, once every number of it is looked at.

The first number is found that is out of its range, or fits neither the others nor the world. Else what follows from the
rows of a kit is found: inverses of masses, lengths as placed, weights of areas, slots and owners.
"""

import math
from typing import Annotated, NamedTuple

from sandbox.physics.arena import NO_ARENA, Arena, begin, is_full, new_tuple
from sandbox.physics.arrays import Flags, Floats, Slots
from sandbox.physics.breaking import MaterialLimits
from sandbox.physics.commands.changes import is_body
from sandbox.physics.commands.command import HAND, NOT_ALLOWED, SPENT, UNTOUCHED, Commanded, denied, refusal, spend
from sandbox.physics.constraints import AREA, BEND, measure_constraint
from sandbox.physics.driving import Drives, contract
from sandbox.physics.jit import Bundle, inner_kernel, kernel, unpack
from sandbox.physics.joints.joint_set import DrivenWheels
from sandbox.physics.marks import (
    ALL_GROUPS,
    BANK_UNOPENED,
    GRAB_COUNT,
    GRAB_DAMPING,
    GRAB_MATERIAL,
    GRAB_STIFFNESS,
    TERRAIN_GROUP,
)
from sandbox.physics.state import GoodValues, State
from sandbox.physics.water.displacers import HULL, SPRING, TURNED, Water

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
# Columns of whole numbers, then of numbers, in the order of the tables (joining.py).
(
    BODY, GROUP, COLLIDES, PINNED, ROLLS, END_A, END_B, LAW, MATERIAL, EDGE, KIND, SIZE, OF_MATERIAL, CORNER, MUSCLE,
    PERIOD, HYDRAULIC, MOVED_PART, RETURNS, HUB, TURNED_PART, RIM_SIZE, RIM, MATERIAL_SLOT, HULL_BODY, HULL_SPRING,
    HULL_TURNED, WHEEL, MOUNT, SLOT_COLUMNS,
) = range(30)  # fmt: skip
(
    X, Y, VX, VY, MASS, RADIUS, FRICTION, RESTITUTION, GRAVITY_SCALE, ROLLING, ANGLE, SPIN, REST, STIFFNESS, DAMPING,
    HOOKE_STIFFNESS, HOOKE_DAMPING, LOWEST_MODE, BELT, KEPT_AREA, OF_STIFFNESS, OF_DAMPING, OF_MODE, FORM_X, FORM_Y,
    VALUE, AMPLITUDE, PHASE, MUSCLE_FORCE, SHORTEST, LONGEST, RATE, FORCE, SPEED, TORQUE, TENSION, COMPRESSION,
    YIELDING, YIELD_SHARE, NUMBER_COLUMNS,
) = range(SLOT_COLUMNS, SLOT_COLUMNS + 40)  # fmt: skip


class KitScratch(NamedTuple):
    """Scratch: where each column begins; slots of both ends of springs; by particle and spring, who was there last."""

    at: Annotated[Slots, "columns"]
    a: Annotated[Slots, "springs"]
    b: Annotated[Slots, "springs"]
    seen: Annotated[Slots, "particles"]
    is_driven: Annotated[Flags, "springs"]


class Joinable(NamedTuple):
    """The arrays that a kit changes; a world block begins with them."""

    commanded: Commanded
    drives: Drives
    wheels: DrivenWheels
    limits: MaterialLimits
    water: Water


@kernel
def join(
    pointer: Bundle[Joinable], arena: Arena, giver: int, kind: int, table: Slots, ranges: Floats, slots: Slots,
    numbers: Floats,
) -> int:  # fmt: skip
    """Let a packed kit join a world that has rows for it; 0, or see NO_ROWS and DENIED.

    kind: the number of the command that adds it. table, ranges: TABLE, RANGES.
    """
    world = unpack(pointer)
    state, good = world.commanded.state, world.commanded.good
    begin(arena)
    work = new_tuple(
        KitScratch, arena, columns=NUMBER_COLUMNS, springs=max(slots[SPRINGS], 0), particles=max(slots[PARTICLES], 0)
    )  # fmt: skip
    if is_full(arena):
        return NO_ARENA
    _find_columns(table, slots, work.at)
    bad = _first_out_of_range(table, ranges, slots, numbers, work.at)
    if bad < 0:
        bad = _first_wrong(state, slots, numbers, work)
    if bad < 0:
        bad = _first_wrong_drive(world.limits, slots, numbers, work)
    if bad >= 0:
        return BAD_PLACE - bad
    why = refusal(state, giver, kind, 1)
    if why == NOT_ALLOWED:
        return denied(why, 0)
    untouched = _first_untouched(state, giver, slots, work.at)
    if untouched >= 0:
        return denied(UNTOUCHED, untouched)
    if why == SPENT:
        return denied(why, 0)
    many = _first_too_many(state, world.drives, slots, numbers, work.at)
    if many >= 0:
        return TOO_MANY - many
    if not _has_rows(state, world.drives, world.wheels, world.water, slots):
        return NO_LIMIT_ROWS if _has_limits(world.limits, slots, numbers, work.at) else NO_ROWS
    if _has_limits(world.limits, slots, numbers, work.at) and not _has_limit_rows(world.limits, state, slots, work.at):
        return NO_LIMIT_ROWS
    _add_particles(state, good, slots, numbers, work.at)
    _add_springs(state, good, slots, numbers, work)
    _add_constraints(state, good, slots, numbers, work.at)
    _add_drives(state, good, world.drives, world.commanded.choices, slots, numbers, work.at)
    _add_motors(world.wheels, slots, numbers, work.at)
    _add_hulls(world.water, slots, work.at)
    _add_limits(world.limits, world.drives, slots, numbers, work.at)
    spend(state, giver, kind, 1)
    return 0


@inner_kernel
def _first_untouched(state: State, giver: int, slots: Slots, at: Slots) -> int:
    # The first particle of the world that springs of a kit end at and that hands may not touch; -1: none.
    for k in range(slots[SPRINGS] if giver == HAND else 0):
        for column in (END_A, END_B):
            end = -1 - slots[at[column] + k]
            if end >= 0 and state.untouchable[end]:
                return end
    return -1


@kernel
def reserve(pointer: Bundle[Joinable], particle: int, spring: int) -> None:
    """Make new rows, from these on, those of hands that hold nothing, as World.reserve_grabs does."""
    world = unpack(pointer)
    state, good = world.commanded.state, world.commanded.good
    for hand in range(GRAB_COUNT):
        p, s = particle + hand, spring + hand
        state.mass[p] = good.mass[p] = state.gravity_scale[p] = good.gravity_scale[p] = 1.0
        state.unmoved[p] = True
        state.owner[p], state.energy_bank[p] = -1 - p, BANK_UNOPENED
        state.particle_a[s], state.material[s] = p, GRAB_MATERIAL
        state.stiffness[s] = good.stiffness[s] = GRAB_STIFFNESS
        state.damping[s] = good.damping[s] = GRAB_DAMPING
    state.energy_bank[0] = BANK_UNOPENED


@inner_kernel
def _add_particles(state: State, good: GoodValues, slots: Slots, numbers: Floats, at: Slots) -> None:
    first = slots[COUNTED + PARTICLES]
    for k in range(slots[PARTICLES]):
        p, pinned = first + k, slots[at[PINNED] + k] != 0
        for axis in range(2):
            state.position[p, axis] = good.position[p, axis] = numbers[at[X + axis] + k] + 0.0
            state.origin[p, axis] = state.position[p, axis]
            state.velocity[p, axis] = 0.0 if pinned else numbers[at[VX + axis] + k] + 0.0
            good.velocity[p, axis] = state.slow_velocity[p, axis] = state.velocity[p, axis]
        state.mass[p] = good.mass[p] = numbers[at[MASS] + k]
        state.inverse_mass[p] = 0.0 if pinned else 1.0 / state.mass[p]
        state.radius[p] = good.radius[p] = numbers[at[RADIUS] + k] + 0.0
        state.friction[p] = good.friction[p] = numbers[at[FRICTION] + k] + 0.0
        state.restitution[p] = good.restitution[p] = numbers[at[RESTITUTION] + k] + 0.0
        state.gravity_scale[p] = good.gravity_scale[p] = numbers[at[GRAVITY_SCALE] + k] + 0.0
        state.rolling[p] = good.rolling[p] = numbers[at[ROLLING] + k] + 0.0
        state.angle[p] = good.angle[p] = numbers[at[ANGLE] + k] + 0.0
        state.spin[p] = good.spin[p] = 0.0 if pinned else numbers[at[SPIN] + k] + 0.0
        state.particle_active[p] = state.unmoved[p] = True
        state.rolls[p] = slots[at[ROLLS] + k] != 0
        state.energy_bank[p] = BANK_UNOPENED
        body = slots[at[BODY] + k]
        state.owner[p] = slots[COUNTED + BODIES] + body if body >= 0 else body - first
        state.group[p], state.collides[p] = slots[at[GROUP] + k], slots[at[COLLIDES] + k]
    bit = _first_free_bit(state, slots, at)
    for k in range(slots[FREE]):
        if _is_first_of_wheel(slots, at, k):
            _free_wheel(state, slots, at, k, bit)
            bit = bit << 1


@inner_kernel
def _free_wheel(state: State, slots: Slots, at: Slots, k: int, own: int) -> None:
    # Put a wheel into a group of its own. Its mount does not touch that group; all that touched its old group do.
    first, wheel, named = slots[COUNTED + PARTICLES], slots[at[WHEEL] + k], 0
    for p in range(slots[PARTICLES]):
        if named == 0 and slots[at[BODY] + p] == wheel:
            named = state.group[first + p]
    for p in range(first + slots[PARTICLES]):
        is_mount, row = False, k
        while p >= first and row < slots[FREE] and slots[at[WHEEL] + row] == wheel:
            is_mount = is_mount or slots[at[MOUNT] + row] == slots[at[BODY] + p - first]
            row += 1
        if state.collides[p] & named != 0 and not is_mount:
            state.collides[p] = state.collides[p] | own
        else:
            state.collides[p] = state.collides[p] & ~own
    for p in range(slots[PARTICLES]):
        if slots[at[BODY] + p] == wheel:
            state.group[first + p] = own


@inner_kernel
def _still(state: State, good: GoodValues, p: int) -> None:
    # What springs and constraints hold does not turn; something outside has changed its body.
    state.spin[p] = good.spin[p] = 0.0
    state.energy_bank[p] = BANK_UNOPENED


@inner_kernel
def _add_springs(state: State, good: GoodValues, slots: Slots, numbers: Floats, work: KitScratch) -> None:
    at, first = work.at, slots[COUNTED + SPRINGS]
    for k in range(slots[SPRINGS]):
        s, a, b, rest = first + k, work.a[k], work.b[k], numbers[at[REST] + k]
        state.particle_a[s], state.particle_b[s] = a, b
        if not rest <= math.inf:
            dx, dy = state.position[b, 0] - state.position[a, 0], state.position[b, 1] - state.position[a, 1]
            rest = math.sqrt(dx * dx + dy * dy)
        state.rest_length[s] = good.rest_length[s] = state.natural_length[s] = rest + 0.0
        state.stiffness[s] = good.stiffness[s] = numbers[at[STIFFNESS] + k] + 0.0
        state.damping[s] = good.damping[s] = numbers[at[DAMPING] + k] + 0.0
        state.hooke_stiffness[s] = good.hooke_stiffness[s] = numbers[at[HOOKE_STIFFNESS] + k] + 0.0
        state.hooke_damping[s] = good.hooke_damping[s] = numbers[at[HOOKE_DAMPING] + k] + 0.0
        state.lowest_mode[s] = good.lowest_mode[s] = numbers[at[LOWEST_MODE] + k] + 0.0
        state.belt[s] = numbers[at[BELT] + k] + 0.0
        state.law[s], state.edge[s] = slots[at[LAW] + k], slots[at[EDGE] + k]
        state.material[s] = slots[at[MATERIAL_SLOT] + slots[at[MATERIAL] + k]]
        state.spring_active[s] = True
        _still(state, good, a)
        _still(state, good, b)


@inner_kernel
def _add_constraints(state: State, good: GoodValues, slots: Slots, numbers: Floats, at: Slots) -> None:
    first, corner = slots[COUNTED + CONSTRAINTS], slots[COUNTED + CORNERS]
    for c in range(slots[CORNERS]):
        state.corner_particle[corner + c] = slots[COUNTED + PARTICLES] + slots[at[CORNER] + c]
        for axis in range(2):
            state.corner_form[corner + c, axis] = form_of(slots, numbers, at, c, axis)
            good.corner_form[corner + c, axis] = state.corner_form[corner + c, axis]
        _still(state, good, state.corner_particle[corner + c])
    for k in range(slots[CONSTRAINTS]):
        e, material, size = first + k, slots[at[OF_MATERIAL] + k], slots[at[SIZE] + k]
        state.constraint_kind[e], state.constraint_first[e] = slots[at[KIND] + k], corner
        state.constraint_corners[e] = size
        state.constraint_material[e] = slots[at[MATERIAL_SLOT] + material] if material >= 0 else -1
        state.constraint_active[e] = True
        state.constraint_stiffness[e] = good.constraint_stiffness[e] = numbers[at[OF_STIFFNESS] + k] + 0.0
        state.constraint_damping[e] = good.constraint_damping[e] = numbers[at[OF_DAMPING] + k] + 0.0
        state.constraint_lowest_mode[e] = good.constraint_lowest_mode[e] = numbers[at[OF_MODE] + k] + 0.0
        measure_constraint(state, good, e, 1.0)
        wanted = numbers[at[KEPT_AREA] + k]
        if slots[at[KIND] + k] == AREA and wanted <= math.inf:
            state.constraint_rest[e, 0] = good.constraint_rest[e, 0] = wanted + 0.0
        corner += size


@inner_kernel
def _add_drives(
    state: State, good: GoodValues, drives: Drives, choices: Slots, slots: Slots, numbers: Floats, at: Slots
) -> None:  # fmt: skip
    first, spring, part = slots[COUNTED + MUSCLES], slots[COUNTED + SPRINGS], slots[COUNTED + PARTS]
    for k in range(slots[MUSCLES]):
        m = first + k
        drives.muscle[m], drives.period[m] = spring + slots[at[MUSCLE] + k], slots[at[PERIOD] + k]
        drives.amplitude[m], drives.phase[m] = numbers[at[AMPLITUDE] + k] + 0.0, numbers[at[PHASE] + k] + 0.0
        drives.muscle_force[m] = numbers[at[MUSCLE_FORCE] + k]
    # A muscle is where its wave is by now.
    contract(state, good, drives, first, slots[TICK], choices[0], choices[1])
    first = slots[COUNTED + HYDRAULICS]
    for k in range(slots[HYDRAULICS]):
        h = first + k
        drives.hydraulic[h], drives.part[h] = spring + slots[at[HYDRAULIC] + k], part + slots[at[MOVED_PART] + k]
        drives.shortest[h], drives.longest[h] = numbers[at[SHORTEST] + k] + 0.0, numbers[at[LONGEST] + k] + 0.0
        drives.rate[h], drives.hydraulic_force[h] = numbers[at[RATE] + k] + 0.0, numbers[at[FORCE] + k]
        drives.returns[h] = slots[at[RETURNS] + k] != 0
    for k in range(slots[PARTS]):
        state.actuator_value[part + k] = numbers[at[VALUE] + k] + 0.0


@inner_kernel
def _add_motors(wheels: DrivenWheels, slots: Slots, numbers: Floats, at: Slots) -> None:
    particle, rim, first = slots[COUNTED + PARTICLES], slots[COUNTED + RIMS], slots[COUNTED + MOTORS]
    for k in range(slots[RIMS]):
        wheels.rim[rim + k] = particle + slots[at[RIM] + k]
    for k in range(slots[MOTORS]):
        m = first + k
        wheels.hub[m] = particle + slots[at[HUB] + k]
        wheels.part[m] = slots[COUNTED + PARTS] + slots[at[TURNED_PART] + k]
        wheels.speed[m], wheels.torque[m] = numbers[at[SPEED] + k] + 0.0, numbers[at[TORQUE] + k] + 0.0
        rim += slots[at[RIM_SIZE] + k]
        wheels.rim_start[m + 1] = rim


@inner_kernel
def _add_hulls(water: Water, slots: Slots, at: Slots) -> None:
    first = slots[COUNTED + HULLS]
    number = water.hull[first - 1, HULL] + 1 if first > 0 and slots[HULLS] > 0 else 0
    for k in range(slots[HULLS]):
        water.hull[first + k, HULL] = number + slots[at[HULL_BODY] + k]
        water.hull[first + k, SPRING] = slots[COUNTED + SPRINGS] + slots[at[HULL_SPRING] + k]
        water.hull[first + k, TURNED] = slots[at[HULL_TURNED] + k]


@inner_kernel
def _add_limits(limits: MaterialLimits, drives: Drives, slots: Slots, numbers: Floats, at: Slots) -> None:
    if limits.tension.shape[0] == 0:
        return
    for k in range(slots[MATERIALS]):
        slot = slots[at[MATERIAL_SLOT] + k]
        if slot >= slots[COUNTED + MATERIALS]:
            tension, compression = numbers[at[TENSION] + k], numbers[at[COMPRESSION] + k]
            yielding, share = numbers[at[YIELDING] + k], numbers[at[YIELD_SHARE] + k]
            limits.tension[slot] = tension if tension <= math.inf else math.inf
            limits.compression[slot] = compression if compression <= math.inf else math.inf
            limits.yielding[slot] = yielding if yielding <= math.inf else math.inf
            limits.yield_share[slot] = share + 0.0 if share <= math.inf else 0.0
    for k in range(drives.muscle.shape[0]):
        limits.driven[drives.muscle[k]] = True
    for k in range(drives.hydraulic.shape[0]):
        limits.driven[drives.hydraulic[k]] = True


@inner_kernel
def _find_columns(table: Slots, slots: Slots, at: Slots) -> None:
    """Find where each column begins; numbers are counted behind the whole numbers."""
    place = HEADER
    for c in range(NUMBER_COLUMNS):
        part = table[4 * c] if c < SLOT_COLUMNS else table[4 * SLOT_COLUMNS + c - SLOT_COLUMNS]
        if c == SLOT_COLUMNS:
            place = 0
        at[c] = place
        place += slots[part]


@inner_kernel
def _first_out_of_range(table: Slots, ranges: Floats, slots: Slots, numbers: Floats, at: Slots) -> int:
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
def _first_wrong(state: State, slots: Slots, numbers: Floats, work: KitScratch) -> int:
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
def _first_wrong_drive(limits: MaterialLimits, slots: Slots, numbers: Floats, work: KitScratch) -> int:
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
def _first_too_many(state: State, drives: Drives, slots: Slots, numbers: Floats, at: Slots) -> int:
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
    wheels, bit = 0, _first_free_bit(state, slots, at)
    for k in range(slots[FREE]):
        wheels += 1 if _is_first_of_wheel(slots, at, k) else 0
    return FREE if wheels > 0 and (wheels > 62 or bit > ALL_GROUPS >> (wheels - 1)) else -1


@inner_kernel
def _materials_then(slots: Slots, at: Slots) -> int:
    # How many materials the world has once the kit has joined it.
    count = slots[COUNTED + MATERIALS]
    for k in range(slots[MATERIALS]):
        count = max(count, slots[at[MATERIAL_SLOT] + k] + 1)
    return count


@inner_kernel
def _is_first_of_wheel(slots: Slots, at: Slots, k: int) -> bool:
    """Whether a row of free wheels is the first of its wheel."""
    return k == 0 or slots[at[WHEEL] + k] != slots[at[WHEEL] + k - 1]


@inner_kernel
def _first_free_bit(state: State, slots: Slots, at: Slots) -> int:
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
def _has_rows(state: State, drives: Drives, wheels: DrivenWheels, water: Water, slots: Slots) -> bool:
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
def _has_limits(limits: MaterialLimits, slots: Slots, numbers: Floats, at: Slots) -> bool:
    """Whether any material of the world or of the kit breaks or yields."""
    for c in range(3):
        for k in range(at[TENSION + c], at[TENSION + c] + slots[MATERIALS]):
            if numbers[k] < math.inf:
                return True
    return limits.tension.shape[0] > 0


@inner_kernel
def _has_limit_rows(limits: MaterialLimits, state: State, slots: Slots, at: Slots) -> bool:
    """Whether the limits of materials have rows for it."""
    return limits.tension.shape[0] >= _materials_then(slots, at) and limits.driven.shape[0] == state.law.shape[0]
