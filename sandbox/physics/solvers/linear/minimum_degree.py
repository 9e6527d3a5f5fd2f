"""Elimination order of the direct solver: connected bodies, minimum degree, and where each update of a factor lands.

Everything here is integer work, a pure function of which particles the springs join: no state, no history, and no
library's choice enters, because the order decides the last bits of a tick.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.jit import inner_kernel, kernel
from sandbox.physics.state import Slots


class QuotientGraph(NamedTuple):
    """The neighbours of nodes (n,): near_count nodes and element_count elements each, in rows that begin at start."""

    start: Slots
    near: Slots
    near_count: Slots
    element: Slots
    element_count: Slots


class Columns(NamedTuple):
    """The nodes that eliminating a node joins, its element: node[start[k]:start[k + 1]] for the k-th."""

    start: Slots
    node: Slots


class Marks(NamedTuple):
    """By element: absorbed; outside: members beyond the newest one, counted: for which step. mark: step of a node."""

    absorbed: NDArray[np.bool_]
    mark: Slots
    outside: Slots
    counted: Slots


class Heap(NamedTuple):
    """Nodes by degree, least first, ties by lowest index; place: where each node is in it."""

    node: Slots
    place: Slots
    degree: Slots


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
def _bound_degrees(step: int, left: int, graph: QuotientGraph, columns: Columns, marks: Marks, queue: Heap) -> None:
    # Neighbours outside every element, in the new element, and in each older one beyond it: at least the degree, which
    # cannot exceed what was left before nor the nodes left. An older element inside the new one says nothing more.
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
        degree[node] = min(bound, before + members, left - 1)
        if degree[node] < before:
            _sift_up(queue, queue.place[node])
        elif degree[node] > before:
            _sift_down(queue, queue.place[node], left)


@kernel
def minimum_degree(graph: QuotientGraph, order: Slots, columns: Columns, marks: Marks, queue: Heap) -> bool:
    """Order the nodes by approximate minimum degree, ties by lowest index; False where columns are too short.

    graph: of n nodes, without elements; it is changed on the way. order (n,): nodes as they are eliminated; columns:
    for each of them, the nodes still present that it is joined to by then. mark and counted hold -1.
    Source: Amestoy, Davis, Duff 1996, without their merging of like nodes.
    """
    size = order.shape[0]
    for node in range(size):
        queue.degree[node] = graph.near_count[node]
        queue.node[node] = node
        _sift_up(queue, node)
    for step in range(order.shape[0]):
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
        _bound_degrees(step, size, graph, columns, marks, queue)
    return True


@kernel
def update_targets(column_start: Slots, row: Slots, target: NDArray[np.int32], where: Slots) -> None:
    """For each column and each pair of its blocks, upper then lower: the block of the factor that the pair updates.

    The order is that in which the factorisation meets them; where (n,) is scratch.
    """
    found = 0
    for j in range(column_start.shape[0] - 1):
        for upper in range(column_start[j], column_start[j + 1]):
            owner = row[upper]
            for at in range(column_start[owner], column_start[owner + 1]):
                where[row[at]] = at
            for lower in range(upper + 1, column_start[j + 1]):
                target[found] = where[row[lower]]
                found += 1
