"""Actuators of a world, constant while it runs, and the springs among them, whose rest length is driven in each tick.

Muscles are driven by the number of the tick, hydraulics by the value of their part; motors: see joints/joint_set.py.
One of limited force does not wind up: where it is held back its rest length stays as near to its length as its force
asks for, so that it does not leap when it is let go.
"""

import math
from dataclasses import dataclass, field
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.arrays import Flags, Floats, Slots
from sandbox.physics.equation import HIGHEST_COEFFICIENT, capped, reduced_mass
from sandbox.physics.jit import Bundle, inner_kernel, kernel, scalar_kernel, unpack
from sandbox.physics.marks import LAW_HOOKE
from sandbox.physics.settings import DIRECT
from sandbox.physics.state import GoodValues, State

# How far a wave goes in a part of its period, at its steepest: the slope of its parabolas where they meet.
STEEPEST = 8.0

_slots: Any = partial(np.zeros, 0, np.int64)
_flags: Any = partial(np.zeros, 0, np.bool_)
_floats: Any = partial(np.zeros, 0, np.float64)


@dataclass(frozen=True, eq=False)
class Muscles:
    """Springs whose rest length follows a wave: slot, amplitude as a share of the natural length, period [ticks] of 2
    or more, phase 0..1, force [N] at most; each (k,), force also (0,): without limits."""

    spring: Slots = field(default_factory=_slots)
    amplitude: Floats = field(default_factory=_floats)
    period: Slots = field(default_factory=_slots)
    phase: Floats = field(default_factory=_floats)
    force: Floats = field(default_factory=_floats)


@dataclass(frozen=True, eq=False)
class Hydraulics:
    """Springs whose rest length goes from shortest to longest [m] at rate [m/s] times their part's value.

    force [N] at most; returns: whether it goes back to its natural length at that rate while the value is 0. Each (k,);
    force also (0,): without limits; returns not given: none does.
    """

    spring: Slots = field(default_factory=_slots)
    shortest: Floats = field(default_factory=_floats)
    longest: Floats = field(default_factory=_floats)
    rate: Floats = field(default_factory=_floats)
    part: Slots = field(default_factory=_slots)
    force: Floats = field(default_factory=_floats)
    returns: NDArray[np.bool_] = field(default_factory=_flags)

    def __post_init__(self) -> None:
        if len(self.returns) != len(self.spring):
            object.__setattr__(self, "returns", np.zeros(len(self.spring), dtype=np.bool_))


@dataclass(frozen=True, eq=False)
class Motors:
    """Wheels that are turned about their hubs: hub slot, speed [rad/s], largest torque [N m], part; each (k,).

    rim[rim_start[k]:rim_start[k + 1]] are the particles of wheel k without its hub.
    """

    hub: Slots = field(default_factory=_slots)
    speed: Floats = field(default_factory=_floats)
    torque: Floats = field(default_factory=_floats)
    part: Slots = field(default_factory=_slots)
    rim_start: Slots = field(default_factory=lambda: np.zeros(1, dtype=np.int64))
    rim: Slots = field(default_factory=_slots)


@dataclass(frozen=True, eq=False)
class Actuators:
    """Everything that is driven; names: of the motors and hydraulics that a command can drive."""

    names: tuple[str, ...] = ()
    muscles: Muscles = field(default_factory=Muscles)
    hydraulics: Hydraulics = field(default_factory=Hydraulics)
    motors: Motors = field(default_factory=Motors)

    def springs(self, count: int) -> NDArray[np.bool_]:
        """Which of the first `count` springs have a rest length that is driven."""
        driven = np.zeros(count, dtype=np.bool_)
        driven[self.muscles.spring] = driven[self.hydraulics.spring] = True
        return driven


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
    dx, dy = state.position[b, 0] - state.position[a, 0], state.position[b, 1] - state.position[a, 1]
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
def drive_springs(state: State, good: GoodValues, drives: Drives, tick: int, solver: int, tick_rate: int) -> None:
    """Give driven springs the rest lengths that they have at a tick; solver: see settings.py."""
    contract(state, good, drives, 0, tick, solver, tick_rate)
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


@kernel
def drive_muscles(pointer: Bundle[tuple[State, GoodValues, Drives]], tick: int, solver: int, tick_rate: int) -> None:
    """Give every muscle the rest length that it has at a tick."""
    state, good, drives = unpack(pointer)
    contract(state, good, drives, 0, tick, solver, tick_rate)
