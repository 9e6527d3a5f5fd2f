"""Where the blocks of a sparse matrix lie, and of its factor."""

from typing import NamedTuple

import numpy as np

from sandbox.physics.arena import (
    FIRST_ARENA,
    Arena,
    begin,
    give_back,
    is_full,
    lay_out,
    mark,
    new_float_rows,
    new_int32s,
    new_slots,
)
from sandbox.physics.arrays import Slots, empty
from sandbox.physics.jit import Bundle, bundle, inner_kernel, items_of, kernel, set_field, unpack
from sandbox.physics.solvers.linear.minimum_degree import Columns, order_by_degree, update_targets
from sandbox.physics.solvers.linear.sparse_ldl import Matrix
from sandbox.physics.topology.sorting import place_among, sort_by_value

# Updates of a factorisation whose places are kept in a table, 4 bytes each; a body of more, some 15,000 particles of a
# lattice, finds them anew in every step: half as fast, without gigabytes.
LARGEST_TABLE = 1 << 25


@inner_kernel
def lay_out_columns(
    order: Slots, columns: Columns, row_of: Slots, column_start: Slots, row: Slots, pairs: Slots, same: Slots,
    merge_buffer: Slots,
) -> int:  # fmt: skip
    """Lay out the blocks below the diagonal, by column; how long the longest one is.

    order, columns: of the nodes that were eliminated; row_of: their rows, all others have no blocks. column_start and
    pairs (n+1,): pairs of blocks in all columns before. same (n,), merge_buffer (n,): scratch.
    """
    rows = same.shape[0]
    for j in range(rows):
        same[j] = j
        column_start[j] = 0
    column_start[rows] = 0
    for step in range(order.shape[0]):
        column_start[row_of[order[step]] + 1] = columns.start[step + 1] - columns.start[step]
    longest = 0
    pairs[0] = 0
    for j in range(rows):
        length = column_start[j + 1]
        longest = max(longest, length)
        pairs[j + 1] = pairs[j] + length * (length - 1) // 2
        column_start[j + 1] += column_start[j]
    for step in range(order.shape[0]):
        j = row_of[order[step]]
        for k in range(columns.start[step + 1] - columns.start[step]):
            row[column_start[j] + k] = row_of[columns.node[columns.start[step] + k]]
        sort_by_value(same, row, column_start[j], column_start[j + 1], merge_buffer)
    return longest


@inner_kernel
def block_below(low: int, high: int, column_start: Slots, row: Slots) -> int:
    """The block that the rows low < high of a sparse matrix share."""
    return place_among(high, row, column_start[low], column_start[low + 1])


@kernel
def find_blocks(row_a: Slots, row_b: Slots, column_start: Slots, row: Slots, block: Slots) -> None:
    """Find the blocks (k,) that rows of a sparse matrix share, row_a[k] and row_b[k], which differ."""
    for k in range(block.shape[0]):
        block[k] = block_below(min(row_a[k], row_b[k]), max(row_a[k], row_b[k]), column_start, row)


@inner_kernel
def new_matrix(rows: int, order: Slots, columns: Columns, row_of: Slots, arena: Arena) -> Matrix:
    """A matrix of so many rows, ready for numbers; order, columns, row_of: see lay_out_columns."""
    blocks = int(columns.start[order.shape[0]])
    column_start, pairs, where = new_slots(arena, rows + 1), new_slots(arena, rows + 1), new_slots(arena, rows)
    row, longest, updates = new_slots(arena, blocks), 0, 0
    scratch = mark(arena)
    same, merge_buffer = new_slots(arena, rows), new_slots(arena, rows)
    if not is_full(arena):
        longest = lay_out_columns(order, columns, row_of, column_start, row, pairs, same, merge_buffer)
        give_back(arena, scratch)
        updates = pairs[rows] if pairs[rows] <= LARGEST_TABLE else 0
    target = new_int32s(arena, updates)
    if updates > 0 and not is_full(arena):
        update_targets(column_start, row, target, where)
    return Matrix(
        column_start, row, pairs, target, where, new_float_rows(arena, rows, 3), new_float_rows(arena, blocks, 4),
        new_float_rows(arena, longest, 4),
    )  # fmt: skip


class GraphMatrix(NamedTuple):
    """The matrix of a graph of n nodes, and the order in which they are eliminated: order (n,) by row, rank by node."""

    matrix: Matrix
    order: Slots
    rank: Slots


@kernel
def _lay_out_graph(pointer: Bundle[GraphMatrix], arena: Arena, nodes: int, link_a: Slots, link_b: Slots) -> None:
    begin(arena)
    made = unpack(pointer)
    ordered, rank = order_by_degree(nodes, link_a, link_b, arena), new_slots(arena, nodes)
    if is_full(arena):
        return
    for row in range(nodes):
        rank[ordered.order[row]] = row
    set_field(made, "order", ordered.order)
    set_field(made, "rank", rank)
    set_field(made, "matrix", new_matrix(nodes, ordered.order, ordered.columns, rank, arena))


def matrix_of_graph(nodes: int, link_a: Slots, link_b: Slots) -> GraphMatrix:
    """A matrix of a block for each node and each link (l,), ready for numbers."""
    pointer = bundle(empty(GraphMatrix))
    lay_out(_lay_out_graph, pointer, np.zeros(FIRST_ARENA, np.int64), nodes, link_a, link_b)
    made: GraphMatrix = items_of(pointer)
    return made
