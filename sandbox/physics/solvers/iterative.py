"""Iterative, warm-started: springs and constraints in order, N times, on a velocity change.

No proven limit. Only springs are warm-started. Of a spring of limited force the sum of its impulses is clamped. Hooke
springs are no constraints: they act once, explicitly, before the iterations. Source: Nissen's demo programs after the
article.

Springs at what a hand holds are each solved with the hand, as one. A hand is as stiff as the whole body is heavy; what
it holds may be light, and much may hang on that. As a row of its own it would give in an iteration only what stops the
light end, and swing what hangs there ever wider. So a spring is given what it asks for where the hand answers at once:
the hand is eliminated from the two (a Schur complement).

    y = G W n,    A = (G W G + 1/K)^-1,    P(j) = the hand's impulse where the spring gives j:  P0 - A y j, clamped
    w j + y . (P(j) - P) = r

G = the hand's rows, W = inverse masses, w = n W n, r = the change that the spring still asks for. Where the hand is not
at its limit, the spring's effective mass is 1 / (w - y A y): that of a light end is nearly a pin's. The left side rises
with j, so there is one j; at the limit Newton's method finds it. P reaches the particles after all springs; until then
y . P is what it does to a spring.
"""

import math
from typing import Annotated, NamedTuple

from sandbox.physics.arena import Arena, give_back, is_full, mark, new_floats, new_slots, new_tuple
from sandbox.physics.arrays import FloatRows, Floats, SlotRows, Slots
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
from sandbox.physics.joints.hands import HandRows
from sandbox.physics.joints.joint_rows import (
    Joints,
    answer_of_two,
    give_impulse,
    iterate_joints,
    own_response,
    row_velocity,
    shortened,
    warm_start_joints,
)
from sandbox.physics.marks import LAW_NISSEN
from sandbox.physics.solvers.contact.contact_solve import propagate_all_impacts
from sandbox.physics.solvers.contact.gauss_seidel import (
    ContactConstraints,
    ContactOrder,
    Delassus,
    add_change,
    load_biases,
    load_responses,
    load_surfaces,
    store_spins,
    sweep,
    warm_start_contacts,
)
from sandbox.physics.solvers.inputs import Inputs
from sandbox.physics.state import State
from sandbox.physics.topology.sorting import sort_by_value

# A hand answers at once to a spring of whose impulse it takes more than this part. One that holds a soft body all over
# takes next to nothing of that of any of many springs.
LEAST_TAKEN = 0.2
# How often j is made better where a hand is at its limit: along one line once is enough.
ROUNDS = 4
# The effective inverse mass of a spring with hands is at least this part of that without: what rounding leaves.
LEAST_INVERSE_MASS_SHARE = 1e-12
# The share of what an area still wants that it gets in an iteration after the first. With all of it jellies and rings,
# which have more constraints than ways to move, gain energy several times over; with 0.3 or less a crushed jelly stays
# crushed.
AREA_SHARE = 0.5
spring_constant = explicit_spring_constant


class HeldSprings(NamedTuple):
    """The hands that are solved with springs, and those springs."""

    hand: Annotated[Slots, "hands"]  # first row of each
    row: Annotated[Slots, "particles"]  # by particle: that of the hand that holds it, -1: none
    entry: Annotated[Slots, "particles"]  # by particle: its place in the row
    at: Annotated[SlotRows, "springs, 2"]  # by spring that pulls: the rows of hands at its ends, the first -1: none
    answer: Annotated[FloatRows, "springs, 4"]  # y of each
    asked: Annotated[FloatRows, "springs, 4"]  # A y of each
    mass: Annotated[Floats, "springs"]  # [kg]: effective mass where no hand that answers at once is at its limit
    free: Annotated[FloatRows, "2, 2"]  # scratch, P0


class ConstraintScratch(NamedTuple):
    """Scratch of the constraints: of corners (q, 2), then of each (t,), see `_iterate_constraints`.

    Of a bend, damped = Cd m, kept = 1 - Cd and whole = kept + Cd m / present mass. Of an area, as of a spring, damped =
    m, kept = 0 and whole = 1, then 1 / AREA_SHARE.
    """

    place: Annotated[FloatRows, "corners, 2"]
    slope: Annotated[FloatRows, "corners, 2"]  # gradient
    target: Annotated[Floats, "constraints"]  # -(Cs C / h + Cd dC/dt) m
    damped: Annotated[Floats, "constraints"]
    kept: Annotated[Floats, "constraints"]
    whole: Annotated[Floats, "constraints"]
    impulse: Annotated[Floats, "constraints"]  # the sum of its j


class SpringScratch(NamedTuple):
    """Scratch of the springs that do something, count of them by slot."""

    slot: Annotated[Slots, "springs"]
    normal: Annotated[FloatRows, "springs, 2"]
    target: Annotated[Floats, "springs"]  # [m/s]: r
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
        _no_held_springs(arena),
    )  # fmt: skip


@inner_kernel
def _lightness(state: State, p: int) -> float:
    return state.inverse_mass[p] if state.inverse_mass[p] > 0.0 else math.inf


@inner_kernel
def _no_held_springs(arena: Arena) -> HeldSprings:
    """Held springs of a world without hands: none."""
    return new_tuple(HeldSprings, arena, hands=0, particles=0, springs=0)


@inner_kernel
def new_held_springs(hands: HandRows, state: State, springs: int, arena: Arena) -> HeldSprings:
    """The hands of a world of so many springs that hold no particle that one before them holds."""
    grips = hands.grips
    count, particles = grips.hand.shape[0], state.owner.shape[0]
    if count == 0:
        return _no_held_springs(arena)
    made = new_tuple(HeldSprings, arena, hands=count, particles=particles, springs=springs)
    if is_full(arena):
        return made
    for p in range(particles):
        made.row[p] = -1
    last = 0
    for i in range(count):
        is_apart = True
        for e in range(grips.start[i], grips.start[i + 1]):
            is_apart = is_apart and made.row[grips.particle[e]] < 0
        if is_apart:
            made.hand[last] = hands.row[i]
            last += 1
            for e in range(grips.start[i], grips.start[i + 1]):
                made.row[grips.particle[e]] = hands.row[i]
                made.entry[grips.particle[e]] = e - grips.start[i]
    return HeldSprings(
        made.hand[:last], made.row, made.entry, made.at, made.answer, made.asked, made.mass, made.free
    )  # fmt: skip


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
    hands_answer = step.held.hand.shape[0] > 0 and _load_held_springs(
        step.held, joints, state, scratch.slot, scratch.normal, scratch.mass, count
    )
    for k in range(iterations):
        backwards = alternates and k % 2 == 1
        if hands_answer:
            for i in range(step.held.hand.shape[0]):
                for row in range(step.held.hand[i], step.held.hand[i] + 2):
                    joints.velocity[row] = row_velocity(joints.rows, row, velocity, change)
                    joints.last_impulse[row] = joints.rows.impulse[row]
        _iterate_springs(count, state, step, joints, hands_answer, backwards)
        if hands_answer:
            # Particles get what hands have answered.
            for i in range(step.held.hand.shape[0]):
                for row in range(step.held.hand[i], step.held.hand[i] + 2):
                    more = joints.rows.impulse[row] - joints.last_impulse[row]
                    give_impulse(joints.rows, row, more, change, inverse_mass)
        _iterate_constraints(inverse_mass, constraints, step.constraint_scratch, change)
        iterate_joints(joints, velocity, change, inverse_mass)
        sweep(contacts, terms, velocity, change, inverse_mass, delassus)
    add_change(velocity, change, inverse_mass)
    store_spins(terms, state.spin, state.radius)


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
        scratch.target[count] = spring_impulse(
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
        mass, ratio = explicit_mass(
            first, last, state.inverse_mass, constraints.particle, constraints.weight, scratch.slope
        )  # fmt: skip
        rate = constraint_rate(first, last, state.velocity, constraints.particle, scratch.slope)
        damping = inputs.constraint_damping[k]
        scratch.target[k] = spring_impulse(inputs.constraint_stiffness[k], damping, error, rate, mass, h)
        if constraints.kind[k] == BEND:
            scratch.damped[k] = damping * mass
            scratch.kept[k] = 1.0 - damping
            scratch.whole[k] = scratch.kept[k] + damping * ratio
        else:
            scratch.damped[k] = mass
            scratch.kept[k] = 0.0
            scratch.whole[k] = 1.0
        scratch.impulse[k] = 0.0


@inner_kernel
def _load_held_springs(
    held: HeldSprings, joints: Joints, state: State, slot: Slots, normal: FloatRows, mass: Floats, count: int
) -> bool:
    """What hands answer to each spring that pulls, and whether any answers at once.

    slot, normal, mass [kg]: of the first `count` springs that pull.
    """
    found = False
    for c in range(count):
        _find_answers(held, joints, state, slot[c], c, normal[c, 0], normal[c, 1])
        held.mass[c] = mass[c]
        if held.at[c, 0] < 0:
            continue
        taken, less = 0.0, 0.0
        for place in range(2):
            if held.at[c, place] >= 0:
                x, y = held.answer[c, 2 * place], held.answer[c, 2 * place + 1]
                px, py = _asked(joints, held.at[c, place], x, y)
                held.asked[c, 2 * place], held.asked[c, 2 * place + 1] = px, py
                taken = max(taken, px * px + py * py)
                less += x * px + y * py
        if taken > LEAST_TAKEN * LEAST_TAKEN:
            inverse = 1.0 / mass[c]
            held.mass[c] = 1.0 / max(inverse - less, LEAST_INVERSE_MASS_SHARE * inverse)
            found = True
    return found


@inner_kernel
def _find_answers(held: HeldSprings, joints: Joints, state: State, s: int, c: int, nx: float, ny: float) -> None:
    # y of the hands at the ends of a spring; one that holds both is entered once.
    rows = joints.rows
    held.at[c, 0] = held.at[c, 1] = -1
    for end in range(2):
        p, sign = (state.particle_b[s], 1.0) if end == 1 else (state.particle_a[s], -1.0)
        k = held.row[p]
        if k < 0:
            continue
        place = 0 if held.at[c, 0] < 0 or held.at[c, 0] == k else 1
        if held.at[c, place] < 0:
            held.at[c, place] = k
            held.answer[c, 2 * place] = held.answer[c, 2 * place + 1] = 0.0
        along, across = rows.first[k] + held.entry[p], rows.first[k + 1] + held.entry[p]
        change = sign * state.inverse_mass[p]
        held.answer[c, 2 * place] += change * (rows.gradient[along, 0] * nx + rows.gradient[along, 1] * ny)
        held.answer[c, 2 * place + 1] += change * (rows.gradient[across, 0] * nx + rows.gradient[across, 1] * ny)


@inner_kernel
def _asked(joints: Joints, k: int, x: float, y: float) -> tuple[float, float]:
    # (G W G + 1/K)^-1 (x, y): the impulse that takes such a velocity from what a hand holds.
    couplings = joints.couplings
    a = own_response(joints, k) + joints.rows.softness[k]
    b = couplings.response[couplings.own[k] + 1]
    d = own_response(joints, k + 1) + joints.rows.softness[k + 1]
    determinant = a * d - b * b
    if not determinant > 0.0:
        return 0.0, 0.0
    return (d * x - b * y) / determinant, (a * y - b * x) / determinant


@inner_kernel
def _iterate_springs(
    count: int, state: State, step: Iteration, joints: Joints, hands_answer: bool, backwards: bool
) -> None:  # fmt: skip
    # j = -(n . (dv_b - dv_a) - r) m_r, applied at once to the velocity change dv; bounded where hands answer at once,
    # or some springs are of limited force.
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
        lacks = -(nx * du + ny * dv - scratch.target[c])
        j = lacks * scratch.mass[c]
        if hands_answer or limits:
            least, most = -math.inf, math.inf
            if limits:
                least, most = -scratch.limit[c] - scratch.impulse[c], scratch.limit[c] - scratch.impulse[c]
            if hands_answer and held.at[c, 0] >= 0:
                j = _pull_held(held, joints, c, lacks, scratch.mass[c], least, most)
            else:
                j = min(max(j, least), most)
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
def _pull_held(
    held: HeldSprings, joints: Joints, c: int, missing: float, mass: float, least: float, most: float
) -> float:  # fmt: skip
    """The impulse of a spring with hands at its ends, between bounds, to which they answer at once.

    missing [m/s]: what its velocity lacks, where particles have nothing yet of what hands answered in the iteration.
    """
    rows = joints.rows
    for place in range(2):
        k = held.at[c, place]
        if k >= 0:
            dx, dy = rows.impulse[k] - joints.last_impulse[k], rows.impulse[k + 1] - joints.last_impulse[k + 1]
            missing -= _along(held, c, place, dx, dy)
    if held.mass[c] > mass:
        missing = _let_hands_answer(held, joints, c, missing, mass, least, most)
    j = min(max(missing * mass, least), most)
    for place in range(2):
        k = held.at[c, place]
        if k >= 0:
            joints.velocity[k] += held.answer[c, 2 * place] * j
            joints.velocity[k + 1] += held.answer[c, 2 * place + 1] * j
    return j


@inner_kernel
def _along(held: HeldSprings, c: int, place: int, x: float, y: float) -> float:
    return held.answer[c, 2 * place] * x + held.answer[c, 2 * place + 1] * y


@inner_kernel
def _let_hands_answer(
    held: HeldSprings, joints: Joints, c: int, missing: float, mass: float, least: float, most: float
) -> float:  # fmt: skip
    # Give the hands of a spring the impulses P(j); what its velocity lacks with those.
    rows, remaining, clamps = joints.rows, missing, False
    for place in range(2):
        k = held.at[c, place]
        if k >= 0:
            first, second = answer_of_two(joints, k, joints.velocity[k], joints.velocity[k + 1])
            held.free[place, 0], held.free[place, 1] = first, second
            remaining -= _along(held, c, place, first - rows.impulse[k], second - rows.impulse[k + 1])
    j = min(max(remaining * held.mass[c], least), most)
    for place in range(2):
        if held.at[c, place] >= 0:
            first, second = _hand_at(held, c, place, j)
            clamps = clamps or shortened(first, second, rows.limit[held.at[c, place]]) < 1.0
    if clamps:
        j = _search(held, joints, c, missing, mass, least, most, j)
    for place in range(2):
        k = held.at[c, place]
        if k >= 0:
            first, second = _hand_at(held, c, place, j)
            ratio = shortened(first, second, rows.limit[k])
            dx, dy = ratio * first - rows.impulse[k], ratio * second - rows.impulse[k + 1]
            both = joints.couplings.response[joints.couplings.own[k] + 1]
            rows.impulse[k] += dx
            rows.impulse[k + 1] += dy
            joints.velocity[k] += own_response(joints, k) * dx + both * dy
            joints.velocity[k + 1] += both * dx + own_response(joints, k + 1) * dy
            missing -= _along(held, c, place, dx, dy)
    return missing


@inner_kernel
def _hand_at(held: HeldSprings, c: int, place: int, j: float) -> tuple[float, float]:
    # P0 - A y j
    return held.free[place, 0] - held.asked[c, 2 * place] * j, held.free[place, 1] - held.asked[c, 2 * place + 1] * j


@inner_kernel
def _search(
    held: HeldSprings, joints: Joints, c: int, missing: float, mass: float, least: float, most: float, j: float
) -> float:  # fmt: skip
    # j where hands are at their limits, from that where they are not.
    rows = joints.rows
    for _ in range(ROUNDS):
        remaining, slope = missing - j / mass, 1.0 / mass
        for place in range(2):
            k = held.at[c, place]
            if k < 0:
                continue
            first, second = _hand_at(held, c, place, j)
            ax, ay = held.asked[c, 2 * place], held.asked[c, 2 * place + 1]
            yields = _along(held, c, place, ax, ay)
            ratio = shortened(first, second, rows.limit[k])
            if ratio < 1.0:
                # In its own direction a hand gives no more.
                along = _along(held, c, place, first, second) * (ax * first + ay * second)
                yields = ratio * (yields - along / (first * first + second * second))
            remaining -= _along(held, c, place, ratio * first - rows.impulse[k], ratio * second - rows.impulse[k + 1])
            slope -= yields
        j = min(max(j + remaining / max(slope, LEAST_INVERSE_MASS_SHARE / mass), least), most)  # (23)
    return j


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
        j = (scratch.target[k] - scratch.damped[k] * rate - scratch.kept[k] * scratch.impulse[k]) / scratch.whole[k]
        scratch.impulse[k] += j
        if constraints.kind[k] == AREA:
            scratch.whole[k] = 1.0 / AREA_SHARE
        for c in range(first, last):
            p = constraints.particle[c]
            change[p, 0] += j * scratch.slope[c, 0] * inverse_mass[p]
            change[p, 1] += j * scratch.slope[c, 1] * inverse_mass[p]
