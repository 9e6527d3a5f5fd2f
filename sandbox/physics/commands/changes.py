"""What commands do to the arrays of a world: hands, pins, coefficients, pushes, moves. None of it asks whether."""

import math

from sandbox.physics.arrays import Floats, Slots
from sandbox.physics.jit import inner_kernel
from sandbox.physics.marks import (
    BANK_EMPTIED,
    BANK_UNOPENED,
    FARTHEST_PLACE,
    GRAB_COUNT,
    LAW_HAND,
    LAW_NISSEN,
    LEAST_MASS,
    MOST_MASS,
)
from sandbox.physics.ramps import set_constraint, set_number, set_spring
from sandbox.physics.settings import DRAG, WIND_X
from sandbox.physics.state import GoodValues, State


@inner_kernel
def is_body(state: State, first_cursor: int, p: int) -> bool:
    """Whether a particle is there and in use, and no cursor of a hand."""
    return 0 <= p < state.owner.shape[0] and state.particle_active[p] and not is_cursor(first_cursor, p)


@inner_kernel
def is_cursor(first_cursor: int, p: int) -> bool:
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
def grab(state: State, slots: Slots, numbers: Floats) -> None:
    hand, particle = slots[2], slots[3]
    cursor = _set_hand(state, slots[0], slots[1], hand, particle, True)
    state.position[cursor, 0], state.position[cursor, 1] = numbers[0], numbers[1]
    state.hand_strength[hand], state.hand_radius[hand] = numbers[2], numbers[3]
    state.spin[particle] = 0.0
    state.energy_bank[particle] = BANK_UNOPENED


@inner_kernel
def release(state: State, slots: Slots) -> None:
    """Let a hand go: slots = first cursor, first spring, hand."""
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
def unpin(state: State, particle: int) -> None:
    state.inverse_mass[particle] = 1.0 / state.mass[particle]
    for axis in range(2):
        state.slow_velocity[particle, axis] = state.velocity[particle, axis]
    state.energy_bank[particle] = BANK_UNOPENED


@inner_kernel
def _is_of(material: int, slots: Slots) -> bool:
    return material == slots[1] if slots[0] != 0 else material >= 0


@inner_kernel
def set_air(state: State, settings: Floats, slots: Slots, numbers: Floats) -> None:
    if slots[0] != 0:
        for axis in range(2):
            set_number(state, settings, WIND_X + axis, numbers[1 + axis], slots[2])
    if slots[1] != 0:
        set_number(state, settings, DRAG, numbers[0], slots[2])


@inner_kernel
def set_coefficients(state: State, good: GoodValues, slots: Slots, numbers: Floats) -> None:
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
def _can_move(state: State, first_cursor: int, p: int) -> bool:
    return state.particle_active[p] and not is_cursor(first_cursor, p) and state.inverse_mass[p] > 0.0


@inner_kernel
def _weight_of_push(state: State, first_cursor: int, p: int, numbers: Floats) -> float:
    # 1 - (d / radius)^2 of what is near and can move; -1 of all else.
    dx, dy = state.position[p, 0] - numbers[0], state.position[p, 1] - numbers[1]
    square, reach = dx * dx + dy * dy, numbers[5] * numbers[5]
    if not _can_move(state, first_cursor, p) or not square < reach:
        return -1.0
    return 1.0 - square / reach


@inner_kernel
def push(state: State, good: GoodValues, first_cursor: int, numbers: Floats) -> int:
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
def shake(state: State, good: GoodValues, first_cursor: int, numbers: Floats) -> int:
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


@inner_kernel
def move_listed(state: State, good: GoodValues, body: Slots, dx: float, dy: float, stands: bool) -> bool:
    """Move particles (k,) by a way [m]; stands: they are at rest there.

    False, and nothing is moved, where any would be beyond FARTHEST_PLACE.
    """
    for k in range(body.shape[0]):
        x, y = state.position[body[k], 0] + dx, state.position[body[k], 1] + dy
        if not (abs(x) <= FARTHEST_PLACE and abs(y) <= FARTHEST_PLACE):
            return False
    for k in range(body.shape[0]):
        p = body[k]
        for axis in range(2):
            state.position[p, axis] += dx if axis == 0 else dy
            good.position[p, axis] = state.position[p, axis]
            if stands:
                state.velocity[p, axis] = good.velocity[p, axis] = state.slow_velocity[p, axis] = 0.0
        state.energy_bank[p] = BANK_UNOPENED
    return True


@inner_kernel
def scale_mass(state: State, good: GoodValues, particle: int, factor: float) -> bool:
    """Make every particle of the body of a particle so many times as heavy, pinned ones too.

    False, and nothing is changed, where any would weigh less than LEAST_MASS or more than MOST_MASS.
    """
    owner = state.owner[particle]
    for p in range(state.owner.shape[0]):
        is_of_body = state.particle_active[p] and state.owner[p] == owner
        if is_of_body and not LEAST_MASS <= state.mass[p] * factor <= MOST_MASS:
            return False
    for p in range(state.owner.shape[0]):
        if state.particle_active[p] and state.owner[p] == owner:
            state.mass[p] = good.mass[p] = state.mass[p] * factor
            if state.inverse_mass[p] > 0.0:
                state.inverse_mass[p] = 1.0 / state.mass[p]
            state.energy_bank[p] = BANK_UNOPENED
    return True
