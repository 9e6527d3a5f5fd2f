"""The fallback of a step: f itself (spring_terms.py), minimised by projected Newton: what pushes adds no curvature."""

from sandbox.physics.jit import inner_kernel
from sandbox.physics.solvers.direct.constraint_terms import linearise_shapes, shape_objective, shape_slope
from sandbox.physics.solvers.direct.spring_terms import linearise, objective, solve_linear

# Newton rounds of the minimisation, sufficient decrease (Armijo), halvings of a round, and the relative decrease at
# which it ends. With 3 rounds, a whipping rope can lose most of its motion in one step.
NEWTON_ROUNDS = 10
ARMIJO = 1e-4
NEWTON_HALVINGS = 30
NEWTON_TOLERANCE = 1e-6


@inner_kernel
def copy(first, last, source, destination):  # type: ignore[no-untyped-def]
    for r in range(first, last):
        destination[r, 0] = source[r, 0]
        destination[r, 1] = source[r, 1]


@inner_kernel
def scale(first, last, factor, vector):  # type: ignore[no-untyped-def]
    for r in range(first, last):
        vector[r, 0] *= factor
        vector[r, 1] *= factor


@inner_kernel
def _objective(first_row, last_row, first, last, low, high, rows, springs, shapes, h):  # type: ignore[no-untyped-def]
    springs_hold = objective(first_row, last_row, first, last, rows, springs, h)
    return springs_hold + shape_objective(low, high, rows, shapes, h)


@inner_kernel
def _start_minimisation(first_row, last_row, first, last, low, high, rows, springs, shapes, h):  # type: ignore[no-untyped-def]
    # From the best of the candidate, v* and all at rest; f there.
    copy(first_row, last_row, rows.trial, rows.best)
    lowest = _objective(first_row, last_row, first, last, low, high, rows, springs, shapes, h)
    copy(first_row, last_row, rows.target, rows.trial)
    value = _objective(first_row, last_row, first, last, low, high, rows, springs, shapes, h)
    if not lowest <= value:
        lowest = value
        copy(first_row, last_row, rows.trial, rows.best)
    scale(first_row, last_row, 0.0, rows.trial)
    value = _objective(first_row, last_row, first, last, low, high, rows, springs, shapes, h)
    if lowest <= value:
        copy(first_row, last_row, rows.best, rows.trial)
        value = lowest
    return value


@inner_kernel
def minimise(first_row, last_row, first, last, low, high, rows, springs, shapes, matrix, h):  # type: ignore[no-untyped-def]
    # Newton's method on f with A = M + sum [K n' n'^T + h^2 max(0, t) / l' (I - n' n'^T)].
    value = _start_minimisation(first_row, last_row, first, last, low, high, rows, springs, shapes, h)
    for _ in range(NEWTON_ROUNDS):
        linearise(first, last, rows, springs, h, 1.0, 0.0)
        linearise_shapes(low, high, rows, shapes, h, 1.0, 0.0)
        copy(first_row, last_row, rows.trial, rows.best)
        solve_linear(first_row, last_row, first, last, low, high, rows, springs, shapes, matrix)
        slope = _slope(first_row, last_row, first, last, rows, springs) + shape_slope(low, high, rows, shapes, last_row)
        if not slope < 0.0:
            break
        length = 1.0
        better = False
        for _halving in range(NEWTON_HALVINGS):
            for r in range(first_row, last_row):
                rows.trial[r, 0] = rows.best[r, 0] + length * rows.change[r, 0]
                rows.trial[r, 1] = rows.best[r, 1] + length * rows.change[r, 1]
            reached = _objective(first_row, last_row, first, last, low, high, rows, springs, shapes, h)
            if reached <= value + ARMIJO * length * slope:
                value = reached
                better = True
                break
            length *= 0.5
        if not better:
            copy(first_row, last_row, rows.best, rows.trial)
            break
        if not -slope > NEWTON_TOLERANCE * value:
            break
    keep_tension(first, last, rows, springs, h)


@inner_kernel
def _slope(first_row, last_row, first, last, rows, springs):  # type: ignore[no-untyped-def]
    # -(right side) . D = the derivative of f along D
    free_count = last_row
    total = 0.0
    for r in range(first_row, last_row):
        total -= rows.mass[r] * (
            (rows.target[r, 0] - rows.trial[r, 0]) * rows.change[r, 0]
            + (rows.target[r, 1] - rows.trial[r, 1]) * rows.change[r, 1]
        )
    for k in range(first, last):
        a = springs.row_a[k]
        b = springs.row_b[k]
        jx = springs.impulse[k] * springs.normal[k, 0]
        jy = springs.impulse[k] * springs.normal[k, 1]
        if a < free_count:
            total += jx * rows.change[a, 0] + jy * rows.change[a, 1]
        if b < free_count:
            total -= jx * rows.change[b, 0] + jy * rows.change[b, 1]
    return total


@inner_kernel
def keep_tension(first, last, rows, springs, h):  # type: ignore[no-untyped-def]
    linearise(first, last, rows, springs, h, 1.0, 0.0)
    for k in range(first, last):
        springs.tension[k] = max(0.0, -springs.impulse[k])
