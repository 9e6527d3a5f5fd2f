"""Where the blocks of a sparse matrix lie, and of its factor."""

import numpy as np

from sandbox.physics.jit import inner_kernel, kernel
from sandbox.physics.solvers.linear.minimum_degree import Columns, update_targets
from sandbox.physics.solvers.linear.sparse_ldl import Matrix
from sandbox.physics.state import Slots
from sandbox.physics.topology.sorting import place_among, sort_by_value

# Updates of a factorisation whose places are kept in a table, 4 bytes each; a body of more, some 15,000 particles of a
# lattice, finds them anew in every step: half as fast, without gigabytes.
LARGEST_TABLE = 1 << 25


@inner_kernel
def lay_out_columns(
    order: Slots, columns: Columns, row_of: Slots, column_start: Slots, row: Slots, pairs: Slots, same: Slots,
    spare: Slots,
) -> int:  # fmt: skip
    """Lay out the blocks below the diagonal, by column; how long the longest one is.

    order, columns: of the nodes that were eliminated; row_of: their rows, all others have no blocks. column_start and
    pairs (n+1,): pairs of blocks in all columns before. same (n,), spare (n,): scratch.
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
        sort_by_value(same, row, column_start[j], column_start[j + 1], spare)
    return longest


@kernel
def _lay_out_columns(
    order: Slots, columns: Columns, row_of: Slots, column_start: Slots, row: Slots, pairs: Slots, same: Slots,
    spare: Slots,
) -> int:  # fmt: skip
    return lay_out_columns(order, columns, row_of, column_start, row, pairs, same, spare)


@inner_kernel
def block_below(low: int, high: int, column_start: Slots, row: Slots) -> int:
    """The block that the rows low < high of a sparse matrix share."""
    return place_among(high, row, column_start[low], column_start[low + 1])


@kernel
def find_blocks(row_a: Slots, row_b: Slots, column_start: Slots, row: Slots, block: Slots) -> None:
    """Find the blocks (k,) that rows of a sparse matrix share, row_a[k] and row_b[k], which differ."""
    for k in range(block.shape[0]):
        block[k] = block_below(min(row_a[k], row_b[k]), max(row_a[k], row_b[k]), column_start, row)


def new_matrix(rows: int, order: Slots, columns: Columns, row_of: Slots) -> Matrix:
    """A matrix of so many rows, ready for numbers; order, columns, row_of: see lay_out_columns."""
    blocks = int(columns.start[len(order)])
    column_start, pairs = np.zeros((2, rows + 1), np.int64)
    row, where, same, spare = np.zeros(blocks, np.int64), *np.zeros((3, rows), np.int64)
    longest = _lay_out_columns(order, columns, row_of, column_start, row, pairs, same, spare)
    target = np.zeros(int(pairs[-1]) if pairs[-1] <= LARGEST_TABLE else 0, dtype=np.int32)
    if len(target):
        update_targets(column_start, row, target, where)
    numbers = np.zeros((rows, 3)), np.zeros((blocks, 4)), np.zeros((longest, 4))
    return Matrix(column_start, row, pairs, target, where, *numbers)
