"""Sparse factorisation of the direct solver: L D L^T of a symmetric positive definite matrix of 2x2 blocks."""

from typing import NamedTuple

from sandbox.physics.arrays import FloatRows, Int32s, Slots
from sandbox.physics.jit import inner_kernel

# A pivot that is not above this share of the diagonal it came from is left out (its row does not move): only rounding,
# overflow or NaN bring one there.
SMALLEST_PIVOT = 1e-15


class Matrix(NamedTuple):
    """A symmetric matrix of n rows of 2x2 blocks by columns, then its factor: b blocks below the diagonal."""

    column_start: Slots  # (n + 1,): where each column begins
    row: Slots  # (b,): rows of its blocks
    target_start: Slots  # (n + 1,)
    target: Int32s  # the block that each pair of blocks of a column updates, or empty: found anew then
    where: Slots  # (n,): scratch of that
    diagonal: FloatRows  # (n, 3): symmetric blocks xx, xy, yy
    lower: FloatRows  # (b, 4): blocks below, xx, xy, yx, yy
    scaled: FloatRows  # (longest column, 4): scratch


@inner_kernel
def inverse_pivot(pivot: float, original: float) -> float:
    """1 / pivot; 0 where that is not a positive number of the original's order."""
    # Written so that NaN and infinities give 0.
    return 1.0 / pivot if pivot > SMALLEST_PIVOT * original else 0.0


@inner_kernel
def factorise(first: int, last: int, matrix: Matrix) -> None:
    """Factor the rows first..last in place: diagonal = 1 / d_x, l, 1 / d_y of each row's own two scalars, lower = L.

    Scalars are eliminated one by one: with inverted 2x2 blocks the error would grow with the square of stiffness over
    mass.
    """
    column_start, row, target, where = matrix.column_start, matrix.row, matrix.target, matrix.where
    diagonal, lower, scaled = matrix.diagonal, matrix.lower, matrix.scaled
    for j in range(first, last):
        xx = diagonal[j, 0]
        yy = diagonal[j, 2]
        inverse_x = inverse_pivot(xx, xx)
        slant = diagonal[j, 1] * inverse_x
        inverse_y = inverse_pivot(yy - slant * diagonal[j, 1], yy)
        diagonal[j, 0] = inverse_x
        diagonal[j, 1] = slant
        diagonal[j, 2] = inverse_y
        begin = column_start[j]
        end = column_start[j + 1]
        for at in range(begin, end):
            k = at - begin
            lower[at, 1] -= slant * lower[at, 0]
            lower[at, 3] -= slant * lower[at, 2]
            scaled[k, 0] = lower[at, 0] * inverse_x
            scaled[k, 1] = lower[at, 1] * inverse_y
            scaled[k, 2] = lower[at, 2] * inverse_x
            scaled[k, 3] = lower[at, 3] * inverse_y
        # A_ik -= L_ij D_j L_kj^T for every pair of rows i >= k of the column
        found = matrix.target_start[j]
        known = target.shape[0] > 0
        for at in range(begin, end):
            k = at - begin
            a0 = lower[at, 0]
            a1 = lower[at, 1]
            a2 = lower[at, 2]
            a3 = lower[at, 3]
            i = row[at]
            if not known:
                for block in range(column_start[i], column_start[i + 1]):
                    where[row[block]] = block
            diagonal[i, 0] -= scaled[k, 0] * a0 + scaled[k, 1] * a1
            diagonal[i, 1] -= scaled[k, 0] * a2 + scaled[k, 1] * a3
            diagonal[i, 2] -= scaled[k, 2] * a2 + scaled[k, 3] * a3
            for below in range(k + 1, end - begin):
                block = target[found] if known else where[row[begin + below]]
                found += 1
                lower[block, 0] -= scaled[below, 0] * a0 + scaled[below, 1] * a1
                lower[block, 1] -= scaled[below, 0] * a2 + scaled[below, 1] * a3
                lower[block, 2] -= scaled[below, 2] * a0 + scaled[below, 3] * a1
                lower[block, 3] -= scaled[below, 2] * a2 + scaled[below, 3] * a3
        for at in range(begin, end):
            k = at - begin
            lower[at, 0] = scaled[k, 0]
            lower[at, 1] = scaled[k, 1]
            lower[at, 2] = scaled[k, 2]
            lower[at, 3] = scaled[k, 3]


@inner_kernel
def back_substitute(first: int, last: int, matrix: Matrix, vector: FloatRows) -> None:
    """Solve for the rows first..last of vector (n, 2) in place, with the factor that `factorise` left."""
    column_start, row, diagonal, lower = matrix.column_start, matrix.row, matrix.diagonal, matrix.lower
    for j in range(first, last):
        x = vector[j, 0]
        y = vector[j, 1] - diagonal[j, 1] * x
        vector[j, 1] = y
        for at in range(column_start[j], column_start[j + 1]):
            i = row[at]
            vector[i, 0] -= lower[at, 0] * x + lower[at, 1] * y
            vector[i, 1] -= lower[at, 2] * x + lower[at, 3] * y
    for back in range(last - first):
        j = last - 1 - back
        x = diagonal[j, 0] * vector[j, 0]
        y = diagonal[j, 2] * vector[j, 1]
        for at in range(column_start[j], column_start[j + 1]):
            i = row[at]
            x -= lower[at, 0] * vector[i, 0] + lower[at, 2] * vector[i, 1]
            y -= lower[at, 1] * vector[i, 0] + lower[at, 3] * vector[i, 1]
        vector[j, 0] = x - diagonal[j, 1] * y
        vector[j, 1] = y
