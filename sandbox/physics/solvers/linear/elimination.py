"""Elimination order of a whole system: body by body, large ones dissected, the others by minimum degree.

A dissected body is split by the median coordinate of the longer side of where its particles were created; those of the
second half that touch the first are eliminated last (nested dissection; George 1973, in its geometric form). Each part
is a dense front (fronts.py). Integer work and comparisons of creation positions, no library's choice: the order decides
the last bits of a tick.
"""

from typing import Annotated, NamedTuple

from sandbox.physics.arena import Arena, give_back, is_full, mark, new_tuple
from sandbox.physics.arrays import Floats, SlotRows, Slots
from sandbox.physics.components import label_linked
from sandbox.physics.jit import inner_kernel
from sandbox.physics.solvers.linear.sparse_ldl import FILL_GUESS, Ordering, new_ordering, order_graph
from sandbox.physics.topology.sorting import list_by_key, list_neighbours, sort_by_value

# Particles that are not split further. Fewer make many small fronts, more make needless zeros; measured best of 12..48.
LEAF_SIZE = 16
# Bodies of fewer particles go to the sparse factorisation, and so do those whose borders have fewer rows on average,
# ropes, bridges and strips up to 8 particles wide: there dense fronts hold mostly zeros and take up to twice the time.
SMALLEST_BODY = 400
NARROWEST_BORDER = 15.0
# Levels of splitting that no body exceeds: 2^60 particles.
DEEPEST = 64
# In place of a number of fronts: the room for borders is too short.
TOO_SHORT = -1
# First guess of rows in borders per node; too low costs one more pass, too high memory.
BORDER_GUESS = 8
# Places in `counts`: bodies, fronts, rows in borders, nodes that are ordered by minimum degree, blocks of their factor.
BODIES, FRONTS, BORDERS, SMALL, BLOCKS, COUNTS = range(6)
# Places in `whole` of a Tuning.
SMALLEST, LEAF, DIVIDED, WIDEST_NARROW = range(4)
# What ordering comes to.
DONE, BORDERS_TOO_SHORT, BLOCKS_TOO_SHORT = range(3)


class Halving(NamedTuple):
    """Nodes (n,) while they are split; from part on scratch."""

    start: Annotated[Slots, "nodes + 1"]
    near: Annotated[Slots, "2 * pairs"]  # neighbours of node k: near[start[k]:start[k + 1]]
    x: Floats  # [m]
    y: Floats
    by_x: Annotated[Slots, "large"]  # nodes of one body after another by x; becomes the elimination order
    by_y: Annotated[Slots, "large"]  # the same by y
    part: Annotated[Slots, "large"]
    merge_buffer: Annotated[Slots, "large"]
    same: Annotated[Slots, "large"]  # 0..n-1
    mark: Annotated[Slots, "large"]
    where: Annotated[Slots, "large"]
    stack: Annotated[SlotRows, f"3 * {DEEPEST}, 5"]  # first, last row, level, side, separator, -1: not split yet
    waiting: Annotated[SlotRows, f"{DEEPEST} + 1, 2"]  # fronts whose parent is yet to come, by level and side


class Dissection(NamedTuple):
    """The fronts of dissected bodies, children before parents.

    first, last (f,): the rows that a front eliminates; border_start (f+1), border: the later rows that they are joined
    to by then, ascending; child (f, 2): fronts, or -1; place (f, 2): level and side, which no other front of the body
    that is still waiting for its parent shares; to_parent: for each border row its place among the parent's rows.
    """

    first: Annotated[Slots, "nodes"]
    last: Annotated[Slots, "nodes"]
    child: Annotated[SlotRows, "nodes, 2"]
    place: Annotated[SlotRows, "nodes, 2"]
    border_start: Annotated[Slots, "nodes + 1"]
    border: Annotated[Slots, "borders"]
    to_parent: Annotated[Slots, "borders"]


class Links(NamedTuple):
    """Pairs of n nodes that are joined, a and b (l,); x, y (n,): where nodes were created [m]."""

    a: Slots
    b: Slots
    x: Floats
    y: Floats


class Elimination(NamedTuple):
    """The order of n nodes, which become the rows of the matrix; b bodies in the order of their lowest nodes."""

    order: Annotated[Slots, "nodes"]  # by row
    rank: Annotated[Slots, "nodes"]  # by node
    body: Annotated[Slots, "nodes"]  # by row
    first_row: Annotated[Slots, "nodes + 1"]
    lowest: Annotated[Slots, "nodes"]  # node
    first_front: Annotated[Slots, "nodes + 1"]
    label: Annotated[Slots, "nodes"]  # label, number, ends (n,): scratch
    number: Annotated[Slots, "nodes"]
    row_of: Annotated[Slots, "nodes"]  # the row of each node ordered by minimum degree, by their numbers
    ends: Annotated[Slots, "nodes"]


class Tuning(NamedTuple):
    """Numbers that decide how a system is laid out.

    whole (4,): SMALLEST_BODY, LEAF_SIZE, WORTH_DIVIDING (fronts.py), NARROW (layout.py); narrowest (1,):
    NARROWEST_BORDER.
    """

    whole: Slots
    narrowest: Floats


class Ordered(NamedTuple):
    """The order of nodes, with the dissection of large bodies and the order of all others."""

    elimination: Elimination
    fronts: Dissection
    small: Ordering


@inner_kernel
def order_for_elimination(links: Links, tuning: Tuning, counts: Slots, arena: Arena) -> Ordered:
    """The elimination order of nodes; counts (COUNTS,): how much there is of all."""
    nodes, pairs, smallest = links.x.shape[0], links.a.shape[0], tuning.whole[SMALLEST]
    large = nodes if nodes >= smallest else 0
    blocks, borders = FILL_GUESS * nodes + 16, BORDER_GUESS * large
    made = new_tuple(Elimination, arena, nodes=nodes)
    halving = new_tuple(Halving, arena, x=links.x, y=links.y, nodes=nodes, pairs=pairs, large=large)
    scratch = mark(arena)
    fronts, small = new_dissection(large, borders, arena), new_ordering(nodes, pairs, blocks, arena)
    outcome = BLOCKS_TOO_SHORT
    while not is_full(arena) and outcome != DONE:
        outcome = _eliminate(
            links, smallest, tuning.narrowest[0], tuning.whole[LEAF], made, halving, fronts, small, counts
        )  # fmt: skip
        if outcome != DONE:
            give_back(arena, scratch)
            blocks *= 2 if outcome == BLOCKS_TOO_SHORT else 1
            borders *= 2 if outcome == BORDERS_TOO_SHORT else 1
            fronts, small = new_dissection(large, borders, arena), new_ordering(nodes, pairs, blocks, arena)
    return Ordered(made, fronts, small)


@inner_kernel
def new_dissection(nodes: int, borders: int, arena: Arena) -> Dissection:
    """A dissection of so many nodes to be filled in, with room for borders of so many rows in all."""
    return new_tuple(Dissection, arena, nodes=nodes, borders=borders)


@inner_kernel
def _eliminate(
    links: Links, smallest: int, narrowest: float, leaf: int, made: Elimination, nodes: Halving, fronts: Dissection,
    small: Ordering, counts: Slots,
) -> int:  # fmt: skip
    """Order the nodes for elimination; counts (COUNTS,): how much there is of all; one of the codes above.

    Bodies of `smallest` nodes or more are dissected, unless their borders have fewer rows than `narrowest` on average.
    nodes.start and near: filled in with the neighbours of each node. small: the order of all others, in numbers of
    their own.
    """
    size = made.order.shape[0]
    list_neighbours(links.a, links.b, links.a.shape[0], size, nodes.start, nodes.near, small.graph.near, made.ends)
    bodies = _find_bodies(links, made)
    count = _dissect_bodies(bodies, smallest, narrowest, leaf, made, nodes, fronts)
    if count < 0:
        return BORDERS_TOO_SHORT
    counts[BODIES] = bodies
    counts[FRONTS] = count
    counts[BORDERS] = fronts.border_start[count]
    # Number the nodes of bodies without fronts; `ends` holds the body of each node.
    numbered = 0
    for node in range(made.number.shape[0]):
        b = made.ends[node]
        made.number[node] = -1
        if made.first_front[b] == made.first_front[b + 1]:
            made.number[node] = numbered
            made.row_of[numbered] = node
            numbered += 1
    counts[SMALL] = numbered
    if not order_graph(nodes.start, nodes.near, made.number, small):
        return BLOCKS_TOO_SHORT
    counts[BLOCKS] = small.columns.start[counts[SMALL]]
    body_of = made.ends
    for k in range(counts[SMALL]):
        # From the first row of its body on: where the next one goes is kept at the body's lowest node.
        node = made.row_of[small.order[k]]
        lowest = made.lowest[body_of[node]]
        made.order[made.first_row[body_of[node]] + made.label[lowest] - lowest] = node
        made.label[lowest] += 1
    for row in range(size):
        made.rank[made.order[row]] = row
    for k in range(counts[SMALL]):
        made.row_of[k] = made.rank[made.row_of[k]]
    return DONE


@inner_kernel
def _find_bodies(links: Links, made: Elimination) -> int:
    # List the nodes by body, ascending, in `order`; how many bodies there are.
    nodes = made.order.shape[0]
    for node in range(nodes):
        made.label[node] = node
    label_linked(links.a, links.b, made.label)
    bodies = 0
    for node in range(nodes):
        if made.label[node] == node:
            made.lowest[bodies] = node
            made.number[node] = bodies
            bodies += 1
        made.ends[node] = made.number[made.label[node]]
    list_by_key(made.ends, nodes, bodies, made.first_row, made.order)
    for b in range(bodies):
        for row in range(made.first_row[b], made.first_row[b + 1]):
            made.body[row] = b
    return bodies


@inner_kernel
def _dissect_bodies(
    bodies: int, smallest: int, narrowest: float, leaf: int, made: Elimination, nodes: Halving, fronts: Dissection
) -> int:
    # Dissect large bodies; how many fronts there are, or TOO_SHORT.
    count = 0
    made.first_front[0] = fronts.border_start[0] = 0
    for node in range(nodes.part.shape[0]):
        nodes.part[node] = nodes.mark[node] = -1
        nodes.same[node] = node
    for b in range(bodies):
        first, last = made.first_row[b], made.first_row[b + 1]
        if last - first >= smallest:
            for row in range(first, last):
                nodes.by_x[row] = nodes.by_y[row] = made.order[row]
            count = _dissect(first, last, count, made.rank, nodes, fronts, leaf, narrowest)
            if count < 0:
                return TOO_SHORT
            for row in range(first, last if count > made.first_front[b] else first):
                made.order[row] = nodes.by_x[row]
        made.first_front[b + 1] = count
    return count


@inner_kernel
def _dissect(
    first_row: int, last_row: int, first_front: int, rank: Slots, nodes: Halving, fronts: Dissection, leaf: int,
    narrowest: float,
) -> int:  # fmt: skip
    """Dissect a body with these rows, into fronts from first_front on; how many fronts there are then.

    rank (n,): the rows of its nodes, of which the order is found. As many as before: it is better off without, since
    its borders have fewer rows than `narrowest` on average. TOO_SHORT: there is too little room for borders.
    """
    merge_buffer = nodes.merge_buffer
    sort_by_value(nodes.x, nodes.by_x, first_row, last_row, merge_buffer)
    sort_by_value(nodes.y, nodes.by_y, first_row, last_row, merge_buffer)
    last_front = _split_into_fronts(first_row, last_row, first_front, nodes, fronts, leaf)
    for row in range(first_row, last_row):
        rank[nodes.by_x[row]] = row
    for front in range(first_front, last_front):
        if not _find_border(front, rank, nodes, fronts):
            return TOO_SHORT
    borders = fronts.border_start[last_front] - fronts.border_start[first_front]
    if not borders >= narrowest * (last_front - first_front):
        return first_front
    # The places of border rows among the parents' rows.
    where, border_start, border = nodes.where, fronts.border_start, fronts.border
    for front in range(first_front, last_front):
        eliminated = fronts.last[front] - fronts.first[front]
        for k in range(eliminated):
            where[fronts.first[front] + k] = k
        for at in range(border_start[front], border_start[front + 1]):
            where[border[at]] = eliminated + at - border_start[front]
        for side in range(2):
            below = fronts.child[front, side]
            if below >= 0:
                for at in range(border_start[below], border_start[below + 1]):
                    fronts.to_parent[at] = where[border[at]]
    return last_front


@inner_kernel
def _split_into_fronts(begin: int, end: int, count: int, nodes: Halving, fronts: Dissection, leaf: int) -> int:
    # Split the nodes of a body, whose rows are begin..end, into fronts from number `count` on; how many there are then.
    stack, waiting = nodes.stack, nodes.waiting
    for level in range(DEEPEST):
        waiting[level, 0] = waiting[level, 1] = -1
    left = 0
    _push(stack, 0, begin, end, 0, 0)
    top = 1
    while top > 0:
        top -= 1
        begin = stack[top, 0]
        end = stack[top, 1]
        level = stack[top, 2]
        side = stack[top, 3]
        apart = stack[top, 4]
        if apart < 0 and end - begin > leaf:
            middle = (begin + end) // 2
            apart = _split(begin, end, left, nodes)
            left += 3
            stack[top, 4] = apart
            top += 1
            if apart > middle:
                _push(stack, top, middle, apart, level + 1, 1)
                top += 1
            _push(stack, top, begin, middle, level + 1, 0)
            top += 1
        else:
            fronts.first[count] = begin if apart < 0 else apart
            fronts.last[count] = end
            fronts.place[count, 0] = level
            fronts.place[count, 1] = side
            for other in range(2):
                fronts.child[count, other] = waiting[level + 1, other]
                waiting[level + 1, other] = -1
            waiting[level, side] = count
            count += 1
    return count


@inner_kernel
def _push(stack: SlotRows, top: int, begin: int, end: int, level: int, side: int) -> None:
    stack[top, 0] = begin
    stack[top, 1] = end
    stack[top, 2] = level
    stack[top, 3] = side
    stack[top, 4] = -1


@inner_kernel
def _split(first: int, last: int, left: int, nodes: Halving) -> int:
    start, near, part, by_x, by_y = nodes.start, nodes.near, nodes.part, nodes.by_x, nodes.by_y
    x, y = nodes.x, nodes.y
    middle = (first + last) // 2
    longer = by_x
    if y[by_y[last - 1]] - y[by_y[first]] > x[by_x[last - 1]] - x[by_x[first]]:
        longer = by_y
    for at in range(first, middle):
        part[longer[at]] = left
    apart = last
    for at in range(middle, last):
        node = longer[at]
        part[node] = left + 1
        for neighbour in range(start[node], start[node + 1]):
            if part[near[neighbour]] == left:
                part[node] = left + 2
                apart -= 1
                break
    _partition(first, last, middle, apart, left, part, by_x, nodes.merge_buffer)
    _partition(first, last, middle, apart, left, part, by_y, nodes.merge_buffer)
    return apart


@inner_kernel
def _partition(
    first: int, last: int, split: int, apart: int, left: int, part: Slots, nodes: Slots, merge_buffer: Slots
) -> None:
    # The left half, the right one and what separates them, each in the order that it has.
    at_left = first
    at_right = split
    at_apart = apart
    for at in range(first, last):
        node = nodes[at]
        if part[node] == left:
            merge_buffer[at_left] = node
            at_left += 1
        elif part[node] == left + 1:
            merge_buffer[at_right] = node
            at_right += 1
        else:
            merge_buffer[at_apart] = node
            at_apart += 1
    for at in range(first, last):
        nodes[at] = merge_buffer[at]


@inner_kernel
def _find_border(front: int, rank: Slots, nodes: Halving, fronts: Dissection) -> bool:
    # The border of a front; False: it is too short.
    top = fronts.border_start[front]
    for row in range(fronts.first[front], fronts.last[front]):
        node = nodes.by_x[row]
        for at in range(nodes.start[node], nodes.start[node + 1]):
            top = _border(front, rank[nodes.near[at]], top, fronts, nodes.mark)
            if top < 0:
                return False
    for side in range(2):
        below = fronts.child[front, side]
        if below >= 0:
            for at in range(fronts.border_start[below], fronts.border_start[below + 1]):
                top = _border(front, fronts.border[at], top, fronts, nodes.mark)
                if top < 0:
                    return False
    fronts.border_start[front + 1] = top
    sort_by_value(nodes.same, fronts.border, fronts.border_start[front], top, nodes.merge_buffer)
    return True


@inner_kernel
def _border(front: int, other: int, top: int, fronts: Dissection, mark: Slots) -> int:
    # Add a row to the border of a front that ends there, once; how long all borders are then, or TOO_SHORT.
    if other < fronts.last[front] or mark[other] == front:
        return top
    if top == fronts.border.shape[0]:
        return TOO_SHORT
    mark[other] = front
    fronts.border[top] = other
    return top + 1
