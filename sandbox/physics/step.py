"""step(world): one tick on one screen. The order of its parts is part of the replay contract."""

from collections.abc import Sequence

import numpy as np

from sandbox.physics.jit import kernel
from sandbox.physics.meeting import leave, meet
from sandbox.physics.quarantine import contain_inputs, contain_outcome
from sandbox.physics.settings import AUTO, WorldSettings
from sandbox.physics.solvers import SOLVERS, halves
from sandbox.physics.solvers.direct import pattern_of
from sandbox.physics.solvers.dissection import dissect
from sandbox.physics.substeps import halve, substep_count
from sandbox.physics.world import Floats, World

# Changes only when the arithmetic of a tick changes; replays of another version are refused.
PHYSICS_VERSION = 1


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


def substep_time(settings: WorldSettings, parts: int | None = None) -> float:
    """Time step h [s] of one of `parts` substeps (None: of the fewest that the settings give a tick)."""
    return 1.0 / (settings.tick_rate * (parts or settings.fewest_substeps))


def substep_coefficients(world: World, parts: int | None = None) -> tuple[Floats, Floats]:
    """Cs and Cd (m,) of one substep, which leave every spring's motion from tick to tick as its Cs and Cd say.

    parts: substeps in the tick (None: the fewest that the settings give it).
    """
    stiffness, damping = world.stiffness.copy(), world.damping.copy()
    halve(stiffness, damping, parts or world.settings.fewest_substeps)
    return stiffness, damping


def step(world: World) -> None:
    """Advance the world by one tick of 1 / tick_rate seconds."""
    settings = world.settings
    solver = SOLVERS[settings.solver]
    contain_inputs(world)
    parts = substep_count(world)
    h = substep_time(settings, parts)
    # Solvers only read them, so a tick in one part needs no copies.
    whole = world.stiffness, world.damping
    stiffness, damping = whole if parts == 1 else substep_coefficients(world, parts)
    # What a solver keeps is an impulse of one step: exact, as parts are a power of two.
    world.scale_impulses(settings.fewest_substeps / parts)
    world.contacts = None
    for _ in range(parts):
        before = world.velocity.copy() if world.has_contacts else world.velocity
        _add_gravity(world.velocity, world.inverse_mass, world.particle_active, *settings.gravity, h)
        meeting = meet(world, before, h) if world.has_contacts else None
        solver.solve(world, stiffness, damping, h)
        if meeting is not None:
            leave(world, meeting, h)
        _integrate(world.position, world.velocity, world.particle_active, h)
    world.scale_impulses(parts / settings.fewest_substeps)
    world.rest_hands()
    world.tick += 1
    contain_outcome(world)


def warm_up(solvers: Sequence[str] = tuple(SOLVERS)) -> None:
    """Compile every kernel of a tick with these solvers, or load it from the cache, on a world of two particles."""
    for solver in solvers:
        world = World(WorldSettings(solver=solver, substeps=AUTO))
        world.add_particles(["a", "b"], np.array([[0.0, 0.0], [1.0, 0.0]]))
        world.add_springs(["s", "t"], [0, 0], [1, 1], law=[0, 1])
        step(world)
    if "direct" in solvers:
        # That is too small a body to be dissected by itself, or to need a second thread.
        dissect(np.array([0]), np.array([1]), world.position)
        pattern = pattern_of(world)
        halves.warm_up(pattern.matrix.fronts, pattern.rows.change)
