"""Sparse factorisation of the direct solver: L D L^T of a symmetric positive definite matrix of 2x2 blocks.

Rows are eliminated by minimum degree, and where the blocks of the matrix and of its factor lie follows from that order:
integer work, a pure function of which particles the springs join. No state, no history, and no library's choice enters,
because the order decides the last bits of a tick.
"""

from typing import Annotated, NamedTuple

from sandbox.physics.arena import (
    Arena,
    give_back,
    is_full,
    mark,
    new_float_rows,
    new_int32s,
    new_slots,
    new_tuple,
)
from sandbox.physics.arrays import Flags, FloatRows, Int32s, Slots
from sandbox.physics.components import join, root_of
from sandbox.physics.jit import inner_kernel
from sandbox.physics.topology.sorting import list_neighbours, place_among, sort_by_value

# First guess of blocks in the factor per node; too low costs one more pass, too high memory.
FILL_GUESS = 24
# A pivot that is not above this share of the diagonal it came from is left out (its row does not move): only rounding,
# overflow or NaN bring one there.
SMALLEST_PIVOT = 1e-15
# Updates of a factorisation whose places are kept in a table, 4 bytes each; a body of more, some 15,000 particles of a
# lattice, finds them anew in every step: half as fast, without gigabytes.
LARGEST_TABLE = 1 << 25


class QuotientGraph(NamedTuple):
    """The neighbours of nodes (n,): near_count nodes and element_count elements each, in rows that begin at start."""

    start: Annotated[Slots, "nodes + 1"]
    near: Annotated[Slots, "2 * links"]
    near_count: Annotated[Slots, "nodes"]
    element: Annotated[Slots, "2 * links"]
    element_count: Annotated[Slots, "nodes"]


class Columns(NamedTuple):
    """The nodes that eliminating a node joins, its element: node[start[k]:start[k + 1]] for the k-th."""

    start: Annotated[Slots, "nodes + 1"]
    node: Annotated[Slots, "blocks"]


class Marks(NamedTuple):
    """By element: absorbed; outside: members beyond the newest one, counted: for which step. mark: step of a node."""

    absorbed: Annotated[Flags, "nodes"]
    mark: Annotated[Slots, "nodes"]
    outside: Annotated[Slots, "nodes"]
    counted: Annotated[Slots, "nodes"]


class Parts(NamedTuple):
    """Nodes (n,) that hang together: the lowest of them by node, and how many are left by that lowest one."""

    label: Annotated[Slots, "nodes"]
    remaining: Annotated[Slots, "nodes"]


class Heap(NamedTuple):
    """Nodes by degree, least first, ties by lowest index; place: where each node is in it."""

    node: Annotated[Slots, "nodes"]
    place: Annotated[Slots, "nodes"]
    degree: Annotated[Slots, "nodes"]


class Ordering(NamedTuple):
    """Room for ordering a graph of up to n nodes: see what it is made of; order (n,)."""

    graph: QuotientGraph
    order: Annotated[Slots, "nodes"]
    columns: Columns
    marks: Marks
    parts: Parts
    queue: Heap


class Matrix(NamedTuple):
    """A symmetric matrix of n rows of 2x2 blocks by columns, then its factor: b blocks below the diagonal."""

    column_start: Slots  # (n + 1,): where each column begins
    row: Slots  # (b,): rows of its blocks
    target_start: Slots  # (n + 1,): pairs of blocks in all columns before
    target: Int32s  # the block that each pair of blocks of a column updates, or empty: found anew then
    where: Slots  # (n,): scratch of that
    diagonal: FloatRows  # (n, 3): symmetric blocks xx, xy, yy
    lower: FloatRows  # (b, 4): blocks below, xx, xy, yx, yy
    scaled: FloatRows  # (n, 4): scratch, of a body that of its rows


@inner_kernel
def order_by_degree(nodes: int, link_a: Slots, link_b: Slots, arena: Arena) -> Ordering:
    """The order in which a graph of so many nodes is eliminated, and its columns."""
    links = link_a.shape[0]
    start, near, number = new_slots(arena, nodes + 1), new_slots(arena, 2 * links), new_slots(arena, nodes)
    blocks, scratch = FILL_GUESS * nodes + 16, mark(arena)
    made = new_ordering(nodes, links, blocks, arena)
    if is_full(arena):
        return made
    list_neighbours(link_a, link_b, links, nodes, start, near, made.graph.near, number)
    for node in range(nodes):
        number[node] = node
    while not order_graph(start, near, number, made):
        give_back(arena, scratch)
        blocks *= 2
        made = new_ordering(nodes, links, blocks, arena)
        if is_full(arena):
            return made
    return made


@inner_kernel
def new_ordering(nodes: int, links: int, blocks: int, arena: Arena) -> Ordering:
    """Room for ordering a graph; blocks: of the factor, below its diagonal."""
    return new_tuple(Ordering, arena, nodes=nodes, links=links, blocks=blocks)


@inner_kernel
def order_graph(start: Slots, near: Slots, number: Slots, made: Ordering) -> bool:
    """Order those nodes of a graph that have a number, 0, 1, 2 ... in their order; False: columns are too short.

    Their neighbours, near[start[k]:start[k + 1]], ascending, have numbers too, and may be there several times.
    """
    graph = made.graph
    count = 0
    top = 0
    graph.start[0] = 0
    for node in range(number.shape[0]):
        if number[node] < 0:
            continue
        for at in range(start[node], start[node + 1]):
            other = number[near[at]]
            if top == graph.start[count] or graph.near[top - 1] != other:
                graph.near[top] = other
                top += 1
        graph.near_count[count] = top - graph.start[count]
        graph.element_count[count] = 0
        made.marks.absorbed[count] = False
        made.marks.mark[count] = made.marks.counted[count] = -1
        count += 1
        graph.start[count] = top
    made.columns.start[0] = 0
    parts = made.parts
    for node in range(count):
        parts.label[node] = node
        parts.remaining[node] = 0
    for node in range(count):
        for at in range(graph.start[node], graph.start[node + 1]):
            join(parts.label, node, graph.near[at])
    for node in range(count):
        parts.label[node] = root_of(parts.label, node)
        parts.remaining[parts.label[node]] += 1
    return minimum_degree(count, graph, made.order, made.columns, made.marks, made.parts, made.queue)


@inner_kernel
def minimum_degree(
    size: int, graph: QuotientGraph, order: Slots, columns: Columns, marks: Marks, parts: Parts, queue: Heap
) -> bool:  # fmt: skip
    """Order `size` nodes by approximate minimum degree, ties by lowest index; False where columns are too short.

    The order within a part is that in which it would be alone.

    graph: of n nodes, without elements; it is changed on the way. order (n,): nodes as they are eliminated; columns:
    for each of them, the nodes still present that it is joined to by then. mark and counted hold -1.
    Source: Amestoy, Davis, Duff 1996, without their merging of like nodes.
    """
    for node in range(size):
        queue.degree[node] = graph.near_count[node]
        queue.node[node] = node
        _sift_up(queue, node)
    for step in range(size):
        pivot = queue.node[0]
        size -= 1
        queue.node[0] = queue.node[size]
        if size > 0:
            _sift_down(queue, 0, size)
        order[step] = pivot
        top = _gather(step, pivot, graph, columns, marks)
        if top < 0:
            return False
        columns.start[step + 1] = top
        _prune(step, graph, columns, marks)
        lowest = parts.label[pivot]
        parts.remaining[lowest] -= 1
        _bound_degrees(step, size, parts.remaining[lowest], graph, columns, marks, queue)
    return True


@inner_kernel
def _sift_up(queue: Heap, at: int) -> None:
    heap, place, degree = queue.node, queue.place, queue.degree
    node = heap[at]
    while at > 0:
        parent = (at - 1) // 2
        other = heap[parent]
        if degree[other] < degree[node] or (degree[other] == degree[node] and other < node):
            break
        heap[at] = other
        place[other] = at
        at = parent
    heap[at] = node
    place[node] = at


@inner_kernel
def _sift_down(queue: Heap, at: int, size: int) -> None:
    heap, place, degree = queue.node, queue.place, queue.degree
    node = heap[at]
    while 2 * at + 1 < size:
        child = 2 * at + 1
        first = heap[child]
        if child + 1 < size:
            second = heap[child + 1]
            if degree[second] < degree[first] or (degree[second] == degree[first] and second < first):
                child += 1
                first = second
        if degree[node] < degree[first] or (degree[node] == degree[first] and node < first):
            break
        heap[at] = first
        place[first] = at
        at = child
    heap[at] = node
    place[node] = at


@inner_kernel
def _gather(step: int, pivot: int, graph: QuotientGraph, columns: Columns, marks: Marks) -> int:
    # The nodes that eliminating the pivot joins to one another: its neighbours and those of the elements it takes in.
    # An element whose member is eliminated is taken in by it, so the others hold no eliminated node.
    start, column, mark = graph.start, columns.node, marks.mark
    top = columns.start[step]
    mark[pivot] = step
    for at in range(start[pivot], start[pivot] + graph.near_count[pivot]):
        node = graph.near[at]
        if top == column.shape[0]:
            return -1
        mark[node] = step
        column[top] = node
        top += 1
    for at in range(start[pivot], start[pivot] + graph.element_count[pivot]):
        older = graph.element[at]
        marks.absorbed[older] = True
        for member in range(columns.start[older], columns.start[older + 1]):
            node = column[member]
            if mark[node] != step:
                if top == column.shape[0]:
                    return -1
                mark[node] = step
                column[top] = node
                top += 1
    return top


@inner_kernel
def _prune(step: int, graph: QuotientGraph, columns: Columns, marks: Marks) -> None:
    # What the new element covers leaves its members' lists; how many members each of their older elements has outside.
    start, near, element, column_start = graph.start, graph.near, graph.element, columns.start
    for at in range(column_start[step], column_start[step + 1]):
        node = columns.node[at]
        kept = start[node]
        for place in range(start[node], start[node] + graph.near_count[node]):
            if marks.mark[near[place]] != step:
                near[kept] = near[place]
                kept += 1
        graph.near_count[node] = kept - start[node]
        kept = start[node]
        for place in range(start[node], start[node] + graph.element_count[node]):
            older = element[place]
            if not marks.absorbed[older]:
                element[kept] = older
                kept += 1
                if marks.counted[older] != step:
                    marks.counted[older] = step
                    marks.outside[older] = column_start[older + 1] - column_start[older]
                marks.outside[older] -= 1
        element[kept] = step
        graph.element_count[node] = kept + 1 - start[node]


@inner_kernel
def _bound_degrees(
    step: int, size: int, remaining: int, graph: QuotientGraph, columns: Columns, marks: Marks, queue: Heap
) -> None:
    # Neighbours outside every element, in the new element, and in each older one beyond it: at least the degree, which
    # cannot exceed what was left before nor the nodes left of its part. An older element inside the new one says
    # nothing more.
    start, element, column_start, degree = graph.start, graph.element, columns.start, queue.degree
    members = column_start[step + 1] - column_start[step] - 1
    for at in range(column_start[step], column_start[step + 1]):
        node = columns.node[at]
        bound = graph.near_count[node] + members
        kept = start[node]
        for other in range(start[node], start[node] + graph.element_count[node]):
            older = element[other]
            if older == step or marks.outside[older] > 0:
                element[kept] = older
                kept += 1
                if older != step:
                    bound += marks.outside[older]
        graph.element_count[node] = kept - start[node]
        before = degree[node]
        degree[node] = min(bound, before + members, remaining - 1)
        if degree[node] < before:
            _sift_up(queue, queue.place[node])
        elif degree[node] > before:
            _sift_down(queue, queue.place[node], size)


@inner_kernel
def new_matrix(rows: int, order: Slots, columns: Columns, row_of: Slots, arena: Arena) -> Matrix:
    """A matrix of so many rows, ready for numbers.

    order, columns: of the nodes that were eliminated; row_of: their rows, all others have no blocks.
    """
    blocks = int(columns.start[order.shape[0]])
    column_start, pairs, where = new_slots(arena, rows + 1), new_slots(arena, rows + 1), new_slots(arena, rows)
    row, updates = new_slots(arena, blocks), 0
    scratch = mark(arena)
    same, merge_buffer = new_slots(arena, rows), new_slots(arena, rows)
    if not is_full(arena):
        for j in range(rows):
            same[j] = j
            column_start[j] = 0
        column_start[rows] = 0
        for step in range(order.shape[0]):
            column_start[row_of[order[step]] + 1] = columns.start[step + 1] - columns.start[step]
        pairs[0] = 0
        for j in range(rows):
            length = column_start[j + 1]
            pairs[j + 1] = pairs[j] + length * (length - 1) // 2
            column_start[j + 1] += column_start[j]
        for step in range(order.shape[0]):
            j = row_of[order[step]]
            for k in range(columns.start[step + 1] - columns.start[step]):
                row[column_start[j] + k] = row_of[columns.node[columns.start[step] + k]]
            sort_by_value(same, row, column_start[j], column_start[j + 1], merge_buffer)
        give_back(arena, scratch)
        updates = pairs[rows] if pairs[rows] <= LARGEST_TABLE else 0
    target = new_int32s(arena, updates)
    if updates > 0 and not is_full(arena):
        # For each pair of blocks of a column, upper then lower: the block of the factor that it updates.
        found = 0
        for j in range(column_start.shape[0] - 1):
            for upper in range(column_start[j], column_start[j + 1]):
                owner = row[upper]
                for at in range(column_start[owner], column_start[owner + 1]):
                    where[row[at]] = at
                for lower in range(upper + 1, column_start[j + 1]):
                    target[found] = where[row[lower]]
                    found += 1
    return Matrix(
        column_start, row, pairs, target, where, new_float_rows(arena, rows, 3), new_float_rows(arena, blocks, 4),
        new_float_rows(arena, rows, 4),
    )  # fmt: skip


@inner_kernel
def block_below(low: int, high: int, column_start: Slots, row: Slots) -> int:
    """The block that the rows low < high of a sparse matrix share."""
    return place_among(high, row, column_start[low], column_start[low + 1])


@inner_kernel
def factorise(first: int, last: int, matrix: Matrix) -> None:
    """Factor the rows first..last in place: diagonal = 1 / d_x, l, 1 / d_y of each row's own two scalars, lower = L.

    Scalars are eliminated one by one: with inverted 2x2 blocks the error would grow with the square of stiffness over
    mass.
    """
    column_start, row, target, where = matrix.column_start, matrix.row, matrix.target, matrix.where
    diagonal, lower, scaled = matrix.diagonal, matrix.lower, matrix.scaled
    for j in range(first, last):
        xx = diagonal[j, 0]
        yy = diagonal[j, 2]
        inverse_x = inverse_pivot(xx, xx)
        slant = diagonal[j, 1] * inverse_x
        inverse_y = inverse_pivot(yy - slant * diagonal[j, 1], yy)
        diagonal[j, 0] = inverse_x
        diagonal[j, 1] = slant
        diagonal[j, 2] = inverse_y
        begin = column_start[j]
        end = column_start[j + 1]
        for at in range(begin, end):
            k = first + at - begin
            lower[at, 1] -= slant * lower[at, 0]
            lower[at, 3] -= slant * lower[at, 2]
            scaled[k, 0] = lower[at, 0] * inverse_x
            scaled[k, 1] = lower[at, 1] * inverse_y
            scaled[k, 2] = lower[at, 2] * inverse_x
            scaled[k, 3] = lower[at, 3] * inverse_y
        # A_ik -= L_ij D_j L_kj^T for every pair of rows i >= k of the column
        found = matrix.target_start[j]
        known = target.shape[0] > 0
        for at in range(begin, end):
            k = first + at - begin
            a0 = lower[at, 0]
            a1 = lower[at, 1]
            a2 = lower[at, 2]
            a3 = lower[at, 3]
            i = row[at]
            if not known:
                for block in range(column_start[i], column_start[i + 1]):
                    where[row[block]] = block
            diagonal[i, 0] -= scaled[k, 0] * a0 + scaled[k, 1] * a1
            diagonal[i, 1] -= scaled[k, 0] * a2 + scaled[k, 1] * a3
            diagonal[i, 2] -= scaled[k, 2] * a2 + scaled[k, 3] * a3
            for below in range(k + 1, first + end - begin):
                block = target[found] if known else where[row[begin + below - first]]
                found += 1
                lower[block, 0] -= scaled[below, 0] * a0 + scaled[below, 1] * a1
                lower[block, 1] -= scaled[below, 0] * a2 + scaled[below, 1] * a3
                lower[block, 2] -= scaled[below, 2] * a0 + scaled[below, 3] * a1
                lower[block, 3] -= scaled[below, 2] * a2 + scaled[below, 3] * a3
        for at in range(begin, end):
            k = first + at - begin
            lower[at, 0] = scaled[k, 0]
            lower[at, 1] = scaled[k, 1]
            lower[at, 2] = scaled[k, 2]
            lower[at, 3] = scaled[k, 3]


@inner_kernel
def inverse_pivot(pivot: float, original: float) -> float:
    """1 / pivot; 0 where that is not a positive number of the original's order."""
    # Written so that NaN and infinities give 0.
    return 1.0 / pivot if pivot > SMALLEST_PIVOT * original else 0.0


@inner_kernel
def back_substitute(first: int, last: int, matrix: Matrix, vector: FloatRows) -> None:
    """Solve for the rows first..last of vector (n, 2) in place, with the factor that `factorise` left."""
    column_start, row, diagonal, lower = matrix.column_start, matrix.row, matrix.diagonal, matrix.lower
    for j in range(first, last):
        x = vector[j, 0]
        y = vector[j, 1] - diagonal[j, 1] * x
        vector[j, 1] = y
        for at in range(column_start[j], column_start[j + 1]):
            i = row[at]
            vector[i, 0] -= lower[at, 0] * x + lower[at, 1] * y
            vector[i, 1] -= lower[at, 2] * x + lower[at, 3] * y
    for back in range(last - first):
        j = last - 1 - back
        x = diagonal[j, 0] * vector[j, 0]
        y = diagonal[j, 2] * vector[j, 1]
        for at in range(column_start[j], column_start[j + 1]):
            i = row[at]
            x -= lower[at, 0] * vector[i, 0] + lower[at, 2] * vector[i, 1]
            y -= lower[at, 1] * vector[i, 0] + lower[at, 3] * vector[i, 1]
        vector[j, 0] = x - diagonal[j, 1] * y
        vector[j, 1] = y
