"""How what joints act on answers to them, and to one another through it.

A joint takes in many particles of a body, so it is swept through what each of its bodies answers to a unit of it,
Z = A^-1 g, kept by row: an impulse at one particle changes u by Z there, that of another joint by g . Z. Joints that
share no body are not coupled at all, and nothing is kept or done for them.
"""

from typing import NamedTuple

from sandbox.physics.arena import Arena, is_full, new_float_rows, new_floats, new_slots
from sandbox.physics.arrays import FloatRows, Floats, Slots
from sandbox.physics.jit import inner_kernel
from sandbox.physics.joints.rows import PAIR, SECOND_OF_TWO, JointRows
from sandbox.physics.topology.sorting import list_by_key, place_among


class Actions(NamedTuple):
    """What rows act on: nodes, each a body or a particle in none; an action is that of one row on one node."""

    start: Slots  # particles of node q: particle[start[q]:start[q + 1]],
    particle: Slots  # those of a body in the order of the matrix
    body: Slots  # (q,): its number, -1: a particle
    node: Slots  # by particle (n,), -1: none
    place: Slots  # by particle (n,): its place in its node
    first: Slots  # actions of row k: first[k] to first[k + 1]
    row: Slots  # by action
    on: Slots  # by action: its node
    answers: Slots  # by action: where those of the node's particles begin
    entry: Slots  # by entry of rows: its action
    at_first: Slots
    at: Slots  # actions on node q: at[at_first[q]:at_first[q + 1]]


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
    listed: Slots  # the rows that are swept, ascending; as long as there are rows
    answer: FloatRows  # (a, 2): velocities by a unit impulse, see Actions
    velocity: Floats  # (k,): u; scratch of a step, as all below
    last_impulse: Floats  # (k,): as that of contacts
    search_direction: Floats  # (k,): likewise
    push: FloatRows  # (n, 2) [N s]: what the joints together give each particle


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
def _new_actions(rows: JointRows, particle: Slots, row_of: Slots, row_start: Slots, arena: Arena) -> Actions:
    count, entries, particles = rows.limit.shape[0], rows.particle.shape[0], row_of.shape[0]
    particles = particles if entries > 0 else 0
    last = new_slots(arena, entries)
    made = Actions(
        new_slots(arena, entries + 1), new_slots(arena, particles), new_slots(arena, entries),
        new_slots(arena, particles), new_slots(arena, particles), new_slots(arena, count + 1),
        new_slots(arena, entries), new_slots(arena, entries), new_slots(arena, entries + 1),
        new_slots(arena, entries), new_slots(arena, entries + 1), new_slots(arena, entries),
    )  # fmt: skip
    if not is_full(arena):
        nodes = _find_nodes(rows, particle, row_of, row_start, made)
        _find_actions(rows, nodes, last, made)
    return made


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
def _new_couplings(actions: Actions, count: int, arena: Arena) -> Couplings:
    first, seen, slot = new_slots(arena, count + 1), new_slots(arena, count), new_slots(arena, count)
    if not is_full(arena):
        _count_couplings(actions, first, seen)
    coupled = first[count] if not is_full(arena) else 0
    made = Couplings(first, new_slots(arena, coupled), new_slots(arena, count), new_floats(arena, coupled), slot)
    if not is_full(arena):
        _list_couplings(actions, made, seen, slot)
    return made


@inner_kernel
def new_joints(rows: JointRows, particle: Slots, row_of: Slots, row_start: Slots, arena: Arena) -> Joints:
    """Lay out joints, with room for the rows of a world.

    particle: of each row of the matrix; row_of (n,): the row of each particle, -1: in none; row_start: of each body.
    """
    count, particles = rows.limit.shape[0], row_of.shape[0]
    actions = _new_actions(rows, particle, row_of, row_start, arena)
    couplings = _new_couplings(actions, count, arena)
    entries: int = rows.particle.shape[0]
    answers = actions.answers[entries] if not is_full(arena) else 0
    return Joints(
        rows, actions, couplings, new_slots(arena, count), new_float_rows(arena, answers, 2), new_floats(arena, count),
        new_floats(arena, count), new_floats(arena, count), new_float_rows(arena, particles if count > 0 else 0, 2),
    )  # fmt: skip


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
    return Joints(
        rows, Actions(none, none, none, none, none, none, none, none, none, none, none, none), couplings, listed,
        new_float_rows(arena, 0, 2), new_floats(arena, count), new_floats(arena, count), new_floats(arena, count),
        new_float_rows(arena, 0, 2),
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
    """The responses of rows, and of two with each other, where every particle answers by its own mass."""
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
