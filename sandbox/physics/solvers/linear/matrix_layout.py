"""Where the blocks of a sparse matrix lie, and of its factor."""

from sandbox.physics.arena import (
    Arena,
    give_back,
    is_full,
    mark,
    new_float_rows,
    new_int32s,
    new_slots,
)
from sandbox.physics.arrays import Slots
from sandbox.physics.jit import inner_kernel
from sandbox.physics.solvers.linear.minimum_degree import Columns, update_targets
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
