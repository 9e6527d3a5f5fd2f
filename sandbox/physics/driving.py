"""Springs whose rest length is driven: muscles by the number of the tick, hydraulics by the value of their part."""

import numpy as np

from sandbox.physics.jit import kernel, scalar_kernel
from sandbox.physics.world import Floats, World


@scalar_kernel
def wave(tick, period, phase):  # type: ignore[no-untyped-def]
    """A wave of -1..1 at a tick: two parabolas, as smooth as a sine to the eye, that repeat exactly after a period."""
    # u = the part of the period that is over;  16 u (1/2 - u) in its first half, -16 (u - 1/2) (1 - u) in its second
    u = (tick % period) / period + phase
    if u >= 1.0:
        u -= 1.0
    if u < 0.5:
        return 16.0 * u * (0.5 - u)
    return -16.0 * (u - 0.5) * (1.0 - u)


@kernel
def _contract(tick, spring, amplitude, period, phase, natural_length, lengths):  # type: ignore[no-untyped-def]
    # L = L0 (1 + amplitude wave)
    for k in range(spring.shape[0]):
        lengths[k] = natural_length[spring[k]] * (1.0 + amplitude[k] * wave(tick, period[k], phase[k]))


@kernel
def _extend(spring, shortest, longest, rate, part, actuator_value, rest_length, h, lengths):  # type: ignore[no-untyped-def]
    # L += value rate h, within shortest..longest
    for k in range(spring.shape[0]):
        wanted = rest_length[spring[k]] + actuator_value[part[k]] * rate[k] * h
        lengths[k] = min(max(wanted, shortest[k]), longest[k])


def drive_muscles(world: World, tick: int) -> None:
    """Give every muscle the rest length that it has at a tick."""
    muscles = world.actuators.muscles
    if not len(muscles.spring):
        return
    lengths = np.zeros(len(muscles.spring))
    _contract(
        tick, muscles.spring, muscles.amplitude, muscles.period, muscles.phase, world.natural_length, lengths
    )  # fmt: skip
    world.set_rest_lengths(muscles.spring, lengths)


def drive_springs(world: World) -> Floats:
    """Give driven springs the rest lengths of the coming tick's end; the rest lengths (m,) before, for their work."""
    before, hydraulics = world.rest_length, world.actuators.hydraulics
    if not len(world.actuators.muscles.spring) and not len(hydraulics.spring):
        return before
    before = before.copy()
    drive_muscles(world, world.tick + 1)
    lengths = np.zeros(len(hydraulics.spring))
    _extend(
        hydraulics.spring, hydraulics.shortest, hydraulics.longest, hydraulics.rate, hydraulics.part,
        world.actuator_value, world.rest_length, 1.0 / world.settings.tick_rate, lengths,
    )  # fmt: skip
    world.set_rest_lengths(hydraulics.spring, lengths)
    return before
