"""A body's matrix, factored and solved with: sparse, or in fronts where the body is large.

Wide constraints are taken in after the factorisation: (A + K g g^T)^-1 = A^-1 - z z^T / (1 / K + g . z), z = A^-1 g
(Sherman and Morrison 1950). Right sides and solutions are in `delta_v`.
"""

from sandbox.physics.arrays import FloatRows
from sandbox.physics.jit import inner_kernel
from sandbox.physics.solvers.direct.constraint_terms import gradient_dot
from sandbox.physics.solvers.direct.families import assemble, load_residual
from sandbox.physics.solvers.direct.motion import copy
from sandbox.physics.solvers.direct.system import Span, System
from sandbox.physics.solvers.linear.halves import solve_fronts
from sandbox.physics.solvers.linear.sparse_ldl import back_substitute, factorise


@inner_kernel
def solve_linear(span: Span, system: System) -> None:
    """Solve A D = right side for one body as it is linearised; D is left in `delta_v`, the factor in the matrix."""
    rows, fronts = system.rows, system.fronts
    load_residual(span, system)
    assemble(span, system)
    if fronts.of_row[span.first_row] >= 0:
        solve_fronts(False, span.first_row, span.last_row, fronts, rows.delta_v)
    else:
        factorise(span.first_row, span.last_row, system.matrix)
        back_substitute(span.first_row, span.last_row, system.matrix, rows.delta_v)
    if span.last_constraint > span.first_constraint:
        _take_in_wide(span, system)


@inner_kernel
def refine(span: Span, system: System) -> None:
    """Solve for the rest of the right side, with the impulses found so far; the solution is in `delta_v`."""
    load_residual(span, system)
    solve_again(span, system)


@inner_kernel
def solve_again(span: Span, system: System) -> None:
    """Solve with the matrix as it was factored, wide constraints included, for the right side in `delta_v`."""
    _substitute(span, system)
    if span.last_constraint > span.first_constraint:
        _correct_wide(span, system, span.last_constraint)


@inner_kernel
def respond(span: Span, system: System, vector: FloatRows) -> None:
    """Solve A x = vector for the rows of one body, in place, with the factor that a linear solve has left."""
    copy(span, vector, system.rows.delta_v)
    solve_again(span, system)
    copy(span, system.rows.delta_v, vector)


@inner_kernel
def _substitute(span: Span, system: System) -> None:
    # Without wide constraints.
    rows, fronts = system.rows, system.fronts
    if fronts.of_row[span.first_row] >= 0:
        solve_fronts(True, span.first_row, span.last_row, fronts, rows.delta_v)
    else:
        back_substitute(span.first_row, span.last_row, system.matrix, rows.delta_v)


@inner_kernel
def _take_in_wide(span: Span, system: System) -> None:
    # Find z of each wide constraint of a body from the factored matrix, and correct the solution in `delta_v`.
    rows, constraints = system.rows, system.constraints
    free_count = system.matrix.diagonal.shape[0]
    any_wide = False
    for k in range(span.first_constraint, span.last_constraint):
        if constraints.wide[k] >= 0:
            any_wide = True
    if not any_wide:
        return
    copy(span, rows.delta_v, rows.saved_delta_v)
    for k in range(span.first_constraint, span.last_constraint):
        number = constraints.wide[k]
        if number < 0:
            continue
        for r in range(span.first_row, span.last_row):
            rows.delta_v[r, 0] = 0.0
            rows.delta_v[r, 1] = 0.0
        for c in range(constraints.first[k], constraints.first[k + 1]):
            r = constraints.row[c]
            if r < free_count:
                rows.delta_v[r, 0] = constraints.gradient[c, 0]
                rows.delta_v[r, 1] = constraints.gradient[c, 1]
        _substitute(span, system)
        _correct_wide(span, system, k)
        for r in range(span.first_row, span.last_row):
            constraints.response[number, r, 0] = rows.delta_v[r, 0]
            constraints.response[number, r, 1] = rows.delta_v[r, 1]
        yields = gradient_dot(k, constraints, rows.delta_v, free_count)
        constraints.scale[number] = constraints.K[k] / (1.0 + constraints.K[k] * max(0.0, yields))
    copy(span, rows.saved_delta_v, rows.delta_v)
    _correct_wide(span, system, span.last_constraint)


@inner_kernel
def _correct_wide(span: Span, system: System, last: int) -> None:
    # x -= scale (g . x) z, for the wide constraints before the last.  (18)
    rows, constraints = system.rows, system.constraints
    free_count = system.matrix.diagonal.shape[0]
    for k in range(span.first_constraint, last):
        number = constraints.wide[k]
        if number < 0:
            continue
        taken = constraints.scale[number] * gradient_dot(k, constraints, rows.delta_v, free_count)
        for r in range(span.first_row, span.last_row):
            rows.delta_v[r, 0] -= taken * constraints.response[number, r, 0]
            rows.delta_v[r, 1] -= taken * constraints.response[number, r, 1]
