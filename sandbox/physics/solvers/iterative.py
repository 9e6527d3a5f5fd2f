"""Iterative, warm-started: springs and constraints in order, N times, on a velocity change.

No proven limit. Only springs are warm-started. Hooke springs are no constraints: they act once, explicitly, before the
iterations. Source: Nissen's demo programs after the article.
"""

from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.collision.types import NO_CONTACTS, LentContacts
from sandbox.physics.constraints import AREA, BEND, ConstraintArrays, constraint_rate, evaluate, explicit_mass, look
from sandbox.physics.equation import direction, explicit_spring_constant, reduced_mass, spring_impulse
from sandbox.physics.jit import bundle, contents, inner_kernel, kernel
from sandbox.physics.joints.joint_set import joints_of
from sandbox.physics.joints.joint_sweep import iterate_joints, joints_by_mass, no_joints, warm_start_joints
from sandbox.physics.joints.limited_springs import unlimited_active
from sandbox.physics.solvers.contact.body_impacts import pass_on
from sandbox.physics.solvers.contact.gauss_seidel import (
    ContactConstraints,
    Delassus,
    add_change,
    load_biases,
    load_responses,
    load_surfaces,
    new_contact_constraints,
    no_blocks,
    store_spins,
    sweep,
    warm_start_contacts,
)
from sandbox.physics.solvers.lent_substep import LentSubstep, SubstepArrays
from sandbox.physics.solvers.single_pass import Particles, apply_explicit, particles_of
from sandbox.physics.substeps import Substep
from sandbox.physics.world import LAW_HOOKE, LAW_NISSEN, Floats, Slots, World

# The share of what an area still wants that it gets in an iteration after the first. With all of it jellies and rings,
# which have more constraints than ways to move, gain energy several times over; with 0.3 or less a crushed jelly stays
# crushed.
AREA_SHARE = 0.5
# Room for contacts is made for so many times as many as are wanted.
MORE_ROOM = 2


class Wanted(NamedTuple):
    """Scratch of the constraints: corners' places and gradients (q, 2), and of each (t,) what `_iterate_constraints`
    says.

    wanted = -(Cs C / h + Cd dC/dt) m; impulse = the sum of its j. Of a bend, damped = Cd m, kept = 1 - Cd and whole =
    kept + Cd m / present mass. Of an area, as of a spring, damped = m, kept = 0 and whole = 1, then 1 / AREA_SHARE.
    """

    place: Floats
    slope: Floats
    wanted: Floats
    damped: Floats
    kept: Floats
    whole: Floats
    impulse: Floats


class Pulling(NamedTuple):
    """Scratch of the springs that do something, count of them by slot: wanted [m/s] = r, mass [kg], normal (m, 2).

    By particle: change [m/s] (n, 2). By slot of all springs: accumulated [N s] (m, 2), which outlives the step.
    """

    slot: Slots
    normal: Floats
    wanted: Floats
    mass: Floats
    change: Floats
    accumulated: Floats


class IteratedSprings(NamedTuple):
    """Springs (m,) as steps read them, see StateArrays; slots of those that are iterated, in two orders.

    listed: as they are. heavy_first: those of heavy particles first.
    """

    particle_a: NDArray[np.int32]
    particle_b: NDArray[np.int32]
    rest_length: Floats
    listed: Slots
    heavy_first: Slots


class Turning(NamedTuple):
    """How particles (n,) turn: spin [rad/s], radius [m]."""

    spin: Floats
    radius: Floats


class Iteration(NamedTuple):
    """The arrays of a world that steps read and fill in; they stay until its topology changes."""

    particles: Particles
    turning: Turning
    springs: IteratedSprings
    pulling: Pulling
    constraints: ConstraintArrays
    wanted: Wanted
    delassus: Delassus


@inner_kernel
def _prepare_constraints(
    particles: Particles, constraints: ConstraintArrays, given: SubstepArrays, h: float, wanted: Wanted
) -> None:
    # wanted = -(Cs C / h + Cd dC/dt) m
    for k in range(constraints.kind.shape[0]):
        wanted.whole[k] = 0.0
        if not constraints.active[k]:
            continue
        first = constraints.first[k]
        last = first + constraints.corners[k]
        look(first, last, particles.position, constraints.particle, wanted.place)
        error = evaluate(
            constraints.kind[k], wanted.place, first, last, constraints.rest, k, constraints.weight, wanted.slope
        )  # fmt: skip
        mass, share = explicit_mass(
            first, last, particles.inverse_mass, constraints.particle, constraints.weight, wanted.slope
        )  # fmt: skip
        rate = constraint_rate(first, last, particles.velocity, constraints.particle, wanted.slope)
        damping = given.constraint_damping[k]
        wanted.wanted[k] = spring_impulse(given.constraint_stiffness[k], damping, error, rate, mass, h)
        if constraints.kind[k] == BEND:
            wanted.damped[k] = damping * mass
            wanted.kept[k] = 1.0 - damping
            wanted.whole[k] = wanted.kept[k] + damping * share
        else:
            wanted.damped[k] = mass
            wanted.kept[k] = 0.0
            wanted.whole[k] = 1.0
        wanted.impulse[k] = 0.0


@inner_kernel
def _iterate_constraints(inverse_mass: Floats, constraints: ConstraintArrays, wanted: Wanted, change: Floats) -> None:
    # A bend obeys (1 - Cd) j = -(Cs C / h + Cd (dC/dt + g . dv)) m, the equation with the velocity after the step
    # (equation.py): so can all of more bends than there are ways to bend. Both go at once into the velocity change dv.
    for k in range(constraints.kind.shape[0]):
        if wanted.whole[k] == 0.0:
            continue
        first = constraints.first[k]
        last = first + constraints.corners[k]
        rate = constraint_rate(first, last, change, constraints.particle, wanted.slope)
        j = (wanted.wanted[k] - wanted.damped[k] * rate - wanted.kept[k] * wanted.impulse[k]) / wanted.whole[k]
        wanted.impulse[k] += j
        if constraints.kind[k] == AREA:
            wanted.whole[k] = 1.0 / AREA_SHARE
        for c in range(first, last):
            p = constraints.particle[c]
            change[p, 0] += j * wanted.slope[c, 0] * inverse_mass[p]
            change[p, 1] += j * wanted.slope[c, 1] * inverse_mass[p]


@inner_kernel
def _prepare_springs(
    particles: Particles, springs: IteratedSprings, order: Slots, given: SubstepArrays, warm_start: float, h: float,
    pulling: Pulling,
) -> int:  # fmt: skip
    # r = -(Cs x / h + Cd u), the wanted change of relative velocity; how many springs want one.
    position, velocity, inverse_mass = particles.position, particles.velocity, particles.inverse_mass
    change, accumulated = pulling.change, pulling.accumulated
    count = 0
    for i in range(order.shape[0]):
        s = order[i]
        a = springs.particle_a[s]
        b = springs.particle_b[s]
        m = reduced_mass(inverse_mass[a], inverse_mass[b])
        # Warm start: p = n . acc; only a pull (p < 0) is used again, j = Cw p.
        warm_x = accumulated[s, 0]
        warm_y = accumulated[s, 1]
        accumulated[s, 0] = 0.0
        accumulated[s, 1] = 0.0
        if m == 0.0:
            continue
        du = velocity[b, 0] - velocity[a, 0]
        dv = velocity[b, 1] - velocity[a, 1]
        nx, ny, length = direction(position[b, 0] - position[a, 0], position[b, 1] - position[a, 1], du, dv)
        pulling.slot[count] = s
        pulling.normal[count, 0] = nx
        pulling.normal[count, 1] = ny
        pulling.mass[count] = m
        pulling.wanted[count] = spring_impulse(
            given.stiffness[s], given.damping[s], length - springs.rest_length[s], nx * du + ny * dv, 1.0, h
        )  # fmt: skip
        count += 1
        p = nx * warm_x + ny * warm_y
        if p < 0.0:
            j = warm_start * p
            change[a, 0] -= j * nx * inverse_mass[a]
            change[a, 1] -= j * ny * inverse_mass[a]
            change[b, 0] += j * nx * inverse_mass[b]
            change[b, 1] += j * ny * inverse_mass[b]
    return count


@inner_kernel
def _iterate_springs(
    count: int, inverse_mass: Floats, springs: IteratedSprings, pulling: Pulling, backwards: bool
) -> None:
    # j = -(n . (dv_b - dv_a) - r) m_r, applied at once to the velocity change dv.
    change, accumulated = pulling.change, pulling.accumulated
    for i in range(count):
        c = count - 1 - i if backwards else i
        s = pulling.slot[c]
        a = springs.particle_a[s]
        b = springs.particle_b[s]
        nx = pulling.normal[c, 0]
        ny = pulling.normal[c, 1]
        du = change[b, 0] - change[a, 0]
        dv = change[b, 1] - change[a, 1]
        j = -(nx * du + ny * dv - pulling.wanted[c]) * pulling.mass[c]
        jx = j * nx
        jy = j * ny
        change[a, 0] -= jx * inverse_mass[a]
        change[a, 1] -= jy * inverse_mass[a]
        change[b, 0] += jx * inverse_mass[b]
        change[b, 1] += jy * inverse_mass[b]
        accumulated[s, 0] += jx
        accumulated[s, 1] += jy


@kernel
def _iterate(
    lent: Any, lent_substep: Any, lent_contacts: Any, lent_terms: Any, iterations: int, warm_start: float,
    alternates: bool, h: float,
) -> None:  # fmt: skip
    # alternates: every other iteration goes through the springs backwards, as they are listed. In small steps what one
    # order has not carried through a wheel throws it off the ground; in one step a tick light wheels would sink in
    # under heavy loads. There each goes from the springs of heavy particles to those of light ones: what a load asks
    # for goes on to what bears it within an iteration, and a wheel of 0.2 kg a particle sinks 3 cm under 60 kg in place
    # of 9.
    (step,) = contents(lent)
    (given,) = contents(lent_substep)
    (contacts,) = contents(lent_contacts)
    (terms,) = contents(lent_terms)
    velocity, inverse_mass, change = step.particles.velocity, step.particles.inverse_mass, step.pulling.change
    spin, radius = step.turning.spin, step.turning.radius
    for p in range(change.shape[0]):
        change[p, 0] = 0.0
        change[p, 1] = 0.0
    load_surfaces(terms, spin, radius)
    order = step.springs.listed if alternates else step.springs.heavy_first
    load_biases(contacts, terms, h)
    load_responses(contacts, terms, inverse_mass, step.delassus)
    pass_on(contacts, terms, velocity, change, inverse_mass, step.delassus, h)
    count = _prepare_springs(step.particles, step.springs, order, given, warm_start, h, step.pulling)
    _prepare_constraints(step.particles, step.constraints, given, h, step.wanted)
    warm_start_contacts(contacts, terms, change, inverse_mass, step.delassus)
    warm_start_joints(step.delassus.joints, change, inverse_mass)
    for k in range(iterations):
        _iterate_springs(count, inverse_mass, step.springs, step.pulling, alternates and k % 2 == 1)
        _iterate_constraints(inverse_mass, step.constraints, step.wanted, change)
        iterate_joints(step.delassus.joints, velocity, change, inverse_mass)
        sweep(contacts, terms, velocity, change, inverse_mass, step.delassus)
    add_change(velocity, change, inverse_mass)
    store_spins(terms, spin, radius)


@dataclass(eq=False)
class IterationRoom:
    """The scratch of a world's steps, each part as one argument for kernels; hooke: springs by that law, None: none.

    no_contacts: in place of those of a step that finds none.
    """

    lent: Any
    terms: ContactConstraints
    lent_terms: Any
    no_contacts: Any
    hooke: NDArray[np.bool_] | None
    substep: LentSubstep = field(default_factory=LentSubstep)

    def grow(self, contacts: int) -> None:
        """Make room for a number of contacts."""
        if contacts > len(self.terms.bias):
            self.terms = new_contact_constraints(MORE_ROOM * contacts, self.terms.surface)
            self.lent_terms = bundle((self.terms,))


def _make_room(world: World) -> IterationRoom:
    listed, joints = np.flatnonzero(unlimited_active(world) & (world.law == LAW_NISSEN)), joints_of(world)
    moved = np.where(world.inverse_mass > 0.0, world.inverse_mass, np.inf)
    lightness = np.minimum(moved[world.particle_a[listed]], moved[world.particle_b[listed]])
    count, particles = len(listed), world.particle_count
    step = Iteration(
        particles_of(world),
        Turning(world.spin, world.radius),
        IteratedSprings(
            world.particle_a, world.particle_b, world.rest_length, listed, listed[np.argsort(lightness, kind="stable")]
        ),
        Pulling(
            np.zeros(count, np.int64), np.zeros((count, 2)), np.zeros(count), np.zeros(count), np.zeros((particles, 2)),
            world.impulse,
        ),
        world.constraints,
        Wanted(*np.zeros((2, len(world.corner_particle), 2)), *np.zeros((5, world.constraint_count))),
        no_blocks(particles, no_joints() if joints is None else joints_by_mass(joints.rows)),
    )  # fmt: skip
    terms, hooke = new_contact_constraints(0, np.zeros(particles)), world.spring_active & (world.law == LAW_HOOKE)
    lent_terms, nothing = bundle((terms,)), bundle((NO_CONTACTS,))
    return IterationRoom(bundle((step,)), terms, lent_terms, nothing, hooke if hooke.any() else None)


spring_constant = explicit_spring_constant


def solve(world: World, substep: Substep, contacts: LentContacts | None) -> None:
    """Bring the velocities to the end of a substep; world.impulse keeps the sums for the next warm start."""
    room, settings = world.derived(_make_room), world.settings
    if room.hooke is not None:
        apply_explicit(world, room.hooke, substep)
    if contacts is not None:
        room.grow(len(contacts.arrays.particle))
    _iterate(
        room.lent, room.substep.lend(substep), room.no_contacts if contacts is None else contacts.lent,
        room.lent_terms, settings.iterations, settings.warm_start, substep.substeps > 1, substep.h,
    )  # fmt: skip
