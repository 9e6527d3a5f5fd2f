"""Elimination order of a whole system: body by body, large ones dissected, the others by minimum degree."""

from typing import Annotated, NamedTuple

from sandbox.physics.arena import Arena, give_back, is_full, mark, new_tuple
from sandbox.physics.arrays import Floats, Slots
from sandbox.physics.components import label_linked
from sandbox.physics.jit import inner_kernel
from sandbox.physics.solvers.linear.dissection import (
    TOO_SHORT,
    Dissection,
    Halving,
    begin_dissections,
    dissect,
    new_dissection,
    new_halving,
)
from sandbox.physics.solvers.linear.minimum_degree import FILL_GUESS, Ordering, new_ordering, order_graph
from sandbox.physics.topology.sorting import list_by_key, list_neighbours

# First guess of rows in borders per node; too low costs one more pass, too high memory.
BORDER_GUESS = 8
# Places in `counts`: bodies, fronts, rows in borders, nodes that are ordered by minimum degree, blocks of their factor.
BODIES, FRONTS, BORDERS, SMALL, BLOCKS, COUNTS = range(6)
# Places in `whole` of a Tuning.
SMALLEST, LEAF, HALVED, WIDEST_NARROW = range(4)
# What ordering comes to.
DONE, BORDERS_TOO_SHORT, BLOCKS_TOO_SHORT = range(3)


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
    if nodes.part.shape[0] > 0:
        begin_dissections(nodes)
    for b in range(bodies):
        first, last = made.first_row[b], made.first_row[b + 1]
        if last - first >= smallest:
            for row in range(first, last):
                nodes.by_x[row] = nodes.by_y[row] = made.order[row]
            count = dissect(first, last, count, made.rank, nodes, fronts, leaf, narrowest)
            if count < 0:
                return TOO_SHORT
            for row in range(first, last if count > made.first_front[b] else first):
                made.order[row] = nodes.by_x[row]
        made.first_front[b + 1] = count
    return count


@inner_kernel
def _number_small(bodies: int, made: Elimination) -> int:
    # Number the nodes of bodies without fronts; how many there are. `ends` holds the body of each node.
    small = 0
    for node in range(made.number.shape[0]):
        b = made.ends[node]
        made.number[node] = -1
        if made.first_front[b] == made.first_front[b + 1]:
            made.number[node] = small
            made.row_of[small] = node
            small += 1
    return small


@inner_kernel
def eliminate(
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
    counts[SMALL] = _number_small(bodies, made)
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


class Tuning(NamedTuple):
    """What decides how a system is laid out.

    whole (4,): SMALLEST_BODY, LEAF_SIZE, see dissection.py, WORTH_HALVING, see halves.py, NARROW, see choosing.py;
    narrowest (1,): NARROWEST_BORDER.
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
    made, halving = new_tuple(Elimination, arena, nodes=nodes), new_halving(pairs, links.x, links.y, large, arena)
    scratch = mark(arena)
    fronts, small = new_dissection(large, borders, arena), new_ordering(nodes, pairs, blocks, arena)
    outcome = BLOCKS_TOO_SHORT
    while not is_full(arena) and outcome != DONE:
        outcome = eliminate(
            links, smallest, tuning.narrowest[0], tuning.whole[LEAF], made, halving, fronts, small, counts
        )  # fmt: skip
        if outcome != DONE:
            give_back(arena, scratch)
            blocks *= 2 if outcome == BLOCKS_TOO_SHORT else 1
            borders *= 2 if outcome == BORDERS_TOO_SHORT else 1
            fronts, small = new_dissection(large, borders, arena), new_ordering(nodes, pairs, blocks, arena)
    return Ordered(made, fronts, small)
