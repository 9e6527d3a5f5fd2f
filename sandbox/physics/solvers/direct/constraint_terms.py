"""Elements in the network of a body: their part in its linear system and in its energies (see spring_terms.py).

An element stands in f as a spring does, with C for x: K (C' - C)^2 + K beta (C'^2 - (C' - C)^2); its part of the matrix
is K g g^T. That of three corners is added to the matrix. More corners would all be joined with each other, so a wide
element is taken in after the factorisation: (A + K g g^T)^-1 = A^-1 - z z^T / (1 / K + g . z), z = A^-1 g (Sherman and
Morrison 1950).
"""

from typing import NamedTuple

from sandbox.physics.constraints import AREA, area_of, evaluate
from sandbox.physics.jit import inner_kernel, scalar_kernel
from sandbox.physics.solvers.linear.parallel import solve_fronts
from sandbox.physics.solvers.linear.sparse_ldl import back_substitute
from sandbox.physics.world import Floats, Slots

# Cd is capped here, and Cs with it: nearer to 1 springs stretch less, but steps are rejected more often and damp more.
HIGHEST_COEFFICIENT = 1.0 - 1e-7
# A bend misses what was foreseen by so much of this [rad], where an area is held against its own size.
WHOLE_BEND = 1.0


class Shapes(NamedTuple):
    """The elements of the matrix by body: t elements, q corners.

    first (t+1,): where corners begin; row (q,); block (t, 3): where the pairs of a narrow element's corners (0, 1),
    (1, 2), (2, 0) lie, -1: one is pinned; wide (t,): number among the wide elements of the body, -1: narrow.
    rest, weight, stiffness, damping, least and most are those of the step, copied. response (w, n, 2) and scale (w,):
    z and 1 / (1 / K + g . z) of the wide elements. All else is scratch.
    """

    slot: Slots
    kind: Slots
    first: Slots
    row: Slots
    block: Slots
    wide: Slots
    rest: Floats
    weight: Floats
    stiffness: Floats
    damping: Floats
    least: Floats
    most: Floats
    place: Floats
    slope: Floats
    spare: Floats
    along: Floats
    pull: Floats
    measured: Floats
    hidden: Floats
    error: Floats
    foreseen: Floats
    impulse: Floats
    response: Floats
    scale: Floats


@scalar_kernel
def implicit_masses(stiffness, damping, mass):  # type: ignore[no-untyped-def]
    """K and K beta [kg] of a spring whose effective mass is `mass` [kg]; the like of an element."""
    # K = m Cd / (1 - Cd);  K beta = m Cs / (1 - Cd)
    if damping > HIGHEST_COEFFICIENT:
        damping = HIGHEST_COEFFICIENT
        stiffness = min(stiffness, HIGHEST_COEFFICIENT)
    return mass * damping / (1.0 - damping), mass * stiffness / (1.0 - damping)


@inner_kernel
def _look(k, shapes, position, velocity, time):  # type: ignore[no-untyped-def]
    # The corners of an element at position + time velocity.
    for c in range(shapes.first[k], shapes.first[k + 1]):
        r = shapes.row[c]
        shapes.place[c, 0] = position[r, 0] + time * velocity[r, 0]
        shapes.place[c, 1] = position[r, 1] + time * velocity[r, 1]


@inner_kernel
def _error(k, shapes, slope):  # type: ignore[no-untyped-def]
    first = shapes.first[k]
    return evaluate(shapes.kind[k], shapes.place, first, shapes.first[k + 1], shapes.rest, k, shapes.weight, slope)


@inner_kernel
def load_shapes(low, high, inverse_mass, rows, shapes, parts, h):  # type: ignore[no-untyped-def]
    """Bring the elements low..high into their scratch, and return what `load_springs` does of springs."""
    bouncy = False
    spread = False
    moved = 0.0
    for k in range(low, high):
        total = 0.0
        for c in range(shapes.first[k], shapes.first[k + 1]):
            total += inverse_mass[rows.particle[shapes.row[c]]] * shapes.weight[c]
        mass = 1.0 / total if total > 0.0 else 0.0
        along, pull = implicit_masses(shapes.stiffness[k], shapes.damping[k], mass)
        shapes.along[k] = along
        shapes.pull[k] = pull
        if pull > along:
            bouncy = True
        shapes.measured[k] = pull
        shapes.hidden[k] = 0.0
        if parts > 0:
            shapes.measured[k] = mass * shapes.least[k] / (parts * parts)
            shapes.hidden[k] = mass * (shapes.most[k] - shapes.least[k]) / (parts * parts)
            if shapes.most[k] > shapes.least[k]:
                spread = True
        _look(k, shapes, rows.moved, rows.moved, 0.0)
        error = _error(k, shapes, shapes.spare) / h
        moved += 0.5 * shapes.measured[k] * error * error
        _look(k, shapes, rows.position, rows.position, 0.0)
        shapes.error[k] = _error(k, shapes, shapes.spare)
    return bouncy, spread, moved


@inner_kernel
def _growth(k, rows, shapes, h):  # type: ignore[no-untyped-def]
    # (C' - C) / h; of an area dA/dt + h A(v), which does not cancel
    if shapes.kind[k] != AREA:
        _look(k, shapes, rows.position, rows.trial, h)
        return (_error(k, shapes, shapes.spare) - shapes.error[k]) / h
    first = shapes.first[k]
    last = shapes.first[k + 1]
    _look(k, shapes, rows.trial, rows.trial, 0.0)
    growth = h * area_of(shapes.place, first, last)
    base = shapes.row[first]
    before = shapes.row[last - 1]
    here = base
    for c in range(first, last):
        after = shapes.row[c + 1] if c + 1 < last else base
        growth += 0.5 * (
            (rows.position[after, 1] - rows.position[before, 1]) * (rows.trial[here, 0] - rows.trial[base, 0])
            - (rows.position[after, 0] - rows.position[before, 0]) * (rows.trial[here, 1] - rows.trial[base, 1])
        )
        before = here
        here = after
    return growth


@inner_kernel
def linearise_shapes(low, high, rows, shapes, h, ahead, behind):  # type: ignore[no-untyped-def]
    """Gradients and impulses of the elements low..high for one linear solve, as `linearise` gives those of springs."""
    for k in range(low, high):
        for c in range(shapes.first[k], shapes.first[k + 1]):
            r = shapes.row[c]
            for axis in range(2):
                shapes.place[c, axis] = rows.position[r, axis] + h * (
                    ahead * rows.trial[r, axis] - behind * rows.slow[r, axis]
                )
        _error(k, shapes, shapes.slope)
        growth = _growth(k, rows, shapes, h)
        # J = -(K (C' - C) / h + K beta C / h)
        shapes.impulse[k] = -(shapes.along[k] * growth + shapes.pull[k] * shapes.error[k] / h)
        shapes.foreseen[k] = shapes.error[k] + h * growth


@inner_kernel
def _add_block(matrix, fronted, r, s, at, xx, xy, yx, yy):  # type: ignore[no-untyped-def]
    # Row r >= s, column s of the matrix, whose block lies at `at`.
    if fronted:
        # The upper triangle by rows: turned over.
        numbers = matrix.fronts.numbers
        width = matrix.fronts.row_width[s]
        numbers[at] += xx
        numbers[at + 1] += yx
        numbers[at + width] += xy
        numbers[at + width + 1] += yy
    elif r == s:
        matrix.diagonal[r, 0] += xx
        matrix.diagonal[r, 1] += xy
        matrix.diagonal[r, 2] += yy
    else:
        matrix.lower[at, 0] += xx
        matrix.lower[at, 1] += xy
        matrix.lower[at, 2] += yx
        matrix.lower[at, 3] += yy


@inner_kernel
def assemble_shapes(low, high, shapes, matrix, fronted):  # type: ignore[no-untyped-def]
    """Add K g g^T of the narrow elements low..high to an assembled matrix."""
    free_count = matrix.diagonal.shape[0]
    for k in range(low, high):
        if shapes.wide[k] >= 0:
            continue
        first = shapes.first[k]
        for corner in range(3):
            c = first + corner
            r = shapes.row[c]
            gx = shapes.slope[c, 0]
            gy = shapes.slope[c, 1]
            kx = shapes.along[k] * gx
            ky = shapes.along[k] * gy
            if r < free_count:
                at = matrix.fronts.diagonal[r] if fronted else r
                _add_block(matrix, fronted, r, r, at, kx * gx, kx * gy, kx * gy, ky * gy)
            at = shapes.block[k, corner]
            if at >= 0:
                d = first + (corner + 1) % 3
                s = shapes.row[d]
                ex = shapes.slope[d, 0]
                ey = shapes.slope[d, 1]
                if r > s:
                    _add_block(matrix, fronted, r, s, at, kx * ex, kx * ey, ky * ex, ky * ey)
                else:
                    _add_block(matrix, fronted, s, r, at, ex * kx, ex * ky, ey * kx, ey * ky)


@inner_kernel
def along_shape(k, shapes, change, free_count):  # type: ignore[no-untyped-def]
    """g . change of an element."""
    total = 0.0
    for c in range(shapes.first[k], shapes.first[k + 1]):
        r = shapes.row[c]
        if r < free_count:
            total += shapes.slope[c, 0] * change[r, 0] + shapes.slope[c, 1] * change[r, 1]
    return total


@inner_kernel
def push_shapes(low, high, rows, shapes, free_count):  # type: ignore[no-untyped-def]
    """Add the impulses of the elements low..high to the right side, in `change`."""
    for k in range(low, high):
        for c in range(shapes.first[k], shapes.first[k + 1]):
            r = shapes.row[c]
            if r < free_count:
                rows.change[r, 0] += shapes.impulse[k] * shapes.slope[c, 0]
                rows.change[r, 1] += shapes.impulse[k] * shapes.slope[c, 1]


@inner_kernel
def solve_again(first_row, last_row, rows, matrix):  # type: ignore[no-untyped-def]
    """Solve with the matrix as it was factored, for the right side in `change`."""
    fronts = matrix.fronts
    if fronts.of_row[first_row] >= 0:
        solve_fronts(True, first_row, last_row, fronts, rows.change)
        return
    back_substitute(
        first_row, last_row, matrix.column_start, matrix.row, matrix.diagonal, matrix.lower, rows.change
    )  # fmt: skip


@inner_kernel
def take_in_wide(first_row, last_row, low, high, rows, shapes, matrix):  # type: ignore[no-untyped-def]
    """Find z of each wide element of a body from the factored matrix, and correct the solution in `change`."""
    free_count = matrix.diagonal.shape[0]
    any_wide = False
    for k in range(low, high):
        if shapes.wide[k] >= 0:
            any_wide = True
    if not any_wide:
        return
    for r in range(first_row, last_row):
        rows.held[r, 0] = rows.change[r, 0]
        rows.held[r, 1] = rows.change[r, 1]
    for k in range(low, high):
        number = shapes.wide[k]
        if number < 0:
            continue
        for r in range(first_row, last_row):
            rows.change[r, 0] = 0.0
            rows.change[r, 1] = 0.0
        for c in range(shapes.first[k], shapes.first[k + 1]):
            r = shapes.row[c]
            if r < free_count:
                rows.change[r, 0] = shapes.slope[c, 0]
                rows.change[r, 1] = shapes.slope[c, 1]
        solve_again(first_row, last_row, rows, matrix)
        correct_wide(first_row, last_row, low, k, rows, shapes, free_count)
        for r in range(first_row, last_row):
            shapes.response[number, r, 0] = rows.change[r, 0]
            shapes.response[number, r, 1] = rows.change[r, 1]
        yields = along_shape(k, shapes, rows.change, free_count)
        shapes.scale[number] = shapes.along[k] / (1.0 + shapes.along[k] * max(0.0, yields))
    for r in range(first_row, last_row):
        rows.change[r, 0] = rows.held[r, 0]
        rows.change[r, 1] = rows.held[r, 1]
    correct_wide(first_row, last_row, low, high, rows, shapes, free_count)


@inner_kernel
def correct_wide(first_row, last_row, low, high, rows, shapes, free_count):  # type: ignore[no-untyped-def]
    """Correct a solution in `change` for the wide elements low..high."""
    for k in range(low, high):
        number = shapes.wide[k]
        if number < 0:
            continue
        taken = shapes.scale[number] * along_shape(k, shapes, rows.change, free_count)
        for r in range(first_row, last_row):
            rows.change[r, 0] -= taken * shapes.response[number, r, 0]
            rows.change[r, 1] -= taken * shapes.response[number, r, 1]


@inner_kernel
def update_shapes(low, high, rows, shapes, h, free_count):  # type: ignore[no-untyped-def]
    """Bring the elements low..high to `trial`, which D has been added to: their energy [J] after the step and misfit.

    The misfit is the largest difference between C and what was foreseen, as a share of the area, or [rad].
    """
    energy = 0.0
    misfit = 0.0
    for k in range(low, high):
        u = along_shape(k, shapes, rows.change, free_count)
        shapes.foreseen[k] += h * u
        shapes.impulse[k] -= shapes.along[k] * u
        _look(k, shapes, rows.position, rows.trial, h)
        error = _error(k, shapes, shapes.spare)
        extent = WHOLE_BEND
        if shapes.kind[k] == AREA:
            extent = abs(shapes.rest[k, 0]) + abs(shapes.error[k] + shapes.rest[k, 0])
        missed = abs(error - shapes.foreseen[k])
        if missed > misfit * extent and extent > 0.0:
            misfit = missed / extent
        error /= h
        energy += 0.5 * shapes.measured[k] * error * error
    return energy, misfit


@inner_kernel
def shape_objective(low, high, rows, shapes, h):  # type: ignore[no-untyped-def]
    """The elements' part of f(v') at `trial` [J]."""
    total = 0.0
    for k in range(low, high):
        growth = _growth(k, rows, shapes, h)
        after = shapes.error[k] / h + growth
        total += 0.5 * (shapes.along[k] * growth * growth + shapes.pull[k] * (after * after - growth * growth))
    return total


@inner_kernel
def shape_slope(low, high, rows, shapes, free_count):  # type: ignore[no-untyped-def]
    """The elements' part of the derivative of f along D."""
    total = 0.0
    for k in range(low, high):
        total -= shapes.impulse[k] * along_shape(k, shapes, rows.change, free_count)
    return total


@inner_kernel
def shape_potential(low, high, position, velocity, shapes, weight, time, h):  # type: ignore[no-untyped-def]
    """Energy of the elements low..high at position + time velocity [J]: sum of weight C^2 / (2 h^2)."""
    total = 0.0
    for k in range(low, high):
        _look(k, shapes, position, velocity, time)
        error = _error(k, shapes, shapes.spare) / h
        total += 0.5 * weight[k] * error * error
    return total
