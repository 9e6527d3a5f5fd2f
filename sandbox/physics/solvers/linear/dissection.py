"""Nested dissection of large bodies: their elimination order and the dense fronts of their factorisation.

A body is split by the median coordinate of the longer side of where its particles were created; those of the second
half that touch the first are eliminated last. Integer work and comparisons of creation positions, no library's choice:
the order decides the last bits of a tick. Source: George 1973, in its geometric form.
"""

from typing import Annotated, NamedTuple

from sandbox.physics.arena import Arena, new_tuple
from sandbox.physics.arrays import Floats, SlotRows, Slots
from sandbox.physics.jit import inner_kernel
from sandbox.physics.topology.sorting import sort_by_value

# Particles that are not split further. Fewer make many small fronts, more make needless zeros; measured best of 12..48.
LEAF_SIZE = 16
# Bodies of fewer particles go to the sparse factorisation, and so do those whose borders have fewer rows on average,
# ropes, bridges and strips up to 8 particles wide: there dense fronts hold mostly zeros and take up to twice the time.
SMALLEST_BODY = 400
NARROWEST_BORDER = 15.0
# Halvings that no body exceeds: 2^60 particles.
DEEPEST = 64
# In place of a number of fronts: the room for borders is too short.
TOO_SHORT = -1


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
def _dissect(begin: int, end: int, count: int, nodes: Halving, fronts: Dissection, leaf: int) -> int:
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
def _border(front: int, other: int, top: int, fronts: Dissection, mark: Slots) -> int:
    # Add a row to the border of a front that ends there, once; how long all borders are then, or TOO_SHORT.
    if other < fronts.last[front] or mark[other] == front:
        return top
    if top == fronts.border.shape[0]:
        return TOO_SHORT
    mark[other] = front
    fronts.border[top] = other
    return top + 1


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
def _find_places(first_front: int, last_front: int, nodes: Halving, fronts: Dissection) -> None:
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


@inner_kernel
def begin_dissections(nodes: Halving) -> None:
    """Prepare for `dissect`; borders begin at 0."""
    for node in range(nodes.part.shape[0]):
        nodes.part[node] = -1
        nodes.mark[node] = -1
        nodes.same[node] = node


@inner_kernel
def dissect(
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
    last_front = _dissect(first_row, last_row, first_front, nodes, fronts, leaf)
    for row in range(first_row, last_row):
        rank[nodes.by_x[row]] = row
    for front in range(first_front, last_front):
        if not _find_border(front, rank, nodes, fronts):
            return TOO_SHORT
    borders = fronts.border_start[last_front] - fronts.border_start[first_front]
    if not borders >= narrowest * (last_front - first_front):
        return first_front
    _find_places(first_front, last_front, nodes, fronts)
    return last_front


@inner_kernel
def new_halving(pairs: int, x: Floats, y: Floats, large: int, arena: Arena) -> Halving:
    """Scratch for the dissection of nodes at x, y [m] (n,), which have this many pairs of neighbours.

    large: nodes of bodies that may be dissected, 0 where none is large enough.
    """
    return new_tuple(Halving, arena, x=x, y=y, nodes=x.shape[0], pairs=pairs, large=large)


@inner_kernel
def new_dissection(nodes: int, borders: int, arena: Arena) -> Dissection:
    """A dissection of so many nodes to be filled in, with room for borders of so many rows in all."""
    return new_tuple(Dissection, arena, nodes=nodes, borders=borders)
