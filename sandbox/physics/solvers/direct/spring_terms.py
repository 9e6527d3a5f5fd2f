"""One body's springs as one linear system, and the energies that decide whether its solution is taken.

For 0 < Cd < 1 the article's impulse (Nissen 2019) is, for one spring, identical to

    J = -K (u' + beta x / h),   K = m_r Cd / (1 - Cd) [kg],   beta = Cs / Cd

with u' the velocity error AFTER the step, which is the minimum over v' of

    f(v') = 1/2 |v' - v*|^2_M + sum over springs of [K (x' - x)^2 + K beta (x'^2 - (x' - x)^2)] / (2 h^2)

v* = the velocities after gravity, x' = |d + h (v'_b - v'_a)| - L. Here K is `along`, K beta (which needs no division
by Cd) is `pull`, v* is `target`, v' is `trial`; the directions, rows of the Jacobian, are `normal`, and the geometric
stiffness across them is `across`. A spring of Cs > Cd is underdamped, in code bouncy.
"""

import math

from sandbox.physics.equation import SHORTEST, direction, reduced_mass
from sandbox.physics.jit import inner_kernel, scalar_kernel
from sandbox.physics.solvers.direct.constraint_terms import (
    assemble_shapes,
    correct_wide,
    implicit_masses,
    push_shapes,
    solve_again,
    take_in_wide,
)
from sandbox.physics.solvers.linear.fronts import add_block, clear_fronts
from sandbox.physics.solvers.linear.parallel import solve_fronts
from sandbox.physics.solvers.linear.sparse_ldl import back_substitute, factorise

# A linear solve is refined once where impulses that cancel are this many times those that are left: a violent step. A
# higher bound loses the digits of one spring's step at Cd near 1, a lower one costs time on every step.
CANCELLATION = 300.0
# Refined only where lengths miss what was foreseen by no more than this share: what turns has larger errors than those
# of rounding. Higher costs swinging ropes a tenth of their time, 0 loses one spring's digits.
ROUNDING_MISFIT = 1e-10


@inner_kernel
def load_springs(  # type: ignore[no-untyped-def]
    first, last, body_mass, inverse_mass, rest_length, stiffness, damping, material, tension, rows, springs, least,
    most, parts, h, free_count,
):  # fmt: skip
    """Bring the springs first..last into their scratch; whether any has Cs > Cd, and any a measure that spreads.

    Also their energy [J] once pinned particles have moved. parts: 0, or those of a tick that chooses them, with the
    measures least and most of each spring (energy_norm.py).
    """
    bouncy = False
    spread = False
    moved = 0.0
    for k in range(first, last):
        s = springs.slot[k]
        a = springs.row_a[k]
        b = springs.row_b[k]
        # A hand's spring pulls at the whole body, so that a heavy rope lifts as readily as a light one.
        if material[s] == -1:
            mass = body_mass
        else:
            mass = reduced_mass(inverse_mass[rows.particle[a]], inverse_mass[rows.particle[b]])
        along, pull = implicit_masses(stiffness[s], damping[s], mass)
        springs.along[k] = along
        springs.pull[k] = pull
        if pull > along:
            bouncy = True
        springs.measured[k] = pull
        if parts > 0:
            springs.measured[k] = mass * least[s] / (parts * parts)
            springs.hidden[k] = mass * (most[s] - least[s]) / (parts * parts)
            if most[s] > least[s]:
                spread = True
        dx = rows.position[b, 0] - rows.position[a, 0]
        dy = rows.position[b, 1] - rows.position[a, 1]
        length = math.sqrt(dx * dx + dy * dy)
        springs.length[k] = length
        springs.error[k] = length - rest_length[s]
        springs.tension[k] = tension[s]
        if a >= free_count or b >= free_count:
            dx = rows.moved[b, 0] - rows.moved[a, 0]
            dy = rows.moved[b, 1] - rows.moved[a, 1]
            length = math.sqrt(dx * dx + dy * dy)
        error = (length - rest_length[s]) / h
        moved += 0.5 * springs.measured[k] * error * error
    return bouncy, spread, moved


@inner_kernel
def linearise(first, last, rows, springs, h, ahead, behind):  # type: ignore[no-untyped-def]
    """Directions, transverse masses and impulses of the springs first..last for one linear solve about `trial`.

    Directions are those at x + h (ahead v' - behind s). behind = 0 is Newton's method on f; else the transverse mass
    comes from the springs' `tension` [N s], and never exceeds K.
    """
    for k in range(first, last):
        a = springs.row_a[k]
        b = springs.row_b[k]
        dx = rows.position[b, 0] - rows.position[a, 0]
        dy = rows.position[b, 1] - rows.position[a, 1]
        ux = rows.trial[b, 0] - rows.trial[a, 0]
        uy = rows.trial[b, 1] - rows.trial[a, 1]
        px = dx + h * (ahead * ux - behind * (rows.slow[b, 0] - rows.slow[a, 0]))
        py = dy + h * (ahead * uy - behind * (rows.slow[b, 1] - rows.slow[a, 1]))
        growth = _growth(dx, dy, ux, uy, springs.length[k], h)
        # A spring foreseen to turn over is taken as it lies: else it pushes where it would have to pull.
        if behind > 0.0 and (dx * px + dy * py <= 0.0 or dx * (dx + h * ux) + dy * (dy + h * uy) <= 0.0):
            px = dx
            py = dy
            if springs.length[k] > SHORTEST:
                growth = (dx * ux + dy * uy) / springs.length[k]
        nx, ny, length = direction(px, py, ux, uy)
        springs.normal[k, 0] = nx
        springs.normal[k, 1] = ny
        along = springs.along[k]
        # J = -(K (x' - x) / h + K beta x / h)
        impulse = -(along * growth + springs.pull[k] * springs.error[k] / h)
        springs.impulse[k] = impulse
        springs.foreseen[k] = springs.error[k] + h * growth
        springs.sideways[k] = 0.0
        pulled = springs.tension[k]
        if behind == 0.0:
            pulled = max(0.0, -impulse)
        # h T / l, with T the impulse by which the spring pulls
        across = ahead * h * pulled / length if length > SHORTEST else along
        if behind > 0.0 and not across < along:
            across = along
        springs.across[k] = across


@inner_kernel
def _growth(dx, dy, ux, uy, length, h):  # type: ignore[no-untyped-def]
    # (l' - l) / h = (2 d.u + h u.u) / (l' + l), which does not cancel
    ex = dx + h * ux
    ey = dy + h * uy
    total = math.sqrt(ex * ex + ey * ey) + length
    if total > SHORTEST:
        return (2.0 * (dx * ux + dy * uy) + h * (ux * ux + uy * uy)) / total
    return 0.0


@scalar_kernel
def _block(nx, ny, along, across):  # type: ignore[no-untyped-def]
    # K n n^T + g (I - n n^T)
    more = along - across
    return across + more * nx * nx, more * nx * ny, across + more * ny * ny


@inner_kernel
def assemble_fronts(first_row, last_row, first, last, rows, springs, matrix):  # type: ignore[no-untyped-def]
    """The same matrix as `assemble`, of a large body."""
    clear_fronts(first_row, last_row, rows.inertia, matrix.fronts)
    free_count = matrix.diagonal.shape[0]
    numbers = matrix.fronts.numbers
    diagonal = matrix.fronts.diagonal
    width = matrix.fronts.row_width
    for k in range(first, last):
        xx, xy, yy = _block(springs.normal[k, 0], springs.normal[k, 1], springs.along[k], springs.across[k])
        a = springs.row_a[k]
        b = springs.row_b[k]
        if a < free_count:
            add_block(numbers, diagonal[a], width[a], 1.0, xx, xy, yy)
        if b < free_count:
            add_block(numbers, diagonal[b], width[b], 1.0, xx, xy, yy)
        if springs.block[k] >= 0:
            add_block(numbers, springs.block[k], width[min(a, b)], -1.0, xx, xy, yy)


@inner_kernel
def assemble(first_row, last_row, first, last, rows, springs, matrix):  # type: ignore[no-untyped-def]
    """A = M + sum [K n n^T + g (I - n n^T)]."""
    free_count = matrix.diagonal.shape[0]
    for r in range(first_row, last_row):
        mass = rows.inertia[r]
        matrix.diagonal[r, 0] = mass
        matrix.diagonal[r, 1] = 0.0
        matrix.diagonal[r, 2] = mass
    for at in range(matrix.column_start[first_row], matrix.column_start[last_row]):
        matrix.lower[at, 0] = 0.0
        matrix.lower[at, 1] = 0.0
        matrix.lower[at, 2] = 0.0
        matrix.lower[at, 3] = 0.0
    for k in range(first, last):
        xx, xy, yy = _block(springs.normal[k, 0], springs.normal[k, 1], springs.along[k], springs.across[k])
        a = springs.row_a[k]
        b = springs.row_b[k]
        if a < free_count:
            matrix.diagonal[a, 0] += xx
            matrix.diagonal[a, 1] += xy
            matrix.diagonal[a, 2] += yy
        if b < free_count:
            matrix.diagonal[b, 0] += xx
            matrix.diagonal[b, 1] += xy
            matrix.diagonal[b, 2] += yy
        at = springs.block[k]
        if at >= 0:
            matrix.lower[at, 0] -= xx
            matrix.lower[at, 1] -= xy
            matrix.lower[at, 2] -= xy
            matrix.lower[at, 3] -= yy


@inner_kernel
def load_residual(first_row, last_row, first, last, rows, springs, free_count):  # type: ignore[no-untyped-def]
    """The right side M (v* - v') + sum of the springs' impulses of one body, into `change`."""
    for r in range(first_row, last_row):
        rows.change[r, 0] = rows.inertia[r] * (rows.aim[r, 0] - rows.trial[r, 0])
        rows.change[r, 1] = rows.inertia[r] * (rows.aim[r, 1] - rows.trial[r, 1])
    for k in range(first, last):
        nx = springs.normal[k, 0]
        ny = springs.normal[k, 1]
        jx = springs.impulse[k] * nx - springs.sideways[k] * ny
        jy = springs.impulse[k] * ny + springs.sideways[k] * nx
        a = springs.row_a[k]
        b = springs.row_b[k]
        if a < free_count:
            rows.change[a, 0] -= jx
            rows.change[a, 1] -= jy
        if b < free_count:
            rows.change[b, 0] += jx
            rows.change[b, 1] += jy


@inner_kernel
def solve_linear(first_row, last_row, first, last, low, high, rows, springs, shapes, matrix):  # type: ignore[no-untyped-def]
    """Solve A D = right side for the rows, springs and elements of one body; D is left in `change`."""
    load_residual(first_row, last_row, first, last, rows, springs, matrix.diagonal.shape[0])
    if high > low:
        push_shapes(low, high, rows, shapes, matrix.diagonal.shape[0])
    fronts = matrix.fronts
    if fronts.of_row[first_row] >= 0:
        assemble_fronts(first_row, last_row, first, last, rows, springs, matrix)
        if high > low:
            assemble_shapes(low, high, shapes, matrix, True)
        solve_fronts(False, first_row, last_row, fronts, rows.change)
    else:
        assemble(first_row, last_row, first, last, rows, springs, matrix)
        if high > low:
            assemble_shapes(low, high, shapes, matrix, False)
        factorise(
            first_row, last_row, matrix.column_start, matrix.row, matrix.target_start, matrix.target, matrix.where,
            matrix.diagonal, matrix.lower, matrix.scaled,
        )  # fmt: skip
        back_substitute(
            first_row, last_row, matrix.column_start, matrix.row, matrix.diagonal, matrix.lower, rows.change
        )  # fmt: skip
    if high > low:
        take_in_wide(first_row, last_row, low, high, rows, shapes, matrix)


@inner_kernel
def update_impulses(first, last, rows, springs, rest_length, h, free_count):  # type: ignore[no-untyped-def]
    """Bring one body's springs to `trial`, which D has been added to: J = q - K n.(D_b - D_a), the like across, x'.

    Returned are their energy [J] after the step, the largest difference between a length then and the length foreseen,
    as a share of its length, and whether D wants refining.
    """
    before = 0.0
    after = 0.0
    energy = 0.0
    misfit = 0.0
    for k in range(first, last):
        a = springs.row_a[k]
        b = springs.row_b[k]
        ux = 0.0
        uy = 0.0
        if b < free_count:
            ux += rows.change[b, 0]
            uy += rows.change[b, 1]
        if a < free_count:
            ux -= rows.change[a, 0]
            uy -= rows.change[a, 1]
        nx = springs.normal[k, 0]
        ny = springs.normal[k, 1]
        u = nx * ux + ny * uy
        foreseen = springs.foreseen[k] + h * u
        springs.foreseen[k] = foreseen
        taken = springs.along[k] * u
        springs.impulse[k] -= taken
        springs.sideways[k] -= springs.across[k] * (nx * uy - ny * ux)
        before += abs(taken)
        after += abs(springs.impulse[k])
        dx = rows.position[b, 0] - rows.position[a, 0] + h * (rows.trial[b, 0] - rows.trial[a, 0])
        dy = rows.position[b, 1] - rows.position[a, 1] + h * (rows.trial[b, 1] - rows.trial[a, 1])
        rest = rest_length[springs.slot[k]]
        error = math.sqrt(dx * dx + dy * dy) - rest
        missed = abs(error - foreseen)
        error /= h
        energy += 0.5 * springs.measured[k] * error * error
        extent = rest + springs.length[k]
        # One of rest length 0, such as a hand's, has no strain to be spared.
        if rest > 0.0 and extent > SHORTEST and missed > misfit * extent:
            misfit = missed / extent
    return energy, 2.0 * misfit, before > CANCELLATION * after and 2.0 * misfit < ROUNDING_MISFIT


@inner_kernel
def refine(first_row, last_row, first, last, low, high, rows, springs, shapes, matrix):  # type: ignore[no-untyped-def]
    """Solve for what is left of the right side, with the impulses found so far; it is left in `change`."""
    free_count = matrix.diagonal.shape[0]
    load_residual(first_row, last_row, first, last, rows, springs, free_count)
    if high > low:
        push_shapes(low, high, rows, shapes, free_count)
    solve_again(first_row, last_row, rows, matrix)
    if high > low:
        correct_wide(first_row, last_row, low, high, rows, shapes, free_count)


@inner_kernel
def objective(first_row, last_row, first, last, rows, springs, h):  # type: ignore[no-untyped-def]
    """f(v') of one body at `trial` [J]."""
    total = 0.0
    for r in range(first_row, last_row):
        ux = rows.trial[r, 0] - rows.target[r, 0]
        uy = rows.trial[r, 1] - rows.target[r, 1]
        total += 0.5 * rows.mass[r] * (ux * ux + uy * uy)
    for k in range(first, last):
        a = springs.row_a[k]
        b = springs.row_b[k]
        dx = rows.position[b, 0] - rows.position[a, 0]
        dy = rows.position[b, 1] - rows.position[a, 1]
        ux = rows.trial[b, 0] - rows.trial[a, 0]
        uy = rows.trial[b, 1] - rows.trial[a, 1]
        growth = _growth(dx, dy, ux, uy, springs.length[k], h)
        error = springs.error[k] / h
        after = error + growth
        total += 0.5 * (springs.along[k] * growth * growth + springs.pull[k] * (after * after - growth * growth))
    return total


@inner_kernel
def hold_spin(first_row, last_row, rows):  # type: ignore[no-untyped-def]
    """Take from `trial` the angular momentum that a free body would gain: nothing outside turns it.

    Directions taken ahead turn a body that is violently out of shape. What is taken is a turn as a whole.
    """
    mass = x = y = before = after = inertia = u = v = p = q = 0.0
    for r in range(first_row, last_row):
        m = rows.mass[r]
        mass += m
        x += m * rows.position[r, 0]
        y += m * rows.position[r, 1]
        u += m * rows.target[r, 0]
        v += m * rows.target[r, 1]
        p += m * rows.trial[r, 0]
        q += m * rows.trial[r, 1]
    x /= mass
    y /= mass
    for r in range(first_row, last_row):
        m = rows.mass[r]
        dx = rows.position[r, 0] - x
        dy = rows.position[r, 1] - y
        inertia += m * (dx * dx + dy * dy)
        before += m * (dx * (rows.target[r, 1] - v / mass) - dy * (rows.target[r, 0] - u / mass))
        after += m * (dx * (rows.trial[r, 1] - q / mass) - dy * (rows.trial[r, 0] - p / mass))
    kept = min(max(after, min(0.0, before)), max(0.0, before))
    if kept == after or not inertia > 0.0:
        return
    turn = (kept - after) / inertia
    for r in range(first_row, last_row):
        rows.trial[r, 0] -= turn * (rows.position[r, 1] - y)
        rows.trial[r, 1] += turn * (rows.position[r, 0] - x)


@inner_kernel
def kinetic(first_row, last_row, mass, velocity):  # type: ignore[no-untyped-def]
    """1/2 |v|^2_M of one body [J]."""
    total = 0.0
    for r in range(first_row, last_row):
        total += 0.5 * mass[r] * (velocity[r, 0] * velocity[r, 0] + velocity[r, 1] * velocity[r, 1])
    return total


@inner_kernel
def potential(first, last, position, velocity, springs, weight, rest_length, time, h):  # type: ignore[no-untyped-def]
    """Energy of one body's springs at position + time velocity [J]: sum of weight x^2 / (2 h^2)."""
    total = 0.0
    for k in range(first, last):
        a = springs.row_a[k]
        b = springs.row_b[k]
        dx = position[b, 0] - position[a, 0] + time * (velocity[b, 0] - velocity[a, 0])
        dy = position[b, 1] - position[a, 1] + time * (velocity[b, 1] - velocity[a, 1])
        error = (math.sqrt(dx * dx + dy * dy) - rest_length[springs.slot[k]]) / h
        total += 0.5 * weight[k] * error * error
    return total
