"""Commands: what people do to a world between ticks, on its arrays, as one kernel. None of it is part of a tick."""

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from sandbox.physics.arena import Arena, begin, is_full, new_flags, new_slots
from sandbox.physics.arrays import Flags, Floats, Slots
from sandbox.physics.constraints import AREA
from sandbox.physics.jit import bundle, contents, inner_kernel, kernel
from sandbox.physics.marks import BANK_EMPTIED, BANK_UNOPENED, GRAB_COUNT, LAW_HAND, LAW_NISSEN
from sandbox.physics.state import GoodValues, State
from sandbox.physics.topology.sorting import list_ends

# What is to be done, with what is in `slots` and `numbers` then:
# GRAB        first cursor, first spring of a hand, hand, particle; target [m] x, y, strength [m/s^2], radius [m]
# MOVE_GRAB   first cursor, hand; target [m] x, y, tick rate [1/s]
# RELEASE     first cursor, first spring of a hand, hand
# PIN, UNPIN, FREEZE   particle
# CUT, BREAK  springs
# SET_COEFFICIENTS     material, -1: all; whether Cs is set, whether Cd is; Cs, Cd
# DRIVE       part; value
# PUSH        first cursor; place [m] x, y, impulse [N s] x, y, outward [N s], radius [m]
# SHAKE       first cursor; acceleration of the frame [m/s^2] x, y, tick rate [1/s]
GRAB, MOVE_GRAB, RELEASE, PIN, UNPIN, FREEZE, CUT, BREAK, SET_COEFFICIENTS, DRIVE, PUSH, SHAKE = range(12)
# In place of a result: the arena is full, and nothing was changed.
NO_ARENA = -1


class Commanded(NamedTuple):
    """What commands change; a world block begins with it."""

    state: State
    good: GoodValues


@kernel
def command(lent: Any, arena: Arena, kind: int, slots: Slots, numbers: Floats) -> int:
    """Carry out a command, see GRAB; how many particles were pushed or shaken, for all others 0, or NO_ARENA."""
    world: Commanded = contents(lent)
    state = world.state
    if kind == GRAB:
        _grab(state, slots, numbers)
    elif kind == MOVE_GRAB:
        cursor = slots[0] + slots[1]
        for axis in range(2):
            state.velocity[cursor, axis] = (numbers[axis] - state.position[cursor, axis]) * numbers[2]
    elif kind == RELEASE:
        _release(state, slots)
    elif kind == PIN:
        _pin(state, slots[0])
    elif kind == UNPIN:
        _unpin(state, slots[0])
    elif kind == FREEZE:
        _freeze(state, world.good, slots[0])
    elif kind in (CUT, BREAK):
        return _cut(state, slots, kind == CUT, arena)
    elif kind == SET_COEFFICIENTS:
        _set_coefficients(state, world.good, slots, numbers)
    elif kind == DRIVE:
        state.actuator_value[slots[0]] = numbers[0]
    elif kind == PUSH:
        return _push(state, world.good, slots[0], numbers)
    elif kind == SHAKE:
        return _shake(state, world.good, slots[0], numbers)
    return 0


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
def _pin(state: State, particle: int) -> None:
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
def _freeze(state: State, good: GoodValues, particle: int) -> None:
    for axis in range(2):
        state.position[particle, axis] = good.position[particle, axis]
    state.angle[particle], state.mass[particle] = good.angle[particle], good.mass[particle]
    state.radius[particle], state.gravity_scale[particle] = good.radius[particle], good.gravity_scale[particle]
    state.friction[particle], state.restitution[particle] = good.friction[particle], good.restitution[particle]
    state.rolling[particle] = good.rolling[particle]
    _pin(state, particle)


@inner_kernel
def _side_is_lost(p: int, q: int, state: State, start: Slots, listed: Slots, gone: Flags) -> bool:
    # Whether a spring that is taken out joined two particles, and none that acts does.
    lost = False
    for at in range(start[p], start[p + 1]):
        s = listed[at]
        if (state.particle_a[s] == p and state.particle_b[s] == q) or (
            state.particle_a[s] == q and state.particle_b[s] == p
        ):
            if state.spring_active[s]:
                return False
            lost = lost or gone[s]
    return lost


@inner_kernel
def _cut(state: State, springs: Slots, disturbs: bool, arena: Arena) -> int:
    # Take springs out, and the constraints that they were a side of, unless another spring holds that side. Pieces of
    # what breaks by itself keep the energy of the body.
    begin(arena)
    count, constraints = state.law.shape[0], state.constraint_kind.shape[0]
    looked_at = count if constraints > 0 else 0
    gone = new_flags(arena, count)
    start, listed = new_slots(arena, state.owner.shape[0] + 1), new_slots(arena, 2 * looked_at)
    if is_full(arena):
        return NO_ARENA
    for k in range(springs.shape[0]):
        s = springs[k]
        gone[s] = True
        state.spring_active[s] = False
        state.impulse[s, 0] = state.impulse[s, 1] = state.tension[s] = 0.0
        if disturbs:
            state.energy_bank[state.particle_a[s]] = state.energy_bank[state.particle_b[s]] = BANK_UNOPENED
    if constraints == 0:
        return 0
    list_ends(state.particle_a, state.particle_b, count, state.owner.shape[0], start, listed)
    for k in range(constraints):
        first, last = state.constraint_first[k], state.constraint_first[k] + state.constraint_corners[k]
        # A bend's two outer corners are no side of it.
        begins = last - 1 if state.constraint_kind[k] == AREA else first
        for corner in range(first if state.constraint_kind[k] == AREA else first + 1, last):
            p, q = state.corner_particle[begins], state.corner_particle[corner]
            if _side_is_lost(p, q, state, start, listed, gone):
                state.constraint_active[k] = False
            begins = corner
    return 0


@inner_kernel
def _is_of(material: int, wanted: int) -> bool:
    return material >= 0 if wanted < 0 else material == wanted


@inner_kernel
def _set_coefficients(state: State, good: GoodValues, slots: Slots, numbers: Floats) -> None:
    # Of springs and areas; grabs, Hooke springs and constraints with Cs and Cd of their own keep theirs.
    for s in range(state.material.shape[0]):
        if _is_of(state.material[s], slots[0]):
            state.stiffness[s] = good.stiffness[s] = numbers[0] if slots[1] != 0 else state.stiffness[s]
            state.damping[s] = good.damping[s] = numbers[1] if slots[2] != 0 else state.damping[s]
            state.lowest_mode[s] = good.lowest_mode[s] = 0.0
            state.energy_bank[state.particle_a[s]] = state.energy_bank[state.particle_b[s]] = BANK_UNOPENED
    for k in range(state.constraint_material.shape[0]):
        if _is_of(state.constraint_material[k], slots[0]):
            stiffness, damping = state.constraint_stiffness, state.constraint_damping
            stiffness[k] = good.constraint_stiffness[k] = numbers[0] if slots[1] != 0 else stiffness[k]
            damping[k] = good.constraint_damping[k] = numbers[1] if slots[2] != 0 else damping[k]
            state.constraint_lowest_mode[k] = good.constraint_lowest_mode[k] = 0.0
            for corner in range(
                state.constraint_first[k], state.constraint_first[k] + state.constraint_corners[k]
            ):  # fmt: skip
                state.energy_bank[state.corner_particle[corner]] = BANK_UNOPENED


@inner_kernel
def _can_move(state: State, first_cursor: int, p: int) -> bool:
    is_cursor = 0 <= first_cursor <= p < first_cursor + GRAB_COUNT
    return state.particle_active[p] and not is_cursor and state.inverse_mass[p] > 0.0


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


def lend(state: State, good: GoodValues) -> Any:
    """What commands change, as kernels take it."""
    return bundle(Commanded(state, good))


def carry_out(lent: Any, kind: int, slots: Sequence[int] | Slots, numbers: Sequence[float]) -> int:
    """Carry out a command, see GRAB; how many particles were pushed or shaken."""
    given = np.array(slots, np.int64), np.array(numbers, np.float64)
    arena = np.zeros(1, np.int64)
    while (result := command(lent, arena, kind, *given)) == NO_ARENA:
        arena = np.zeros(int(arena[0]), np.int64)
    return result
