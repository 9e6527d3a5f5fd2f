"""Single pass: every spring and constraint evaluated once on the old velocities, the impulses summed (Nissen 2019).

Stable for Cs = Cd < 4 / (3 n_eff), see stability.py; never stiff. Joints are springs of it as well: what they are
clamped at carries only what springs as soft as these pass on, no wheel under a load.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.collision.types import LentContacts
from sandbox.physics.constraints import ConstraintArrays, constraint_rate, evaluate, explicit_mass, look
from sandbox.physics.equation import direction, explicit_spring_constant, reduced_mass, spring_impulse
from sandbox.physics.jit import bundle, contents, kernel
from sandbox.physics.joints.joint_set import joints_of
from sandbox.physics.joints.joint_sweep import Joints, couple_masses, iterate_joint, joints_by_mass
from sandbox.physics.joints.limited_springs import force_limits
from sandbox.physics.joints.rows import PAIR, SCALAR, clamped, row_velocity
from sandbox.physics.substeps import Pair, Substep
from sandbox.physics.world import Floats, World

# Cs and Cd of a joint: (Cs + 2 Cd) n < 4 for n = 1, which leaves room for the springs of what it acts on.
JOINT_STIFFNESS = 0.05
JOINT_DAMPING = 0.5


class Particles(NamedTuple):
    """The arrays of particles (n,) that an explicit solver reads: position [m], velocity [m/s], inverse mass [1/kg]."""

    position: Floats
    velocity: Floats
    inverse_mass: Floats


class Ends(NamedTuple):
    """The arrays of springs (m,) that an explicit solver reads: see StateArrays; stiffness and damping of the substep.

    limit [N]: the force that each gives at most.
    """

    particle_a: NDArray[np.int32]
    particle_b: NDArray[np.int32]
    rest_length: Floats
    stiffness: Floats
    damping: Floats
    law: NDArray[np.int8]
    hooke_stiffness: Floats
    hooke_damping: Floats
    limit: Floats


def particles_of(world: World) -> Particles:
    """The particles of a world as they are now."""
    return Particles(world.position, world.velocity, world.inverse_mass)


def ends_of(world: World, springs: Pair) -> Ends:
    """The springs of a world as they are now, with their Cs and Cd in a substep."""
    return Ends(
        world.particle_a, world.particle_b, world.rest_length, *springs, world.law, world.hooke_stiffness,
        world.hooke_damping, force_limits(world),
    )  # fmt: skip


@kernel
def _constraint_pass(
    particles: Particles, constraints: ConstraintArrays, stiffness: Floats, damping: Floats, h: float, place: Floats,
    slope: Floats, impulse: Floats,
) -> None:  # fmt: skip
    # J = -(Cs C / h + Cd dC/dt) m, along the gradient at each corner
    for k in range(constraints.kind.shape[0]):
        if not constraints.active[k]:
            continue
        first = constraints.first[k]
        last = first + constraints.corners[k]
        look(first, last, particles.position, constraints.particle, place)
        error = evaluate(constraints.kind[k], place, first, last, constraints.rest, k, constraints.weight, slope)
        mass, _ = explicit_mass(first, last, particles.inverse_mass, constraints.particle, constraints.weight, slope)
        rate = constraint_rate(first, last, particles.velocity, constraints.particle, slope)
        j = spring_impulse(stiffness[k], damping[k], error, rate, mass, h)
        for c in range(first, last):
            impulse[constraints.particle[c], 0] += j * slope[c, 0]
            impulse[constraints.particle[c], 1] += j * slope[c, 1]


@kernel
def _explicit_pass(
    particles: Particles, ends: Ends, chosen: NDArray[np.bool_], start: Floats, ease: float, h: float, impulse: Floats
) -> None:
    # Nissen: J = -(Cs x / h + Cd u) m_r.  Hooke: J = -(k x + c u) h / ease, u before forces: at rest it is 0, and so
    # k x alone carries a weight.  Then v += J w.
    position, velocity, inverse_mass = particles.position, particles.velocity, particles.inverse_mass
    for s in range(chosen.shape[0]):
        if not chosen[s]:
            continue
        a = ends.particle_a[s]
        b = ends.particle_b[s]
        mass = reduced_mass(inverse_mass[a], inverse_mass[b])
        if mass == 0.0:
            continue
        du = velocity[b, 0] - velocity[a, 0]
        dv = velocity[b, 1] - velocity[a, 1]
        nx, ny, length = direction(position[b, 0] - position[a, 0], position[b, 1] - position[a, 1], du, dv)
        x = length - ends.rest_length[s]
        u = nx * du + ny * dv
        if ends.law[s] == 0:
            j = spring_impulse(ends.stiffness[s], ends.damping[s], x, u, mass, h)
        else:
            u = nx * (start[b, 0] - start[a, 0]) + ny * (start[b, 1] - start[a, 1])
            j = -(ends.hooke_stiffness[s] * x + ends.hooke_damping[s] * u) * h / ease
        if ends.limit[s] < math.inf:
            j = clamped(j, ends.limit[s] * h)
        impulse[a, 0] -= j * nx
        impulse[a, 1] -= j * ny
        impulse[b, 0] += j * nx
        impulse[b, 1] += j * ny
    # The guard keeps pinned particles where they are also when a mistuned Hooke spring pulls with inf: inf * 0 is NaN.
    for p in range(inverse_mass.shape[0]):
        if inverse_mass[p] > 0.0:
            velocity[p, 0] += impulse[p, 0] * inverse_mass[p]
            velocity[p, 1] += impulse[p, 1] * inverse_mass[p]


def apply_explicit(world: World, chosen: NDArray[np.bool_], substep: Substep, constraints: Pair | None = None) -> None:
    """Evaluate the chosen springs (m,) on the present velocities and apply their summed impulses.

    constraints: Cs and Cd of all constraints, where they are to be too.
    """
    h = substep.h
    impulse, particles = np.zeros((world.particle_count, 2)), particles_of(world)
    if constraints is not None and world.constraint_count:
        place, slope = np.zeros((2, len(world.corner_particle), 2))
        _constraint_pass(particles, world.constraints, *constraints, h, place, slope, impulse)
    _explicit_pass(
        particles, ends_of(world, substep.springs), chosen, substep.step_start.velocity, substep.ease, h, impulse
    )


class ExplicitJoints(NamedTuple):
    """Joints of the single pass, and scratch by row: effective mass = 1 / (g W g), 0: a hand's; impulse in this step.

    rows.impulse is that of the spring part, -Cs m lag / h, whose lag runs on until the limit is reached.
    """

    joints: Joints
    mass: Floats
    given: Floats


@kernel
def _find_joint_impulses(lent: Any, velocity: Floats, inverse_mass: Floats, still: Floats) -> None:
    # J = -(Cs lag / h + Cd (u - target)) m, the lag's part kept from step to step
    (explicit,) = contents(lent)
    rows = explicit.joints.rows
    couple_masses(explicit.joints, inverse_mass)
    for k in range(rows.limit.shape[0]):
        response = explicit.joints.response[k, k]
        explicit.mass[k] = 1.0 / response if response > 0.0 and rows.pair[k] == SCALAR else 0.0
        lag = rows.impulse[k] if rows.pair[k] == SCALAR else 0.0
        u = row_velocity(rows, k, velocity, still)
        explicit.given[k] = clamped(lag - JOINT_DAMPING * (u - rows.target[k]) * explicit.mass[k], rows.limit[k])


@kernel
def _give_joint_impulses(lent: Any, velocity: Floats, inverse_mass: Floats, still: Floats) -> None:
    (explicit,) = contents(lent)
    joints, rows = explicit.joints, explicit.joints.rows
    for k in range(rows.limit.shape[0]):
        for e in range(rows.first[k], rows.first[k + 1]):
            p = rows.particle[e]
            velocity[p, 0] += rows.gradient[e, 0] * explicit.given[k] * inverse_mass[p]
            velocity[p, 1] += rows.gradient[e, 1] * explicit.given[k] * inverse_mass[p]
    # A hand comes last and has its velocity at once, as a pin that is moved: that is stable wherever the springs are.
    for k in range(rows.limit.shape[0]):
        if rows.pair[k] != SCALAR:
            rows.impulse[k] = 0.0
    for k in range(rows.limit.shape[0]):
        if rows.pair[k] == PAIR:
            iterate_joint(joints, k, still, velocity, inverse_mass)


@kernel
def _let_joints_follow(lent: Any, velocity: Floats, still: Floats) -> None:
    # lag += h (u' - target)
    (explicit,) = contents(lent)
    rows = explicit.joints.rows
    for k in range(rows.limit.shape[0]):
        u = row_velocity(rows, k, velocity, still)
        lag = rows.impulse[k] - JOINT_STIFFNESS * (u - rows.target[k]) * explicit.mass[k]
        rows.impulse[k] = clamped(lag, rows.limit[k]) if rows.pair[k] == SCALAR else rows.impulse[k]


def _lent_joints(world: World) -> Any:
    joints = joints_of(world)
    if joints is None:
        return None
    count = len(joints.rows.limit)
    return bundle((ExplicitJoints(joints_by_mass(joints.rows), np.zeros(count), np.zeros(count)),))


spring_constant = explicit_spring_constant


def solve(world: World, substep: Substep, contacts: LentContacts | None) -> None:
    """Bring the velocities to the end of a substep; contacts are swept after springs, constraints and joints."""
    joints = world.derived(_lent_joints)
    if joints is not None:
        still = np.zeros((world.particle_count, 2))
        _find_joint_impulses(joints, world.velocity, world.inverse_mass, still)
    apply_explicit(world, world.spring_active, substep, substep.constraints)
    if joints is not None:
        _give_joint_impulses(joints, world.velocity, world.inverse_mass, still)
    if contacts is not None:
        from sandbox.physics.solvers.contact.body_impacts import sweep_masses
        from sandbox.physics.solvers.contact.gauss_seidel import lent_masses, new_contact_constraints

        count = world.particle_count
        sweep_masses(
            contacts.arrays, new_contact_constraints(len(contacts.arrays.particle), np.zeros(count)), world.velocity,
            np.zeros((count, 2)), world.inverse_mass, world.spin, world.radius, world.derived(lent_masses),
            world.settings.iterations, substep.h,
        )  # fmt: skip
    if joints is not None:
        _let_joints_follow(joints, world.velocity, still)
