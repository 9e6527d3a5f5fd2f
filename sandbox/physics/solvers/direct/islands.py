"""Contact islands: which bodies and free particles contacts touch or joints act on, and which of them hang together.

Each island is solved as if it were alone in the world: what does not touch, changes nothing. So its members, contacts
and joints lie one behind another, and are numbered within the island.
"""

from typing import Annotated, NamedTuple

from sandbox.physics.arena import Arena, is_full, new_slots, new_tuple
from sandbox.physics.arrays import Flags, FloatRows, Floats, Slots
from sandbox.physics.collision.types import ENDS, Contacts, contacts_between, weight_of
from sandbox.physics.components import root_of, united
from sandbox.physics.jit import inner_kernel, set_field
from sandbox.physics.joints.joint_rows import Actions, Joints
from sandbox.physics.solvers.contact.gauss_seidel import (
    ContactConstraints,
    ContactOrder,
    Delassus,
    put_in_order,
    terms_between,
)
from sandbox.physics.solvers.direct.system import BY_MASS, PASSED, Span, System, span_of
from sandbox.physics.topology.sorting import list_by_key, place_among

# Places in `counts`: bodies that contacts touch, members (those and free particles), islands, and the room that the
# Delassus blocks of the bodies want: for their numbers, and in each lane for the columns of the largest.
BODIES, MEMBERS, ISLANDS, NUMBERS, COLUMNS, COUNTED = range(6)
# Bodies of an island that are worked on at once, each lane of them with scratch of its own.
LANES = 8
# What a Delassus block may cost at most in a linear solve, in units of four multiplications, about 1 ns each. A body
# that wants more, because much of it lies on something, has none: in the sweeps its particles answer by their own
# masses, and between them by its springs. Less leaves what is large soft where it lands.
DEAREST_BLOCK = 4_000_000
# Columns of `tally`: the energy of an island's members, what that may be, what of this is lent; and what was too much
# after the last solve.
TOTAL, ALLOWED, LENT, EXCESS, TALLIED = range(5)


class BodyIslands(NamedTuple):
    """The bodies and free particles that contacts touch or joints act on, in this order the members of islands.

    There is room for all bodies and particles. Of all islands together bodies and free particles lie island by island;
    `alone` is one of them, its members numbered by themselves as those of the only island there is: so are `member` and
    the blocks of bodies.
    """

    counts: Annotated[Slots, f"{COUNTED}"]  # (5,): how many there are
    body: Annotated[Slots, "bodies"]  # their numbers
    free: Annotated[Slots, "particles"]  # slots of particles
    member: Annotated[Slots, "particles"]  # (n,) by particle, -1: none
    row: Annotated[Slots, "particles"]  # (n,) by particle: its row in the matrix, -1: none
    mass: Annotated[Floats, "members"]  # [kg]: by member, as all down to fresh
    energy0: Annotated[Floats, "members"]  # [J]: where the step begins
    budget: Annotated[Floats, "members"]  # [J]: in its energy budget
    energy: Annotated[Floats, "members"]  # [J]: where the step ends
    debt: Annotated[Floats, "members"]  # [J]: the most it may owe
    ahead: Annotated[Floats, "members"]  # [J]: work of forces in half a step at v'
    moves: Annotated[Floats, "members"]  # [J]: KE(v')
    rises: Annotated[Floats, "members"]  # [J]: what it seems to gain if it is stopped
    fresh: Annotated[Flags, "members"]  # its budget is begun for all of it
    misfit: Annotated[Floats, "bodies"]  # by touched body, as all down to by_mass
    due: Annotated[Flags, "bodies"]  # to be solved again
    rigid: Annotated[Flags, "bodies"]  # all its springs are
    firm: Annotated[Flags, "bodies"]  # all its springs are
    pressed: Annotated[Flags, "bodies"]  # contacts press it by far more than forces do, and no joint acts on it
    still: Annotated[Flags, "bodies"]  # pressed and slow
    driven: Annotated[Flags, "bodies"]  # a joint acts on it
    by_mass: Annotated[Flags, "bodies"]  # it has no block, see DEAREST_BLOCK
    tally: Annotated[FloatRows, f"members, {TALLIED}"]  # (islands, TALLIED) [J]: see TOTAL
    way: Annotated[Slots, "members"]  # by island: see system.py
    v_free: Annotated[FloatRows, "rows, 2"]  # [m/s] by row: velocities without contacts
    impulse: Annotated[FloatRows, "rows, 2"]  # [N s] by row: of contacts and joints; then the change by it [m/s]
    v0: Annotated[FloatRows, "particles, 2"]  # [m/s] (n,) by particle: velocities without contacts
    delta_v: Annotated[FloatRows, "particles, 2"]  # [m/s] (n,): what contacts add
    label: Annotated[Slots, "members"]  # label, root, marked: scratch
    root: Annotated[Slots, "members"]
    marked: Annotated[Flags, "particles"]


class IslandLists(NamedTuple):
    """Where the bodies, free particles and joints of each island begin, (i + 1,) each; counts (5 i,): as in `alone`."""

    body: Annotated[Slots, "islands + 1"]
    free: Annotated[Slots, "islands + 1"]
    joint: Annotated[Slots, "islands + 1"]
    counts: Annotated[Slots, f"{COUNTED} * islands"]


class IslandWorkspace(NamedTuple):
    """Islands of bodies with what solves their contacts, as kernels take them; ways: counts, see system.py."""

    ways: Slots
    islands: BodyIslands
    lists: IslandLists
    delassus: Delassus
    terms: ContactConstraints
    order: ContactOrder


@inner_kernel
def lay_out_islands(system: System, particles: int, arena: Arena, out: IslandWorkspace) -> None:
    """Lay out islands and blocks for a system, in a world of so many particles; the room of blocks is made apart."""
    bodies, free_rows = system.bodies.lowest.shape[0], system.matrix.diagonal.shape[0]
    members = bodies + particles
    islands = new_tuple(BodyIslands, arena, bodies=bodies, particles=particles, members=members, rows=free_rows)
    set_field(out, "islands", islands)
    set_field(out, "lists", new_tuple(IslandLists, arena, islands=members))
    given = out.delassus
    delassus = new_tuple(
        Delassus, arena, numbers=given.numbers, columns=given.columns, joints=given.joints, particles=particles,
        blocks=bodies, rows=free_rows,
    )  # fmt: skip
    set_field(out, "delassus", delassus)
    if is_full(arena):
        return
    for p in range(particles):
        islands.row[p] = islands.member[p] = delassus.block[p] = delassus.place[p] = -1
    for row in range(free_rows):
        islands.row[system.rows.particle[row]] = row


@inner_kernel
def use_diagonal_delassus(particles: int, arena: Arena, out: Delassus) -> None:
    """Lay out a Delassus operator that is diagonal: each particle answers an impulse by its own mass."""
    block = new_slots(arena, particles)
    set_field(out, "block", block)
    set_field(out, "start", new_slots(arena, 1))
    if not is_full(arena):
        for p in range(particles):
            block[p] = -1


@inner_kernel
def find_body_islands(
    contacts: Contacts, source: Slots, inverse_mass: Floats, system: System, workspace: IslandWorkspace
) -> bool:  # fmt: skip
    """Find the bodies and free particles that some contacts touch, and their islands; whether there is room for them.

    source: which contacts; they are put into the order of their islands.
    """
    islands, lists, joints = workspace.islands, workspace.lists, workspace.delassus.joints
    particles, bodies = islands.row.shape[0], system.bodies.touched.shape[0]
    for node in range(particles + bodies):
        islands.label[node] = node
    for p in range(particles):
        islands.marked[p] = False
    for body in range(bodies):
        system.bodies.touched[body] = False
    _join_driven(joints, system, islands)
    _join_touching(contacts, source, inverse_mass, system, islands)
    count = _number_islands(system.bodies.touched, islands)
    list_by_key(islands.label[particles:], bodies, count, lists.body, islands.body)
    list_by_key(islands.label, particles, count, lists.free, islands.free)
    # List the rows that are on, by island.
    particles, actions, key = islands.row.shape[0], joints.actions, joints.couplings.slot
    for k in range(key.shape[0]):
        key[k] = -1
        if joints.rows.limit[k] > 0.0 and actions.first[k] < actions.first[k + 1]:
            key[k] = islands.label[_node_acted_on(actions.on[actions.first[k]], actions, particles)]
    list_by_key(key, key.shape[0], count, lists.joint, joints.listed)
    # Put the contacts of each island behind one another, in their order.
    order = workspace.order
    for k in range(source.shape[0]):
        order.island[k] = -1
        for end in range(3):
            p, _ = weight_of(contacts, source[k], end)
            if p >= 0 and inverse_mass[p] > 0.0:
                order.island[k] = islands.label[_node_of(p, islands.row, system.bodies.row_start)]
    put_in_order(source, order, count)
    _number_members(count, system, workspace)
    islands.counts[BODIES] = lists.body[count]
    islands.counts[MEMBERS] = lists.body[count] + lists.free[count]
    islands.counts[ISLANDS] = count
    _find_room(system, workspace)
    counts, delassus = islands.counts, workspace.delassus
    return counts[NUMBERS] <= delassus.numbers.shape[0] and counts[COLUMNS] <= delassus.columns.shape[0]


@inner_kernel
def _join_driven(joints: Joints, system: System, islands: BodyIslands) -> None:
    # Label the nodes alike that one joint acts on, and mark them.
    particles, actions = islands.row.shape[0], joints.actions
    for k in range(joints.rows.limit.shape[0]):
        if not joints.rows.limit[k] > 0.0:
            continue
        first = -1
        for a in range(actions.first[k], actions.first[k + 1]):
            node = _node_acted_on(actions.on[a], actions, particles)
            if node >= particles:
                system.bodies.touched[node - particles] = True
            else:
                islands.marked[node] = True
            first = united(islands.label, first, root_of(islands.label, node))


@inner_kernel
def _node_acted_on(q: int, actions: Actions, particles: int) -> int:
    body = actions.body[q]
    return particles + body if body >= 0 else actions.particle[actions.start[q]]


@inner_kernel
def _join_touching(
    contacts: Contacts, source: Slots, inverse_mass: Floats, system: System, islands: BodyIslands
) -> None:  # fmt: skip
    # Label the nodes alike that touch each other, and mark them; what cannot move joins nothing.
    particles = islands.row.shape[0]
    for k in range(source.shape[0]):
        first = -1
        for end in range(ENDS):
            p, _ = weight_of(contacts, source[k], end)
            if p < 0 or inverse_mass[p] == 0.0:
                continue
            islands.marked[p] = True
            node = _node_of(p, islands.row, system.bodies.row_start)
            if node >= particles:
                system.bodies.touched[node - particles] = True
            first = united(islands.label, first, root_of(islands.label, node))


@inner_kernel
def _node_of(p: int, row: Slots, row_start: Slots) -> int:
    # Nodes are particles (n,), then bodies: a particle of a body stands for that.
    return p if row[p] < 0 else row.shape[0] + place_among(row[p] + 1, row_start, 0, row_start.shape[0]) - 1


@inner_kernel
def _number_islands(touched: Flags, islands: BodyIslands) -> int:
    # The island of each node in `label`, in the order of their first members, -1: in none; how many islands there are.
    particles, nodes = islands.row.shape[0], islands.label.shape[0]
    for node in range(nodes):
        islands.root[node] = root_of(islands.label, node)
        islands.label[node] = islands.root[node]
    for node in range(nodes):
        islands.label[node] = -1
    count = 0
    for i in range(nodes):
        # Bodies first.
        node = particles + i if i < nodes - particles else i - (nodes - particles)
        if touched[i] if node >= particles else islands.marked[node] and islands.row[node] < 0:
            root = islands.root[node]
            if islands.label[root] < 0:
                islands.label[root] = count
                count += 1
    for node in range(nodes):
        islands.label[node] = islands.label[islands.root[node]]
    return count


@inner_kernel
def _number_members(count: int, system: System, workspace: IslandWorkspace) -> None:
    # Number the members of each island, and list the points of its bodies by row.
    islands, lists, delassus = workspace.islands, workspace.lists, workspace.delassus
    for p in range(islands.member.shape[0]):
        islands.member[p] = delassus.block[p] = delassus.place[p] = -1
    points = 0
    for i in range(count):
        bodies = lists.body[i + 1] - lists.body[i]
        for number in range(bodies):
            k = lists.body[i] + number
            body = islands.body[k]
            islands.driven[k] = _is_driven(body, delassus.joints, system)
            delassus.start[k] = points
            for r in range(system.bodies.row_start[body], system.bodies.row_start[body + 1]):
                p = system.rows.particle[r]
                if islands.marked[p]:
                    delassus.block[p] = islands.member[p] = number
                    delassus.place[p] = points - delassus.start[k]
                    delassus.point[points] = p
                    points += 1
        for at in range(lists.free[i], lists.free[i + 1]):
            islands.member[islands.free[at]] = bodies + at - lists.free[i]
        lists.counts[COUNTED * i + BODIES] = bodies
        lists.counts[COUNTED * i + MEMBERS] = bodies + lists.free[i + 1] - lists.free[i]
        lists.counts[COUNTED * i + ISLANDS] = 1
        islands.way[i] = PASSED
    delassus.start[lists.body[count]] = points


@inner_kernel
def _is_driven(body: int, joints: Joints, system: System) -> bool:
    actions = joints.actions
    if actions.node.shape[0] == 0:
        return False
    q = actions.node[system.rows.particle[system.bodies.row_start[body]]]
    if q >= 0:
        for i in range(actions.at_first[q], actions.at_first[q + 1]):
            if joints.rows.limit[actions.row[actions.at[i]]] > 0.0:
                return True
    return False


@inner_kernel
def _find_room(system: System, workspace: IslandWorkspace) -> None:
    # Where the Delassus blocks of the bodies begin, and what room they want.
    islands, delassus = workspace.islands, workspace.delassus
    base = 0
    columns = 0
    for k in range(islands.counts[BODIES]):
        points = delassus.start[k + 1] - delassus.start[k]
        span = span_of(system, islands.body[k])
        delassus.base[k] = base
        # A substitution for each column, and for a small body that is not in fronts the sum over its rows.
        cost = 2 * points * cost_of_answer(span, system)
        if system.fronts.of_row[span.first_row] < 0:
            cost = cost // 4 + points * points * (span.last_row - span.first_row)
        islands.by_mass[k] = cost > DEAREST_BLOCK
        if islands.by_mass[k]:
            workspace.ways[BY_MASS] += 1
            for i in range(delassus.start[k], delassus.start[k + 1]):
                delassus.block[delassus.point[i]] = -1
            continue
        base += 4 * points * points
        if system.fronts.of_row[span.first_row] < 0:
            columns = max(columns, 4 * points * (span.last_row - span.first_row))
    delassus.base[islands.counts[BODIES]] = base
    islands.counts[NUMBERS] = base
    islands.counts[COLUMNS] = min(LANES, islands.counts[BODIES]) * columns


@inner_kernel
def contacts_of(i: int, contacts: Contacts, workspace: IslandWorkspace) -> Contacts:
    """The contacts of one island."""
    return contacts_between(contacts, workspace.order.first[i], workspace.order.first[i + 1])


@inner_kernel
def alone(i: int, workspace: IslandWorkspace) -> IslandWorkspace:
    """One island, as if there were no other: the slices of the workspace that belong to it."""
    w, lists, delassus, order = workspace.islands, workspace.lists, workspace.delassus, workspace.order
    b, c, f, g = lists.body[i], lists.body[i + 1], lists.free[i], lists.free[i + 1]
    k, m = b + f, c + g
    joints = delassus.joints
    islands = BodyIslands(
        lists.counts[COUNTED * i : COUNTED * (i + 1)], w.body[b:c], w.free[f:g], w.member, w.row,
        w.mass[k:m], w.energy0[k:m], w.budget[k:m], w.energy[k:m], w.debt[k:m], w.ahead[k:m], w.moves[k:m],
        w.rises[k:m], w.fresh[k:m], w.misfit[b:c], w.due[b:c], w.rigid[b:c], w.firm[b:c], w.pressed[b:c], w.still[b:c],
        w.driven[b:c], w.by_mass[b:c], w.tally[i : i + 1], w.way[i : i + 1], w.v_free, w.impulse, w.v0,
        w.delta_v, w.label, w.root, w.marked,
    )  # fmt: skip
    return IslandWorkspace(
        workspace.ways, islands, lists,
        Delassus(
            delassus.block, delassus.place, delassus.start[b : c + 1], delassus.point, delassus.base[b : c + 1],
            delassus.numbers, delassus.columns,
            Joints(
                joints.rows, joints.actions, joints.couplings, joints.listed[lists.joint[i] : lists.joint[i + 1]],
                joints.answer, joints.velocity, joints.last_impulse, joints.search_direction, joints.push,
            ),
        ),
        terms_between(workspace.terms, order.first[i], order.first[i + 1]), order,
    )  # fmt: skip


@inner_kernel
def cost_of_answer(span: Span, system: System) -> int:
    """What one substitution costs that brings impulses to a whole body, in units of DEAREST_BLOCK."""
    fronts, column_start = system.fronts, system.matrix.column_start
    if fronts.of_row[span.first_row] < 0:
        return 2 * (column_start[span.last_row] - column_start[span.first_row])
    last = fronts.of_row[span.last_row - 1]
    rows = 2 * (fronts.last[last] - fronts.first[last])
    return (fronts.base[last] + rows * fronts.width[last] - fronts.base[fronts.of_row[span.first_row]]) // 2


@inner_kernel
def has_coarse(islands: BodyIslands) -> bool:
    """Whether a body of an island has no Delassus block."""
    found = False
    for k in range(islands.counts[BODIES]):
        found = found or islands.by_mass[k]
    return found
