"""Iterative, warm-started: springs and constraints in order, N times, on a velocity change.

No proven limit. Only springs are warm-started. Of a spring of limited force the sum of its impulses is clamped. Hooke
springs are no constraints: they act once, explicitly, before the iterations. Source: Nissen's demo programs after the
article.
"""

import math
from typing import Annotated, NamedTuple

from sandbox.physics.arena import Arena, give_back, is_full, mark, new_floats, new_slots, new_tuple
from sandbox.physics.arrays import FloatRows, Floats, Slots
from sandbox.physics.collision.types import Contacts
from sandbox.physics.constraints import (
    AREA,
    BEND,
    ConstraintArrays,
    constraint_rate,
    constraints_of,
    evaluate,
    explicit_mass,
    look,
)
from sandbox.physics.equation import direction, explicit_spring_constant, reduced_mass, spring_impulse
from sandbox.physics.jit import inner_kernel
from sandbox.physics.joints.joint_answers import Joints
from sandbox.physics.joints.joint_sweep import iterate_joints, warm_start_joints
from sandbox.physics.marks import LAW_NISSEN
from sandbox.physics.solvers.contact.body_impacts import propagate_all_impacts
from sandbox.physics.solvers.contact.contact_order import ContactOrder
from sandbox.physics.solvers.contact.gauss_seidel import (
    ContactConstraints,
    Delassus,
    add_change,
    load_biases,
    load_responses,
    load_surfaces,
    store_spins,
    sweep,
    warm_start_contacts,
)
from sandbox.physics.solvers.held_springs import (
    HeldSprings,
    begin_with_hands,
    end_with_hands,
    load_held_springs,
    no_held_springs,
    pull_held,
)
from sandbox.physics.solvers.inputs import Inputs
from sandbox.physics.state import State
from sandbox.physics.topology.sorting import sort_by_value

# The share of what an area still wants that it gets in an iteration after the first. With all of it jellies and rings,
# which have more constraints than ways to move, gain energy several times over; with 0.3 or less a crushed jelly stays
# crushed.
AREA_SHARE = 0.5


class ConstraintScratch(NamedTuple):
    """Scratch of the constraints: of corners (q, 2), then of each (t,), see `_iterate_constraints`.

    Of a bend, damped = Cd m, kept = 1 - Cd and whole = kept + Cd m / present mass. Of an area, as of a spring, damped =
    m, kept = 0 and whole = 1, then 1 / AREA_SHARE.
    """

    place: Annotated[FloatRows, "corners, 2"]
    slope: Annotated[FloatRows, "corners, 2"]  # gradient
    wanted: Annotated[Floats, "constraints"]  # -(Cs C / h + Cd dC/dt) m
    damped: Annotated[Floats, "constraints"]
    kept: Annotated[Floats, "constraints"]
    whole: Annotated[Floats, "constraints"]
    impulse: Annotated[Floats, "constraints"]  # the sum of its j


class SpringScratch(NamedTuple):
    """Scratch of the springs that do something, count of them by slot."""

    slot: Annotated[Slots, "springs"]
    normal: Annotated[FloatRows, "springs, 2"]
    wanted: Annotated[Floats, "springs"]  # [m/s]: r
    mass: Annotated[Floats, "springs"]  # [kg]
    limit: Annotated[Floats, "springs"]  # [N s]: of those of limited force, as impulse
    impulse: Annotated[Floats, "springs"]  # [N s]: the sum of its impulses
    change: Annotated[FloatRows, "particles, 2"]  # [m/s]: by particle


class Iteration(NamedTuple):
    """Slots of the springs that are iterated, and scratch."""

    listed: Slots  # as they are listed
    heavy_first: Slots  # those of heavy particles first
    limit: Floats  # [N] (m,): the force that each spring gives at most, (0,): none has a limit
    spring_scratch: SpringScratch
    constraint_scratch: ConstraintScratch
    held: HeldSprings  # follows from what hands hold


@inner_kernel
def _prepare_constraints(
    state: State, constraints: ConstraintArrays, inputs: Inputs, h: float, scratch: ConstraintScratch
) -> None:  # fmt: skip
    # wanted = -(Cs C / h + Cd dC/dt) m
    for k in range(constraints.kind.shape[0]):
        scratch.whole[k] = 0.0
        if not constraints.active[k]:
            continue
        first = constraints.first[k]
        last = first + constraints.corners[k]
        look(first, last, state.position, constraints.particle, scratch.place)
        error = evaluate(
            constraints.kind[k], scratch.place, first, last, constraints.rest, k, constraints.weight, scratch.slope
        )  # fmt: skip
        mass, share = explicit_mass(
            first, last, state.inverse_mass, constraints.particle, constraints.weight, scratch.slope
        )  # fmt: skip
        rate = constraint_rate(first, last, state.velocity, constraints.particle, scratch.slope)
        damping = inputs.constraint_damping[k]
        scratch.wanted[k] = spring_impulse(inputs.constraint_stiffness[k], damping, error, rate, mass, h)
        if constraints.kind[k] == BEND:
            scratch.damped[k] = damping * mass
            scratch.kept[k] = 1.0 - damping
            scratch.whole[k] = scratch.kept[k] + damping * share
        else:
            scratch.damped[k] = mass
            scratch.kept[k] = 0.0
            scratch.whole[k] = 1.0
        scratch.impulse[k] = 0.0


@inner_kernel
def _iterate_constraints(
    inverse_mass: Floats, constraints: ConstraintArrays, scratch: ConstraintScratch, change: FloatRows
) -> None:
    # A bend obeys (1 - Cd) j = -(Cs C / h + Cd (dC/dt + g . dv)) m, the equation with the velocity after the step
    # (equation.py): so can all of more bends than there are ways to bend. Both go at once into the velocity change dv.
    for k in range(constraints.kind.shape[0]):
        if scratch.whole[k] == 0.0:
            continue
        first = constraints.first[k]
        last = first + constraints.corners[k]
        rate = constraint_rate(first, last, change, constraints.particle, scratch.slope)
        j = (scratch.wanted[k] - scratch.damped[k] * rate - scratch.kept[k] * scratch.impulse[k]) / scratch.whole[k]
        scratch.impulse[k] += j
        if constraints.kind[k] == AREA:
            scratch.whole[k] = 1.0 / AREA_SHARE
        for c in range(first, last):
            p = constraints.particle[c]
            change[p, 0] += j * scratch.slope[c, 0] * inverse_mass[p]
            change[p, 1] += j * scratch.slope[c, 1] * inverse_mass[p]


@inner_kernel
def _prepare_springs(
    state: State, order: Slots, limit: Floats, inputs: Inputs, warm_start: float, h: float, scratch: SpringScratch
) -> int:  # fmt: skip
    # r = -(Cs x / h + Cd u), the wanted change of relative velocity; how many springs want one.
    position, velocity, inverse_mass = state.position, state.velocity, state.inverse_mass
    change, accumulated = scratch.change, state.impulse
    count = 0
    for i in range(order.shape[0]):
        s = order[i]
        a = state.particle_a[s]
        b = state.particle_b[s]
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
        scratch.slot[count] = s
        scratch.normal[count, 0] = nx
        scratch.normal[count, 1] = ny
        scratch.mass[count] = m
        scratch.wanted[count] = spring_impulse(
            inputs.stiffness[s], inputs.damping[s], length - state.rest_length[s], nx * du + ny * dv, 1.0, h
        )  # fmt: skip
        p = nx * warm_x + ny * warm_y
        if limit.shape[0] > 0:
            scratch.limit[count] = limit[s] * h
            scratch.impulse[count] = min(max(warm_start * p, -scratch.limit[count]), 0.0)
        if p < 0.0:
            j = scratch.impulse[count] if limit.shape[0] > 0 else warm_start * p
            change[a, 0] -= j * nx * inverse_mass[a]
            change[a, 1] -= j * ny * inverse_mass[a]
            change[b, 0] += j * nx * inverse_mass[b]
            change[b, 1] += j * ny * inverse_mass[b]
        count += 1
    return count


@inner_kernel
def _iterate_springs(count: int, state: State, scratch: SpringScratch, backwards: bool) -> None:
    # j = -(n . (dv_b - dv_a) - r) m_r, applied at once to the velocity change dv.
    change, accumulated, inverse_mass = scratch.change, state.impulse, state.inverse_mass
    for i in range(count):
        c = count - 1 - i if backwards else i
        s = scratch.slot[c]
        a = state.particle_a[s]
        b = state.particle_b[s]
        nx = scratch.normal[c, 0]
        ny = scratch.normal[c, 1]
        du = change[b, 0] - change[a, 0]
        dv = change[b, 1] - change[a, 1]
        j = -(nx * du + ny * dv - scratch.wanted[c]) * scratch.mass[c]
        jx = j * nx
        jy = j * ny
        change[a, 0] -= jx * inverse_mass[a]
        change[a, 1] -= jy * inverse_mass[a]
        change[b, 0] += jx * inverse_mass[b]
        change[b, 1] += jy * inverse_mass[b]
        accumulated[s, 0] += jx
        accumulated[s, 1] += jy


@inner_kernel
def _iterate_bounded_springs(
    count: int, state: State, step: Iteration, joints: Joints, hands_answer: bool, backwards: bool
) -> None:  # fmt: skip
    # The same where hands answer at once, or some springs are of limited force.
    scratch, held, limits = step.spring_scratch, step.held, step.limit.shape[0] > 0
    change, accumulated, inverse_mass = scratch.change, state.impulse, state.inverse_mass
    for i in range(count):
        c = count - 1 - i if backwards else i
        s = scratch.slot[c]
        a = state.particle_a[s]
        b = state.particle_b[s]
        nx = scratch.normal[c, 0]
        ny = scratch.normal[c, 1]
        du = change[b, 0] - change[a, 0]
        dv = change[b, 1] - change[a, 1]
        lacks = -(nx * du + ny * dv - scratch.wanted[c])
        least, most = -math.inf, math.inf
        if limits:
            least, most = -scratch.limit[c] - scratch.impulse[c], scratch.limit[c] - scratch.impulse[c]
        if hands_answer and held.at[c, 0] >= 0:
            j = pull_held(held, joints, c, lacks, scratch.mass[c], least, most)
        else:
            j = min(max(lacks * scratch.mass[c], least), most)
        if limits:
            scratch.impulse[c] += j
        jx = j * nx
        jy = j * ny
        change[a, 0] -= jx * inverse_mass[a]
        change[a, 1] -= jy * inverse_mass[a]
        change[b, 0] += jx * inverse_mass[b]
        change[b, 1] += jy * inverse_mass[b]
        accumulated[s, 0] += jx
        accumulated[s, 1] += jy


@inner_kernel
def solve(
    state: State, step: Iteration, inputs: Inputs, contacts: Contacts, terms: ContactConstraints, order: ContactOrder,
    delassus: Delassus, iterations: int, warm_start: float, alternates: bool, h: float,
) -> None:  # fmt: skip
    """Bring the velocities to the end of a substep of h [s]; the springs' impulses are kept for the next warm start.

    alternates: every other iteration goes through the springs backwards, as they are listed.
    """
    # In small steps what one order has not carried through a wheel throws it off the ground; in one step a tick light
    # wheels would sink in under heavy loads. There each goes from the springs of heavy particles to those of light
    # ones: what a load asks for goes on to what bears it within an iteration, and a wheel of 0.2 kg a particle sinks
    # 3 cm under 60 kg in place of 9.
    velocity, inverse_mass, change = state.velocity, state.inverse_mass, step.spring_scratch.change
    joints, scratch = delassus.joints, step.spring_scratch
    for p in range(change.shape[0]):
        change[p, 0] = 0.0
        change[p, 1] = 0.0
    load_surfaces(terms, state.spin, state.radius)
    springs = step.listed if alternates else step.heavy_first
    load_biases(contacts, terms, h)
    load_responses(contacts, terms, inverse_mass, delassus)
    propagate_all_impacts(contacts, terms, order, velocity, change, inverse_mass, delassus, h)
    count = _prepare_springs(state, springs, step.limit, inputs, warm_start, h, scratch)
    constraints = constraints_of(state)
    _prepare_constraints(state, constraints, inputs, h, step.constraint_scratch)
    warm_start_contacts(contacts, terms, change, inverse_mass, delassus)
    warm_start_joints(joints, change, inverse_mass)
    hands_answer = step.held.hand.shape[0] > 0 and load_held_springs(
        step.held, joints, state, scratch.slot, scratch.normal, scratch.mass, count
    )
    for k in range(iterations):
        backwards = alternates and k % 2 == 1
        if hands_answer:
            begin_with_hands(step.held, joints, velocity, change)
        if hands_answer or step.limit.shape[0] > 0:
            _iterate_bounded_springs(count, state, step, joints, hands_answer, backwards)
        else:
            _iterate_springs(count, state, scratch, backwards)
        if hands_answer:
            end_with_hands(step.held, joints, change, inverse_mass)
        _iterate_constraints(inverse_mass, constraints, step.constraint_scratch, change)
        iterate_joints(joints, velocity, change, inverse_mass)
        sweep(contacts, terms, velocity, change, inverse_mass, delassus)
    add_change(velocity, change, inverse_mass)
    store_spins(terms, state.spin, state.radius)


@inner_kernel
def new_iteration(state: State, limit: Floats, arena: Arena) -> Iteration:
    """The springs of a world that are iterated, with scratch; limit [N] (m,): the force that each gives at most."""
    springs, corners, constraints = state.law.shape[0], state.corner_particle.shape[0], state.constraint_kind.shape[0]
    listed, heavy_first = new_slots(arena, springs), new_slots(arena, springs)
    scratch = mark(arena)
    lightness, order, merge_buffer = new_floats(arena, springs), new_slots(arena, springs), new_slots(arena, springs)
    count = 0
    limits = False
    if not is_full(arena):
        for s in range(springs):
            limits = limits or limit[s] < math.inf
            if state.spring_active[s] and state.law[s] == LAW_NISSEN:
                listed[count] = s
                order[count] = count
                lightness[count] = min(_lightness(state, state.particle_a[s]), _lightness(state, state.particle_b[s]))
                count += 1
        sort_by_value(lightness, order, 0, count, merge_buffer)
        for k in range(count):
            heavy_first[k] = listed[order[k]]
        give_back(arena, scratch)
    return Iteration(
        listed[:count], heavy_first[:count], limit if limits else limit[:0],
        new_tuple(SpringScratch, arena, springs=count, particles=state.owner.shape[0]),
        new_tuple(ConstraintScratch, arena, constraints=constraints, corners=corners),
        no_held_springs(arena),
    )  # fmt: skip


@inner_kernel
def _lightness(state: State, p: int) -> float:
    return state.inverse_mass[p] if state.inverse_mass[p] > 0.0 else math.inf


spring_constant = explicit_spring_constant
