"""What the matrix of the direct solver is made of: which springs, constraints and particles, and what those join."""

from typing import NamedTuple

from sandbox.physics.arena import Arena, is_full, new_floats, new_slots
from sandbox.physics.arrays import Flags, Floats, Slots
from sandbox.physics.jit import inner_kernel
from sandbox.physics.marks import LAW_NISSEN
from sandbox.physics.state import State

# Corners at most of a constraint that is added to the matrix; one of more is wide.
NARROW = 3
# Places in `counts`: springs, constraints and their corners, free particles, pinned ones, links between free ones; wide
# constraints that a body has at most.
SPRINGS, CONSTRAINTS, CORNERS, NODES, ANCHORS, LINKS, MOST_WIDE, COUNTS = range(8)


class MatrixContents(NamedTuple):
    """What is in the matrix, slots ascending, in arrays with room for all there is."""

    spring: Slots
    constraint: Slots  # (k,): those with a free corner
    start: Slots
    corner: Slots  # corners of constraint i: corner[start[i]:start[i + 1]]
    particle: Slots  # free ones, which are the nodes, then pinned ones
    number: Slots  # (n,): place of a particle in that, -1: none
    link_a: Slots  # nodes that are joined: of a narrow constraint all,
    link_b: Slots  # of a wide one each free corner and the next free one, past the pinned
    x: Floats  # [m]: where nodes were created
    y: Floats


@inner_kernel
def _choose_springs(state: State, unlimited: Flags, chosen: MatrixContents, counts: Slots) -> None:
    springs = 0
    for s in range(state.law.shape[0]):
        a = state.particle_a[s]
        b = state.particle_b[s]
        moves = state.inverse_mass[a] > 0.0 or state.inverse_mass[b] > 0.0
        if moves and unlimited[s] and state.law[s] == LAW_NISSEN:
            chosen.spring[springs] = s
            chosen.number[a] = chosen.number[b] = 0
            springs += 1
    counts[SPRINGS] = springs


@inner_kernel
def _choose_constraints(state: State, chosen: MatrixContents, counts: Slots) -> None:
    constraints = 0
    corners = 0
    last = 0
    chosen.start[0] = 0
    for k in range(state.constraint_kind.shape[0]):
        first = last
        last = first + state.constraint_corners[k]
        moves = False
        for corner in range(first, last):
            moves = moves or state.inverse_mass[state.corner_particle[corner]] > 0.0
        if not (moves and state.constraint_active[k]):
            continue
        for corner in range(first, last):
            chosen.corner[corners] = corner
            chosen.number[state.corner_particle[corner]] = 0
            corners += 1
        chosen.constraint[constraints] = k
        constraints += 1
        chosen.start[constraints] = corners
    counts[CONSTRAINTS] = constraints
    counts[CORNERS] = corners


@inner_kernel
def _number_particles(state: State, chosen: MatrixContents, counts: Slots) -> None:
    # The free ones that something holds, then the pinned ones.
    count = 0
    for p in range(chosen.number.shape[0]):
        if chosen.number[p] == 0 and state.inverse_mass[p] > 0.0:
            chosen.particle[count] = p
            chosen.x[count] = state.origin[p, 0]
            chosen.y[count] = state.origin[p, 1]
            count += 1
    counts[NODES] = count
    for p in range(chosen.number.shape[0]):
        if chosen.number[p] == 0 and not state.inverse_mass[p] > 0.0:
            chosen.particle[count] = p
            count += 1
    counts[ANCHORS] = count - counts[NODES]
    for k in range(count):
        chosen.number[chosen.particle[k]] = k


@inner_kernel
def _link(p: int, q: int, count: int, nodes: int, chosen: MatrixContents) -> int:
    # Join two particles, where both are free; how many links there are then.
    a = chosen.number[p]
    b = chosen.number[q]
    if a >= nodes or b >= nodes:
        return count
    chosen.link_a[count] = a
    chosen.link_b[count] = b
    return count + 1


@inner_kernel
def _find_links(state: State, chosen: MatrixContents, narrow: int, counts: Slots) -> None:
    nodes = counts[NODES]
    count = 0
    for k in range(counts[SPRINGS]):
        s = chosen.spring[k]
        count = _link(state.particle_a[s], state.particle_b[s], count, nodes, chosen)
    for k in range(counts[CONSTRAINTS]):
        first, last = chosen.start[k], chosen.start[k + 1]
        if last - first <= narrow:
            for c in range(3):
                p = state.corner_particle[chosen.corner[first + c]]
                q = state.corner_particle[chosen.corner[first + (c + 1) % 3]]
                count = _link(p, q, count, nodes, chosen)
        else:
            before = -1
            for at in range(first, last):
                p = state.corner_particle[chosen.corner[at]]
                if state.inverse_mass[p] > 0.0:
                    if before >= 0:
                        count = _link(before, p, count, nodes, chosen)
                    before = p
    counts[LINKS] = count


@inner_kernel
def choose_for_matrix(state: State, unlimited: Flags, chosen: MatrixContents, narrow: int, counts: Slots) -> None:
    """Choose what is in the matrix, and say in counts (COUNTS,) how much it is; narrow: see NARROW."""
    for p in range(chosen.number.shape[0]):
        chosen.number[p] = -1
    _choose_springs(state, unlimited, chosen, counts)
    _choose_constraints(state, chosen, counts)
    _number_particles(state, chosen, counts)
    _find_links(state, chosen, narrow, counts)


@inner_kernel
def chosen_for_matrix(state: State, unlimited: Flags, narrow: int, counts: Slots, arena: Arena) -> MatrixContents:
    """What is in the matrix of a world, and in counts (COUNTS,) how much it is; narrow: see NARROW."""
    particles, springs, constraints = state.owner.shape[0], state.law.shape[0], state.constraint_kind.shape[0]
    corners = state.corner_particle.shape[0]
    # Of c corners a narrow constraint has c links, and a wide one fewer.
    links = springs + corners
    chosen = MatrixContents(
        new_slots(arena, springs), new_slots(arena, constraints), new_slots(arena, constraints + 1),
        new_slots(arena, corners), new_slots(arena, particles), new_slots(arena, particles), new_slots(arena, links),
        new_slots(arena, links), new_floats(arena, particles), new_floats(arena, particles),
    )  # fmt: skip
    if not is_full(arena):
        choose_for_matrix(state, unlimited, chosen, narrow, counts)
    return chosen
