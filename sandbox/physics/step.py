"""step(world): one tick on one screen. The order of its parts is part of the replay contract."""

import numpy as np

from sandbox.physics.equation import half_step
from sandbox.physics.jit import kernel
from sandbox.physics.quarantine import contain_inputs, contain_outcome
from sandbox.physics.settings import WorldSettings
from sandbox.physics.solvers import SOLVERS
from sandbox.physics.solvers.dissection import dissect
from sandbox.physics.world import Floats, World

# Changes only when the arithmetic of a tick changes; replays of another version are refused.
PHYSICS_VERSION = 1


@kernel
def halve(stiffness, damping, substeps):  # type: ignore[no-untyped-def]
    """Turn Cs and Cd (m,) of a tick into those of a substep, in place; substeps is a power of two."""
    # One exact halving of h at a time.
    for s in range(stiffness.shape[0]):
        parts = 1
        while parts < substeps:
            stiffness[s], damping[s] = half_step(stiffness[s], damping[s])
            parts *= 2


@kernel
def _add_gravity(velocity, inverse_mass, active, gravity_x, gravity_y, h):  # type: ignore[no-untyped-def]
    # v += g h for free particles.
    for p in range(inverse_mass.shape[0]):
        if active[p] and inverse_mass[p] > 0.0:
            velocity[p, 0] += gravity_x * h
            velocity[p, 1] += gravity_y * h


@kernel
def _integrate(position, velocity, active, h):  # type: ignore[no-untyped-def]
    # Symplectic Euler: x += v h with the NEW velocity; the equation is derived for it.
    for p in range(active.shape[0]):
        if active[p]:
            position[p, 0] += velocity[p, 0] * h
            position[p, 1] += velocity[p, 1] * h


def substep_time(settings: WorldSettings) -> float:
    """Time step h [s] of one substep."""
    return 1.0 / (settings.tick_rate * settings.substeps)


def substep_coefficients(world: World) -> tuple[Floats, Floats]:
    """Cs and Cd (m,) of one substep, which leave every spring's motion from tick to tick as its Cs and Cd say."""
    stiffness, damping = world.stiffness.copy(), world.damping.copy()
    halve(stiffness, damping, world.settings.substeps)
    return stiffness, damping


def step(world: World) -> None:
    """Advance the world by one tick of 1 / tick_rate seconds."""
    settings = world.settings
    solver = SOLVERS[settings.solver]
    h = substep_time(settings)
    contain_inputs(world)
    stiffness, damping = substep_coefficients(world)
    for _ in range(settings.substeps):
        _add_gravity(world.velocity, world.inverse_mass, world.particle_active, *settings.gravity, h)
        solver.solve(world, stiffness, damping, h)
        _integrate(world.position, world.velocity, world.particle_active, h)
    world.rest_hands()
    world.tick += 1
    contain_outcome(world)


def warm_up() -> None:
    """Compile every kernel of a tick, or load it from the cache, on a world of two particles."""
    for solver in SOLVERS:
        world = World(WorldSettings(solver=solver, substeps=2))
        world.add_particles(["a", "b"], np.array([[0.0, 0.0], [1.0, 0.0]]))
        world.add_springs(["s", "t"], [0, 0], [1, 1], law=[0, 1])
        step(world)
    # That is too small a body to be dissected by itself.
    dissect(np.array([0]), np.array([1]), world.position)
