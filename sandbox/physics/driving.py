"""Springs whose rest length is driven: muscles by the number of the tick, hydraulics by the value of their part.

One of limited force does not wind up: where it is held back its rest length stays as near to its length as its force
asks for, so that it does not leap when it is let go.
"""

import math
from typing import NamedTuple

import numpy as np

from sandbox.physics.actuators import Actuators
from sandbox.physics.arrays import Flags, Floats, Slots
from sandbox.physics.equation import HIGHEST_COEFFICIENT, capped, reduced_mass
from sandbox.physics.jit import Bundle, bundle, inner_kernel, kernel, scalar_kernel, unpack
from sandbox.physics.marks import LAW_HOOKE
from sandbox.physics.settings import DIRECT
from sandbox.physics.state import GoodValues, State, good_of, state_of
from sandbox.physics.world import World

# How far a wave goes in a part of its period, at its steepest: the slope of its parabolas where they meet.
STEEPEST = 8.0


class Drives(NamedTuple):
    """The driven springs of a world as kernels read them: k muscles, then j hydraulics, see Muscles and Hydraulics.

    Forces are infinite where there is no limit.
    """

    muscle: Slots
    amplitude: Floats
    period: Slots
    phase: Floats
    muscle_force: Floats
    hydraulic: Slots
    shortest: Floats
    longest: Floats
    rate: Floats
    part: Slots
    hydraulic_force: Floats
    returns: Flags


def drives_of(actuators: Actuators) -> Drives:
    """The driven springs of some actuators."""
    muscles, hydraulics = actuators.muscles, actuators.hydraulics
    forces = [
        driven.force if len(driven.force) else np.full(len(driven.spring), np.inf) for driven in (muscles, hydraulics)
    ]
    return Drives(
        muscles.spring, muscles.amplitude, muscles.period, muscles.phase, forces[0], hydraulics.spring,
        hydraulics.shortest, hydraulics.longest, hydraulics.rate, hydraulics.part, forces[1], hydraulics.returns,
    )  # fmt: skip


@scalar_kernel
def wave(tick: int, period: int, phase: float) -> float:
    """A wave of -1..1 at a tick: two parabolas, as smooth as a sine to the eye, that repeat exactly after a period."""
    # u = the part of the period that is over;  16 u (1/2 - u) in its first half, -16 (u - 1/2) (1 - u) in its second
    u = (tick % period) / period + phase
    if u >= 1.0:
        u -= 1.0
    if u < 0.5:
        return 16.0 * u * (0.5 - u)
    return -16.0 * (u - 0.5) * (1.0 - u)


@inner_kernel
def _held_back(state: State, s: int, wanted: float, force: float, stride: float, solver: int, h: float) -> float:
    # The rest length of a spring, no further from the present one than asks for force [N] and a tick's stride:
    # |L - l| <= F / k + stride max(1, Cd / Cs): the damping resists the stride as well.
    if not force < math.inf:
        return wanted
    a, b = state.particle_a[s], state.particle_b[s]
    mass = reduced_mass(state.inverse_mass[a], state.inverse_mass[b])
    restores, resists = state.stiffness[s], state.damping[s]
    if state.law[s] == LAW_HOOKE:
        constant = state.hooke_stiffness[s]
        restores, resists = constant, state.hooke_damping[s] / h
    elif solver == DIRECT:
        stiffness, damping = capped(restores, resists, HIGHEST_COEFFICIENT)
        constant = stiffness * mass / ((1.0 - damping) * h * h)
    else:
        constant = restores * mass / (h * h)
    asked = force / constant if constant > 0.0 else math.inf
    if mass == 0.0:
        # Between two pins no force moves anything.
        asked = 0.0
    if stride > 0.0:
        asked += stride * max(1.0, resists / restores if restores > 0.0 else math.inf)
    dx = state.position[b, 0] - state.position[a, 0]
    dy = state.position[b, 1] - state.position[a, 1]
    present = math.sqrt(dx * dx + dy * dy)
    # Never below 0, which no rest length is.
    return min(max(wanted, max(0.0, present - asked)), present + asked)


@inner_kernel
def contract(
    state: State, good: GoodValues, drives: Drives, first: int, tick: int, solver: int, tick_rate: int
) -> None:  # fmt: skip
    """Give muscles, from the first on, the rest lengths that they have at a tick."""
    # L = L0 (1 + amplitude wave)
    for k in range(first, drives.muscle.shape[0]):
        s = drives.muscle[k]
        natural = state.natural_length[s]
        wanted = natural * (1.0 + drives.amplitude[k] * wave(tick, drives.period[k], drives.phase[k]))
        stride = STEEPEST * drives.amplitude[k] * natural / drives.period[k]
        state.rest_length[s] = _held_back(state, s, wanted, drives.muscle_force[k], stride, solver, 1.0 / tick_rate)
        good.rest_length[s] = state.rest_length[s]


@inner_kernel
def _extend(state: State, good: GoodValues, drives: Drives, solver: int, tick_rate: int) -> None:
    # L += value rate h, within shortest..longest;  where it returns and the value is 0, towards L0 by rate h at most
    h = 1.0 / tick_rate
    for k in range(drives.hydraulic.shape[0]):
        s = drives.hydraulic[k]
        value, rate, wanted = state.actuator_value[drives.part[k]], drives.rate[k], state.rest_length[s]
        if drives.returns[k] and value == 0.0:
            first = state.natural_length[s]
            wanted = min(max(first, wanted - rate * h), wanted + rate * h)
        else:
            wanted += value * rate * h
        wanted = min(max(wanted, drives.shortest[k]), drives.longest[k])
        wanted = _held_back(state, s, wanted, drives.hydraulic_force[k], rate / tick_rate, solver, h)
        state.rest_length[s] = min(max(wanted, drives.shortest[k]), drives.longest[k])
        good.rest_length[s] = state.rest_length[s]


@inner_kernel
def drive_springs(state: State, good: GoodValues, drives: Drives, tick: int, solver: int, tick_rate: int) -> None:
    """Give driven springs the rest lengths that they have at a tick; solver: see settings.py."""
    contract(state, good, drives, 0, tick, solver, tick_rate)
    _extend(state, good, drives, solver, tick_rate)


@kernel
def _drive_muscles(pointer: Bundle[tuple[State, GoodValues, Drives]], tick: int, solver: int, tick_rate: int) -> None:
    state, good, drives = unpack(pointer)
    contract(state, good, drives, 0, tick, solver, tick_rate)


def drive_muscles(world: World, tick: int) -> None:
    """Give every muscle the rest length that it has at a tick."""
    if len(world.actuators.muscles.spring):
        solver, tick_rate, *_ = world.settings.choices
        _drive_muscles(bundle((state_of(world), good_of(world), drives_of(world.actuators))), tick, solver, tick_rate)
