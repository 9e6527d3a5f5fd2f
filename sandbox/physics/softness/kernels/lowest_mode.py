"""The slowest wobble of a form: one number, which says how its springs, areas and bends act together.

    S = sum over springs of m_r n n^T + sum over areas and bends of m g g^T, at rest;   S u = a M u

A form that is stiff without pins has three motions as a whole, of a = 0; the next eigenvalue is its lowest mode. It has
no unit: neither size, nor mass, nor Cs, Cd and h are in it.
"""

import math
from typing import Annotated, NamedTuple

import numpy as np

from sandbox.physics.arena import (
    FIRST_ARENA,
    Arena,
    begin,
    is_full,
    lay_out,
    new_float_rows,
    new_float_tables,
    new_floats,
    new_slots,
    new_tuple,
)
from sandbox.physics.arrays import FloatRows, Floats, FloatTables, Int32s, SlotRows, Slots, empty
from sandbox.physics.constraints import AREA, BEND, evaluate, measure_rest, rest_mass
from sandbox.physics.equation import reduced_mass
from sandbox.physics.jit import Bundle, bundle, inner_kernel, items_of, kernel, set_field, unpack
from sandbox.physics.keeping.equipment import StiffForm
from sandbox.physics.solvers.linear.sparse_ldl import (
    Matrix,
    back_substitute,
    block_below,
    factorise,
    new_matrix,
    order_by_degree,
)

# S + SHIFT M is factored, as S itself has no inverse. A higher one slows the iteration down in slender forms, whose
# lowest modes are as small; a lower one loses digits.
SHIFT = 1e-7
# Iterations end where the eigenvalue changes by less than this share, at the latest after ROUNDS. Modes that lie a
# per cent apart change it by a millionth while the wrong one goes.
CONVERGED = 1e-9
ROUNDS = 200
# A form whose lowest mode is below this is not stiff: it moves without any spring being stretched, to first order.
LEAST_STIFF_MODE = 1e-9
# In place of a mode: the arena is too small.
NO_MODE = -1.0
# Corners of an area or a bend; motions of a form as a whole.
CORNERS = WHOLE_MOTIONS = 3


class ConstraintRows(NamedTuple):
    """Springs, areas and bends alike: first (k+1,) = where corners begin, mass (k,); node (q,), gradient (q, 2)."""

    first: Annotated[Slots, "rows + 1"]
    node: Annotated[Slots, "corners"]
    gradient: Annotated[FloatRows, "corners, 2"]
    mass: Annotated[Floats, "rows"]


class RestScratch(NamedTuple):
    """Corners (q,) of a form as constraints have them: places, inverse masses, weights, numbers; rest (1, 2)."""

    place: Annotated[FloatRows, "corners, 2"]
    inverse_mass: Annotated[Floats, "corners"]
    weight: Annotated[Floats, "corners"]
    corner: Annotated[Int32s, "corners"]
    rest: Annotated[FloatRows, "1, 2"]


@inner_kernel
def _iterate_inversely(
    matrix: Matrix, rows: ConstraintRows, mass: Floats, rigid: FloatTables, vector: FloatRows, right_side: FloatRows
) -> float:
    # x -> (S + SHIFT M)^-1 M x without its motions as a whole; the Rayleigh quotient x S x / x M x of the last x.
    count = mass.shape[0]
    factorise(0, count, matrix)
    quotient = 0.0
    for _ in range(ROUNDS):
        for k in range(rigid.shape[0]):
            along = 0.0
            whole = 0.0
            for i in range(count):
                along += mass[i] * (rigid[k, i, 0] * vector[i, 0] + rigid[k, i, 1] * vector[i, 1])
                whole += mass[i] * (rigid[k, i, 0] * rigid[k, i, 0] + rigid[k, i, 1] * rigid[k, i, 1])
            share = along / whole if whole > 0.0 else 0.0
            for i in range(count):
                vector[i, 0] -= share * rigid[k, i, 0]
                vector[i, 1] -= share * rigid[k, i, 1]
        square = 0.0
        for i in range(count):
            square += mass[i] * (vector[i, 0] * vector[i, 0] + vector[i, 1] * vector[i, 1])
        if not square > 0.0:
            return 0.0
        size = 1.0 / math.sqrt(square)
        for i in range(count):
            vector[i, 0] *= size
            vector[i, 1] *= size
            right_side[i, 0] = mass[i] * vector[i, 0]
            right_side[i, 1] = mass[i] * vector[i, 1]
        last_quotient = quotient
        quotient = 0.0
        for k in range(rows.mass.shape[0]):
            rate = 0.0
            for c in range(rows.first[k], rows.first[k + 1]):
                i = rows.node[c]
                rate += rows.gradient[c, 0] * vector[i, 0] + rows.gradient[c, 1] * vector[i, 1]
            quotient += rows.mass[k] * rate * rate  # (20)
        if abs(quotient - last_quotient) <= CONVERGED * quotient:
            break
        back_substitute(0, count, matrix, right_side)
        for i in range(count):
            vector[i, 0] = right_side[i, 0]
            vector[i, 1] = right_side[i, 1]
    return quotient


@inner_kernel
def new_rows(form: StiffForm, arena: Arena) -> ConstraintRows:
    """Rows of what holds the particles of a form, at their places."""
    springs, others = form.pairs.shape[0], form.areas.shape[0] + form.bends.shape[0]
    corners = 2 * springs + CORNERS * others
    rows = new_tuple(ConstraintRows, arena, rows=springs + others, corners=corners)
    scratch = new_tuple(RestScratch, arena, corners=corners)
    if is_full(arena):
        return rows
    for k in range(springs):
        a, b = form.pairs[k, 0], form.pairs[k, 1]
        dx, dy = form.points[b, 0] - form.points[a, 0], form.points[b, 1] - form.points[a, 1]
        length = math.sqrt(dx * dx + dy * dy)
        # A spring of no length holds nothing.
        x, y = (dx / length, dy / length) if length > 0.0 else (0.0, 0.0)
        rows.first[k + 1] = 2 * (k + 1)
        rows.node[2 * k], rows.node[2 * k + 1] = a, b
        rows.gradient[2 * k, 0], rows.gradient[2 * k, 1] = -x, -y
        rows.gradient[2 * k + 1, 0], rows.gradient[2 * k + 1, 1] = x, y
        rows.mass[k] = reduced_mass(1.0 / form.mass[a], 1.0 / form.mass[b])
    for t in range(form.areas.shape[0]):
        _add_constraint(form, AREA, form.areas, t, springs + t, rows, scratch)
    for t in range(form.bends.shape[0]):
        _add_constraint(form, BEND, form.bends, t, springs + form.areas.shape[0] + t, rows, scratch)
    return rows


@inner_kernel
def _add_constraint(
    form: StiffForm, kind: int, corners: SlotRows, t: int, k: int, rows: ConstraintRows, scratch: RestScratch
) -> None:
    first = rows.first[k]
    last = first + CORNERS
    rows.first[k + 1] = last
    for i in range(CORNERS):
        node, c = corners[t, i], first + i
        rows.node[c], scratch.corner[c] = node, c
        scratch.place[c, 0], scratch.place[c, 1] = form.points[node, 0], form.points[node, 1]
        scratch.inverse_mass[c] = 1.0 / form.mass[node]
    measure_rest(kind, scratch.place, first, last, scratch.rest, 0, scratch.weight)
    evaluate(kind, scratch.place, first, last, scratch.rest, 0, scratch.weight, rows.gradient)
    rows.mass[k] = rest_mass(first, last, scratch.inverse_mass, scratch.corner, scratch.weight)


@inner_kernel
def _add_block(matrix: Matrix, rows: ConstraintRows, k: int, one: int, other: int) -> None:
    # m g g^T of two corners of a row. The row of the block is the later of the two.
    a, b = rows.node[one], rows.node[other]
    later, earlier = (one, other) if a >= b else (other, one)
    x, y = rows.gradient[later, 0], rows.gradient[later, 1]
    weighted_x, weighted_y = rows.mass[k] * rows.gradient[earlier, 0], rows.mass[k] * rows.gradient[earlier, 1]
    if a == b:
        matrix.diagonal[a, 0] += x * weighted_x
        matrix.diagonal[a, 1] += x * weighted_y
        matrix.diagonal[a, 2] += y * weighted_y
        return
    block = block_below(min(a, b), max(a, b), matrix.column_start, matrix.row)
    matrix.lower[block, 0] += x * weighted_x
    matrix.lower[block, 1] += x * weighted_y
    matrix.lower[block, 2] += y * weighted_x
    matrix.lower[block, 3] += y * weighted_y


@inner_kernel
def _assemble(matrix: Matrix, rows: ConstraintRows, springs: int, mass: Floats) -> None:
    # Write S + SHIFT M into the matrix, whose rows the nodes are; each pair of corners of all springs, then of others.
    for i in range(mass.shape[0]):
        matrix.diagonal[i, 0] = matrix.diagonal[i, 2] = SHIFT * mass[i]
        matrix.diagonal[i, 1] = 0.0
    for size in (2, CORNERS):
        begins, ends = (0, springs) if size == 2 else (springs, rows.mass.shape[0])
        for one in range(size):
            for other in range(one + 1):
                for k in range(begins, ends):
                    _add_block(matrix, rows, k, rows.first[k] + one, rows.first[k] + other)


@inner_kernel
def _start(points: FloatRows, mass: Floats, order: Slots, vector: FloatRows, rigid: FloatTables) -> None:
    # A vector (n, 2) that no mode is orthogonal to, and the motions of the whole (3, n, 2); mass: in the order.
    total, sum_x, sum_y, count = 0.0, 0.0, 0.0, mass.shape[0]
    for k in range(count):
        total += mass[k]
        sum_x += mass[k] * points[order[k], 0]
        sum_y += mass[k] * points[order[k], 1]
    largest_x, largest_y = 0.0, 0.0
    for k in range(count):
        vector[k, 0], vector[k, 1] = points[order[k], 0] - sum_x / total, points[order[k], 1] - sum_y / total
        largest_x, largest_y = max(largest_x, abs(vector[k, 0])), max(largest_y, abs(vector[k, 1]))
    largest = max(largest_x, largest_y)
    for k in range(count):
        x, y = vector[k, 0], vector[k, 1]
        if largest > 0.0:
            x, y = x / largest, y / largest
        rigid[0, k, 0] = rigid[1, k, 1] = 1.0
        rigid[0, k, 1] = rigid[1, k, 0] = 0.0
        rigid[2, k, 0], rigid[2, k, 1] = -y, x
        # Fields of every symmetry that bodies have, and something of everything else.
        across, up = _uneven(k), _uneven(count - 1 - k)
        vector[k, 0] = x + 0.3 * y + x * x + 0.8 * x * y + 0.6 * y * y + across
        vector[k, 1] = 0.5 * x - 0.7 * y + 0.9 * x * x + 0.7 * x * y + 0.5 * y * y - up


@inner_kernel
def _uneven(k: int) -> float:
    return (k * 7 % 13 - 6) / 60.0


@inner_kernel
def lowest_mode_in(form: StiffForm, arena: Arena) -> float:
    """The lowest mode of a form; 0 where it is not stiff without pins; NO_MODE: the arena is too small.

    By inverse iteration, in + - * / and square roots of a fixed order: part of what makes a run repeatable.
    """
    count, springs = form.mass.shape[0], form.pairs.shape[0]
    most = springs + CORNERS * (form.areas.shape[0] + form.bends.shape[0])
    rows = new_rows(form, arena)
    link_a, link_b, rank = new_slots(arena, most), new_slots(arena, most), new_slots(arena, count)
    mass = new_floats(arena, count)
    vector, right_side = new_float_rows(arena, count, 2), new_float_rows(arena, count, 2)
    rigid = new_float_tables(arena, WHOLE_MOTIONS, count, 2)
    if is_full(arena):
        return NO_MODE
    # Each pair of corners of a row that are two particles.
    links = 0
    for k in range(rows.mass.shape[0]):
        for one in range(rows.first[k], rows.first[k + 1]):
            for other in range(rows.first[k], one):
                if rows.node[one] != rows.node[other]:
                    link_a[links], link_b[links] = rows.node[one], rows.node[other]
                    links += 1
    ordered = order_by_degree(count, link_a[:links], link_b[:links], arena)
    if is_full(arena):
        return NO_MODE
    for k in range(count):
        rank[ordered.order[k]] = k
        mass[k] = form.mass[ordered.order[k]]
    matrix = new_matrix(count, ordered.order, ordered.columns, rank, arena)
    if is_full(arena):
        return NO_MODE
    for c in range(rows.node.shape[0]):
        rows.node[c] = rank[rows.node[c]]
    _assemble(matrix, rows, springs, mass)
    _start(form.points, mass, ordered.order, vector, rigid)
    found = _iterate_inversely(matrix, rows, mass, rigid, vector, right_side)
    return found if found >= LEAST_STIFF_MODE else 0.0


@kernel
def find_lowest_mode(form: StiffForm, arena: Arena) -> float:
    """`lowest_mode_in` an arena of its own."""
    begin(arena)
    return lowest_mode_in(form, arena)


@kernel
def _lay_out_rows(pointer: Bundle[ConstraintRows], arena: Arena, form: StiffForm) -> None:
    begin(arena)
    made, rows = unpack(pointer), new_rows(form, arena)
    set_field(made, "first", rows.first)
    set_field(made, "node", rows.node)
    set_field(made, "gradient", rows.gradient)
    set_field(made, "mass", rows.mass)


def rows_of(form: StiffForm) -> ConstraintRows:
    """Rows of what holds the particles of a form, at their places."""
    pointer = bundle(empty(ConstraintRows))
    lay_out(_lay_out_rows, pointer, np.zeros(FIRST_ARENA, np.int64), form)
    made: ConstraintRows = items_of(pointer)
    return made
