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
from sandbox.physics.world import LAW_NISSEN, Floats, Slots, World

# K at least, as a share of the reduced mass: of a spring without damping it would be 0, and 1/K infinite.
LEAST_SHARE = 1e-9


class LimitedRows(NamedTuple):
    """The springs of limited force, s of them, from row first[0] on: spring (s,): slots, force [N] (s,).

    Of all particles and springs: see StateArrays; impulse keeps J as the iterative solver keeps that of its springs.
    """

    first: Slots
    spring: Slots
    force: Floats
    position: Floats
    velocity: Floats
    inverse_mass: Floats
    particle_a: NDArray[np.int32]
    particle_b: NDArray[np.int32]
    rest_length: Floats
    impulse: Floats


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
    return LimitedRows(
        np.array([first]), springs, force_limits(world)[springs], world.position, world.velocity, world.inverse_mass,
        world.particle_a, world.particle_b, world.rest_length, world.impulse,
    )  # fmt: skip


@inner_kernel
def load_limited(
    rows: JointRows, limited: LimitedRows, stiffness: Floats, damping: Floats, form: int, h: float
) -> None:
    """Fill in the rows for a substep of h [s], in which springs have these Cs and Cd.

    form: 0 = the rows are off, 1 = that of the direct solver, 2 = that of the iterative one.
    """
    position, velocity, inverse_mass = limited.position, limited.velocity, limited.inverse_mass
    for i in range(limited.spring.shape[0]):
        s, k = limited.spring[i], limited.first[0] + i
        a, b = limited.particle_a[s], limited.particle_b[s]
        du, dv = difference(a, b, velocity)
        nx, ny, length = direction(position[b, 0] - position[a, 0], position[b, 1] - position[a, 1], du, dv)
        for e in range(rows.first[k], rows.first[k + 1]):
            sign = 1.0 if rows.particle[e] == b else -1.0
            rows.gradient[e, 0] = sign * nx
            rows.gradient[e, 1] = sign * ny
        x = length - limited.rest_length[s]
        m = reduced_mass(inverse_mass[a], inverse_mass[b])
        if form == 1:
            stiff, restoring = implicit_masses(stiffness[s], damping[s], m)
            stiff = max(stiff, LEAST_SHARE * m)
            rows.softness[k] = 1.0 / stiff
            rows.target[k] = -restoring / stiff * x / h
        else:
            u = nx * du + ny * dv
            rows.softness[k] = 0.0
            rows.target[k] = u - (stiffness[s] * x / h + damping[s] * u)
        rows.limit[k] = limited.force[i] * h if form > 0 else 0.0
        rows.impulse[k] = clamped(nx * limited.impulse[s, 0] + ny * limited.impulse[s, 1], rows.limit[k])


@inner_kernel
def keep_limited(rows: JointRows, limited: LimitedRows, form: int) -> None:
    """Keep the impulses for the next substep, where rows are on; those along each spring's first entry's direction."""
    for i in range(limited.spring.shape[0]):
        s, k = limited.spring[i], limited.first[0] + i
        e = rows.first[k]
        if form > 0:
            sign = 1.0 if rows.particle[e] == limited.particle_b[s] else -1.0
            limited.impulse[s, 0] = sign * rows.gradient[e, 0] * rows.impulse[k]
            limited.impulse[s, 1] = sign * rows.gradient[e, 1] * rows.impulse[k]
