"""Springs whose rest length is driven: muscles by the number of the tick, hydraulics by the value of their part.

One of limited force does not wind up: where it is held back its rest length stays as near to its length as its force
asks for, so that it does not leap when it is let go.
"""

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.jit import kernel, scalar_kernel
from sandbox.physics.solvers import SOLVERS
from sandbox.physics.world import LAW_HOOKE, Floats, Slots, World


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


@kernel
def _contract(
    tick: int, spring: Slots, amplitude: Floats, period: Slots, phase: Floats, natural_length: Floats, lengths: Floats
) -> None:
    # L = L0 (1 + amplitude wave)
    for k in range(spring.shape[0]):
        lengths[k] = natural_length[spring[k]] * (1.0 + amplitude[k] * wave(tick, period[k], phase[k]))


@kernel
def _extend(
    spring: Slots, shortest: Floats, longest: Floats, rate: Floats, part: Slots, returns: NDArray[np.bool_],
    actuator_value: Floats, natural_length: Floats, rest_length: Floats, h: float, lengths: Floats,
) -> None:  # fmt: skip
    # L += value rate h, within shortest..longest;  where it returns and the value is 0, towards L0 by rate h at most
    for k in range(spring.shape[0]):
        value, wanted = actuator_value[part[k]], rest_length[spring[k]]
        if returns[k] and value == 0.0:
            first = natural_length[spring[k]]
            wanted = min(max(first, wanted - rate[k] * h), wanted + rate[k] * h)
        else:
            wanted += value * rate[k] * h
        lengths[k] = min(max(wanted, shortest[k]), longest[k])


# How far a wave goes in a part of its period, at its steepest: the slope of its parabolas where they meet.
STEEPEST = 8.0


def _held_back(world: World, springs: Slots, force: Floats, stride: Floats, lengths: Floats) -> Floats:
    """Rest lengths [m] (k,) of springs, no further from the present ones than asks for force [N] and a tick's stride.

    |L - l| <= F / k + stride max(1, Cd / Cs): the damping resists the stride as well.
    """
    h = 1.0 / world.settings.tick_rate
    a, b = world.particle_a[springs], world.particle_b[springs]
    total = world.inverse_mass[a] + world.inverse_mass[b]
    mass = np.divide(1.0, total, out=np.zeros_like(total), where=total > 0.0)
    spring_constant = SOLVERS[world.settings.solver].spring_constant
    is_hooke = world.law[springs] == LAW_HOOKE
    constant = spring_constant(world.stiffness[springs], world.damping[springs], mass, h)
    constant = np.where(is_hooke, world.hooke_stiffness[springs], constant)
    resists = np.where(is_hooke, world.hooke_damping[springs] / h, world.damping[springs])
    restores = np.where(is_hooke, world.hooke_stiffness[springs], world.stiffness[springs])
    never = np.full_like(total, np.inf)
    ahead = np.divide(resists, restores, out=never.copy(), where=restores > 0.0)
    asked = np.divide(force, constant, out=never, where=constant > 0.0)
    # Between two pins no force moves anything.
    asked[total == 0.0] = 0.0
    asked += np.multiply(stride, np.maximum(1.0, ahead), out=np.zeros_like(total), where=stride > 0.0)
    dx, dy = world.position[b, 0] - world.position[a, 0], world.position[b, 1] - world.position[a, 1]
    present = np.sqrt(dx * dx + dy * dy)
    # Never below 0, which no rest length is.
    near = np.maximum(0.0, present - asked)
    return np.where(np.isfinite(force), np.minimum(np.maximum(lengths, near), present + asked), lengths)


def drive_muscles(world: World, tick: int) -> None:
    """Give every muscle the rest length that it has at a tick."""
    muscles = world.actuators.muscles
    if not len(muscles.spring):
        return
    lengths = np.zeros(len(muscles.spring))
    _contract(
        tick, muscles.spring, muscles.amplitude, muscles.period, muscles.phase, world.natural_length, lengths
    )  # fmt: skip
    if len(muscles.force):
        stride = STEEPEST * muscles.amplitude * world.natural_length[muscles.spring] / muscles.period
        lengths = _held_back(world, muscles.spring, muscles.force, stride, lengths)
    world.set_rest_lengths(muscles.spring, lengths)


def drives_springs(world: World) -> bool:
    """Whether a world has muscles or hydraulics."""
    return bool(len(world.actuators.muscles.spring) or len(world.actuators.hydraulics.spring))


def drive_springs(world: World) -> Floats:
    """Give driven springs the rest lengths of the coming tick's end; the rest lengths (m,) before, for their work."""
    before, hydraulics = world.rest_length.copy(), world.actuators.hydraulics
    drive_muscles(world, world.tick + 1)
    lengths = np.zeros(len(hydraulics.spring))
    _extend(
        hydraulics.spring, hydraulics.shortest, hydraulics.longest, hydraulics.rate, hydraulics.part,
        hydraulics.returns, world.actuator_value, world.natural_length, world.rest_length,
        1.0 / world.settings.tick_rate, lengths,
    )  # fmt: skip
    if len(hydraulics.force):
        stride = hydraulics.rate / world.settings.tick_rate
        lengths = _held_back(world, hydraulics.spring, hydraulics.force, stride, lengths)
        lengths = np.minimum(np.maximum(lengths, hydraulics.shortest), hydraulics.longest)
    world.set_rest_lengths(hydraulics.spring, lengths)
    return before
