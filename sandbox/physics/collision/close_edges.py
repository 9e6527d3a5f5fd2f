"""Which edges of a form lie close to each other without meeting: what may cross first when the form is bent."""

import math
from typing import NamedTuple

from sandbox.physics.arena import Arena, give_back, is_full, mark, new_floats, new_slot_rows, new_slots
from sandbox.physics.arrays import FloatRows, Floats, SlotRows, Slots
from sandbox.physics.geometry.segment import SHORTEST
from sandbox.physics.jit import inner_kernel
from sandbox.physics.topology.sorting import list_by_key, sort_by_value

# Forms of more edges are not looked at, their pairs are too many; of the others so many pairs for each edge are kept.
MOST_EDGES = 160
KEPT = 8
# Classes of distance by which pairs are sorted out before they are sorted.
CLASSES = 64


class CloseEdges(NamedTuple):
    """Pairs of edges of some forms that have no common end and do not cross, the closest first.

    Those of form s: edge[start[s]:start[s + 1]] (k, 2), as far apart as distance [m] (k,). beyond [m] (s,): all others
    of the form are farther apart than this; 0: not known.
    """

    start: Slots
    edge: SlotRows
    distance: Floats
    beyond: Floats


class FormEdges(NamedTuple):
    """Edges a to b (e,) between places of a form [m] (n, 2); shape (n,) of each place; solid_of: see Outline."""

    form: FloatRows
    a: Slots
    b: Slots
    shape: Slots
    solid_of: Slots


class PairScratch(NamedTuple):
    """Scratch. Of edges (e,): key, listed; start (s+1,). Of pairs of one form: one, other, order, spare, distance."""

    key: Slots
    listed: Slots
    start: Slots
    one: Slots
    other: Slots
    order: Slots
    spare: Slots
    distance: Floats


@inner_kernel
def _end_from(edge: int, p: int, given: FormEdges) -> tuple[bool, float]:
    # On which side of the line along an edge a place is, and the square of how far it is from the edge.
    a = given.a[edge]
    form = given.form
    wx = form[given.b[edge], 0] - form[a, 0]
    wy = form[given.b[edge], 1] - form[a, 1]
    x = form[p, 0] - form[a, 0]
    y = form[p, 1] - form[a, 1]
    share = (wx * x + wy * y) * (1.0 / max(wx * wx + wy * wy, SHORTEST))
    is_left = wx * y - wy * x > 0.0
    share = min(max(share, 0.0), 1.0)
    x -= share * wx
    y -= share * wy
    return is_left, x * x + y * y


@inner_kernel
def _apart(one: int, other: int, given: FormEdges) -> float:
    # How far apart two edges are that have no common end and do not cross; -1: they have, or do.
    a = given.a[one]
    b = given.b[one]
    c = given.a[other]
    d = given.b[other]
    if a in (c, d) or b in (c, d):
        return -1.0
    c_left, of_c = _end_from(one, c, given)
    d_left, of_d = _end_from(one, d, given)
    a_left, of_a = _end_from(other, a, given)
    b_left, of_b = _end_from(other, b, given)
    if c_left != d_left and a_left != b_left:
        return -1.0
    return math.sqrt(min(min(of_c, of_d), min(of_a, of_b)))


@inner_kernel
def _sort_closest(count: int, wanted: int, work: PairScratch) -> int:
    # The order of so many of `count` pairs, the closest first, or of more; how many. Only those are sorted that lie in
    # the classes of distance, all alike, that hold the wanted ones.
    farthest = 0.0
    for k in range(count):
        farthest = max(farthest, work.distance[k])
    per_class = (CLASSES - 1.0) / farthest if farthest > 0.0 else 0.0
    for c in range(CLASSES):
        work.spare[c] = 0
    for k in range(count):
        work.spare[math.floor(work.distance[k] * per_class)] += 1
    last = 0
    found = work.spare[0]
    while found < wanted and last + 1 < CLASSES:
        last += 1
        found += work.spare[last]
    found = 0
    for k in range(count):
        if math.floor(work.distance[k] * per_class) <= last:
            work.order[found] = k
            found += 1
    sort_by_value(work.distance, work.order, 0, found, work.spare)
    return found


@inner_kernel
def _find_pairs(first: int, last: int, given: FormEdges, work: PairScratch) -> int:
    # The pairs of edges that may come to cross, of one form, whose edges are listed[first:last]; how many there are.
    count = 0
    for i in range(first, last):
        for j in range(i + 1, last):
            distance = _apart(work.listed[i], work.listed[j], given)
            if distance >= 0.0:
                work.one[count] = work.listed[i]
                work.other[count] = work.listed[j]
                work.distance[count] = distance
                count += 1
    return count


@inner_kernel
def find_close_edges(given: FormEdges, found: CloseEdges, work: PairScratch) -> int:
    """Find the close edges of the forms that are lines alone, solid_of below 0; how many pairs there are."""
    shapes = given.solid_of.shape[0]
    for e in range(given.a.shape[0]):
        work.key[e] = given.shape[given.a[e]]
    list_by_key(work.key, given.a.shape[0], shapes, work.start, work.listed)
    top = 0
    found.start[0] = 0
    for s in range(shapes):
        edges = work.start[s + 1] - work.start[s]
        found.beyond[s] = 0.0
        if given.solid_of[s] < 0 and edges <= MOST_EDGES:
            pairs = _find_pairs(work.start[s], work.start[s + 1], given, work)
            kept = KEPT * edges
            sorted_out = _sort_closest(pairs, kept + 1, work)
            found.beyond[s] = work.distance[work.order[kept]] if kept < pairs else math.inf
            for k in range(min(kept, sorted_out)):
                pair = work.order[k]
                found.edge[top, 0] = work.one[pair]
                found.edge[top, 1] = work.other[pair]
                found.distance[top] = work.distance[pair]
                top += 1
        found.start[s + 1] = top
    return top


@inner_kernel
def no_close_edges(arena: Arena) -> CloseEdges:
    """Lay out an empty list of close edges."""
    return CloseEdges(new_slots(arena, 1), new_slot_rows(arena, 0, 2), new_floats(arena, 0), new_floats(arena, 0))


@inner_kernel
def close_edges(form: FloatRows, a: Slots, b: Slots, shape: Slots, solid_of: Slots, arena: Arena) -> CloseEdges:
    """The close edges, a[k] to b[k], of forms [m] (n, 2); shape (n,): of each place; solid_of (s,): -1: looked at."""
    edges, shapes = a.shape[0], solid_of.shape[0]
    if edges == 0:
        return no_close_edges(arena)
    longest, room = min(edges, MOST_EDGES), KEPT * edges
    pairs = max(longest * longest // 2, CLASSES)
    found = CloseEdges(
        new_slots(arena, shapes + 1), new_slot_rows(arena, room, 2), new_floats(arena, room), new_floats(arena, shapes)
    )
    start = mark(arena)
    work = PairScratch(
        new_slots(arena, edges), new_slots(arena, edges), new_slots(arena, shapes + 1), new_slots(arena, pairs),
        new_slots(arena, pairs), new_slots(arena, pairs), new_slots(arena, pairs), new_floats(arena, pairs),
    )  # fmt: skip
    if is_full(arena):
        return found
    count = find_close_edges(FormEdges(form, a, b, shape, solid_of), found, work)
    give_back(arena, start)
    return CloseEdges(found.start, found.edge[:count], found.distance[:count], found.beyond)
