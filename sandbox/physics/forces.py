"""Gravity and air, which act on particles before the springs do. To the springs they are work from outside."""

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.jit import bundle, contents, inner_kernel, kernel
from sandbox.physics.settings import WorldSettings
from sandbox.physics.world import Floats, World


class StepStart(NamedTuple):
    """The start of a step, before forces and drives: velocity [m/s] (n, 2) and rest_length [m] (m,).

    A solver that tests energies measures the work of forces and drives by it.
    """

    velocity: Floats
    rest_length: Floats


class ForcedParticles(NamedTuple):
    """The arrays of a world that gravity and the air read and change, see StateArrays.

    start [m/s] (n, 2): the velocities at the start of the step. numbers (5,): gravity [m/s^2], wind [m/s], drag [1/s].
    """

    velocity: Floats
    inverse_mass: Floats
    gravity_scale: Floats
    particle_active: NDArray[np.bool_]
    start: Floats
    numbers: Floats


@dataclass(eq=False)
class Forces:
    """The scratch of a world's forces, and it as one argument; settings: those whose numbers are in it."""

    particles: ForcedParticles
    items: Any
    settings: WorldSettings | None = None


@inner_kernel
def add_gravity_and_air(particles: ForcedParticles, h: float) -> None:
    """Bring velocities of free particles from the start of a step of h [s] to where springs begin; keep those before.

    v += g h, times their gravity scale; then, with the air, v' = v + h drag (wind - v'), implicit:
    v += (1 - 1 / (1 + drag h)) (wind - v), which never overshoots.
    """
    velocity = particles.velocity
    gravity_x = particles.numbers[0]
    gravity_y = particles.numbers[1]
    wind_x = particles.numbers[2]
    wind_y = particles.numbers[3]
    drag = particles.numbers[4]
    share = drag * h / (1.0 + drag * h)
    for p in range(particles.inverse_mass.shape[0]):
        particles.start[p, 0] = velocity[p, 0]
        particles.start[p, 1] = velocity[p, 1]
        if particles.particle_active[p] and particles.inverse_mass[p] > 0.0:
            velocity[p, 0] += gravity_x * particles.gravity_scale[p] * h
            velocity[p, 1] += gravity_y * particles.gravity_scale[p] * h
            if drag > 0.0:
                velocity[p, 0] += share * (wind_x - velocity[p, 0])
                velocity[p, 1] += share * (wind_y - velocity[p, 1])


@kernel
def _add_gravity_and_air(items: Any, h: float) -> None:
    (particles,) = contents(items)
    add_gravity_and_air(particles, h)


def forces_of(world: World) -> Forces:
    """The scratch of a world's forces, with the numbers of its present settings."""
    forces, settings = world.derived(_make_forces), world.settings
    if forces.settings is not settings:
        forces.particles.numbers[:] = (*settings.gravity, *settings.wind, settings.drag)
        forces.settings = settings
    return forces


def _make_forces(world: World) -> Forces:
    arrays = world.velocity, world.inverse_mass, world.gravity_scale, world.particle_active
    particles = ForcedParticles(*arrays, np.zeros_like(world.velocity), np.zeros(5))
    return Forces(particles, bundle((particles,)))


def apply_forces(forces: Forces, h: float) -> None:
    """Bring the velocities of free particles from the start of a step of h [s] to where its springs begin."""
    _add_gravity_and_air(forces.items, h)
