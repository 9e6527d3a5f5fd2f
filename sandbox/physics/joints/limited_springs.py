"""Springs of limited force: muscles and hydraulics that give way. Each is a row along its direction, out of the matrix.

Clamped is what the equation gives, |J| <= force h, in the form of the solver that it stands in:

    direct      J = -K (u' + beta x / h)          softness 1/K, target -beta x / h
    iterative   u' = u - (Cs x / h + Cd u)        softness 0, target u'

The single pass clamps the spring itself.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.equation import direction, implicit_masses, reduced_mass
from sandbox.physics.geometry.segment import difference
from sandbox.physics.jit import inner_kernel
from sandbox.physics.joints.rows import JointRows, clamped
from sandbox.physics.settings import DIRECT, SINGLE_PASS
from sandbox.physics.state import State
from sandbox.physics.world import LAW_NISSEN, Floats, Slots, World

# K at least, as a share of the reduced mass: of a spring without damping it would be 0, and 1/K infinite.
LEAST_SHARE = 1e-9


class LimitedRows(NamedTuple):
    """The springs of limited force, s of them, from row first[0] on: spring (s,): slots, force [N] (s,)."""

    first: Slots
    spring: Slots
    force: Floats


def force_limits(world: World) -> Floats:
    """The force [N] (m,) that each spring gives at most; infinite: without a limit."""
    return world.derived(_find_limits)


def _find_limits(world: World) -> Floats:
    limits = np.full(world.spring_count, np.inf)
    for driven in (world.actuators.muscles, world.actuators.hydraulics):
        if len(driven.force):
            limits[driven.spring] = np.minimum(limits[driven.spring], driven.force)
    return limits


def limited_springs(world: World) -> Slots:
    """The springs that solvers take as rows: of limited force, active, of the article's law, with an end that moves."""
    moves = (world.inverse_mass[world.particle_a] > 0.0) | (world.inverse_mass[world.particle_b] > 0.0)
    return np.flatnonzero(np.isfinite(force_limits(world)) & world.spring_active & (world.law == LAW_NISSEN) & moves)


def unlimited_active(world: World) -> NDArray[np.bool_]:
    """Which springs (m,) are active and no rows."""
    return world.derived(_find_unlimited)


def _find_unlimited(world: World) -> NDArray[np.bool_]:
    rest = world.spring_active.copy()
    rest[limited_springs(world)] = False
    return rest


def limited_particles(world: World, springs: Slots) -> list[Slots]:
    """The free particles of each row: both ends, or one."""
    ends = np.stack([world.particle_a[springs], world.particle_b[springs]], axis=1).astype(np.int64)
    return [pair[world.inverse_mass[pair] > 0.0] for pair in ends]


def limited_rows(world: World, springs: Slots, first: int) -> LimitedRows:
    """The input from which kernels fill the rows of these springs, which begin at the row `first`."""
    return LimitedRows(np.array([first]), springs, force_limits(world)[springs])


@inner_kernel
def load_limited(
    rows: JointRows, limited: LimitedRows, state: State, stiffness: Floats, damping: Floats, solver: int, h: float
) -> None:
    """Fill in the rows for a substep of h [s], in which springs have these Cs and Cd; solver: see settings.py.

    The impulse of a spring keeps J as the iterative solver keeps that of its springs.
    """
    position, velocity, inverse_mass = state.position, state.velocity, state.inverse_mass
    for i in range(limited.spring.shape[0]):
        s, k = limited.spring[i], limited.first[0] + i
        a, b = state.particle_a[s], state.particle_b[s]
        du, dv = difference(a, b, velocity)
        nx, ny, length = direction(position[b, 0] - position[a, 0], position[b, 1] - position[a, 1], du, dv)
        for e in range(rows.first[k], rows.first[k + 1]):
            sign = 1.0 if rows.particle[e] == b else -1.0
            rows.gradient[e, 0] = sign * nx
            rows.gradient[e, 1] = sign * ny
        x = length - state.rest_length[s]
        m = reduced_mass(inverse_mass[a], inverse_mass[b])
        if solver == DIRECT:
            stiff, restoring = implicit_masses(stiffness[s], damping[s], m)
            stiff = max(stiff, LEAST_SHARE * m)
            rows.softness[k] = 1.0 / stiff
            rows.target[k] = -restoring / stiff * x / h
        else:
            u = nx * du + ny * dv
            rows.softness[k] = 0.0
            rows.target[k] = u - (stiffness[s] * x / h + damping[s] * u)
        rows.limit[k] = limited.force[i] * h if solver != SINGLE_PASS else 0.0
        rows.impulse[k] = clamped(nx * state.impulse[s, 0] + ny * state.impulse[s, 1], rows.limit[k])


@inner_kernel
def store_limited(rows: JointRows, limited: LimitedRows, state: State, solver: int) -> None:
    """Keep the impulses for the next substep, where rows are on; those along each spring's first entry's direction."""
    for i in range(limited.spring.shape[0]):
        s, k = limited.spring[i], limited.first[0] + i
        e = rows.first[k]
        if solver != SINGLE_PASS:
            sign = 1.0 if rows.particle[e] == state.particle_b[s] else -1.0
            state.impulse[s, 0] = sign * rows.gradient[e, 0] * rows.impulse[k]
            state.impulse[s, 1] = sign * rows.gradient[e, 1] * rows.impulse[k]
