"""Springs of limited force: muscles and hydraulics that give way.

Clamped is what the equation gives, |J| <= force h. In the direct solver each is a row along its direction, out of the
matrix, J = -K (u' + beta x / h): softness 1/K, target -beta x / h. The other solvers clamp the spring itself, where it
stands among all springs: with a row apart a light particle between it and a heavy one would swing ever wider.
"""

import math
from typing import NamedTuple

from sandbox.physics.arena import Arena, is_full, new_flags, new_floats, new_slots
from sandbox.physics.arrays import Flags, Floats, Slots
from sandbox.physics.driving import Drives
from sandbox.physics.equation import direction, implicit_masses, reduced_mass
from sandbox.physics.geometry.segment import difference
from sandbox.physics.jit import inner_kernel
from sandbox.physics.joints.rows import JointRows, clamped
from sandbox.physics.marks import LAW_NISSEN
from sandbox.physics.state import State

# K at least, as a share of the reduced mass: of a spring without damping it would be 0, and 1/K infinite.
LEAST_STIFFNESS_SHARE = 1e-9


class LimitedRows(NamedTuple):
    """The springs of limited force, s of them, from row first[0] on: spring (s,): slots, force [N] (s,)."""

    first: Slots
    spring: Slots
    force: Floats


class SpringForces(NamedTuple):
    """Limits of force: limit [N] (m,), infinite: none; limited (k,): slots of the springs that can be rows.

    Those are active, of the article's law, with an end that moves. unlimited (m,): which are active and can be none.
    """

    limit: Floats
    limited: Slots
    unlimited: Flags


@inner_kernel
def new_spring_forces(state: State, drives: Drives, arena: Arena) -> SpringForces:
    """The limits of force of a world's springs, as its topology is now."""
    springs = state.law.shape[0]
    limit, limited, unlimited = new_floats(arena, springs), new_slots(arena, springs), new_flags(arena, springs)
    if is_full(arena):
        return SpringForces(limit, limited, unlimited)
    for s in range(springs):
        limit[s] = math.inf
    for k in range(drives.muscle.shape[0]):
        limit[drives.muscle[k]] = min(limit[drives.muscle[k]], drives.muscle_force[k])
    for k in range(drives.hydraulic.shape[0]):
        limit[drives.hydraulic[k]] = min(limit[drives.hydraulic[k]], drives.hydraulic_force[k])
    count = 0
    for s in range(springs):
        moves = state.inverse_mass[state.particle_a[s]] > 0.0 or state.inverse_mass[state.particle_b[s]] > 0.0
        is_row = limit[s] < math.inf and state.spring_active[s] and state.law[s] == LAW_NISSEN and moves
        unlimited[s] = state.spring_active[s] and not is_row
        if is_row:
            limited[count] = s
            count += 1
    return SpringForces(limit, limited[:count], unlimited)


@inner_kernel
def list_limited(state: State, forces: SpringForces, first_row: int, rows: JointRows, out: LimitedRows) -> None:
    """List the free particles of each spring's row, both ends or one, from row `first_row` on, and its force."""
    out.first[0] = first_row
    for i in range(forces.limited.shape[0]):
        s, e = forces.limited[i], rows.first[first_row + i]
        out.force[i] = forces.limit[s]
        for end in range(2):
            p = state.particle_a[s] if end == 0 else state.particle_b[s]
            if state.inverse_mass[p] > 0.0:
                rows.particle[e] = p
                e += 1
        rows.first[first_row + i + 1] = e


@inner_kernel
def load_limited(
    rows: JointRows, limited: LimitedRows, state: State, stiffness: Floats, damping: Floats, h: float
) -> None:
    """Fill in the rows for a substep of h [s], in which springs have these Cs and Cd.

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
        stiff, restoring = implicit_masses(stiffness[s], damping[s], m)
        stiff = max(stiff, LEAST_STIFFNESS_SHARE * m)
        rows.softness[k] = 1.0 / stiff
        rows.target[k] = -restoring / stiff * x / h
        rows.limit[k] = limited.force[i] * h
        rows.impulse[k] = clamped(nx * state.impulse[s, 0] + ny * state.impulse[s, 1], rows.limit[k])


@inner_kernel
def store_limited(rows: JointRows, limited: LimitedRows, state: State) -> None:
    """Keep the impulses for the next substep; those along each spring's first entry's direction."""
    for i in range(limited.spring.shape[0]):
        s, k = limited.spring[i], limited.first[0] + i
        e = rows.first[k]
        sign = 1.0 if rows.particle[e] == state.particle_b[s] else -1.0
        state.impulse[s, 0] = sign * rows.gradient[e, 0] * rows.impulse[k]
        state.impulse[s, 1] = sign * rows.gradient[e, 1] * rows.impulse[k]
