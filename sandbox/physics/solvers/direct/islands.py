"""Contact islands: which bodies and free particles contacts touch or joints act on, and which of them hang together."""

from typing import NamedTuple

from sandbox.physics.arena import Arena, is_full, new_flags, new_float_rows, new_floats, new_slots
from sandbox.physics.arrays import Flags, FloatRows, Floats, Slots
from sandbox.physics.collision.types import Contacts, weight_of
from sandbox.physics.components import root_of, united
from sandbox.physics.jit import inner_kernel, put
from sandbox.physics.joints.joint_sweep import Joints
from sandbox.physics.solvers.contact.gauss_seidel import ContactConstraints, Delassus
from sandbox.physics.solvers.direct.energy_bank import PASSED
from sandbox.physics.solvers.direct.system import System

# Places in `counts`: bodies that contacts touch, members (those and free particles), islands, and the room that the
# Delassus blocks of the bodies want: for their numbers, and for the columns of the largest.
BODIES, MEMBERS, ISLANDS, NUMBERS, COLUMNS, COUNTED = range(6)


class BodyIslands(NamedTuple):
    """The bodies and free particles that contacts touch or joints act on, in this order the members of islands.

    There is room for all bodies and particles; counts (5,) says how many there are. body: their numbers; free: slots of
    particles. By member: island, mass [kg], bank, energies where the step begins (energy0) and ends (energy), limit
    [J]; fresh: its bank is begun for all of it. By particle (n,): member, -1: none, row in the matrix, -1: none; given,
    delta_v [m/s]: velocities without contacts, and what those add. By touched body: misfit; due: to be solved again;
    rigid: all its springs are; driven: a joint acts on it. By body: number among the touched. By island: total, allowed
    [J], fails. By row: unpushed [m/s] = velocities without contacts, pushed [m/s] = what contacts and joints add.
    held: something outside holds it; parts: something in it overlaps deeply; excess [J]: what it had too much, see
    giving_way.py; way: see energy_bank.py.
    label, marked: scratch.
    """

    counts: Slots
    body: Slots
    free: Slots
    island: Slots
    member: Slots
    row: Slots
    mass: Floats
    energy0: Floats
    bank: Floats
    energy: Floats
    limit: Floats
    fresh: Flags
    misfit: Floats
    due: Flags
    rigid: Flags
    driven: Flags
    number: Slots
    total: Floats
    allowed: Floats
    fails: Flags
    held: Flags
    parts: Flags
    excess: Floats
    way: Slots
    unpushed: FloatRows
    pushed: FloatRows
    given: FloatRows
    delta_v: FloatRows
    label: Slots
    marked: Flags


class IslandWorkspace(NamedTuple):
    """Islands of bodies with what solves their contacts, as kernels take them; ways: counts, see energy_bank.py."""

    ways: Slots
    islands: BodyIslands
    delassus: Delassus
    terms: ContactConstraints


@inner_kernel
def lay_out_islands(system: System, particles: int, arena: Arena, out: IslandWorkspace) -> None:
    """Lay out islands and blocks for a system, in a world of so many particles; the room of blocks is made apart."""
    bodies, free_rows = system.bodies.lowest.shape[0], system.matrix.diagonal.shape[0]
    members = bodies + particles
    islands = BodyIslands(
        new_slots(arena, COUNTED), new_slots(arena, bodies), new_slots(arena, particles), new_slots(arena, members),
        new_slots(arena, particles), new_slots(arena, particles), new_floats(arena, members),
        new_floats(arena, members), new_floats(arena, members), new_floats(arena, members), new_floats(arena, members),
        new_flags(arena, members), new_floats(arena, bodies), new_flags(arena, bodies), new_flags(arena, bodies),
        new_flags(arena, bodies), new_slots(arena, bodies), new_floats(arena, members), new_floats(arena, members),
        new_flags(arena, members), new_flags(arena, members), new_flags(arena, members), new_floats(arena, members),
        new_slots(arena, members), new_float_rows(arena, free_rows, 2), new_float_rows(arena, free_rows, 2),
        new_float_rows(arena, particles, 2), new_float_rows(arena, particles, 2), new_slots(arena, members),
        new_flags(arena, particles),
    )  # fmt: skip
    put(out, "islands", islands)
    place, point, block = new_slots(arena, particles), new_slots(arena, free_rows), new_slots(arena, particles)
    delassus = out.delassus
    put(delassus, "block", block)
    put(delassus, "place", place)
    put(delassus, "point", point)
    put(delassus, "start", new_slots(arena, bodies + 1))
    put(delassus, "base", new_slots(arena, bodies + 1))
    if is_full(arena):
        return
    for p in range(particles):
        islands.row[p] = islands.member[p] = block[p] = place[p] = -1
    for row in range(free_rows):
        islands.row[system.rows.particle[row]] = row


@inner_kernel
def lay_out_no_blocks(particles: int, arena: Arena, out: Delassus) -> None:
    """Lay out that all particles answer by their own mass."""
    block = new_slots(arena, particles)
    put(out, "block", block)
    put(out, "start", new_slots(arena, 1))
    if not is_full(arena):
        for p in range(particles):
            block[p] = -1


@inner_kernel
def _join_nodes(contacts: Contacts, block: Slots, inverse_mass: Floats, label: Slots, nodes: int) -> None:
    # Label the nodes that touch each other alike: particles (n,), then blocks; what cannot move joins nothing.
    count = block.shape[0]
    for c in range(contacts.particle.shape[0]):
        first = -1
        for end in range(3):
            p, _ = weight_of(contacts, c, end)
            if p < 0 or inverse_mass[p] == 0.0:
                continue
            node = root_of(label, p if block[p] < 0 else count + block[p])
            first = united(label, first, node)
    for node in range(nodes):
        label[node] = root_of(label, node)


@inner_kernel
def _mark_driven(joints: Joints, islands: BodyIslands, touched: Flags) -> None:
    # The bodies, and the particles of none, that joints act on.
    for k in range(joints.rows.limit.shape[0]):
        if not joints.rows.limit[k] > 0.0:
            continue
        for b in range(joints.body_first[k], joints.body_first[k + 1]):
            touched[joints.body[b]] = True
        for e in range(joints.rows.first[k], joints.rows.first[k + 1]):
            p = joints.rows.particle[e]
            if islands.row[p] < 0:
                islands.marked[p] = True


@inner_kernel
def _take_in(body: int, count: int, points: int, islands: BodyIslands, delassus: Delassus) -> int:
    # Number a body among the touched, whose points begin here; how many there are then.
    islands.body[count] = body
    islands.number[body] = count
    delassus.start[count] = points
    return count + 1


@inner_kernel
def _join_driven(joints: Joints, islands: BodyIslands, label: Slots) -> None:
    # Label the nodes alike that one joint acts on.
    particles = islands.member.shape[0]
    rows = joints.rows
    for k in range(rows.limit.shape[0]):
        if not rows.limit[k] > 0.0:
            continue
        first = -1
        for b in range(joints.body_first[k], joints.body_first[k + 1]):
            first = united(label, first, root_of(label, particles + islands.number[joints.body[b]]))
        for e in range(rows.first[k], rows.first[k + 1]):
            if islands.row[rows.particle[e]] < 0:
                first = united(label, first, root_of(label, rows.particle[e]))


@inner_kernel
def _find_members(contacts: Contacts, system: System, inverse_mass: Floats, workspace: IslandWorkspace) -> None:
    # The bodies that contacts touch, with their points by row, and the free particles by slot.
    islands, delassus, bodies, rows = workspace.islands, workspace.delassus, system.bodies, system.rows
    for p in range(islands.member.shape[0]):
        islands.marked[p] = False
        islands.member[p] = -1
        delassus.block[p] = -1
        delassus.place[p] = -1
    for body in range(bodies.touched.shape[0]):
        bodies.touched[body] = False
    _mark_driven(delassus.joints, islands, bodies.touched)
    for c in range(contacts.particle.shape[0]):
        for end in range(3):
            p, _ = weight_of(contacts, c, end)
            if p >= 0 and inverse_mass[p] > 0.0:
                islands.marked[p] = True
    count = 0
    points = 0
    for body in range(bodies.touched.shape[0]):
        driven = bodies.touched[body]
        if driven:
            count = _take_in(body, count, points, islands, delassus)
        for r in range(bodies.row_start[body], bodies.row_start[body + 1]):
            p = rows.particle[r]
            if not islands.marked[p]:
                continue
            if not bodies.touched[body]:
                bodies.touched[body] = True
                count = _take_in(body, count, points, islands, delassus)
            delassus.block[p] = count - 1
            delassus.place[p] = points - delassus.start[count - 1]
            delassus.point[points] = p
            islands.member[p] = count - 1
            points += 1
        if bodies.touched[body]:
            islands.driven[count - 1] = driven
    delassus.start[count] = points
    islands.counts[BODIES] = count
    members = count
    for p in range(islands.member.shape[0]):
        if islands.marked[p] and islands.row[p] < 0:
            islands.free[members - count] = p
            islands.member[p] = members
            members += 1
    islands.counts[MEMBERS] = members


@inner_kernel
def _number_islands(contacts: Contacts, inverse_mass: Floats, workspace: IslandWorkspace) -> None:
    # The island of each member, in the order of their first ones.
    islands, delassus = workspace.islands, workspace.delassus
    particles = islands.member.shape[0]
    bodies = islands.counts[BODIES]
    for node in range(particles + bodies):
        islands.label[node] = node
    _join_driven(delassus.joints, islands, islands.label)
    _join_nodes(contacts, delassus.block, inverse_mass, islands.label, particles + bodies)
    count = 0
    for k in range(islands.counts[MEMBERS]):
        islands.island[k] = islands.label[particles + k if k < bodies else islands.free[k - bodies]]
    for node in range(particles + bodies):
        islands.label[node] = 0
    for k in range(islands.counts[MEMBERS]):
        label = islands.island[k]
        if islands.label[label] == 0:
            islands.label[label] = count + 1
            count += 1
        islands.island[k] = islands.label[label] - 1
        islands.way[islands.island[k]] = PASSED
    islands.counts[ISLANDS] = count


@inner_kernel
def _find_room(system: System, workspace: IslandWorkspace) -> None:
    # Where the Delassus blocks of the bodies begin, and what room they want.
    islands, delassus, bodies = workspace.islands, workspace.delassus, system.bodies
    base = 0
    columns = 0
    for k in range(islands.counts[BODIES]):
        points = delassus.start[k + 1] - delassus.start[k]
        first_row = bodies.row_start[islands.body[k]]
        delassus.base[k] = base
        base += 4 * points * points
        if system.fronts.of_row[first_row] < 0:
            columns = max(columns, 4 * points * (bodies.row_start[islands.body[k] + 1] - first_row))
    delassus.base[islands.counts[BODIES]] = base
    islands.counts[NUMBERS] = base
    islands.counts[COLUMNS] = columns


@inner_kernel
def find_body_islands(contacts: Contacts, inverse_mass: Floats, system: System, workspace: IslandWorkspace) -> bool:
    """Find the bodies and free particles that contacts touch, and their islands; whether there is room for them."""
    _find_members(contacts, system, inverse_mass, workspace)
    _number_islands(contacts, inverse_mass, workspace)
    _find_room(system, workspace)
    counts, delassus = workspace.islands.counts, workspace.delassus
    return counts[NUMBERS] <= delassus.numbers.shape[0] and counts[COLUMNS] <= delassus.columns.shape[0]
