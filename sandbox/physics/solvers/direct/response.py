"""Response of a factored body: how its particles answer to impulses at some of them (Delassus operator)."""

from sandbox.physics.jit import inner_kernel, unsigned
from sandbox.physics.solvers.direct.constraint_terms import correct_wide, solve_again
from sandbox.physics.solvers.direct.newton import copy
from sandbox.physics.solvers.linear.fronts import ONE, TWO, ZERO, subtract_pair


@inner_kernel
def respond(first_row, last_row, low, high, rows, shapes, matrix, vector):  # type: ignore[no-untyped-def]
    """Solve A x = vector for the rows of one body, in place, with the factor that a linear solve has left.

    It takes `change`: the one array that a helping thread knows, and that the body's wide elements correct.
    """
    copy(first_row, last_row, vector, rows.change)
    solve_again(first_row, last_row, rows, matrix)
    if high > low:
        correct_wide(first_row, last_row, low, high, rows, shapes, matrix.diagonal.shape[0])
    copy(first_row, last_row, rows.change, vector)


@inner_kernel
def load_block(k, first_row, last_row, low, high, row, blocks, columns, rows, shapes, matrix, vector):  # type: ignore[no-untyped-def]
    """The response W = P A^-1 P^T of block k, whose points are in the order of their rows; columns, vector: scratch."""
    first = blocks.start[k]
    points = blocks.start[k + 1] - first
    if matrix.fronts.of_row[first_row] >= 0:
        _load_column_wise(
            blocks, first, points, blocks.base[k], first_row, last_row, low, high, row, rows, shapes, matrix, vector
        )
        return
    width = 2 * points
    for at in range((last_row - first_row) * 2 * width):
        columns[at] = 0.0
    for i in range(points):
        at = (row[blocks.point[first + i]] - first_row) * 2 * width + 2 * i
        columns[at] = 1.0
        columns[at + width + 1] = 1.0
    _forward(first_row, last_row, first, points, row, blocks.point, columns, matrix)
    _gather(k, first_row, last_row, first, points, row, blocks, columns, matrix)
    _take_out_wide(low, high, blocks.base[k], first, points, row, blocks, shapes)


@inner_kernel
def _forward(first_row, last_row, first, points, row, point, columns, matrix):  # type: ignore[no-untyped-def]
    # Y = L^-1 P^T, two rows of it for each row of the body; a column begins at its own point.
    width = unsigned(2 * points)
    begun = 0
    for j in range(first_row, last_row):
        while begun < points and row[point[first + begun]] <= j:
            begun += 1
        if begun == 0:
            continue
        end = unsigned(2 * begun)
        upper = unsigned(j - first_row) * TWO * width
        lower = upper + width
        slant = matrix.diagonal[j, 1]
        subtract_pair(columns, lower, columns, upper, upper, slant, 0.0, ZERO, end)
        for at in range(matrix.column_start[j], matrix.column_start[j + 1]):
            target = unsigned(matrix.row[at] - first_row) * TWO * width
            subtract_pair(columns, target, columns, upper, lower, matrix.lower[at, 0], matrix.lower[at, 1], ZERO, end)
            subtract_pair(
                columns, target + width, columns, upper, lower, matrix.lower[at, 2], matrix.lower[at, 3], ZERO, end
            )


@inner_kernel
def _gather(k, first_row, last_row, first, points, row, blocks, columns, matrix):  # type: ignore[no-untyped-def]
    # W = Y^T D^-1 Y: its lower half, then the upper.
    width = unsigned(2 * points)
    base = unsigned(blocks.base[k])
    for at in range(blocks.base[k], blocks.base[k] + 4 * points * points):
        blocks.numbers[at] = 0.0
    begun = 0
    for j in range(first_row, last_row):
        while begun < points and row[blocks.point[first + begun]] <= j:
            begun += 1
        upper = unsigned(j - first_row) * TWO * width
        lower = upper + width
        for c in range(2 * begun):
            i = unsigned(c)
            a = -columns[upper + i] * matrix.diagonal[j, 0]
            b = -columns[lower + i] * matrix.diagonal[j, 2]
            subtract_pair(blocks.numbers, base + i * width, columns, upper, lower, a, b, ZERO, i + ONE)
    for i in range(2 * points):
        for j in range(i):
            blocks.numbers[blocks.base[k] + j * 2 * points + i] = blocks.numbers[blocks.base[k] + i * 2 * points + j]


@inner_kernel
def _take_out_wide(low, high, base, first, points, row, blocks, shapes):  # type: ignore[no-untyped-def]
    # W -= scale (P z) (P z)^T for each wide element, as constraint_terms.py has it of A^-1.
    for k in range(low, high):
        number = shapes.wide[k]
        if number < 0:
            continue
        for i in range(2 * points):
            taken = shapes.scale[number] * shapes.response[number, row[blocks.point[first + i // 2]], i % 2]
            for j in range(2 * points):
                z = shapes.response[number, row[blocks.point[first + j // 2]], j % 2]
                blocks.numbers[base + i * 2 * points + j] -= taken * z


@inner_kernel
def _load_column_wise(  # type: ignore[no-untyped-def]
    blocks, first, points, base, first_row, last_row, low, high, row, rows, shapes, matrix, vector
):
    # A large body has its factor in fronts: one solution for each column.
    for i in range(points):
        for axis in range(2):
            for r in range(first_row, last_row):
                vector[r, 0] = 0.0
                vector[r, 1] = 0.0
            vector[row[blocks.point[first + i]], axis] = 1.0
            respond(first_row, last_row, low, high, rows, shapes, matrix, vector)
            for j in range(points):
                at = base + (2 * j) * 2 * points + 2 * i + axis
                r = row[blocks.point[first + j]]
                blocks.numbers[at] = vector[r, 0]
                blocks.numbers[at + 2 * points] = vector[r, 1]
