"""JOIN: lets a packed kit join a world, once every number of it is looked at. What follows from its rows is found:
inverses of masses, lengths as placed, weights of areas, slots and owners.
"""

import math
from typing import NamedTuple

from sandbox.physics.arena import NO_ARENA, Arena, begin, is_full, new_tuple
from sandbox.physics.arrays import Floats, Slots
from sandbox.physics.breaking import MaterialLimits
from sandbox.physics.commands.command import HAND, NOT_ALLOWED, SPENT, UNTOUCHED, Commanded, denied, refusal, spend
from sandbox.physics.constraints import AREA, measure_rest
from sandbox.physics.driving import Drives, contract
from sandbox.physics.jit import Bundle, inner_kernel, kernel, unpack
from sandbox.physics.joints.joint_set import DrivenWheels
from sandbox.physics.kits.kit import (
    AMPLITUDE,
    ANGLE,
    BAD_PLACE,
    BELT,
    BODIES,
    BODY,
    COLLIDES,
    COMPRESSION,
    CONSTRAINTS,
    CORNER,
    CORNERS,
    COUNTED,
    DAMPING,
    EDGE,
    END_A,
    END_B,
    FORCE,
    FREE,
    FRICTION,
    GRAVITY_SCALE,
    GROUP,
    HOOKE_DAMPING,
    HOOKE_STIFFNESS,
    HUB,
    HULL_BODY,
    HULL_SPRING,
    HULL_TURNED,
    HULLS,
    HYDRAULIC,
    HYDRAULICS,
    KEPT_AREA,
    KIND,
    LAW,
    LONGEST,
    LOWEST_MODE,
    MASS,
    MATERIAL,
    MATERIAL_SLOT,
    MATERIALS,
    MOTORS,
    MOUNT,
    MOVED_PART,
    MUSCLE,
    MUSCLE_FORCE,
    MUSCLES,
    NO_LIMIT_ROWS,
    NO_ROWS,
    NUMBER_COLUMNS,
    OF_DAMPING,
    OF_MATERIAL,
    OF_MODE,
    OF_STIFFNESS,
    PARTICLES,
    PARTS,
    PERIOD,
    PHASE,
    PINNED,
    RADIUS,
    RATE,
    REST,
    RESTITUTION,
    RETURNS,
    RIM,
    RIM_SIZE,
    RIMS,
    ROLLING,
    ROLLS,
    SHORTEST,
    SIZE,
    SPEED,
    SPIN,
    SPRINGS,
    STIFFNESS,
    TENSION,
    TICK,
    TOO_MANY,
    TORQUE,
    TURNED_PART,
    VALUE,
    VX,
    WHEEL,
    YIELD_SHARE,
    YIELDING,
    KitScratch,
    X,
    find_columns,
    first_free_bit,
    first_out_of_range,
    first_too_many,
    first_wrong,
    first_wrong_drive,
    form_of,
    has_limit_rows,
    has_limits,
    has_rows,
    is_first_of_wheel,
)
from sandbox.physics.marks import BANK_UNOPENED, GRAB_COUNT, GRAB_DAMPING, GRAB_MATERIAL, GRAB_STIFFNESS
from sandbox.physics.state import GoodValues, State
from sandbox.physics.water.displacers import HULL, SPRING, TURNED, Water


class Joinable(NamedTuple):
    """What a kit changes; a world block begins with it."""

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
    find_columns(table, slots, work.at)
    bad = first_out_of_range(table, ranges, slots, numbers, work.at)
    if bad < 0:
        bad = first_wrong(state, slots, numbers, work)
    if bad < 0:
        bad = first_wrong_drive(world.limits, slots, numbers, work)
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
    many = first_too_many(state, world.drives, slots, numbers, work.at)
    if many >= 0:
        return TOO_MANY - many
    if not has_rows(state, world.drives, world.wheels, world.water, slots):
        return NO_LIMIT_ROWS if has_limits(world.limits, slots, numbers, work.at) else NO_ROWS
    if has_limits(world.limits, slots, numbers, work.at) and not has_limit_rows(world.limits, state, slots, work.at):
        return NO_LIMIT_ROWS
    _add_particles(state, good, slots, numbers, work.at)
    _add_springs(state, good, slots, numbers, work)
    _add_constraints(state, good, slots, numbers, work.at)
    _add_drives(state, good, world.drives, world.commanded.choices, slots, numbers, work.at)
    _add_motors(state, world.wheels, slots, numbers, work.at)
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
    bit = first_free_bit(state, slots, at)
    for k in range(slots[FREE]):
        if is_first_of_wheel(slots, at, k):
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
            dx = state.position[b, 0] - state.position[a, 0]
            dy = state.position[b, 1] - state.position[a, 1]
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
        kind, rest, wanted = slots[at[KIND] + k], state.constraint_rest, numbers[at[KEPT_AREA] + k]
        measure_rest(kind, state.corner_form, corner, corner + size, rest, e, state.corner_weight)
        if kind == AREA and wanted <= math.inf:
            rest[e, 0] = wanted + 0.0
        for axis in range(2):
            good.constraint_rest[e, axis] = rest[e, axis]
        for c in range(corner, corner + size):
            good.corner_weight[c] = state.corner_weight[c]
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
def _add_motors(state: State, wheels: DrivenWheels, slots: Slots, numbers: Floats, at: Slots) -> None:
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
