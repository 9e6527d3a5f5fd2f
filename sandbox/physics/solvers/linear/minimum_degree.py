"""Elimination order of the direct solver: connected bodies, minimum degree, and where each update of a factor lands.

Everything here is integer work, a pure function of which particles the springs join: no state, no history, and no
library's choice enters, because the order decides the last bits of a tick.
"""

from sandbox.physics.jit import inner_kernel, kernel


@inner_kernel
def _sift_up(heap, place, degree, at):  # type: ignore[no-untyped-def]
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
def _sift_down(heap, place, degree, at, size):  # type: ignore[no-untyped-def]
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
def _gather(  # type: ignore[no-untyped-def]
    step, pivot, start, near, near_count, element, element_count, column_start, column, absorbed, mark
):
    # The nodes that eliminating the pivot joins to one another: its neighbours and those of the elements it takes in.
    # An element whose member is eliminated is taken in by it, so the others hold no eliminated node.
    top = column_start[step]
    mark[pivot] = step
    for at in range(start[pivot], start[pivot] + near_count[pivot]):
        node = near[at]
        if top == column.shape[0]:
            return -1
        mark[node] = step
        column[top] = node
        top += 1
    for at in range(start[pivot], start[pivot] + element_count[pivot]):
        older = element[at]
        absorbed[older] = True
        for member in range(column_start[older], column_start[older + 1]):
            node = column[member]
            if mark[node] != step:
                if top == column.shape[0]:
                    return -1
                mark[node] = step
                column[top] = node
                top += 1
    return top


@inner_kernel
def _prune(  # type: ignore[no-untyped-def]
    step, start, near, near_count, element, element_count, column_start, column, absorbed, mark, outside, counted
):
    # What the new element covers leaves its members' lists; how many members each of their older elements has outside.
    for at in range(column_start[step], column_start[step + 1]):
        node = column[at]
        kept = start[node]
        for place in range(start[node], start[node] + near_count[node]):
            if mark[near[place]] != step:
                near[kept] = near[place]
                kept += 1
        near_count[node] = kept - start[node]
        kept = start[node]
        for place in range(start[node], start[node] + element_count[node]):
            older = element[place]
            if not absorbed[older]:
                element[kept] = older
                kept += 1
                if counted[older] != step:
                    counted[older] = step
                    outside[older] = column_start[older + 1] - column_start[older]
                outside[older] -= 1
        element[kept] = step
        element_count[node] = kept + 1 - start[node]


@inner_kernel
def _bound_degrees(  # type: ignore[no-untyped-def]
    step, left, start, near_count, element, element_count, column_start, column, outside, heap, place, degree
):
    # Neighbours outside every element, in the new element, and in each older one beyond it: at least the degree, which
    # cannot exceed what was left before nor the nodes left. An older element inside the new one says nothing more.
    members = column_start[step + 1] - column_start[step] - 1
    for at in range(column_start[step], column_start[step + 1]):
        node = column[at]
        bound = near_count[node] + members
        kept = start[node]
        for other in range(start[node], start[node] + element_count[node]):
            older = element[other]
            if older == step or outside[older] > 0:
                element[kept] = older
                kept += 1
                if older != step:
                    bound += outside[older]
        element_count[node] = kept - start[node]
        before = degree[node]
        degree[node] = min(bound, before + members, left - 1)
        if degree[node] < before:
            _sift_up(heap, place, degree, place[node])
        elif degree[node] > before:
            _sift_down(heap, place, degree, place[node], left)


@kernel
def minimum_degree(  # type: ignore[no-untyped-def]
    start, near, near_count, element, element_count, order, column_start, column, absorbed, mark, outside, counted,
    heap, place, degree,
):  # fmt: skip
    """Order the nodes by approximate minimum degree, ties by lowest index; False where `column` is too short.

    start (n+1), near: neighbours in compressed rows, changed on the way. order (n,): nodes as they are eliminated.
    column_start (n+1), column: for each of them, the nodes still present that it is joined to by then. mark and
    counted hold -1. Source: Amestoy, Davis, Duff 1996, without their merging of like nodes.
    """
    size = order.shape[0]
    for node in range(size):
        degree[node] = near_count[node]
        heap[node] = node
        _sift_up(heap, place, degree, node)
    for step in range(order.shape[0]):
        pivot = heap[0]
        size -= 1
        heap[0] = heap[size]
        if size > 0:
            _sift_down(heap, place, degree, 0, size)
        order[step] = pivot
        top = _gather(
            step, pivot, start, near, near_count, element, element_count, column_start, column, absorbed, mark
        )
        if top < 0:
            return False
        column_start[step + 1] = top
        _prune(
            step, start, near, near_count, element, element_count, column_start, column, absorbed, mark, outside,
            counted,
        )  # fmt: skip
        _bound_degrees(
            step, size, start, near_count, element, element_count, column_start, column, outside, heap, place, degree
        )  # fmt: skip
    return True


@kernel
def update_targets(column_start, row, target, where):  # type: ignore[no-untyped-def]
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
