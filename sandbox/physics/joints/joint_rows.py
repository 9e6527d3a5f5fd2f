"""Joint rows: velocities that an impulse of bounded size brings to a target; motors and hands are such rows.

A row is u = sum g . v over some particles, and its impulse P gives each of them g P. It obeys the equation in its
implicit form, K made as large as it likes, and the impulse is clamped:

    P = -K (u' - target),   1/K = softness,   |P| <= limit

so what a joint can carry is its limit alone, and it gives no more than it needs. Solvers find P with all else that acts
on the particles: the direct one in sweeps with those of contacts, the iterative one among its springs.

A joint takes in many particles of a body, so it is swept through what each of its bodies answers to a unit of it,
Z = A^-1 g, kept by row: an impulse at one particle changes u by Z there, that of another joint by g . Z. Joints that
share no body are not coupled at all, and nothing is kept or done for them.

Another kind of joint makes its rows in `joint_set.py` and fills in their numbers at the start of every substep.
"""

import math
from typing import Annotated, NamedTuple

from sandbox.physics.arena import Arena, is_full, new_floats, new_slots, new_tuple
from sandbox.physics.arrays import FloatRows, Floats, Slots
from sandbox.physics.equation import implicit_update
from sandbox.physics.jit import inner_kernel
from sandbox.physics.topology.sorting import list_by_key, place_among

# Of a row: alone; the first of two whose impulses together are clamped by their length; the second of them.
SCALAR, PAIR, SECOND_OF_TWO = 0, 1, -1


class JointRows(NamedTuple):
    """The rows of a world's joints. Topology decides the first three fields, a substep the others."""

    first: Annotated[Slots, "rows + 1"]  # entries of row k are first[k] to first[k + 1]
    particle: Annotated[Slots, "entries"]  # free ones, each at most once in a row
    pair: Annotated[Slots, "rows"]  # SCALAR, or one of two that follow each other
    gradient: Annotated[FloatRows, "entries, 2"]
    target: Annotated[Floats, "rows"]
    softness: Annotated[Floats, "rows"]  # 1/K
    limit: Annotated[Floats, "rows"]  # of the impulse, 0: the row is off; two that are clamped together have the same
    impulse: Annotated[Floats, "rows"]  # that of the last substep, then of this one


class Actions(NamedTuple):
    """The nodes that rows act on, each a body or a particle in none; an action is that of one row on one node."""

    start: Annotated[Slots, "entries + 1"]  # particles of node q: particle[start[q]:start[q + 1]],
    particle: Annotated[Slots, "particles"]  # those of a body in the order of the matrix
    body: Annotated[Slots, "entries"]  # (q,): its number, -1: a particle
    node: Annotated[Slots, "particles"]  # by particle (n,), -1: none
    place: Annotated[Slots, "particles"]  # by particle (n,): its place in its node
    first: Annotated[Slots, "count + 1"]  # actions of row k: first[k] to first[k + 1]
    row: Annotated[Slots, "entries"]  # by action
    on: Annotated[Slots, "entries"]  # by action: its node
    answers: Annotated[Slots, "entries + 1"]  # by action: where those of the node's particles begin
    entry: Annotated[Slots, "entries"]  # by entry of rows: its action
    at_first: Annotated[Slots, "entries + 1"]
    at: Annotated[Slots, "entries"]  # actions on node q: at[at_first[q]:at_first[q + 1]]


class Couplings(NamedTuple):
    """Rows that share a node: those of row k, ascending, at row[first[k]:first[k + 1]]; itself at own[k].

    response, by coupling of k with j: g_j . Z_k, what a unit impulse of row k adds to u of row j. slot (k,): scratch.
    """

    first: Slots
    row: Slots
    own: Slots
    response: Floats
    slot: Slots


class Joints(NamedTuple):
    """The rows of joints, and how bodies answer to them."""

    rows: JointRows
    actions: Actions
    couplings: Couplings
    listed: Annotated[Slots, "count"]  # the rows that are swept, ascending; as long as there are rows
    answer: Annotated[FloatRows, "answered, 2"]  # (a, 2): velocities by a unit impulse, see Actions
    velocity: Annotated[Floats, "count"]  # (k,): u; scratch of a step, as all below
    last_impulse: Annotated[Floats, "count"]  # (k,): as that of contacts
    search_direction: Annotated[Floats, "count"]  # (k,): likewise
    push: Annotated[FloatRows, "particles, 2"]  # (n, 2) [N s]: what the joints together give each particle


@inner_kernel
def any_on(rows: JointRows) -> bool:
    """Whether any row is on."""
    found = False
    for k in range(rows.limit.shape[0]):
        found = found or rows.limit[k] > 0.0
    return found


@inner_kernel
def row_velocity(rows: JointRows, k: int, velocity: FloatRows, delta_v: FloatRows) -> float:
    """u = sum g . v of a row, from velocity + delta_v (n, 2)."""
    u = 0.0
    for e in range(rows.first[k], rows.first[k + 1]):
        p = rows.particle[e]
        u += rows.gradient[e, 0] * (velocity[p, 0] + delta_v[p, 0])
        u += rows.gradient[e, 1] * (velocity[p, 1] + delta_v[p, 1])
    return u


@inner_kernel
def clamped(impulse: float, limit: float) -> float:
    """An impulse of at most this size, either way."""
    return min(max(impulse, -limit), limit)


@inner_kernel
def shortened(first: float, second: float, limit: float) -> float:
    """Factor by which two impulses at right angles become no longer than the limit."""
    # Compared as squares: most are short, and no root is taken of them.
    square = first * first + second * second
    if square > limit * limit:
        return limit / math.sqrt(square)
    return 1.0


@inner_kernel
def new_joints(rows: JointRows, particle: Slots, row_of: Slots, row_start: Slots, arena: Arena) -> Joints:
    """Lay out joints, with room for the rows of a world.

    particle: of each row of the matrix; row_of (n,): the row of each particle, -1: in none; row_start: of each body.
    """
    count: int = rows.limit.shape[0]
    entries: int = rows.particle.shape[0]
    particles = row_of.shape[0]
    acted_on = particles if entries > 0 else 0
    last = new_slots(arena, entries)
    actions = new_tuple(Actions, arena, particles=acted_on, count=count, entries=entries)
    if not is_full(arena):
        nodes = _find_nodes(rows, particle, row_of, row_start, actions)
        _find_actions(rows, nodes, last, actions)
    first, seen, slot = new_slots(arena, count + 1), new_slots(arena, count), new_slots(arena, count)
    if not is_full(arena):
        _count_couplings(actions, first, seen)
    coupled = first[count] if not is_full(arena) else 0
    couplings = Couplings(first, new_slots(arena, coupled), new_slots(arena, count), new_floats(arena, coupled), slot)
    if not is_full(arena):
        _list_couplings(actions, couplings, seen, slot)
    answers = actions.answers[entries] if not is_full(arena) else 0
    return new_tuple(
        Joints, arena, rows=rows, actions=actions, couplings=couplings, count=count, answered=answers,
        particles=particles if count > 0 else 0,
    )  # fmt: skip


@inner_kernel
def _find_nodes(rows: JointRows, particle: Slots, row_of: Slots, row_start: Slots, made: Actions) -> int:
    # Number what rows act on in the order in which they name it; how many nodes there are.
    for p in range(made.node.shape[0]):
        made.node[p] = -1
    count = 0
    top = 0
    for e in range(rows.particle.shape[0]):
        p = rows.particle[e]
        if made.node[p] >= 0:
            continue
        made.body[count] = -1
        if row_of[p] >= 0:
            body = place_among(row_of[p] + 1, row_start, 0, row_start.shape[0]) - 1
            made.body[count] = body
            for row in range(row_start[body], row_start[body + 1]):
                made.node[particle[row]] = count
                made.place[particle[row]] = row - row_start[body]
                made.particle[top] = particle[row]
                top += 1
        else:
            made.node[p] = count
            made.particle[top] = p
            top += 1
        count += 1
        made.start[count] = top
    return count


@inner_kernel
def _find_actions(rows: JointRows, nodes: int, last: Slots, made: Actions) -> None:
    # List the actions of every row, and where answers begin, and end in all. last: scratch by node.
    count = 0
    answers = 0
    for q in range(nodes):
        last[q] = -1
    for k in range(rows.limit.shape[0]):
        for e in range(rows.first[k], rows.first[k + 1]):
            q = made.node[rows.particle[e]]
            if last[q] < made.first[k]:
                last[q] = count
                made.row[count] = k
                made.on[count] = q
                made.answers[count] = answers
                answers += made.start[q + 1] - made.start[q]
                count += 1
            made.entry[e] = last[q]
        made.first[k + 1] = count
    for action in range(count, made.answers.shape[0]):
        made.answers[action] = answers
    list_by_key(made.on, count, nodes, made.at_first, made.at)


@inner_kernel
def _count_couplings(actions: Actions, first: Slots, seen: Slots) -> None:
    # Where the couplings of each row begin. seen (k,): scratch.
    for k in range(seen.shape[0]):
        seen[k] = -1
    for k in range(seen.shape[0]):
        first[k + 1] = first[k]
        for a in range(actions.first[k], actions.first[k + 1]):
            q = actions.on[a]
            for i in range(actions.at_first[q], actions.at_first[q + 1]):
                j = actions.row[actions.at[i]]
                if seen[j] != k:
                    seen[j] = k
                    first[k + 1] += 1


@inner_kernel
def _list_couplings(actions: Actions, made: Couplings, seen: Slots, top: Slots) -> None:
    # Coupling goes both ways: row by row, each is entered in the lists of those that it is coupled with.
    for k in range(seen.shape[0]):
        seen[k] = -1
        top[k] = made.first[k]
    for j in range(seen.shape[0]):
        for a in range(actions.first[j], actions.first[j + 1]):
            q = actions.on[a]
            for i in range(actions.at_first[q], actions.at_first[q + 1]):
                k = actions.row[actions.at[i]]
                if seen[k] != j:
                    seen[k] = j
                    made.row[top[k]] = j
                    if k == j:
                        made.own[k] = top[k]
                    top[k] += 1


@inner_kernel
def joints_by_mass(rows: JointRows, arena: Arena) -> Joints:
    """Joints whose particles answer by their own mass alone; coupled are two rows that are clamped together."""
    none, count = new_slots(arena, 0), rows.limit.shape[0]
    listed, first = new_slots(arena, count), new_slots(arena, count + 1)
    couplings = Couplings(
        first, new_slots(arena, 2 * count), new_slots(arena, count), new_floats(arena, 2 * count), none
    )  # fmt: skip
    if not is_full(arena):
        for k in range(count):
            listed[k] = k
            before, after = (1 if rows.pair[k] == SECOND_OF_TWO else 0), (1 if rows.pair[k] == PAIR else 0)
            couplings.own[k] = first[k] + before
            first[k + 1] = first[k] + before + 1 + after
            for j in range(k - before, k + after + 1):
                couplings.row[couplings.own[k] + j - k] = j
    actions = Actions(none, none, none, none, none, none, none, none, none, none, none, none)
    return new_tuple(
        Joints, arena, rows=rows, actions=actions, couplings=couplings, listed=listed, count=count, answered=0,
        particles=0,
    )  # fmt: skip


@inner_kernel
def own_response(joints: Joints, k: int) -> float:
    """g_k . Z_k: what a unit impulse of a row adds to its own u."""
    return joints.couplings.response[joints.couplings.own[k]]


@inner_kernel
def push_at(joints: Joints, p: int, jx: float, jy: float) -> None:
    """Add the effect of an impulse at a particle to the velocities of rows."""
    actions = joints.actions
    if actions.node.shape[0] == 0 or actions.node[p] < 0:
        return
    q = actions.node[p]
    for i in range(actions.at_first[q], actions.at_first[q + 1]):
        action = actions.at[i]
        a = actions.answers[action] + actions.place[p]
        joints.velocity[actions.row[action]] += joints.answer[a, 0] * jx + joints.answer[a, 1] * jy


@inner_kernel
def couple_joints(joints: Joints) -> None:
    """g . Z of the rows that are listed, from the answers."""
    rows, actions, couplings = joints.rows, joints.actions, joints.couplings
    for listed in range(joints.listed.shape[0]):
        k = joints.listed[listed]
        for c in range(couplings.first[k], couplings.first[k + 1]):
            j = couplings.row[c]
            slot = place_among(k, couplings.row, couplings.first[j], couplings.first[j + 1])
            couplings.slot[j] = slot
            couplings.response[slot] = 0.0
        for e in range(rows.first[k], rows.first[k + 1]):
            q = actions.node[rows.particle[e]]
            place = actions.place[rows.particle[e]]
            for i in range(actions.at_first[q], actions.at_first[q + 1]):
                action = actions.at[i]
                a = actions.answers[action] + place
                couplings.response[couplings.slot[actions.row[action]]] += (
                    rows.gradient[e, 0] * joints.answer[a, 0] + rows.gradient[e, 1] * joints.answer[a, 1]
                )


@inner_kernel
def couple_masses(joints: Joints, inverse_mass: Floats) -> None:
    """Find the responses of rows, and of two with each other, where every particle answers by its own mass."""
    rows, couplings = joints.rows, joints.couplings
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
        couplings.response[couplings.own[k]] = own
        if other != k:
            couplings.response[couplings.own[k] + 1] = both
            couplings.response[couplings.own[other] - 1] = both


@inner_kernel
def start_joints(joints: Joints, delta_v: FloatRows) -> None:
    """Apply the impulses that joints bring along."""
    rows = joints.rows
    for i in range(joints.listed.shape[0]):
        k = joints.listed[i]
        joints.search_direction[k] = 0.0
        if rows.impulse[k] != 0.0:
            _push(joints, k, rows.impulse[k], delta_v)


@inner_kernel
def _push(joints: Joints, k: int, impulse: float, delta_v: FloatRows) -> None:
    # What a row's impulse does to particles and to the velocities of rows that are coupled with it.
    actions, couplings = joints.actions, joints.couplings
    for action in range(actions.first[k], actions.first[k + 1]):
        q, answers = actions.on[action], actions.answers[action]
        for i in range(actions.start[q], actions.start[q + 1]):
            p, a = actions.particle[i], answers + i - actions.start[q]
            delta_v[p, 0] += joints.answer[a, 0] * impulse
            delta_v[p, 1] += joints.answer[a, 1] * impulse
    for c in range(couplings.first[k], couplings.first[k + 1]):
        joints.velocity[couplings.row[c]] += couplings.response[c] * impulse


@inner_kernel
def sweep_joints(joints: Joints, delta_v: FloatRows) -> float:
    """One sweep over all joints, in order; the largest change of a row's velocity [m/s, where g has no unit]."""
    rows = joints.rows
    largest = 0.0
    for i in range(joints.listed.shape[0]):
        k = joints.listed[i]
        joints.last_impulse[k] = rows.impulse[k]
    for i in range(joints.listed.shape[0]):
        k = joints.listed[i]
        if rows.pair[k] == SECOND_OF_TWO or not (rows.limit[k] > 0.0 and own_response(joints, k) > 0.0):
            continue
        if rows.pair[k] == PAIR:
            first, second = _of_two(joints, k, joints.velocity[k], joints.velocity[k + 1])
            largest = max(largest, _set(joints, k + 1, second, delta_v))
        else:
            first = _alone(joints, k, joints.velocity[k])
        largest = max(largest, _set(joints, k, first, delta_v))
    return largest


@inner_kernel
def _of_two(joints: Joints, k: int, u: float, v: float) -> tuple[float, float]:
    first, second = answer_of_two(joints, k, u, v)
    ratio = shortened(first, second, joints.rows.limit[k])
    return first * ratio, second * ratio


@inner_kernel
def _set(joints: Joints, k: int, impulse: float, delta_v: FloatRows) -> float:
    # Give a row another impulse; by how much its own velocity changes.
    more = impulse - joints.rows.impulse[k]
    if more == 0.0:
        return 0.0
    joints.rows.impulse[k] = impulse
    _push(joints, k, more, delta_v)
    return abs(more) * own_response(joints, k)


@inner_kernel
def _alone(joints: Joints, k: int, u: float) -> float:
    rows = joints.rows
    new = implicit_update(rows.impulse[k], u - rows.target[k], own_response(joints, k), rows.softness[k])  # (25)
    return clamped(new, rows.limit[k])


@inner_kernel
def swept_by(joints: Joints) -> float:
    """The squared change of impulses in the last sweep, in the metric of the responses."""
    squared = 0.0
    for i in range(joints.listed.shape[0]):
        k = joints.listed[i]
        more = joints.rows.impulse[k] - joints.last_impulse[k]
        squared += own_response(joints, k) * more * more
    return squared


@inner_kernel
def go_on_with_joints(joints: Joints, delta_v: FloatRows, ratio: float) -> None:
    """P += ratio p, clamped; p = ratio p + the change of the sweep: as contacts do."""
    rows = joints.rows
    for i in range(joints.listed.shape[0]):
        k = joints.listed[i]
        more = ratio * joints.search_direction[k]
        joints.search_direction[k] = more + (rows.impulse[k] - joints.last_impulse[k])
        joints.last_impulse[k] = rows.impulse[k] + more
    for i in range(joints.listed.shape[0]):
        k = joints.listed[i]
        if rows.pair[k] == SECOND_OF_TWO:
            continue
        if rows.pair[k] == PAIR:
            shorter = shortened(joints.last_impulse[k], joints.last_impulse[k + 1], rows.limit[k])
            _set(joints, k, joints.last_impulse[k] * shorter, delta_v)
            _set(joints, k + 1, joints.last_impulse[k + 1] * shorter, delta_v)
        else:
            _set(joints, k, clamped(joints.last_impulse[k], rows.limit[k]), delta_v)


@inner_kernel
def gather_push(joints: Joints) -> None:
    """Sum the impulses of the joints that are listed for each particle that they act on, into `push`."""
    rows = joints.rows
    for i in range(joints.listed.shape[0]):
        k = joints.listed[i]
        for e in range(rows.first[k], rows.first[k + 1]):
            joints.push[rows.particle[e], 0] = 0.0
            joints.push[rows.particle[e], 1] = 0.0
    for i in range(joints.listed.shape[0]):
        k = joints.listed[i]
        for e in range(rows.first[k], rows.first[k + 1]):
            p = rows.particle[e]
            joints.push[p, 0] += rows.gradient[e, 0] * rows.impulse[k]
            joints.push[p, 1] += rows.gradient[e, 1] * rows.impulse[k]


@inner_kernel
def warm_start_joints(joints: Joints, delta_v: FloatRows, inverse_mass: Floats) -> None:
    """Apply the impulses that joints bring along, to particles that answer by their own mass."""
    couple_masses(joints, inverse_mass)
    for k in range(joints.rows.limit.shape[0]):
        if joints.rows.impulse[k] != 0.0:
            give_impulse(joints.rows, k, joints.rows.impulse[k], delta_v, inverse_mass)


@inner_kernel
def iterate_joints(joints: Joints, velocity: FloatRows, delta_v: FloatRows, inverse_mass: Floats) -> None:
    """One iteration over all joints of particles that answer by their own mass; clamped is the sum of its impulses."""
    for k in range(joints.rows.limit.shape[0]):
        iterate_joint(joints, k, velocity, delta_v, inverse_mass)


@inner_kernel
def iterate_joint(joints: Joints, k: int, velocity: FloatRows, delta_v: FloatRows, inverse_mass: Floats) -> None:
    """Bring a joint, or two that are clamped together, to its target; particles answer by their own mass."""
    rows = joints.rows
    if rows.pair[k] == SECOND_OF_TWO or not (rows.limit[k] > 0.0 and own_response(joints, k) > 0.0):
        return
    u = row_velocity(rows, k, velocity, delta_v)
    if rows.pair[k] == PAIR:
        first, second = _of_two(joints, k, u, row_velocity(rows, k + 1, velocity, delta_v))
        give_impulse(rows, k + 1, second - rows.impulse[k + 1], delta_v, inverse_mass)
        rows.impulse[k + 1] = second
    else:
        first = _alone(joints, k, u)
    give_impulse(rows, k, first - rows.impulse[k], delta_v, inverse_mass)
    rows.impulse[k] = first


@inner_kernel
def answer_of_two(joints: Joints, k: int, u: float, v: float) -> tuple[float, float]:
    """The impulses of two rows that are clamped together, from their velocities; clamped by nothing yet."""
    # (W + 1/K) dP = -(u - target + P/K)
    rows = joints.rows
    first, second = rows.impulse[k], rows.impulse[k + 1]
    couplings = joints.couplings
    a = own_response(joints, k) + rows.softness[k]
    b = couplings.response[couplings.own[k + 1] - 1]
    c = couplings.response[couplings.own[k] + 1]
    d = own_response(joints, k + 1) + rows.softness[k + 1]
    determinant = a * d - b * c
    if not determinant > 0.0:
        return first, second
    r = -(u - rows.target[k] + rows.softness[k] * first)
    s = -(v - rows.target[k + 1] + rows.softness[k + 1] * second)
    first += (d * r - b * s) / determinant
    second += (a * s - c * r) / determinant
    return first, second


@inner_kernel
def give_impulse(rows: JointRows, k: int, impulse: float, delta_v: FloatRows, inverse_mass: Floats) -> None:
    """Apply an impulse of a row to particles that answer by their own mass."""
    for e in range(rows.first[k], rows.first[k + 1]):
        p = rows.particle[e]
        delta_v[p, 0] += rows.gradient[e, 0] * impulse * inverse_mass[p]
        delta_v[p, 1] += rows.gradient[e, 1] * impulse * inverse_mass[p]
