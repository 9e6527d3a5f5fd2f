"""Layout of the direct solver's system: which rows springs and constraints join, and the order of elimination.

Symbolic work alone: made again when topology or pins change, no part of a world's state.
"""

from typing import Annotated, NamedTuple

import numpy as np

from sandbox.physics.arena import (
    Arena,
    give_back,
    is_full,
    mark,
    new_flags,
    new_float_tables,
    new_slot_rows,
    new_slots,
    new_tuple,
)
from sandbox.physics.arrays import Flags, FloatRows, Floats, Slots
from sandbox.physics.constraints import AREA
from sandbox.physics.jit import inner_kernel, set_field
from sandbox.physics.marks import LAW_NISSEN
from sandbox.physics.solvers.direct.system import (
    Bodies,
    Constraints,
    Rows,
    ShapeMatchGroups,
    Springs,
    System,
    worth_of_sharing,
)
from sandbox.physics.solvers.linear import elimination
from sandbox.physics.solvers.linear import fronts as multifrontal
from sandbox.physics.solvers.linear.elimination import (
    BODIES,
    BORDERS,
    DIVIDED,
    FRONTS,
    SMALL,
    WIDEST_NARROW,
    Dissection,
    Elimination,
    Links,
    Tuning,
    order_for_elimination,
)
from sandbox.physics.solvers.linear.elimination import COUNTS as FOUND_COUNTS
from sandbox.physics.solvers.linear.fronts import Fronts, block_in_front, new_fronts
from sandbox.physics.solvers.linear.sparse_ldl import Matrix, block_below, new_matrix
from sandbox.physics.state import State
from sandbox.physics.topology.sorting import list_by_key, place_among, sort_by_key
from sandbox.physics.untangling.jellies import Triangles, group_triangles
from sandbox.physics.untangling.triangle_clamp import ClampedTriangles, count_with_gaps, fill_triangles

# Corners at most of a constraint that is added to the matrix; one of more is wide.
NARROW = 3
# Places in `counts`: springs, constraints and their corners, free particles, pinned ones, links between free ones; wide
# constraints that a body has at most.
SPRINGS, CONSTRAINTS, CORNERS, NODES, ANCHORS, LINKS, MOST_WIDE, COUNTS = range(8)
# Multiplications of a step: for each row what springs and tests take, and for each pair of blocks of a column.
ROW_WORK, PAIR_WORK = 400, 16
# In place of the row of a body's one pinned particle.
NO_PIVOT, SEVERAL_PIVOTS = -1, -2


class MatrixContents(NamedTuple):
    """What is in the matrix, slots ascending, in arrays with room for all there is."""

    spring: Annotated[Slots, "springs"]
    constraint: Annotated[Slots, "constraints"]  # (k,): those with a free corner
    start: Annotated[Slots, "constraints + 1"]
    corner: Annotated[Slots, "corners"]  # corners of constraint i: corner[start[i]:start[i + 1]]
    particle: Annotated[Slots, "particles"]  # free ones, which are the nodes, then pinned ones
    number: Annotated[Slots, "particles"]  # (n,): place of a particle in that, -1: none
    link_a: Annotated[Slots, "springs + corners"]  # nodes that are joined: of a narrow constraint all,
    link_b: Annotated[Slots, "springs + corners"]  # of a wide one each free corner and the next free one
    x: Annotated[Floats, "particles"]  # [m]: where nodes were created
    y: Annotated[Floats, "particles"]


class Lying(NamedTuple):
    """What is known of the matrix: its order of elimination, its sparse columns, its fronts."""

    order: Elimination
    matrix: Matrix
    fronts: Fronts


class PlaceScratch(NamedTuple):
    """Scratch for springs or constraints (k,), and for lists by row or body: start."""

    key: Annotated[Slots, "longest"]
    low: Annotated[Slots, "longest"]
    order: Annotated[Slots, "longest"]
    items: Annotated[Slots, "longest"]
    start: Annotated[Slots, "rows + 1"]


def tuning() -> Tuning:
    """The numbers of the modules that kernels are given them from."""
    whole = elimination.SMALLEST_BODY, elimination.LEAF_SIZE, multifrontal.WORTH_DIVIDING, NARROW
    return Tuning(np.array(whole, np.int64), np.array([elimination.NARROWEST_BORDER]))


@inner_kernel
def lay_out_system(state: State, unlimited: Flags, tuned: Tuning, arena: Arena, out: System) -> None:
    """Order a world's free particles for elimination and lay out the matrix of its springs and constraints.

    unlimited (m,): active springs of no limited force.
    """
    counts, found = new_slots(arena, COUNTS), new_slots(arena, FOUND_COUNTS)
    chosen = chosen_for_matrix(state, unlimited, tuned.whole[WIDEST_NARROW], counts, arena)
    if is_full(arena):
        return
    nodes, links = counts[NODES], counts[LINKS]
    joined = Links(chosen.link_a[:links], chosen.link_b[:links], chosen.x[:nodes], chosen.y[:nodes])
    ordered = order_for_elimination(joined, tuned, found, arena)
    if is_full(arena):
        return
    made, small, bodies = ordered.elimination, ordered.small, found[BODIES]
    dissected = cut_to(ordered.fronts, found[FRONTS], found[BORDERS])
    fronts = new_fronts(nodes, made.first_front, bodies, dissected, tuned.whole[DIVIDED], arena)
    matrix = new_matrix(nodes, small.order[: found[SMALL]], small.columns, made.row_of, arena)
    if is_full(arena):
        return
    set_field(out, "fronts", fronts)
    set_field(out, "matrix", matrix)
    work = work_of_bodies(bodies, made.first_row, fronts, matrix, arena)
    set_field(out, "bodies", new_tuple(Bodies, arena, work=work, bodies=bodies))
    set_field(out, "rows", new_tuple(Rows, arena, rows=nodes + counts[ANCHORS]))
    set_field(out, "springs", new_tuple(Springs, arena, springs=counts[SPRINGS]))
    constraints = new_tuple(
        Constraints, arena, constraints=counts[CONSTRAINTS], corners=counts[CORNERS], most_wide=0, answered=0
    )  # fmt: skip
    set_field(out, "constraints", constraints)
    _place(state, counts, tuned.whole[WIDEST_NARROW], chosen, Lying(made, matrix, fronts), arena, out)
    # All that follows is ready for a step; of wide constraints a body has most_wide at most.
    most_wide = counts[MOST_WIDE]
    response = new_float_tables(arena, most_wide, nodes if most_wide > 0 else 0, 2)
    set_field(out.constraints, "response", response)
    if not is_full(arena):
        lay_out_groups(state, arena, out)


@inner_kernel
def work_of_bodies(bodies: int, first_row: Slots, fronts: Fronts, matrix: Matrix, arena: Arena) -> Slots:
    """About how many multiplications a step of each body takes, and last what a loop over all saves (b + 1,)."""
    work = new_slots(arena, bodies + 1)
    if not is_full(arena):
        for b in range(bodies):
            first, last = first_row[b], first_row[b + 1]
            work[b] = ROW_WORK * (last - first) + PAIR_WORK * (matrix.target_start[last] - matrix.target_start[first])
            front = fronts.of_row[last - 1]
            if front >= 0:
                for stage in range(fronts.stages[front, 0], fronts.stages[front, 1]):
                    work[b] += fronts.stage_work[stage, 0]
        work[bodies] = worth_of_sharing(bodies, work[:0], work)
    return work


@inner_kernel
def chosen_for_matrix(state: State, unlimited: Flags, narrow: int, counts: Slots, arena: Arena) -> MatrixContents:
    """What is in the matrix of a world, and in counts (COUNTS,) how much it is; narrow: see NARROW."""
    particles, springs, constraints = state.owner.shape[0], state.law.shape[0], state.constraint_kind.shape[0]
    corners = state.corner_particle.shape[0]
    # Of c corners a narrow constraint has c links, and a wide one fewer.
    chosen = new_tuple(
        MatrixContents, arena, particles=particles, springs=springs, constraints=constraints, corners=corners
    )  # fmt: skip
    if not is_full(arena):
        for p in range(chosen.number.shape[0]):
            chosen.number[p] = -1
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
        _choose_constraints(state, chosen, counts)
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
        _find_links(state, chosen, narrow, counts)
    return chosen


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
def cut_to(dissected: Dissection, fronts: int, borders: int) -> Dissection:
    """The dissection that so much of it was filled in of."""
    return Dissection(
        dissected.first[:fronts], dissected.last[:fronts], dissected.child[:fronts], dissected.place[:fronts],
        dissected.border_start[: fronts + 1], dissected.border[:borders], dissected.to_parent[:borders],
    )  # fmt: skip


@inner_kernel
def _place(
    state: State, counts: Slots, narrow: int, chosen: MatrixContents, lying: Lying, arena: Arena, out: System
) -> None:
    # Where all lies in the system, and in counts[MOST_WIDE] how many wide constraints a body has at most.
    nodes, count, bodies = counts[NODES], counts[CONSTRAINTS], out.bodies.lowest.shape[0]
    start, longest = mark(arena), max(counts[SPRINGS], count)
    work = new_tuple(PlaceScratch, arena, longest=longest, rows=nodes)
    if is_full(arena):
        return
    for row in range(nodes):
        out.rows.particle[row] = chosen.particle[lying.order.order[row]]
    for k in range(nodes, nodes + counts[ANCHORS]):
        out.rows.particle[k] = chosen.particle[k]
    for b in range(bodies):
        out.bodies.row_start[b + 1] = lying.order.first_row[b + 1]
        out.bodies.lowest[b] = chosen.particle[lying.order.lowest[b]]
        out.bodies.pivot[b] = NO_PIVOT
    _place_springs(counts[SPRINGS], bodies, state, chosen, lying, out, work)
    for k in range(count):
        low = nodes
        for at in range(chosen.start[k], chosen.start[k + 1]):
            low = min(low, _row_of(state.corner_particle[chosen.corner[at]], chosen, lying))
        work.key[k] = lying.order.body[low]
    list_by_key(work.key, count, bodies, out.bodies.constraint_start, work.order)
    counts[MOST_WIDE] = _place_constraints(count, narrow, state, chosen, lying, out, work)
    give_back(arena, start)


@inner_kernel
def _place_springs(
    count: int, bodies: int, state: State, chosen: MatrixContents, lying: Lying, out: System, work: PlaceScratch
) -> None:
    # Body by body; those of a large one in the order of its rows: what a step reads together then lies together.
    nodes, springs = lying.order.rank.shape[0], out.springs
    for k in range(count):
        s = chosen.spring[k]
        row_a = _row_of(state.particle_a[s], chosen, lying)
        row_b = _row_of(state.particle_b[s], chosen, lying)
        low = min(row_a, row_b)
        work.key[k] = lying.order.body[low]
        work.low[k] = low if lying.fronts.of_row[low] >= 0 else 0
        _anchor(work.key[k], max(row_a, row_b), nodes, out.bodies)
    list_by_key(work.low, count, nodes, work.start, work.items)
    sort_by_key(work.key, work.items, count, bodies, out.bodies.spring_start, work.order)
    for at in range(count):
        s = chosen.spring[work.order[at]]
        row_a = _row_of(state.particle_a[s], chosen, lying)
        row_b = _row_of(state.particle_b[s], chosen, lying)
        springs.slot[at] = s
        springs.row_a[at] = row_a
        springs.row_b[at] = row_b
        springs.block[at] = _block_of(row_a, row_b, lying)


@inner_kernel
def _row_of(p: int, chosen: MatrixContents, lying: Lying) -> int:
    k = chosen.number[p]
    nodes = lying.order.rank.shape[0]
    return lying.order.rank[k] if k < nodes else k


@inner_kernel
def _anchor(b: int, row: int, nodes: int, bodies: Bodies) -> None:
    # Note a row of something that a body has, which may be pinned.
    if row >= nodes:
        bodies.anchored[b] = True
        if bodies.pivot[b] == NO_PIVOT:
            bodies.pivot[b] = row
        elif bodies.pivot[b] != row:
            bodies.pivot[b] = SEVERAL_PIVOTS


@inner_kernel
def _block_of(row_a: int, row_b: int, lying: Lying) -> int:
    # The block that two rows share; -1: one is pinned.
    low = min(row_a, row_b)
    high = max(row_a, row_b)
    if high >= lying.order.rank.shape[0]:
        return -1
    if lying.fronts.of_row[low] >= 0:
        return block_in_front(low, high, lying.fronts)
    return block_below(low, high, lying.matrix.column_start, lying.matrix.row)


@inner_kernel
def _place_constraints(
    count: int, narrow: int, state: State, chosen: MatrixContents, lying: Lying, out: System, work: PlaceScratch
) -> int:
    # Body by body; how many wide ones a body has at most.
    nodes, constraints = lying.order.rank.shape[0], out.constraints
    top = 0
    most = 0
    number = 0
    constraints.first[0] = 0
    for at in range(count):
        k = work.order[at]
        b = work.key[k]
        if at == out.bodies.constraint_start[b]:
            number = 0
        first, last = chosen.start[k], chosen.start[k + 1]
        constraints.slot[at] = chosen.constraint[k]
        constraints.kind[at] = state.constraint_kind[chosen.constraint[k]]
        for corner in range(first, last):
            row = _row_of(state.corner_particle[chosen.corner[corner]], chosen, lying)
            constraints.corner[top + corner - first] = chosen.corner[corner]
            constraints.row[top + corner - first] = row
            _anchor(b, row, nodes, out.bodies)
        is_narrow = last - first <= narrow
        for side in range(3):
            row = constraints.row[top + side]
            following = constraints.row[top + (side + 1) % 3]
            constraints.block[at, side] = _block_of(row, following, lying) if is_narrow else -1
        constraints.wide[at] = -1 if is_narrow else number
        if not is_narrow:
            number += 1
            most = max(most, number)
        top += last - first
        constraints.first[at + 1] = top
    return most


@inner_kernel
def lay_out_groups(state: State, arena: Arena, out: System) -> None:
    """Lay out the groups of a system's constraints, and its triangles."""
    placed, rows, count = out.constraints, out.rows, out.constraints.slot.shape[0]
    constraint, corners, is_left = new_slots(arena, count), new_slot_rows(arena, count, 3), new_flags(arena, count)
    if is_full(arena):
        return
    areas = 0
    for k in range(count):
        if placed.kind[k] == AREA and placed.wide[k] < 0:
            constraint[areas] = k
            is_left[areas] = state.constraint_rest[placed.slot[k], 1] > 0.0
            for c in range(3):
                corners[areas, c] = placed.row[placed.first[k] + c]
            areas += 1
    jellies = group_triangles(corners[:areas], is_left[:areas], state.owner.shape[0], arena)
    found = Triangles(constraint[:areas], corners[:areas], jellies)
    groups = new_tuple(
        ShapeMatchGroups, arena, start=jellies.start, row=jellies.particle, inner=jellies.inner, fan=jellies.fan,
        fan_start=jellies.fan_start, bodies=out.bodies.lowest.shape[0], members=jellies.particle.shape[0],
        groups=jellies.first.shape[0], constraints=count,
    )  # fmt: skip
    triangles = new_tuple(
        ClampedTriangles, arena, rest=placed.rest, position=rows.position, velocity=rows.v, mass=rows.mass,
        inverse_mass=rows.inverse_mass, inverted=groups.inverted, terrain=state.terrain,
        triangles=count_with_gaps(found), rests=count, rows=rows.particle.shape[0],
    )  # fmt: skip
    set_field(out, "shape_match_groups", groups)
    set_field(out, "triangles", triangles)
    if not is_full(arena):
        fill_triangles(found, state, rows.particle, arena, triangles)
        fill_groups(placed, out.bodies.constraint_start, found, state.corner_form, groups)


@inner_kernel
def fill_groups(
    placed: Constraints, constraint_start: Slots, found: Triangles, corner_form: FloatRows, groups: ShapeMatchGroups
) -> None:
    """Fill in where the groups lie and what their forms are; corner_form [m] (q, 2): of a world's corners."""
    jellies = found.jellies
    for k in range(groups.group.shape[0]):
        groups.group[k] = -1
        for c in range(3):
            groups.member[k, c] = -1
    for t in range(found.constraint.shape[0]):
        k = found.constraint[t]
        groups.group[k] = jellies.group[t]
        for c in range(3):
            groups.member[k, c] = jellies.member[t, c]
    # Constraints lie by body, and so do their groups, in the order of the first of each.
    for g in range(groups.sample.shape[0]):
        groups.sample[g] = found.constraint[jellies.first[g]]
    for b in range(groups.of_body.shape[0]):
        groups.of_body[b] = place_among(constraint_start[b], groups.sample, 0, groups.sample.shape[0])
    for i in range(groups.row.shape[0]):
        t = jellies.corner[i] // 3
        corner = placed.corner[placed.first[found.constraint[t]] + jellies.corner[i] % 3]
        for axis in range(2):
            groups.form[i, axis] = corner_form[corner, axis]
