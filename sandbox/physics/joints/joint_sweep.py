"""Joints in the sweeps: their impulses are found together with those of contacts, each clamped.

A joint takes in many particles of a body, so it is swept through what each of its bodies answers to a unit of it,
Z = A^-1 g, kept by row: an impulse at one particle changes u by Z there, that of another joint by g . Z.
"""

from typing import NamedTuple

from sandbox.physics.arena import Arena, is_full, new_float_rows, new_floats, new_slots
from sandbox.physics.arrays import FloatRows, Floats, Slots
from sandbox.physics.equation import implicit_update
from sandbox.physics.jit import inner_kernel
from sandbox.physics.joints.rows import PAIR, SECOND_OF_TWO, JointRows, clamped, row_velocity, shortened
from sandbox.physics.topology.sorting import list_by_key, place_among


class Joints(NamedTuple):
    """The rows of joints, and how bodies answer to them.

    Bodies of row k: body[body_first[k]:body_first[k + 1]]; the answers (velocities by a unit impulse) of the particles
    of body b begin at body_answer[b], row by row of the matrix. Answers of row k: answer_first[k]..answer_first[k + 1],
    those of its particles that are in no body last, in the order of its entries. answer_particle (a,), answer (a, 2).
    The same by particle: at[at_first[p]:at_first[p + 1]] are answers, at_row theirs.

    Scratch of a step: response (k, k) = g . Z; velocity (k,) = u; last_impulse and search_direction (k,) as those of
    contacts; push (n, 2) [N s]: what the joints together give each particle.
    """

    rows: JointRows
    body_first: Slots
    body: Slots
    body_answer: Slots
    answer_first: Slots
    answer_particle: Slots
    answer: FloatRows
    at_first: Slots
    at: Slots
    at_row: Slots
    response: FloatRows
    velocity: Floats
    last_impulse: Floats
    search_direction: Floats
    push: FloatRows


@inner_kernel
def _find_bodies(rows: JointRows, k: int, row_of: Slots, row_start: Slots, first: int, body: Slots) -> int:
    # List the bodies of a row, each once, ascending, from body[first] on; where they end.
    last = first
    for e in range(rows.first[k], rows.first[k + 1]):
        row = row_of[rows.particle[e]]
        if row < 0:
            continue
        found = place_among(row + 1, row_start, 0, row_start.shape[0]) - 1
        at = last
        while at > first and body[at - 1] > found:
            at -= 1
        if at > first and body[at - 1] == found:
            continue
        for other in range(last, at, -1):
            body[other] = body[other - 1]
        body[at] = found
        last += 1
    return last


@inner_kernel
def _list_answers(rows: JointRows, particle: Slots, row_of: Slots, row_start: Slots, joints: Joints) -> None:
    # The particles of each row's bodies, then its own that are in none; and the same by particle.
    top = 0
    for k in range(rows.limit.shape[0]):
        for b in range(joints.body_first[k], joints.body_first[k + 1]):
            for row in range(row_start[joints.body[b]], row_start[joints.body[b] + 1]):
                joints.answer_particle[top] = particle[row]
                top += 1
        for e in range(rows.first[k], rows.first[k + 1]):
            if row_of[rows.particle[e]] < 0:
                joints.answer_particle[top] = rows.particle[e]
                top += 1
    list_by_key(joints.answer_particle, top, joints.at_first.shape[0] - 1, joints.at_first, joints.at)
    for i in range(top):
        # Answers ascend from row to row.
        joints.at_row[i] = place_among(joints.at[i] + 1, joints.answer_first, 0, joints.answer_first.shape[0]) - 1


@inner_kernel
def _joints(
    rows: JointRows, body_first: Slots, body: Slots, body_answer: Slots, answer_first: Slots, answers: int,
    particles: int, arena: Arena,
) -> Joints:  # fmt: skip
    count = rows.limit.shape[0]
    return Joints(
        rows, body_first, body, body_answer, answer_first, new_slots(arena, answers),
        new_float_rows(arena, answers, 2), new_slots(arena, particles + 1), new_slots(arena, answers),
        new_slots(arena, answers), new_float_rows(arena, count, count), new_floats(arena, count),
        new_floats(arena, count), new_floats(arena, count), new_float_rows(arena, particles if count > 0 else 0, 2),
    )  # fmt: skip


@inner_kernel
def new_joints(rows: JointRows, particle: Slots, row_of: Slots, row_start: Slots, arena: Arena) -> Joints:
    """Room for joints.

    particle: of each row of the matrix; row_of (n,): the row of each particle, -1: in none; row_start: of each body.
    """
    count, entries = rows.limit.shape[0], rows.particle.shape[0]
    body_first, answer_first = new_slots(arena, count + 1), new_slots(arena, count + 1)
    body, body_answer = new_slots(arena, entries), new_slots(arena, entries)
    bodies, answers = 0, 0
    if not is_full(arena):
        for k in range(count):
            last = _find_bodies(rows, k, row_of, row_start, bodies, body)
            for b in range(bodies, last):
                body_answer[b] = answers
                answers += row_start[body[b] + 1] - row_start[body[b]]
            for e in range(rows.first[k], rows.first[k + 1]):
                if row_of[rows.particle[e]] < 0:
                    answers += 1
            bodies = last
            body_first[k + 1] = bodies
            answer_first[k + 1] = answers
    joints = _joints(
        rows, body_first, body[:bodies], body_answer[:bodies], answer_first, answers, row_of.shape[0], arena
    )  # fmt: skip
    if not is_full(arena):
        _list_answers(rows, particle, row_of, row_start, joints)
    return joints


@inner_kernel
def joints_by_mass(rows: JointRows, arena: Arena) -> Joints:
    """Joints whose particles answer by their own mass alone."""
    none = new_slots(arena, 0)
    count = rows.limit.shape[0]
    return Joints(
        rows, none, none, none, none, none, new_float_rows(arena, 0, 2), none, none, none,
        new_float_rows(arena, count, count), new_floats(arena, count), new_floats(arena, count),
        new_floats(arena, count), new_float_rows(arena, 0, 2),
    )  # fmt: skip


@inner_kernel
def push_at(joints: Joints, p: int, jx: float, jy: float) -> None:
    """Add the effect of an impulse at a particle to the velocities of rows."""
    if joints.at.shape[0] == 0:
        return
    for i in range(joints.at_first[p], joints.at_first[p + 1]):
        a = joints.at[i]
        joints.velocity[joints.at_row[i]] += joints.answer[a, 0] * jx + joints.answer[a, 1] * jy


@inner_kernel
def _push(joints: Joints, k: int, impulse: float, delta_v: Floats) -> None:
    # What a row's impulse does to particles and to the velocities of all rows.
    for a in range(joints.answer_first[k], joints.answer_first[k + 1]):
        p = joints.answer_particle[a]
        delta_v[p, 0] += joints.answer[a, 0] * impulse
        delta_v[p, 1] += joints.answer[a, 1] * impulse
    for j in range(joints.velocity.shape[0]):
        joints.velocity[j] += joints.response[j, k] * impulse


@inner_kernel
def couple_joints(joints: Joints) -> None:
    """response = g . Z, from the answers."""
    rows = joints.rows
    for k in range(rows.limit.shape[0]):
        for j in range(rows.limit.shape[0]):
            joints.response[k, j] = 0.0
        if not rows.limit[k] > 0.0:
            continue
        for e in range(rows.first[k], rows.first[k + 1]):
            p = rows.particle[e]
            for i in range(joints.at_first[p], joints.at_first[p + 1]):
                a = joints.at[i]
                joints.response[k, joints.at_row[i]] += (
                    rows.gradient[e, 0] * joints.answer[a, 0] + rows.gradient[e, 1] * joints.answer[a, 1]
                )


@inner_kernel
def couple_masses(joints: Joints, inverse_mass: Floats) -> None:
    """The same where every particle answers by its own mass: of each row, and of two with each other."""
    rows = joints.rows
    for k in range(rows.limit.shape[0]):
        other = k + 1 if rows.pair[k] == PAIR else k
        own = 0.0
        both = 0.0
        for e in range(rows.first[k], rows.first[k + 1]):
            w = inverse_mass[rows.particle[e]]
            # Two rows that are clamped together take in the same particles in the same order.
            f = rows.first[other] + e - rows.first[k]
            own += w * (rows.gradient[e, 0] * rows.gradient[e, 0] + rows.gradient[e, 1] * rows.gradient[e, 1])
            both += w * (rows.gradient[e, 0] * rows.gradient[f, 0] + rows.gradient[e, 1] * rows.gradient[f, 1])
        joints.response[k, k] = own
        if other != k:
            joints.response[k, other] = both
            joints.response[other, k] = both


@inner_kernel
def _of_two(joints: Joints, k: int, u: float, v: float) -> tuple[float, float]:
    # Impulses of two rows that are clamped together, from their velocities: (W + 1/K) dP = -(u - target + P/K).
    rows = joints.rows
    first, second = rows.impulse[k], rows.impulse[k + 1]
    a = joints.response[k, k] + rows.softness[k]
    b = joints.response[k, k + 1]
    c = joints.response[k + 1, k]
    d = joints.response[k + 1, k + 1] + rows.softness[k + 1]
    determinant = a * d - b * c
    if not determinant > 0.0:
        return first, second
    r = -(u - rows.target[k] + rows.softness[k] * first)
    s = -(v - rows.target[k + 1] + rows.softness[k + 1] * second)
    first += (d * r - b * s) / determinant
    second += (a * s - c * r) / determinant
    share = shortened(first, second, rows.limit[k])
    return first * share, second * share


@inner_kernel
def _alone(joints: Joints, k: int, u: float) -> float:
    rows = joints.rows
    new = implicit_update(rows.impulse[k], u - rows.target[k], joints.response[k, k], rows.softness[k])
    return clamped(new, rows.limit[k])


@inner_kernel
def start_joints(joints: Joints, delta_v: Floats) -> None:
    """Apply the impulses that joints bring along."""
    rows = joints.rows
    for k in range(rows.limit.shape[0]):
        joints.search_direction[k] = 0.0
        if rows.impulse[k] != 0.0:
            _push(joints, k, rows.impulse[k], delta_v)


@inner_kernel
def sweep_joints(joints: Joints, delta_v: Floats) -> float:
    """One sweep over all joints, in order; the largest change of a row's velocity [m/s, where g has no unit]."""
    rows = joints.rows
    largest = 0.0
    for k in range(rows.limit.shape[0]):
        joints.last_impulse[k] = rows.impulse[k]
    for k in range(rows.limit.shape[0]):
        if rows.pair[k] == SECOND_OF_TWO or not (rows.limit[k] > 0.0 and joints.response[k, k] > 0.0):
            continue
        if rows.pair[k] == PAIR:
            first, second = _of_two(joints, k, joints.velocity[k], joints.velocity[k + 1])
            largest = max(largest, _set(joints, k + 1, second, delta_v))
        else:
            first = _alone(joints, k, joints.velocity[k])
        largest = max(largest, _set(joints, k, first, delta_v))
    return largest


@inner_kernel
def _set(joints: Joints, k: int, impulse: float, delta_v: Floats) -> float:
    # Give a row another impulse; by how much its own velocity changes.
    more = impulse - joints.rows.impulse[k]
    if more == 0.0:
        return 0.0
    joints.rows.impulse[k] = impulse
    _push(joints, k, more, delta_v)
    return abs(more) * joints.response[k, k]


@inner_kernel
def swept_by(joints: Joints) -> float:
    """The squared change of impulses in the last sweep, in the metric of the responses."""
    squared = 0.0
    for k in range(joints.rows.limit.shape[0]):
        more = joints.rows.impulse[k] - joints.last_impulse[k]
        squared += joints.response[k, k] * more * more
    return squared


@inner_kernel
def go_on_with_joints(joints: Joints, delta_v: Floats, ratio: float) -> None:
    """P += ratio p, clamped; p = ratio p + the change of the sweep: as contacts do."""
    rows = joints.rows
    for k in range(rows.limit.shape[0]):
        more = ratio * joints.search_direction[k]
        joints.search_direction[k] = more + (rows.impulse[k] - joints.last_impulse[k])
        joints.last_impulse[k] = rows.impulse[k] + more
    for k in range(rows.limit.shape[0]):
        if rows.pair[k] == SECOND_OF_TWO:
            continue
        if rows.pair[k] == PAIR:
            share = shortened(joints.last_impulse[k], joints.last_impulse[k + 1], rows.limit[k])
            _set(joints, k, joints.last_impulse[k] * share, delta_v)
            _set(joints, k + 1, joints.last_impulse[k + 1] * share, delta_v)
        else:
            _set(joints, k, clamped(joints.last_impulse[k], rows.limit[k]), delta_v)


@inner_kernel
def gather_push(joints: Joints) -> None:
    """Sum the impulses of all joints for each particle, into `push`."""
    rows = joints.rows
    for p in range(joints.push.shape[0]):
        joints.push[p, 0] = 0.0
        joints.push[p, 1] = 0.0
    for k in range(rows.limit.shape[0]):
        for e in range(rows.first[k], rows.first[k + 1]):
            p = rows.particle[e]
            joints.push[p, 0] += rows.gradient[e, 0] * rows.impulse[k]
            joints.push[p, 1] += rows.gradient[e, 1] * rows.impulse[k]


@inner_kernel
def _give(rows: JointRows, k: int, impulse: float, delta_v: Floats, inverse_mass: Floats) -> None:
    for e in range(rows.first[k], rows.first[k + 1]):
        p = rows.particle[e]
        delta_v[p, 0] += rows.gradient[e, 0] * impulse * inverse_mass[p]
        delta_v[p, 1] += rows.gradient[e, 1] * impulse * inverse_mass[p]


@inner_kernel
def warm_start_joints(joints: Joints, delta_v: Floats, inverse_mass: Floats) -> None:
    """Apply the impulses that joints bring along, to particles that answer by their own mass."""
    couple_masses(joints, inverse_mass)
    for k in range(joints.rows.limit.shape[0]):
        if joints.rows.impulse[k] != 0.0:
            _give(joints.rows, k, joints.rows.impulse[k], delta_v, inverse_mass)


@inner_kernel
def iterate_joint(joints: Joints, k: int, velocity: Floats, delta_v: Floats, inverse_mass: Floats) -> None:
    """Bring a joint, or two that are clamped together, to its target; particles answer by their own mass."""
    rows = joints.rows
    if rows.pair[k] == SECOND_OF_TWO or not (rows.limit[k] > 0.0 and joints.response[k, k] > 0.0):
        return
    u = row_velocity(rows, k, velocity, delta_v)
    if rows.pair[k] == PAIR:
        first, second = _of_two(joints, k, u, row_velocity(rows, k + 1, velocity, delta_v))
        _give(rows, k + 1, second - rows.impulse[k + 1], delta_v, inverse_mass)
        rows.impulse[k + 1] = second
    else:
        first = _alone(joints, k, u)
    _give(rows, k, first - rows.impulse[k], delta_v, inverse_mass)
    rows.impulse[k] = first


@inner_kernel
def iterate_joints(joints: Joints, velocity: Floats, delta_v: Floats, inverse_mass: Floats) -> None:
    """One iteration over all joints of particles that answer by their own mass; clamped is the sum of its impulses."""
    for k in range(joints.rows.limit.shape[0]):
        iterate_joint(joints, k, velocity, delta_v, inverse_mass)
