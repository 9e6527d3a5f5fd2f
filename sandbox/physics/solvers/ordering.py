"""Elimination order of the direct solver: connected bodies, minimum degree, and where each update of a factor lands.

Everything here is integer work, a pure function of which particles the springs join: no state, no history, and no
library's choice enters, because the order decides the last bits of a tick.
"""

from sandbox.physics.jit import kernel


@kernel
def label_bodies(link_a, link_b, label):  # type: ignore[no-untyped-def]
    """Label every node (n,) with the lowest node of its connected component; label holds 0..n-1 at the start."""
    for k in range(link_a.shape[0]):
        a = link_a[k]
        b = link_b[k]
        while label[a] != a:
            label[a] = label[label[a]]
            a = label[a]
        while label[b] != b:
            label[b] = label[label[b]]
            b = label[b]
        if a < b:
            label[b] = a
        else:
            label[a] = b
    # Labels never point upwards, so one ascending pass flattens them.
    for node in range(label.shape[0]):
        label[node] = label[label[node]]


@kernel
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


@kernel
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


@kernel
def _gather(  # type: ignore[no-untyped-def]
    step, pivot, start, near, near_count, element, element_count, column_start, column, eliminated, absorbed, mark,
    stamp,
):  # fmt: skip
    # The nodes that eliminating the pivot joins to one another: its neighbours and those of the elements it takes in.
    top = column_start[step]
    mark[pivot] = stamp
    for at in range(start[pivot], start[pivot] + near_count[pivot]):
        node = near[at]
        if mark[node] != stamp:
            if top == column.shape[0]:
                return -1
            mark[node] = stamp
            column[top] = node
            top += 1
    for at in range(start[pivot], start[pivot] + element_count[pivot]):
        older = element[at]
        absorbed[older] = True
        for member in range(column_start[older], column_start[older + 1]):
            node = column[member]
            if not eliminated[node] and mark[node] != stamp:
                if top == column.shape[0]:
                    return -1
                mark[node] = stamp
                column[top] = node
                top += 1
    return top


@kernel
def _prune(step, node, start, near, near_count, element, element_count, absorbed, mark, stamp):  # type: ignore[no-untyped-def]
    # What the new element covers leaves the node's lists; the element joins them.
    kept = start[node]
    for at in range(start[node], start[node] + near_count[node]):
        if mark[near[at]] != stamp:
            near[kept] = near[at]
            kept += 1
    near_count[node] = kept - start[node]
    kept = start[node]
    for at in range(start[node], start[node] + element_count[node]):
        if not absorbed[element[at]]:
            element[kept] = element[at]
            kept += 1
    element[kept] = step
    element_count[node] = kept + 1 - start[node]


@kernel
def _count_neighbours(  # type: ignore[no-untyped-def]
    node, start, near, near_count, element, element_count, column_start, column, eliminated, mark, stamp,
):  # fmt: skip
    mark[node] = stamp
    count = 0
    for at in range(start[node], start[node] + near_count[node]):
        if mark[near[at]] != stamp:
            mark[near[at]] = stamp
            count += 1
    for at in range(start[node], start[node] + element_count[node]):
        for member in range(column_start[element[at]], column_start[element[at] + 1]):
            other = column[member]
            if mark[other] != stamp and not eliminated[other]:
                mark[other] = stamp
                count += 1
    return count


@kernel
def minimum_degree(  # type: ignore[no-untyped-def]
    start, near, near_count, element, element_count, order, column_start, column, eliminated, absorbed, mark, heap,
    place, degree,
):  # fmt: skip
    """Order the nodes by minimum degree, ties by lowest index; False where `column` is too short.

    start (n+1), near: neighbours in compressed rows, changed on the way. order (n,): nodes as they are eliminated.
    column_start (n+1), column: for each of them, the nodes still present that it is joined to by then (George, Liu
    1989, quotient graph).
    """
    count = order.shape[0]
    stamp = 0
    for node in range(count):
        stamp += 1
        degree[node] = _count_neighbours(
            node, start, near, near_count, element, element_count, column_start, column, eliminated, mark, stamp
        )
        heap[node] = node
        _sift_up(heap, place, degree, node)
    size = count
    for step in range(count):
        pivot = heap[0]
        size -= 1
        heap[0] = heap[size]
        if size > 0:
            _sift_down(heap, place, degree, 0, size)
        order[step] = pivot
        eliminated[pivot] = True
        stamp += 1
        top = _gather(step, pivot, start, near, near_count, element, element_count, column_start, column, eliminated,
                      absorbed, mark, stamp)  # fmt: skip
        if top < 0:
            return False
        column_start[step + 1] = top
        for at in range(column_start[step], top):
            _prune(step, column[at], start, near, near_count, element, element_count, absorbed, mark, stamp)
        for at in range(column_start[step], top):
            node = column[at]
            stamp += 1
            degree[node] = _count_neighbours(
                node, start, near, near_count, element, element_count, column_start, column, eliminated, mark, stamp
            )
            _sift_up(heap, place, degree, place[node])
            _sift_down(heap, place, degree, place[node], size)
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
