"""Nested dissection of large bodies: their elimination order and the dense fronts of their factorisation.

A body is split by the median coordinate of the longer side of where its particles were created; those of the second
half that touch the first are eliminated last. Integer work and comparisons of creation positions, no library's choice:
the order decides the last bits of a tick. Source: George 1973, in its geometric form.
"""

from typing import NamedTuple

import numpy as np

from sandbox.physics.jit import inner_kernel, kernel
from sandbox.physics.solvers.linear.fronts import PANEL, Fronts, Scratch
from sandbox.physics.solvers.linear.parallel import CALL_LENGTH, find_fork
from sandbox.physics.world import Floats, Slots

# Particles that are not split further. Fewer make many small fronts, more make needless zeros; measured best of 12..48.
LEAF_SIZE = 16
# Bodies of fewer particles go to the sparse factorisation, and so do those whose borders have fewer rows on average,
# ropes, bridges and strips up to 8 particles wide: there dense fronts hold mostly zeros and take up to twice the time.
SMALLEST_BODY = 400
NARROWEST_BORDER = 15.0
# Halvings that no body exceeds: 2^60 particles.
DEEPEST = 64


class Dissection(NamedTuple):
    """One body of n particles: order (n,) and its fronts, children before parents.

    first, last (f,): the rows that a front eliminates; border_start (f+1), border: the later rows that they are joined
    to by then, ascending; child (f, 2): fronts, or -1; place (f, 2): level and side, which no other front that is still
    waiting for its parent shares; to_parent: for each border row its place among the parent's rows.
    """

    order: Slots
    first: Slots
    last: Slots
    child: Slots
    place: Slots
    border_start: Slots
    border: Slots
    to_parent: Slots


class Halving(NamedTuple):
    """Nodes (n,) while they are split: neighbours near[start[k]:start[k + 1]], place, order by each; part; scratch."""

    start: Slots
    near: Slots
    x: Floats
    y: Floats
    by_x: Slots
    by_y: Slots
    part: Slots
    spare: Slots


class FoundFronts(NamedTuple):
    """The fronts as they are found: see Dissection."""

    first: Slots
    last: Slots
    child: Slots
    place: Slots


@inner_kernel
def _partition(
    first: int, last: int, split: int, apart: int, left: int, part: Slots, nodes: Slots, spare: Slots
) -> None:
    # The left half, the right one and what separates them, each in the order that it has.
    at_left = first
    at_right = split
    at_apart = apart
    for at in range(first, last):
        node = nodes[at]
        if part[node] == left:
            spare[at_left] = node
            at_left += 1
        elif part[node] == left + 1:
            spare[at_right] = node
            at_right += 1
        else:
            spare[at_apart] = node
            at_apart += 1
    for at in range(first, last):
        nodes[at] = spare[at]


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
    _partition(first, last, middle, apart, left, part, by_x, nodes.spare)
    _partition(first, last, middle, apart, left, part, by_y, nodes.spare)
    return apart


@kernel
def _dissect(nodes: Halving, stack: Slots, waiting: Slots, fronts: FoundFronts, leaf: int) -> int:
    # by_x becomes the elimination order. stack: first and last row, level, side, where the separator begins (-1: not
    # split yet). waiting: the fronts whose parent is yet to come, by level and side.
    count = 0
    left = 0
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
def _push(stack: Slots, top: int, begin: int, end: int, level: int, side: int) -> None:
    stack[top, 0] = begin
    stack[top, 1] = end
    stack[top, 2] = level
    stack[top, 3] = side
    stack[top, 4] = -1


@kernel
def _find_neighbours(link_a: Slots, link_b: Slots, start: Slots, near: Slots) -> None:
    # start (n+1) begins as 0. A pair that two springs join is there twice.
    for k in range(link_a.shape[0]):
        start[link_a[k]] += 1
        start[link_b[k]] += 1
    total = 0
    for node in range(start.shape[0]):
        total += start[node]
        start[node] = total
    for k in range(link_a.shape[0]):
        a = link_a[k]
        b = link_b[k]
        start[a] -= 1
        near[start[a]] = b
        start[b] -= 1
        near[start[b]] = a


@kernel
def _find_borders(
    start: Slots, near: Slots, order: Slots, rank: Slots, first: Slots, last: Slots, child: Slots, border_start: Slots,
    border: Slots, mark: Slots,
) -> bool:  # fmt: skip
    # False where `border` is too short.
    for front in range(first.shape[0]):
        top = border_start[front]
        for row in range(first[front], last[front]):
            node = order[row]
            for at in range(start[node], start[node + 1]):
                other = rank[near[at]]
                if other >= last[front] and mark[other] != front:
                    if top == border.shape[0]:
                        return False
                    mark[other] = front
                    border[top] = other
                    top += 1
        for side in range(2):
            below = child[front, side]
            if below >= 0:
                for at in range(border_start[below], border_start[below + 1]):
                    other = border[at]
                    if other >= last[front] and mark[other] != front:
                        if top == border.shape[0]:
                            return False
                        mark[other] = front
                        border[top] = other
                        top += 1
        border_start[front + 1] = top
    return True


@kernel
def _find_places(
    first: Slots, last: Slots, child: Slots, border_start: Slots, border: Slots, where: Slots, to_parent: Slots
) -> None:
    for front in range(first.shape[0]):
        for row in range(first[front], last[front]):
            where[row] = row - first[front]
        for at in range(border_start[front], border_start[front + 1]):
            where[border[at]] = last[front] - first[front] + at - border_start[front]
        for side in range(2):
            below = child[front, side]
            if below >= 0:
                for at in range(border_start[below], border_start[below + 1]):
                    to_parent[at] = where[border[at]]


def dissect(link_a: Slots, link_b: Slots, position: Floats) -> Dissection:
    """Dissect one body, given the pairs of its n particles that springs join and where they were created (n, 2) [m]."""
    count = len(position)
    start, near = np.zeros(count + 1, dtype=np.int64), np.zeros(2 * len(link_a), dtype=np.int64)
    _find_neighbours(link_a, link_b, start, near)
    x, y = np.ascontiguousarray(position[:, 0]), np.ascontiguousarray(position[:, 1])
    order, by_y = np.argsort(x, kind="stable"), np.argsort(y, kind="stable")
    first, last = np.zeros((2, count), dtype=np.int64)
    child, place = np.zeros((2, count, 2), dtype=np.int64)
    part, spare = np.full(count, -1, dtype=np.int64), np.zeros(count, dtype=np.int64)
    stack, waiting = np.zeros((3 * DEEPEST, 5), dtype=np.int64), np.full((DEEPEST, 2), -1, dtype=np.int64)
    stack[0] = 0, count, 0, 0, -1
    nodes = Halving(start, near, x, y, order, by_y, part, spare)
    fronts = _dissect(nodes, stack, waiting, FoundFronts(first, last, child, place), LEAF_SIZE)
    first, last, child, place = (array[:fronts].copy() for array in (first, last, child, place))
    rank = np.zeros(count, dtype=np.int64)
    rank[order] = np.arange(count)
    border_start, border = np.zeros(fronts + 1, dtype=np.int64), np.zeros(8 * count, dtype=np.int64)
    while not _find_borders(
        start, near, order, rank, first, last, child, border_start, border, np.full(count, -1, dtype=np.int64)
    ):
        border = np.zeros(2 * len(border), dtype=np.int64)
    owner = np.repeat(np.arange(fronts), np.diff(border_start))
    border = np.sort(owner * count + border[: border_start[-1]]) % count
    to_parent = np.zeros_like(border)
    _find_places(first, last, child, border_start, border, spare, to_parent)
    return Dissection(order, first, last, child, place, border_start, border, to_parent)


def dissect_bodies(label: Slots, link_a: Slots, link_b: Slots, position: Floats) -> dict[int, Dissection]:
    """The dissections, by label, of those bodies of n free particles that are factored by fronts.

    label, position (n,), (n, 2): the body of each and where it was created [m]; link_a, link_b: pairs that are joined.
    """
    chosen = {}
    index = np.zeros(len(label), dtype=np.int64)
    for body in np.flatnonzero(np.bincount(label) >= SMALLEST_BODY).tolist() if len(label) else []:
        nodes = np.flatnonzero(label == body)
        index[nodes] = np.arange(len(nodes))
        links = np.flatnonzero(label[link_a] == body)
        dissection = dissect(index[link_a[links]], index[link_b[links]], position[nodes])
        if len(dissection.border) >= NARROWEST_BORDER * len(dissection.first):
            chosen[body] = dissection
    return chosen


def make_fronts(count: int, dissections: list[tuple[int, Dissection]]) -> Fronts:
    """Lay out the fronts of bodies in a matrix of `count` rows, each with the first row of its body."""
    rows = [first_row for first_row, _ in dissections]
    fronts_before = np.append(0, np.cumsum([len(one.first) for _, one in dissections])).astype(np.int64)
    borders_before = np.append(0, np.cumsum([len(one.border) for _, one in dissections])).astype(np.int64)

    def joined(name: str, shifts: list[int] | Slots) -> Slots:
        parts = [getattr(one, name) + shift for (_, one), shift in zip(dissections, shifts, strict=False)]
        return np.concatenate(parts) if parts else np.zeros(0, dtype=np.int64)

    none = [0] * len(rows)
    first, last, border = joined("first", rows), joined("last", rows), joined("border", rows)
    child = [
        np.where(one.child < 0, -1, one.child + k) for (_, one), k in zip(dissections, fronts_before, strict=False)
    ]
    starts = [one.border_start[:-1] + k for (_, one), k in zip(dissections, borders_before, strict=False)]
    border_start = np.concatenate([*starts, borders_before[-1:]])
    pivots, borders = 2 * (last - first), 2 * np.diff(border_start)
    width = pivots + borders
    ends = np.cumsum(pivots * width)
    of_row, diagonal, row_width = np.full((3, count), -1, dtype=np.int64)
    owned = np.repeat(np.arange(len(first)), last - first)
    eliminated = np.arange(len(owned)) - np.repeat(np.cumsum(last - first) - (last - first), last - first)
    of_row[first[owned] + eliminated] = owned
    row_width[first[owned] + eliminated] = width[owned]
    diagonal[first[owned] + eliminated] = (ends - pivots * width)[owned] + 2 * eliminated * (width[owned] + 1)
    widest = int(width.max(initial=0))
    levels = joined("place", none).reshape(-1, 2) if rows else np.zeros((0, 2), dtype=np.int64)
    size = np.zeros(DEEPEST, dtype=np.int64)
    np.maximum.at(size, levels[:, 0], borders * borders)
    # Two fronts of a level wait at most, one per side, of each half; nothing lies below the widest front.
    before = widest + 2 * (np.cumsum(size) - size)
    remains = before[levels[:, 0]] + levels[:, 1] * size[levels[:, 0]]
    fork = np.zeros((len(first), 2), dtype=np.int64)
    for (_, one), k in zip(dissections, fronts_before, strict=False):
        begin, end = find_fork(one.first, one.last, one.child, one.border_start)
        fork[k + len(one.first) - 1] = k + begin, k + end
        remains[k + begin : k + end] += 2 * int(size.sum())
    return Fronts(
        of_row, diagonal, row_width, first, last, np.concatenate(child) if child else np.zeros((0, 2), dtype=np.int64),
        border_start, border, joined("to_parent", none), width, ends - pivots * width, remains,
        np.zeros(int(ends[-1]) if len(ends) else 0), np.zeros(widest + (4 if fork.any() else 2) * int(size.sum())),
        np.zeros(2 * count), fork, _scratch(widest), _scratch(widest), np.zeros((count, 2)),
        np.zeros(CALL_LENGTH, dtype=np.int64),
    )  # fmt: skip


def _scratch(widest: int) -> Scratch:
    return Scratch(np.zeros(int(PANEL) * widest), np.zeros(int(PANEL)), np.zeros(widest))


def spring_places(fronts: Fronts, low: Slots, high: Slots) -> Slots:
    """Where the blocks between the rows low < high of large bodies begin in fronts.numbers."""
    front = fronts.of_row[low]
    count = len(fronts.of_row)
    keys = np.repeat(np.arange(len(fronts.first)), np.diff(fronts.border_start)) * count + fronts.border
    eliminated = fronts.last[front] - fronts.first[front]
    outside = eliminated + np.searchsorted(keys, front * count + high) - fronts.border_start[front]
    column = np.where(high < fronts.last[front], high - fronts.first[front], outside)
    return fronts.base[front] + 2 * (low - fronts.first[front]) * fronts.width[front] + 2 * column
