"""Commands: what people do to a world between ticks, on its arrays, as one kernel. None of it is part of a tick."""

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from sandbox.physics.arena import Arena, begin, is_full, new_flags, new_slots, new_tuple
from sandbox.physics.arrays import Floats, Slots
from sandbox.physics.collision.pieces import PieceScratch, part
from sandbox.physics.collision.sides import end_constraints
from sandbox.physics.jit import Bundle, bundle, inner_kernel, kernel, unpack
from sandbox.physics.keeping.arguments import (
    CONSTRAINTS,
    FARTHEST,
    HANDS,
    KEYS,
    PARTICLES,
    PARTS,
    SPRINGS,
    no_slot,
    whole,
    whole_numbers,
)
from sandbox.physics.marks import BANK_EMPTIED, BANK_UNOPENED, GRAB_COUNT, LAW_HAND, LAW_NISSEN
from sandbox.physics.ramps import set_constraint, set_number, set_spring
from sandbox.physics.settings import DRAG, GRAVITY_X, WIND_X
from sandbox.physics.state import GoodValues, State, StateArrays
from sandbox.physics.topology.sorting import list_ends

GRAB, MOVE_GRAB, RELEASE, PIN, UNPIN, CUT, BREAK, PART, SET_COEFFICIENTS, DRIVE, PUSH, SHAKE = range(12)
SET_GRAVITY, SET_AIR, HOLD_KEY, FIRM_SPRINGS, FIRM_CONSTRAINTS = range(12, 17)
# In place of a result: the arena is full, and nothing was changed; the k-th of slots and numbers, counted through, is
# BAD_SLOT - k: a slot that is not there, or a number that is not finite, and nothing was changed.
NO_ARENA, BAD_SLOT = -1, -2
# What has to be derived again after a command: nothing, what follows from hands, what follows from topology.
NOTHING, OF_HANDS, OF_TOPOLOGY = "", "hands", "topology"


class KernelCommand(NamedTuple):
    """A kind of command: its number; what lies in `slots` and `numbers` then; what has to be derived again.

    first_cursor, first_spring: of hands; grab: a hand; tick_rate [1/s]; duration [ticks]: see ramps.py; ?name:
    whether that is given. Others are what commands of files call so: places have two numbers, springs as many slots as
    there are.
    """

    code: int
    slots: tuple[str, ...]
    numbers: tuple[str, ...] = ()
    changes: str = NOTHING


_HAND = ("first_cursor", "first_spring", "grab")
_PARTICLE = ("first_cursor", "particle")
_FIRMNESS = ("stiffness", "damping", "lowest_mode", "duration")
# What is a list of slots, of which a command has one alone.
_LISTS = ("springs", "constraints")
# Kinds of commands by their names in files; files have no `break_springs`, which a tick ends with, and no
# `part_bodies`, which building a level with cut bodies does.
KINDS = {
    "grab": KernelCommand(GRAB, (*_HAND, "particle"), ("target", "strength", "radius"), OF_HANDS),
    "move_grab": KernelCommand(MOVE_GRAB, _HAND, ("target", "tick_rate")),
    "release": KernelCommand(RELEASE, _HAND, (), OF_HANDS),
    "pin": KernelCommand(PIN, _PARTICLE, (), OF_TOPOLOGY),
    "unpin": KernelCommand(UNPIN, _PARTICLE, (), OF_TOPOLOGY),
    "cut_springs": KernelCommand(CUT, ("springs",), (), OF_TOPOLOGY),
    "break_springs": KernelCommand(BREAK, ("springs",), (), OF_TOPOLOGY),
    "part_bodies": KernelCommand(PART, ("springs",), (), OF_TOPOLOGY),
    "set_coefficients": KernelCommand(
        SET_COEFFICIENTS, ("?material", "material", "?stiffness", "?damping", "duration"), ("stiffness", "damping")
    ),
    "set_gravity": KernelCommand(SET_GRAVITY, ("duration",), ("gravity",)),
    # What may be left out and is a pair comes last.
    "set_air": KernelCommand(SET_AIR, ("?wind", "?drag", "duration"), ("drag", "wind")),
    "set_drive": KernelCommand(DRIVE, ("part",), ("value",)),
    "hold_key": KernelCommand(HOLD_KEY, ("key", "down")),
    "firm_springs": KernelCommand(FIRM_SPRINGS, ("springs",), _FIRMNESS),
    "firm_constraints": KernelCommand(FIRM_CONSTRAINTS, ("constraints",), _FIRMNESS),
    "push": KernelCommand(PUSH, ("first_cursor",), ("position", "impulse", "outward", "radius")),
    "shake": KernelCommand(SHAKE, ("first_cursor",), ("acceleration", "tick_rate")),
}


class Commanded(NamedTuple):
    """What commands change; a world block begins with it. numbers: the settings, see settings.py."""

    state: State
    good: GoodValues
    numbers: Floats


@kernel
def command(pointer: Bundle[Commanded], arena: Arena, kind: int, slots: Slots, numbers: Floats) -> int:
    """Carry out a command, see KINDS; how many particles were pushed or shaken, for all others 0; or see NO_ARENA."""
    world = unpack(pointer)
    state = world.state
    bad = _first_bad(state, kind, slots, numbers)
    if bad >= 0:
        return BAD_SLOT - bad
    if kind == GRAB:
        _grab(state, slots, numbers)
    elif kind == MOVE_GRAB:
        cursor = slots[0] + slots[2]
        for axis in range(2):
            state.velocity[cursor, axis] = (numbers[axis] - state.position[cursor, axis]) * numbers[2]
    elif kind == RELEASE:
        _release(state, slots)
    elif kind == PIN:
        pin(state, slots[1])
    elif kind == UNPIN:
        _unpin(state, slots[1])
    elif kind in (CUT, BREAK, PART):
        return _cut(state, world.good, slots, kind, arena)
    elif kind == SET_COEFFICIENTS:
        _set_coefficients(state, world.good, slots, numbers)
    elif kind == SET_GRAVITY:
        for axis in range(2):
            set_number(state, world.numbers, GRAVITY_X + axis, numbers[axis], slots[0])
    elif kind == SET_AIR:
        _set_air(state, world.numbers, slots, numbers)
    elif kind == DRIVE:
        state.actuator_value[slots[0]] = numbers[0]
    elif kind in (FIRM_SPRINGS, FIRM_CONSTRAINTS):
        _firm(state, world.good, slots, numbers, kind)
    elif kind == HOLD_KEY:
        state.key_down[slots[0]] = slots[1] != 0
    elif kind == PUSH:
        return _push(state, world.good, slots[0], numbers)
    elif kind == SHAKE:
        return _shake(state, world.good, slots[0], numbers)
    return 0


@inner_kernel
def _first_bad(state: State, kind: int, slots: Slots, numbers: Floats) -> int:
    # The first of slots and numbers, counted through, that is not there or not finite; -1: none.
    particles, springs = state.owner.shape[0], state.law.shape[0]
    if kind in (GRAB, MOVE_GRAB, RELEASE):
        has_hand = 0 <= slots[2] < state.hand_strength.shape[0]
        if not has_hand or not 0 <= slots[0] + slots[2] < particles or not 0 <= slots[1] + slots[2] < springs:
            return 2
    if kind in (GRAB, PIN, UNPIN) and not _is_body(state, slots[0], slots[slots.shape[0] - 1]):
        return slots.shape[0] - 1
    if kind in (CUT, BREAK, PART):
        for k in range(slots.shape[0]):
            if not 0 <= slots[k] < springs or not state.spring_active[slots[k]] or state.material[slots[k]] < 0:
                return k
    if kind == DRIVE and not 0 <= slots[0] < state.actuator_value.shape[0]:
        return 0
    if kind == HOLD_KEY and not 0 <= slots[0] < state.key_down.shape[0]:
        return 0
    if kind in (FIRM_SPRINGS, FIRM_CONSTRAINTS):
        rows = springs if kind == FIRM_SPRINGS else state.constraint_kind.shape[0]
        for k in range(slots.shape[0]):
            if not 0 <= slots[k] < rows:
                return k
    for k in range(numbers.shape[0]):
        if not -math.inf < numbers[k] < math.inf:
            return slots.shape[0] + k
    return -1


@inner_kernel
def _is_body(state: State, first_cursor: int, p: int) -> bool:
    # Whether a particle is there and in use, and no cursor of a hand.
    return 0 <= p < state.owner.shape[0] and state.particle_active[p] and not _is_cursor(first_cursor, p)


@inner_kernel
def _is_cursor(first_cursor: int, p: int) -> bool:
    return 0 <= first_cursor <= p < first_cursor + GRAB_COUNT


@inner_kernel
def _set_hand(state: State, first_cursor: int, first_spring: int, hand: int, particle: int, holds: bool) -> int:
    # Let a hand hold a particle, or nothing; its cursor.
    cursor, spring = first_cursor + hand, first_spring + hand
    state.particle_active[cursor] = state.spring_active[spring] = holds
    state.particle_b[spring] = particle
    state.law[spring] = LAW_HAND if holds else LAW_NISSEN
    for axis in range(2):
        state.velocity[cursor, axis] = state.slow_velocity[cursor, axis] = state.hand_force[hand, axis] = 0.0
    return cursor


@inner_kernel
def _grab(state: State, slots: Slots, numbers: Floats) -> None:
    hand, particle = slots[2], slots[3]
    cursor = _set_hand(state, slots[0], slots[1], hand, particle, True)
    state.position[cursor, 0], state.position[cursor, 1] = numbers[0], numbers[1]
    state.hand_strength[hand], state.hand_radius[hand] = numbers[2], numbers[3]
    state.spin[particle] = 0.0
    state.energy_bank[particle] = BANK_UNOPENED


@inner_kernel
def _release(state: State, slots: Slots) -> None:
    # No bank keeps energy that the hand's work put into it. Not begun again: what overlaps where a hand lets go is no
    # start, at which parting costs nothing.
    hand, bank = slots[2], state.energy_bank
    held = state.particle_b[slots[1] + hand]
    for p in range(bank.shape[0]):
        if bank[p] > 0.0 or (p == held and bank[p] == 0.0):
            bank[p] = BANK_EMPTIED
    cursor = _set_hand(state, slots[0], slots[1], hand, 0, False)
    state.position[cursor, 0] = state.position[cursor, 1] = 0.0
    state.hand_strength[hand] = state.hand_radius[hand] = 0.0


@inner_kernel
def pin(state: State, particle: int) -> None:
    """Hold a particle where it is."""
    state.inverse_mass[particle] = 0.0
    for axis in range(2):
        state.velocity[particle, axis] = state.slow_velocity[particle, axis] = 0.0
    state.spin[particle] = 0.0
    state.energy_bank[particle] = BANK_UNOPENED


@inner_kernel
def _unpin(state: State, particle: int) -> None:
    state.inverse_mass[particle] = 1.0 / state.mass[particle]
    for axis in range(2):
        state.slow_velocity[particle, axis] = state.velocity[particle, axis]
    state.energy_bank[particle] = BANK_UNOPENED


@inner_kernel
def _cut(state: State, good: GoodValues, springs: Slots, kind: int, arena: Arena) -> int:
    # Take springs out, and the constraints that they were a side of, unless another spring holds that side. What falls
    # into pieces becomes several bodies; those of what breaks by itself keep the energy of the body. PART: the bodies
    # of springs have lost others already.
    begin(arena)
    count = state.law.shape[0]
    gone = new_flags(arena, count)
    pieces = new_tuple(PieceScratch, arena, particles=state.owner.shape[0], springs=count)
    start, listed = new_slots(arena, state.owner.shape[0] + 1), new_slots(arena, 2 * count)
    if is_full(arena):
        return NO_ARENA
    for k in range(springs.shape[0] if kind != PART else 0):
        gone[springs[k]] = True
        state.spring_active[springs[k]] = False
    list_ends(state.particle_a, state.particle_b, count, state.owner.shape[0], start, listed)
    end_constraints(state, start, listed, gone)
    part(state, good, springs, start, listed, gone, pieces)
    for s in range(count):
        if gone[s]:
            state.impulse[s, 0] = state.impulse[s, 1] = state.tension[s] = 0.0
            if kind == CUT:
                state.energy_bank[state.particle_a[s]] = state.energy_bank[state.particle_b[s]] = BANK_UNOPENED
    return 0


@inner_kernel
def _is_of(material: int, slots: Slots) -> bool:
    return material == slots[1] if slots[0] != 0 else material >= 0


@inner_kernel
def _set_air(state: State, settings: Floats, slots: Slots, numbers: Floats) -> None:
    if slots[0] != 0:
        for axis in range(2):
            set_number(state, settings, WIND_X + axis, numbers[1 + axis], slots[2])
    if slots[1] != 0:
        set_number(state, settings, DRAG, numbers[0], slots[2])


@inner_kernel
def _set_coefficients(state: State, good: GoodValues, slots: Slots, numbers: Floats) -> None:
    # Of springs and areas; grabs, Hooke springs and constraints with Cs and Cd of their own keep theirs.
    for s in range(state.material.shape[0]):
        if _is_of(state.material[s], slots):
            stiffness = numbers[0] if slots[2] != 0 else state.stiffness[s]
            damping = numbers[1] if slots[3] != 0 else state.damping[s]
            set_spring(state, good, s, stiffness, damping, 0.0, slots[4])
    for k in range(state.constraint_material.shape[0]):
        if _is_of(state.constraint_material[k], slots):
            stiffness = numbers[0] if slots[2] != 0 else state.constraint_stiffness[k]
            damping = numbers[1] if slots[3] != 0 else state.constraint_damping[k]
            set_constraint(state, good, k, stiffness, damping, 0.0, slots[4])


@inner_kernel
def _firm(state: State, good: GoodValues, slots: Slots, numbers: Floats, kind: int) -> None:
    # Of springs or constraints of a body.
    for at in range(slots.shape[0]):
        if kind == FIRM_SPRINGS:
            set_spring(state, good, slots[at], numbers[0], numbers[1], numbers[2], int(numbers[3]))
        else:
            set_constraint(state, good, slots[at], numbers[0], numbers[1], numbers[2], int(numbers[3]))


@inner_kernel
def _can_move(state: State, first_cursor: int, p: int) -> bool:
    return state.particle_active[p] and not _is_cursor(first_cursor, p) and state.inverse_mass[p] > 0.0


@inner_kernel
def _weight_of_push(state: State, first_cursor: int, p: int, numbers: Floats) -> float:
    # 1 - (d / radius)^2 of what is near and can move; -1 of all else.
    dx, dy = state.position[p, 0] - numbers[0], state.position[p, 1] - numbers[1]
    square, reach = dx * dx + dy * dy, numbers[5] * numbers[5]
    if not _can_move(state, first_cursor, p) or not square < reach:
        return -1.0
    return 1.0 - square / reach


@inner_kernel
def _push(state: State, good: GoodValues, first_cursor: int, numbers: Floats) -> int:
    # dv_i = (J + outward n_i) w_i / sum m w: what is near moves more, whatever its mass, and the momentum grows by J.
    total, count = 0.0, 0
    for p in range(state.owner.shape[0]):
        weight = _weight_of_push(state, first_cursor, p, numbers)
        if weight >= 0.0:
            total += state.mass[p] * weight
            count += 1
    for p in range(state.owner.shape[0]):
        weight = _weight_of_push(state, first_cursor, p, numbers)
        if weight >= 0.0:
            dx, dy = state.position[p, 0] - numbers[0], state.position[p, 1] - numbers[1]
            distance = math.sqrt(dx * dx + dy * dy)
            share = numbers[4] / distance if distance > 0.0 else 0.0
            for axis in range(2):
                away = dx if axis == 0 else dy
                dv = (numbers[2 + axis] + share * away) * (weight / total)
                state.velocity[p, axis] += dv
                good.velocity[p, axis] = state.velocity[p, axis]
                state.slow_velocity[p, axis] += dv
            state.energy_bank[p] = BANK_UNOPENED
    return count


@inner_kernel
def _shake(state: State, good: GoodValues, first_cursor: int, numbers: Floats) -> int:
    # Seen from the frame, every free particle gets the opposite velocity: dv_i = -a / tick_rate, for any gravity scale.
    count = 0
    for p in range(state.owner.shape[0]):
        if _can_move(state, first_cursor, p):
            for axis in range(2):
                dv = numbers[axis] / numbers[2]
                state.velocity[p, axis] -= dv
                good.velocity[p, axis] = state.velocity[p, axis]
                state.slow_velocity[p, axis] -= dv
            state.energy_bank[p] = BANK_UNOPENED
            count += 1
    return count


def lend(state: State, good: GoodValues, numbers: Floats) -> Bundle[Commanded]:
    """What commands change, as kernels take it."""
    return bundle(Commanded(state, good, numbers))


def carry_out(pointer: Any, name: str, given: Mapping[str, Any], state: StateArrays) -> int:
    """Carry out a command of KINDS with what it is given, by name; how many particles were pushed or shaken.

    pointer: what `lend` made of the arrays of `state`. Raises IndexError for a slot that is not there or not in use,
    and ValueError for a number that is not finite; nothing is changed then.
    """
    kind = KINDS[name]
    if kind.slots[0] in _LISTS:
        slots = whole_numbers(kind.slots[0], given[kind.slots[0]])
    else:
        slots = np.array([_packed(kind, each, given) for each in kind.slots], np.int64)
    values = [given[each] for each in kind.numbers]
    numbers = np.array(
        [x for each in values for x in (each if isinstance(each, tuple) else (each or 0.0,))], np.float64
    )
    arena = np.zeros(1, np.int64)
    while (result := command(pointer, arena, kind.code, slots, numbers)) == NO_ARENA:
        arena = np.zeros(int(arena[0]), np.int64)
    if result <= BAD_SLOT:
        raise _fault(kind, BAD_SLOT - result, given, numbers, state)
    return result


def _packed(kind: KernelCommand, name: str, given: Mapping[str, Any]) -> int:
    if name[0] == "?":
        return int(given[name[1:]] is not None)
    is_left_out = given[name] is None and f"?{name}" in kind.slots
    return 0 if is_left_out else max(-1, min(whole(name, given[name]), FARTHEST))


def _fault(kind: KernelCommand, place: int, given: Mapping[str, Any], numbers: Floats, state: StateArrays) -> Exception:
    """What is wrong with the slot or number at a place, as BAD_SLOT counts."""
    is_list = kind.slots[0] in _LISTS
    beyond = place - (len(given[kind.slots[0]]) if is_list else len(kind.slots))
    if beyond >= 0:
        return ValueError(f"{', '.join(kind.numbers)} {numbers.tolist()}: finite numbers are needed")
    name = kind.slots[0 if is_list else place]
    value = given[name][place] if is_list else given[name]
    rows, count = {
        "grab": (HANDS, len(state.hand_strength)),
        "particle": (PARTICLES, len(state.owner)),
        "springs": (SPRINGS, len(state.law)),
        "constraints": (CONSTRAINTS, len(state.constraint_kind)),
        "part": (PARTS, len(state.actuator_value)),
        "key": (KEYS, len(state.key_down)),
    }[name]
    if 0 <= value < count:
        return IndexError(f"{name} {value}: it is not in use, or a hand's")
    return no_slot(name, value, rows, count)
