"""Where rows, springs, constraints and bodies lie in the system of the direct solver."""

from typing import NamedTuple

from sandbox.physics.arena import Arena, give_back, is_full, mark, new_flags, new_slot_rows, new_slots
from sandbox.physics.arrays import Flags, SlotRows, Slots
from sandbox.physics.jit import inner_kernel
from sandbox.physics.solvers.direct.choosing import (
    ANCHORS,
    CONSTRAINTS,
    CORNERS,
    MOST_WIDE,
    NODES,
    SPRINGS,
    MatrixContents,
)
from sandbox.physics.solvers.linear.front_layout import FrontBlocks, block_in_front
from sandbox.physics.solvers.linear.matrix_layout import block_below
from sandbox.physics.state import State
from sandbox.physics.topology.sorting import list_by_key, sort_by_key

# In place of the row of a body's one pinned particle.
NO_PIVOT, SEVERAL_PIVOTS = -1, -2


class Lying(NamedTuple):
    """What is known of the matrix: its order of elimination, see Elimination, its sparse columns, its fronts."""

    order: Slots
    rank: Slots
    body: Slots
    first_row: Slots
    lowest: Slots
    column_start: Slots
    row: Slots
    fronts: FrontBlocks


class Places(NamedTuple):
    """What is to be found: see Rows, Bodies, Springs and Constraints."""

    particle: Slots
    row_start: Slots
    spring_start: Slots
    constraint_start: Slots
    lowest: Slots
    pivot: Slots
    anchored: Flags
    spring: Slots
    row_a: Slots
    row_b: Slots
    spring_block: Slots
    constraint: Slots
    kind: Slots
    first: Slots
    row: Slots
    corner: Slots
    block: SlotRows
    wide: Slots


class PlaceScratch(NamedTuple):
    """Scratch for springs or constraints (k,), and for lists by row or body: start."""

    key: Slots
    low: Slots
    order: Slots
    items: Slots
    start: Slots


@inner_kernel
def _row_of(p: int, chosen: MatrixContents, lying: Lying) -> int:
    k = chosen.number[p]
    nodes = lying.rank.shape[0]
    return lying.rank[k] if k < nodes else k


@inner_kernel
def _block_of(row_a: int, row_b: int, lying: Lying) -> int:
    # The block that two rows share; -1: one is pinned.
    low = min(row_a, row_b)
    high = max(row_a, row_b)
    if high >= lying.rank.shape[0]:
        return -1
    if lying.fronts.of_row[low] >= 0:
        return block_in_front(low, high, lying.fronts)
    return block_below(low, high, lying.column_start, lying.row)


@inner_kernel
def _place_bodies(bodies: int, chosen: MatrixContents, lying: Lying, places: Places) -> None:
    places.row_start[0] = 0
    for b in range(bodies):
        places.row_start[b + 1] = lying.first_row[b + 1]
        places.lowest[b] = chosen.particle[lying.lowest[b]]
        places.pivot[b] = NO_PIVOT
        places.anchored[b] = False


@inner_kernel
def _anchor(b: int, row: int, nodes: int, places: Places) -> None:
    # Note a row of something that a body has, which may be pinned.
    if row >= nodes:
        places.anchored[b] = True
        if places.pivot[b] == NO_PIVOT:
            places.pivot[b] = row
        elif places.pivot[b] != row:
            places.pivot[b] = SEVERAL_PIVOTS


@inner_kernel
def _place_springs(
    count: int,
    bodies: int,
    state: State,
    chosen: MatrixContents,
    lying: Lying,
    places: Places,
    work: PlaceScratch,
) -> None:
    # Body by body; those of a large one in the order of its rows: what a step reads together then lies together.
    nodes = lying.rank.shape[0]
    for k in range(count):
        s = chosen.spring[k]
        row_a = _row_of(state.particle_a[s], chosen, lying)
        row_b = _row_of(state.particle_b[s], chosen, lying)
        low = min(row_a, row_b)
        work.key[k] = lying.body[low]
        work.low[k] = low if lying.fronts.of_row[low] >= 0 else 0
        _anchor(work.key[k], max(row_a, row_b), nodes, places)
    list_by_key(work.low, count, nodes, work.start, work.items)
    sort_by_key(work.key, work.items, count, bodies, places.spring_start, work.order)
    for at in range(count):
        s = chosen.spring[work.order[at]]
        row_a = _row_of(state.particle_a[s], chosen, lying)
        row_b = _row_of(state.particle_b[s], chosen, lying)
        places.spring[at] = s
        places.row_a[at] = row_a
        places.row_b[at] = row_b
        places.spring_block[at] = _block_of(row_a, row_b, lying)


@inner_kernel
def _sort_constraints(
    count: int,
    bodies: int,
    state: State,
    chosen: MatrixContents,
    lying: Lying,
    places: Places,
    work: PlaceScratch,
) -> None:
    nodes = lying.rank.shape[0]
    for k in range(count):
        low = nodes
        for at in range(chosen.start[k], chosen.start[k + 1]):
            low = min(low, _row_of(state.corner_particle[chosen.corner[at]], chosen, lying))
        work.key[k] = lying.body[low]
    list_by_key(work.key, count, bodies, places.constraint_start, work.order)


@inner_kernel
def _place_constraints(
    count: int,
    narrow: int,
    state: State,
    chosen: MatrixContents,
    lying: Lying,
    places: Places,
    work: PlaceScratch,
) -> int:
    # Body by body; how many wide ones a body has at most.
    nodes = lying.rank.shape[0]
    top = 0
    most = 0
    number = 0
    places.first[0] = 0
    for at in range(count):
        k = work.order[at]
        b = work.key[k]
        if at == places.constraint_start[b]:
            number = 0
        first, last = chosen.start[k], chosen.start[k + 1]
        places.constraint[at] = chosen.constraint[k]
        places.kind[at] = state.constraint_kind[chosen.constraint[k]]
        for corner in range(first, last):
            row = _row_of(state.corner_particle[chosen.corner[corner]], chosen, lying)
            places.corner[top + corner - first] = chosen.corner[corner]
            places.row[top + corner - first] = row
            _anchor(b, row, nodes, places)
        is_narrow = last - first <= narrow
        for side in range(3):
            row = places.row[top + side]
            following = places.row[top + (side + 1) % 3]
            places.block[at, side] = _block_of(row, following, lying) if is_narrow else -1
        places.wide[at] = -1 if is_narrow else number
        if not is_narrow:
            number += 1
            most = max(most, number)
        top += last - first
        places.first[at + 1] = top
    return most


@inner_kernel
def place_all(
    counts: Slots, bodies: int, narrow: int, state: State, chosen: MatrixContents, lying: Lying, places: Places,
    work: PlaceScratch,
) -> int:  # fmt: skip
    """Find where all lies; how many wide constraints a body has at most.

    counts: of what was chosen; narrow: see NARROW.
    """
    nodes = lying.rank.shape[0]
    for row in range(nodes):
        places.particle[row] = chosen.particle[lying.order[row]]
    for k in range(nodes, nodes + counts[ANCHORS]):
        places.particle[k] = chosen.particle[k]
    _place_bodies(bodies, chosen, lying, places)
    _place_springs(counts[SPRINGS], bodies, state, chosen, lying, places, work)
    _sort_constraints(counts[CONSTRAINTS], bodies, state, chosen, lying, places, work)
    return _place_constraints(counts[CONSTRAINTS], narrow, state, chosen, lying, places, work)


@inner_kernel
def places_of(
    state: State, counts: Slots, bodies: int, narrow: int, chosen: MatrixContents, lying: Lying, arena: Arena
) -> Places:
    """Where all lies in the system of so many bodies, and in counts[MOST_WIDE] how many wide ones a body has at most.

    counts, narrow: see chosen_for_matrix.
    """
    springs, constraints, corners, rows = counts[SPRINGS], counts[CONSTRAINTS], counts[CORNERS], counts[NODES]
    places = Places(
        new_slots(arena, rows + counts[ANCHORS]), new_slots(arena, bodies + 1), new_slots(arena, bodies + 1),
        new_slots(arena, bodies + 1), new_slots(arena, bodies), new_slots(arena, bodies), new_flags(arena, bodies),
        new_slots(arena, springs), new_slots(arena, springs), new_slots(arena, springs), new_slots(arena, springs),
        new_slots(arena, constraints), new_slots(arena, constraints), new_slots(arena, constraints + 1),
        new_slots(arena, corners), new_slots(arena, corners), new_slot_rows(arena, constraints, 3),
        new_slots(arena, constraints),
    )  # fmt: skip
    start, longest = mark(arena), max(springs, constraints)
    work = PlaceScratch(
        new_slots(arena, longest), new_slots(arena, longest), new_slots(arena, longest), new_slots(arena, longest),
        new_slots(arena, rows + 1),
    )  # fmt: skip
    if not is_full(arena):
        counts[MOST_WIDE] = place_all(counts, bodies, narrow, state, chosen, lying, places, work)
        give_back(arena, start)
    return places
