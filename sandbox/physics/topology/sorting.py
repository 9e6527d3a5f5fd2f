"""Stable sorts and lists by key, for what kernels derive from topology: no library's choice is in their order."""

from sandbox.physics.arrays import Floats, Int32s, Slots
from sandbox.physics.jit import inner_kernel


@inner_kernel
def list_by_key(key: Slots, count: int, bound: int, start: Slots, listed: Slots) -> None:
    """List the items 0..count by their keys, ascending: those of key k are listed[start[k]:start[k + 1]].

    key: below `bound`; of an item of a key below 0 nothing is listed. start: `bound` + 1 numbers or more.
    """
    for k in range(bound + 1):
        start[k] = 0
    for item in range(count):
        if key[item] >= 0:
            start[key[item]] += 1
    end_lists(bound, start)
    for back in range(count):
        item = count - 1 - back
        if key[item] >= 0:
            start[key[item]] -= 1
            listed[start[key[item]]] = item


@inner_kernel
def sort_by_key(key: Slots, items: Slots, count: int, bound: int, start: Slots, listed: Slots) -> None:
    """List `count` items by their keys, 0 to below `bound`; those of one key in the order that they have in items.

    key: by item; those of key k are listed[start[k]:start[k + 1]].
    """
    for k in range(bound + 1):
        start[k] = 0
    for at in range(count):
        start[key[items[at]]] += 1
    end_lists(bound, start)
    for back in range(count):
        item = items[count - 1 - back]
        start[key[item]] -= 1
        listed[start[key[item]]] = item


@inner_kernel
def end_lists(bound: int, start: Slots) -> None:
    """Make of the length of each list the place where it ends."""
    total = 0
    for k in range(bound + 1):
        total += start[k]
        start[k] = total


@inner_kernel
def list_ends(
    end_a: Slots | Int32s, end_b: Slots | Int32s, count: int, bound: int, start: Slots, listed: Slots
) -> None:  # fmt: skip
    """List `count` links by both of their ends, ascending: those of node k are listed[start[k]:start[k + 1]]."""
    for k in range(bound + 1):
        start[k] = 0
    for link in range(count):
        start[end_a[link]] += 1
        start[end_b[link]] += 1
    end_lists(bound, start)
    for back in range(count):
        link = count - 1 - back
        start[end_b[link]] -= 1
        listed[start[end_b[link]]] = link
        start[end_a[link]] -= 1
        listed[start[end_a[link]]] = link


@inner_kernel
def list_neighbours(
    end_a: Slots, end_b: Slots, count: int, bound: int, start: Slots, near: Slots, rough: Slots, ends: Slots
) -> None:  # fmt: skip
    """List the neighbours of each of `bound` nodes, ascending, given `count` links; some are there several times.

    Those of node k: near[start[k]:start[k + 1]], as long as 2 `count`. rough: scratch, as long; ends: `bound`.
    """
    for k in range(bound + 1):
        start[k] = 0
    for link in range(count):
        start[end_a[link]] += 1
        start[end_b[link]] += 1
    end_lists(bound, start)
    for link in range(count):
        a = end_a[link]
        b = end_b[link]
        start[a] -= 1
        rough[start[a]] = b
        start[b] -= 1
        rough[start[b]] = a
    # A node is the neighbour of its neighbours: node by node, each is entered in their lists.
    for node in range(bound):
        ends[node] = start[node]
    for node in range(bound):
        for at in range(start[node], start[node + 1]):
            other = rough[at]
            near[ends[other]] = node
            ends[other] += 1


@inner_kernel
def sort_by_value(value: Slots | Floats, order: Slots, begin: int, end: int, merge_buffer: Slots) -> None:
    """Sort order[begin:end] by the value of each, integers or floats; equal ones stay as they are.

    merge_buffer: scratch of that length. By merging runs, from the shortest up.
    """
    width = 1
    while width < end - begin:
        first = begin
        while first + width < end:
            middle = first + width
            if value[order[middle]] < value[order[middle - 1]]:
                _merge(value, order, first, middle, min(middle + width, end), merge_buffer)
            first += 2 * width
        width *= 2


@inner_kernel
def _merge(value: Slots | Floats, order: Slots, first: int, middle: int, last: int, merge_buffer: Slots) -> None:
    # Two sorted runs as one.
    for at in range(first, middle):
        merge_buffer[at - first] = order[at]
    left = 0
    right = middle
    at = first
    while left < middle - first and right < last:
        if value[order[right]] < value[merge_buffer[left]]:
            order[at] = order[right]
            right += 1
        else:
            order[at] = merge_buffer[left]
            left += 1
        at += 1
    while left < middle - first:
        order[at] = merge_buffer[left]
        left += 1
        at += 1


@inner_kernel
def sort_ascending(listed: Slots | Floats, begin: int, end: int) -> None:
    """Sort listed[begin:end] in place, without scratch. Source: Shell 1959, by Knuth's steps."""
    gap = 1
    while 3 * gap < end - begin:
        gap = 3 * gap + 1
    while gap > 0:
        for at in range(begin + gap, end):
            value = listed[at]
            to = at
            while to - gap >= begin and listed[to - gap] > value:
                listed[to] = listed[to - gap]
                to -= gap
            listed[to] = value
        gap //= 3


@inner_kernel
def place_among(value: int, ascending: Slots, begin: int, end: int) -> int:
    """The place of a value in ascending[begin:end], or where it would be inserted."""
    while begin < end:
        middle = (begin + end) // 2
        if ascending[middle] < value:
            begin = middle + 1
        else:
            end = middle
    return begin
