"""Keeps the momentum of particles, and its moment, where their masses and places change."""

from typing import NamedTuple

from sandbox.physics.arrays import Slots
from sandbox.physics.jit import inner_kernel
from sandbox.physics.marks import BANK_UNOPENED
from sandbox.physics.state import GoodValues, State


class Motion(NamedTuple):
    """Momentum [kg m/s], and its moment [kg m^2/s] about a place [m]."""

    x: float
    y: float
    moment: float
    about_x: float
    about_y: float


@inner_kernel
def motion_of(state: State, torn: Slots) -> Motion:
    """The motion of particles, those of which torn (n,) is not below 0, about their middle."""
    middle_x, middle_y, total = 0.0, 0.0, 0.0
    for p in range(state.owner.shape[0]):
        if torn[p] >= 0:
            total += state.mass[p]
            middle_x += state.mass[p] * state.position[p, 0]
            middle_y += state.mass[p] * state.position[p, 1]
    return _about(state, torn, middle_x / total, middle_y / total)


@inner_kernel
def _about(state: State, torn: Slots, about_x: float, about_y: float) -> Motion:
    px, py, moment = 0.0, 0.0, 0.0
    for p in range(state.owner.shape[0]):
        if torn[p] >= 0:
            x, y = state.mass[p] * state.velocity[p, 0], state.mass[p] * state.velocity[p, 1]
            px += x
            py += y
            moment += (state.position[p, 0] - about_x) * y - (state.position[p, 1] - about_y) * x
    return Motion(px, py, moment, about_x, about_y)


@inner_kernel
def settle_motion(state: State, good: GoodValues, torn: Slots, before: Motion) -> None:
    """Let those of them that can move take up, as one stiff body, what has changed of the motion since."""
    now = _about(state, torn, before.about_x, before.about_y)
    total, middle_x, middle_y, inertia = 0.0, 0.0, 0.0, 0.0
    for p in range(state.owner.shape[0]):
        if torn[p] >= 0 and state.inverse_mass[p] > 0.0:
            total += state.mass[p]
            middle_x += state.mass[p] * (state.position[p, 0] - before.about_x)
            middle_y += state.mass[p] * (state.position[p, 1] - before.about_y)
    if total == 0.0:
        return
    middle_x, middle_y = middle_x / total, middle_y / total
    x, y = (before.x - now.x) / total, (before.y - now.y) / total
    for p in range(state.owner.shape[0]):
        if torn[p] >= 0 and state.inverse_mass[p] > 0.0:
            dx, dy = state.position[p, 0] - before.about_x - middle_x, state.position[p, 1] - before.about_y - middle_y
            inertia += state.mass[p] * (dx * dx + dy * dy)
    moment = before.moment - now.moment - total * (middle_x * y - middle_y * x)
    turning = moment / inertia if inertia > 0.0 else 0.0
    for p in range(state.owner.shape[0]):
        if torn[p] >= 0:
            for axis in range(2 if state.inverse_mass[p] > 0.0 else 0):
                away = (
                    before.about_y + middle_y - state.position[p, 1]
                    if axis == 0
                    else (state.position[p, 0] - before.about_x - middle_x)
                )
                change = (x if axis == 0 else y) + turning * away
                state.velocity[p, axis] += change
                state.slow_velocity[p, axis] += change
            for axis in range(2):
                good.velocity[p, axis] = state.velocity[p, axis]
            state.energy_bank[p] = BANK_UNOPENED
