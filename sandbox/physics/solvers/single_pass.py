"""Single pass: every spring and constraint evaluated once on the old velocities, the impulses summed (Nissen 2019).

Stable for Cs = Cd < 4 / (3 n_eff), see stability.py; never stiff. Joints are springs of it as well: what they are
clamped at carries only what springs as soft as these pass on, no wheel under a load.
"""

import math
from typing import Annotated, NamedTuple

from sandbox.physics.arena import Arena, is_full, new_flags, new_tuple
from sandbox.physics.arrays import Flags, FloatRows, Floats
from sandbox.physics.collision.types import Contacts
from sandbox.physics.constraints import constraint_rate, constraints_of, evaluate, explicit_mass, look
from sandbox.physics.equation import direction, explicit_spring_constant, reduced_mass, spring_impulse
from sandbox.physics.jit import inner_kernel
from sandbox.physics.joints.joint_rows import (
    PAIR,
    SCALAR,
    Joints,
    clamped,
    couple_masses,
    give_impulse,
    iterate_joint,
    own_response,
    row_velocity,
)
from sandbox.physics.marks import LAW_HOOKE, LAW_NISSEN
from sandbox.physics.solvers.contact.contact_solve import sweep_masses
from sandbox.physics.solvers.contact.gauss_seidel import ContactConstraints, ContactOrder, Delassus
from sandbox.physics.solvers.inputs import Inputs
from sandbox.physics.state import State

# Cs and Cd of a joint: (Cs + 2 Cd) n < 4 for n = 1, which leaves room for the springs of what it acts on.
JOINT_STIFFNESS = 0.05
JOINT_DAMPING = 0.5
spring_constant = explicit_spring_constant


class ExplicitPass(NamedTuple):
    """Columns of springs (m,) that an explicit pass reads, and its scratch."""

    joints: Joints  # of particles that answer by their own mass
    chosen: Flags  # (m,): the springs that it evaluates
    limit: Floats  # [N] (m,): the force that each gives at most
    impulse: Annotated[FloatRows, "particles, 2"]  # [N s] (n, 2)
    still: Annotated[FloatRows, "particles, 2"]  # [m/s] (n, 2): 0
    change: Annotated[FloatRows, "particles, 2"]  # [m/s] (n, 2)
    place: Annotated[FloatRows, "corners, 2"]  # (q, 2) by corner, as slope
    slope: Annotated[FloatRows, "corners, 2"]
    mass: Floats  # [kg] by row of joints: 1 / (g W g), 0: a hand's
    joint_impulse: Floats  # [N s] by row of joints: of this step


@inner_kernel
def new_explicit_pass(state: State, limit: Floats, hooke: bool, given: ExplicitPass, arena: Arena) -> ExplicitPass:
    """An explicit pass over all active springs, or those of Hooke's law alone, with the joints that are given.

    limit [N] (m,): the force that each spring gives at most.
    """
    chosen = state.spring_active
    if hooke:
        chosen = new_flags(arena, state.law.shape[0])
        if not is_full(arena):
            for s in range(chosen.shape[0]):
                chosen[s] = state.spring_active[s] and state.law[s] == LAW_HOOKE
    return new_tuple(
        ExplicitPass, arena, joints=given.joints, chosen=chosen, limit=limit, mass=given.mass,
        joint_impulse=given.joint_impulse, particles=state.owner.shape[0], corners=state.corner_particle.shape[0],
    )  # fmt: skip


@inner_kernel
def solve(
    state: State, step: ExplicitPass, inputs: Inputs, contacts: Contacts, terms: ContactConstraints,
    order: ContactOrder, delassus: Delassus, sweeps: int, h: float,
) -> None:  # fmt: skip
    """Bring the velocities to the end of a substep of h [s]; contacts are swept after springs, constraints and joints.

    delassus: of particles that answer by their own mass, without joints.
    """
    # J = -(Cs lag / h + Cd (u - target)) m, the lag's part kept from step to step: rows.impulse is that of the spring
    # part, -Cs m lag / h, whose lag runs on until the limit is reached.
    joints = step.joints
    rows = joints.rows
    couple_masses(joints, state.inverse_mass)
    for k in range(rows.limit.shape[0]):
        response = own_response(joints, k)
        step.mass[k] = 1.0 / response if response > 0.0 and rows.pair[k] == SCALAR else 0.0
        lag = rows.impulse[k] if rows.pair[k] == SCALAR else 0.0
        u = row_velocity(rows, k, state.velocity, step.still)
        step.joint_impulse[k] = clamped(lag - JOINT_DAMPING * (u - rows.target[k]) * step.mass[k], rows.limit[k])
    apply_explicit(state, inputs, step, True, h)
    for k in range(rows.limit.shape[0]):
        give_impulse(rows, k, step.joint_impulse[k], state.velocity, state.inverse_mass)
    # A hand comes last and has its velocity at once, as a pin that is moved: that is stable wherever the springs are.
    for k in range(rows.limit.shape[0]):
        if rows.pair[k] == PAIR:
            rows.impulse[k] = rows.impulse[k + 1] = 0.0
            iterate_joint(joints, k, step.still, state.velocity, state.inverse_mass)
    if contacts.particle.shape[0] > 0:
        sweep_masses(contacts, terms, order, state, step.change, delassus, sweeps, h)
    # lag += h (u' - target)
    for k in range(rows.limit.shape[0]):
        u = row_velocity(rows, k, state.velocity, step.still)
        lag = rows.impulse[k] - JOINT_STIFFNESS * (u - rows.target[k]) * step.mass[k]
        rows.impulse[k] = clamped(lag, rows.limit[k]) if rows.pair[k] == SCALAR else rows.impulse[k]


@inner_kernel
def apply_explicit(state: State, inputs: Inputs, step: ExplicitPass, constrains: bool, h: float) -> None:
    """Evaluate the chosen springs on the present velocities and apply their summed impulses over a step of h [s].

    constrains: all constraints too.
    """
    inverse_mass, impulse = state.inverse_mass, step.impulse
    for p in range(inverse_mass.shape[0]):
        impulse[p, 0] = 0.0
        impulse[p, 1] = 0.0
    if constrains:
        _add_constraint_impulses(state, inputs, step, h)
    _add_spring_impulses(state, inputs, step, h)
    # The guard keeps pinned particles where they are also when a mistuned Hooke spring pulls with inf: inf * 0 is NaN.
    for p in range(inverse_mass.shape[0]):
        if inverse_mass[p] > 0.0:
            state.velocity[p, 0] += impulse[p, 0] * inverse_mass[p]
            state.velocity[p, 1] += impulse[p, 1] * inverse_mass[p]


@inner_kernel
def _add_constraint_impulses(state: State, inputs: Inputs, step: ExplicitPass, h: float) -> None:
    # J = -(Cs C / h + Cd dC/dt) m, along the gradient at each corner
    constraints, place, slope = constraints_of(state), step.place, step.slope
    for k in range(constraints.kind.shape[0]):
        if not constraints.active[k]:
            continue
        first = constraints.first[k]
        last = first + constraints.corners[k]
        look(first, last, state.position, constraints.particle, place)
        error = evaluate(constraints.kind[k], place, first, last, constraints.rest, k, constraints.weight, slope)
        mass, _ = explicit_mass(first, last, state.inverse_mass, constraints.particle, constraints.weight, slope)
        rate = constraint_rate(first, last, state.velocity, constraints.particle, slope)
        j = spring_impulse(inputs.constraint_stiffness[k], inputs.constraint_damping[k], error, rate, mass, h)
        for c in range(first, last):
            step.impulse[constraints.particle[c], 0] += j * slope[c, 0]
            step.impulse[constraints.particle[c], 1] += j * slope[c, 1]


@inner_kernel
def _add_spring_impulses(state: State, inputs: Inputs, step: ExplicitPass, h: float) -> None:
    # Nissen: J = -(Cs x / h + Cd u) m_r.  Hooke: J = -(k x + c u) h / drag_factor, u before forces: at rest that is 0,
    # and so k x alone carries a weight.
    position, velocity, inverse_mass, start = state.position, state.velocity, state.inverse_mass, inputs.start
    impulse = step.impulse
    for s in range(step.chosen.shape[0]):
        if not step.chosen[s]:
            continue
        a = state.particle_a[s]
        b = state.particle_b[s]
        mass = reduced_mass(inverse_mass[a], inverse_mass[b])
        if mass == 0.0:
            continue
        du = velocity[b, 0] - velocity[a, 0]
        dv = velocity[b, 1] - velocity[a, 1]
        nx, ny, length = direction(position[b, 0] - position[a, 0], position[b, 1] - position[a, 1], du, dv)
        x = length - state.rest_length[s]
        u = nx * du + ny * dv
        if state.law[s] == LAW_NISSEN:
            j = spring_impulse(inputs.stiffness[s], inputs.damping[s], x, u, mass, h)
        else:
            u = nx * (start[b, 0] - start[a, 0]) + ny * (start[b, 1] - start[a, 1])
            j = -(state.hooke_stiffness[s] * x + state.hooke_damping[s] * u) * h / inputs.drag_factor
        if step.limit[s] < math.inf:
            j = clamped(j, step.limit[s] * h)
        impulse[a, 0] -= j * nx
        impulse[a, 1] -= j * ny
        impulse[b, 0] += j * nx
        impulse[b, 1] += j * ny
