"""One body's springs in its linear system, and in the energies that decide whether its solution is taken.

The implicit form of the article's impulse (equation.py; Nissen 2019) is, for all springs of a body together, the
minimum over v' of

    f(v') = 1/2 |v' - v*|^2_M + sum over springs of [K (x' - x)^2 + K beta (x'^2 - (x' - x)^2)] / (2 h^2)

v* = the velocities after gravity, x' = |d + h (v'_b - v'_a)| - L. Here v* is `v_star`, v' is `v`. The
Jacobian of a spring's length is its direction n, at its ends with opposite signs.
"""

import math

from sandbox.physics.arrays import FloatRows, Floats
from sandbox.physics.equation import SHORTEST, direction, implicit_impulse, implicit_masses, reduced_mass
from sandbox.physics.geometry.segment import difference
from sandbox.physics.jit import inner_kernel, scalar_kernel
from sandbox.physics.solvers.direct.system import Span, System
from sandbox.physics.solvers.inputs import Inputs
from sandbox.physics.solvers.linear.fronts import add_block
from sandbox.physics.state import State

# A linear solve is refined once where impulses that cancel are this many times those that are left: a violent step. A
# higher bound loses the digits of one spring's step at Cd near 1, a lower one costs time on every step.
CANCELLATION = 300.0
# Refined only where lengths miss what was predicted by no more than this share: what turns has larger errors than those
# of rounding. Higher costs swinging ropes a tenth of their time, 0 loses one spring's digits.
ROUNDING_MISFIT = 1e-10


@inner_kernel
def load_springs(
    span: Span, system: System, state: State, inputs: Inputs, auto_substeps: int, h: float
) -> tuple[bool, float]:
    """Bring the springs of a body into their scratch; whether any has Cs > Cd.

    Also their energy [J] once pinned particles have moved. auto_substeps: those of a tick that chooses their number,
    else 0.
    """
    rows, springs = system.rows, system.springs
    free_count = system.matrix.diagonal.shape[0]
    underdamped = False
    moved = 0.0
    for k in range(span.first_spring, span.last_spring):
        s = springs.slot[k]
        a = springs.row_a[k]
        b = springs.row_b[k]
        mass = reduced_mass(rows.inverse_mass[a], rows.inverse_mass[b])
        stiff, restoring = implicit_masses(inputs.stiffness[s], inputs.damping[s], mass)
        springs.K[k] = stiff
        springs.K_beta[k] = restoring
        if restoring > stiff:
            underdamped = True
        springs.k_h2[k] = restoring
        if auto_substeps > 1:
            # Of the whole tick, to the bit: that of a part has other digits where Cd is near 1.
            _, whole = implicit_masses(state.stiffness[s], state.damping[s], mass)
            springs.k_h2[k] = whole / (auto_substeps * auto_substeps * inputs.drag_factor)
        rest = state.rest_length[s]
        springs.rest[k] = rest
        springs.start_rest[k] = inputs.start_length[s]
        dx, dy = difference(a, b, rows.position)
        length = math.sqrt(dx * dx + dy * dy)
        springs.length[k] = length
        springs.error[k] = length - rest
        springs.tension[k] = state.tension[s]
        if a >= free_count or b >= free_count:
            dx, dy = difference(a, b, rows.x_moved)
            length = math.sqrt(dx * dx + dy * dy)
        error = (length - rest) / h
        moved += 0.5 * springs.k_h2[k] * error * error
    return underdamped, moved


@inner_kernel
def linearise_springs(span: Span, system: System, h: float, ahead: float, behind: float) -> None:
    """Directions, geometric stiffness and impulses of a body's springs for one linear solve about `v`.

    Directions are those at x + h (ahead v' - behind s). behind = 0 is Newton's method on f; else the geometric
    stiffness comes from the springs' `tension` [N s], and never exceeds K.
    """
    rows, springs = system.rows, system.springs
    for k in range(span.first_spring, span.last_spring):
        a = springs.row_a[k]
        b = springs.row_b[k]
        dx, dy = difference(a, b, rows.position)
        ux, uy = difference(a, b, rows.v)
        px = dx + h * (ahead * ux - behind * (rows.slow[b, 0] - rows.slow[a, 0]))  # (11)
        py = dy + h * (ahead * uy - behind * (rows.slow[b, 1] - rows.slow[a, 1]))
        growth = _growth(dx, dy, ux, uy, springs.length[k], h)
        # A spring foreseen to turn over is taken as it lies: else it pushes where it would have to pull. So is one of
        # rest length 0, whose force is linear in where its ends are: taken ahead, an ellipse would become a circle.
        turns_over = dx * px + dy * py <= 0.0 or dx * (dx + h * ux) + dy * (dy + h * uy) <= 0.0
        if behind > 0.0 and (turns_over or springs.rest[k] == 0.0):
            px = dx
            py = dy
            if springs.length[k] > SHORTEST:
                growth = (dx * ux + dy * uy) / springs.length[k]
        nx, ny, length = direction(px, py, ux, uy)
        springs.normal[k, 0] = nx
        springs.normal[k, 1] = ny
        stiff = springs.K[k]
        impulse = implicit_impulse(stiff, springs.K_beta[k], growth, springs.error[k], h)
        springs.impulse[k] = impulse
        springs.predicted[k] = springs.error[k] + h * growth
        springs.tangential[k] = 0.0
        pulled = springs.tension[k]
        if behind == 0.0:
            pulled = max(0.0, -impulse)
        # h T / l, with T the impulse by which the spring pulls  (12)
        transverse = ahead * h * pulled / length if length > SHORTEST else stiff
        if behind > 0.0 and not transverse < stiff:
            transverse = stiff
        springs.transverse[k] = transverse


@scalar_kernel
def _growth(dx: float, dy: float, ux: float, uy: float, length: float, h: float) -> float:
    # (l' - l) / h = (2 d.u + h u.u) / (l' + l), which does not cancel
    ex = dx + h * ux
    ey = dy + h * uy
    total = math.sqrt(ex * ex + ey * ey) + length
    if total > SHORTEST:
        return (2.0 * (dx * ux + dy * uy) + h * (ux * ux + uy * uy)) / total
    return 0.0


@inner_kernel
def assemble_springs(span: Span, system: System) -> None:
    """Add K n n^T + g (I - n n^T) of a body's springs to its matrix, at both ends, and less it between them."""
    springs, matrix = system.springs, system.matrix
    free_count = matrix.diagonal.shape[0]
    for k in range(span.first_spring, span.last_spring):
        xx, xy, yy = _block(springs.normal[k, 0], springs.normal[k, 1], springs.K[k], springs.transverse[k])
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


@scalar_kernel
def _block(nx: float, ny: float, stiff: float, transverse: float) -> tuple[float, float, float]:
    # K n n^T + g (I - n n^T)  (12)
    more = stiff - transverse
    return transverse + more * nx * nx, more * nx * ny, transverse + more * ny * ny


@inner_kernel
def assemble_springs_in_fronts(span: Span, system: System) -> None:
    """`assemble_springs` of a large body, whose matrix lies in fronts."""
    springs, fronts = system.springs, system.fronts
    free_count = system.matrix.diagonal.shape[0]
    numbers = fronts.numbers
    diagonal = fronts.diagonal
    width = fronts.row_width
    for k in range(span.first_spring, span.last_spring):
        xx, xy, yy = _block(springs.normal[k, 0], springs.normal[k, 1], springs.K[k], springs.transverse[k])
        a = springs.row_a[k]
        b = springs.row_b[k]
        if a < free_count:
            add_block(numbers, diagonal[a], width[a], 1.0, xx, xy, yy)
        if b < free_count:
            add_block(numbers, diagonal[b], width[b], 1.0, xx, xy, yy)
        if springs.block[k] >= 0:
            add_block(numbers, springs.block[k], width[min(a, b)], -1.0, xx, xy, yy)


@inner_kernel
def push_springs(span: Span, system: System) -> None:
    """Add the impulses of a body's springs to the right side, in `delta_v`."""
    rows, springs = system.rows, system.springs
    free_count = system.matrix.diagonal.shape[0]
    for k in range(span.first_spring, span.last_spring):
        nx = springs.normal[k, 0]
        ny = springs.normal[k, 1]
        jx = springs.impulse[k] * nx - springs.tangential[k] * ny
        jy = springs.impulse[k] * ny + springs.tangential[k] * nx
        a = springs.row_a[k]
        b = springs.row_b[k]
        if a < free_count:
            rows.delta_v[a, 0] -= jx
            rows.delta_v[a, 1] -= jy
        if b < free_count:
            rows.delta_v[b, 0] += jx
            rows.delta_v[b, 1] += jy


@inner_kernel
def restore_springs(span: Span, system: System, h: float) -> tuple[float, float]:
    """The impulses that bring a body's springs to their lengths from where `v` leads to, for `push_springs`.

    They act along the directions of the last linear solve, whose factor is to answer. Returned are the energy of the
    springs there [J], and the largest share of its length by which one is wrong.
    """
    rows, springs = system.rows, system.springs
    energy = strain = 0.0
    for k in range(span.first_spring, span.last_spring):
        dx, dy = difference(springs.row_a[k], springs.row_b[k], rows.position)
        ux, uy = difference(springs.row_a[k], springs.row_b[k], rows.v)
        dx += h * ux
        dy += h * uy
        error = math.sqrt(dx * dx + dy * dy) - springs.rest[k]
        extent = springs.rest[k] + springs.length[k]
        if extent > SHORTEST:
            strain = max(strain, 2.0 * abs(error) / extent)
        springs.predicted[k] = error
        springs.tangential[k] = 0.0
        mass = reduced_mass(rows.inverse_mass[springs.row_a[k]], rows.inverse_mass[springs.row_b[k]])
        springs.impulse[k] = -restoring_mass(springs.K[k], springs.k_h2[k], mass) * error / h
        error /= h
        energy += 0.5 * springs.k_h2[k] * error * error
    return energy, strain


@inner_kernel
def unrestored_energy(span: Span, system: System, h: float) -> float:
    """What a body's springs hold [J] once the motion in `delta_v` has restored them, each no stiffer than what it
    moves.
    """
    rows, springs = system.rows, system.springs
    free_count = system.matrix.diagonal.shape[0]
    total = 0.0
    for k in range(span.first_spring, span.last_spring):
        a = springs.row_a[k]
        b = springs.row_b[k]
        error = springs.predicted[k] / h
        if b < free_count:
            error += springs.normal[k, 0] * rows.delta_v[b, 0] + springs.normal[k, 1] * rows.delta_v[b, 1]
        if a < free_count:
            error -= springs.normal[k, 0] * rows.delta_v[a, 0] + springs.normal[k, 1] * rows.delta_v[a, 1]
        mass = reduced_mass(rows.inverse_mass[a], rows.inverse_mass[b])
        total += 0.5 * moved_mass(springs.k_h2[k], mass) * error * error
    return total


@scalar_kernel
def restoring_mass(stiff: float, restoring: float, mass: float) -> float:
    """With what [kg] an error counts in A D = right side, so that D is the motion that lowers |D|^2_M + PE most.

    For one spring alone this is exact; stiff: K, restoring: K beta, mass: effective.
    """
    return restoring * (mass + stiff) / (mass + restoring) if mass > 0.0 else 0.0


@scalar_kernel
def moved_mass(restoring: float, mass: float) -> float:
    """With what [kg] an error of one spring alone counts, of which all can come back: the lower of K beta and its
    mass, roughly.
    """
    return restoring * mass / (mass + restoring) if mass > 0.0 else 0.0


@inner_kernel
def update_springs(span: Span, system: System, h: float) -> tuple[float, float, bool]:
    """Bring one body's springs to `v`, which D has been added to: J = q - K n.(D_b - D_a), the like across, x'.

    Returned are their energy [J] after the step, the largest difference between a length then and the length predicted,
    as a share of its length, and whether D wants refining.
    """
    rows, springs = system.rows, system.springs
    free_count = system.matrix.diagonal.shape[0]
    taken_away = 0.0
    remaining = 0.0
    energy = 0.0
    misfit = 0.0
    for k in range(span.first_spring, span.last_spring):
        a = springs.row_a[k]
        b = springs.row_b[k]
        ux = 0.0
        uy = 0.0
        if b < free_count:
            ux += rows.delta_v[b, 0]
            uy += rows.delta_v[b, 1]
        if a < free_count:
            ux -= rows.delta_v[a, 0]
            uy -= rows.delta_v[a, 1]
        nx = springs.normal[k, 0]
        ny = springs.normal[k, 1]
        u = nx * ux + ny * uy
        predicted = springs.predicted[k] + h * u
        springs.predicted[k] = predicted
        taken = springs.K[k] * u
        springs.impulse[k] -= taken
        springs.tangential[k] -= springs.transverse[k] * (nx * uy - ny * ux)
        taken_away += abs(taken)
        remaining += abs(springs.impulse[k])
        dx = rows.position[b, 0] - rows.position[a, 0] + h * (rows.v[b, 0] - rows.v[a, 0])
        dy = rows.position[b, 1] - rows.position[a, 1] + h * (rows.v[b, 1] - rows.v[a, 1])
        rest = springs.rest[k]
        error = math.sqrt(dx * dx + dy * dy) - rest
        missed = abs(error - predicted)
        error /= h
        energy += 0.5 * springs.k_h2[k] * error * error
        extent = rest + springs.length[k]
        # One of rest length 0 has no strain to be spared.
        if rest > 0.0 and extent > SHORTEST and missed > misfit * extent:
            misfit = missed / extent
    return energy, 2.0 * misfit, taken_away > CANCELLATION * remaining and 2.0 * misfit < ROUNDING_MISFIT


@inner_kernel
def spring_objective(span: Span, system: System, h: float) -> float:
    """1/2 |v' - v*|^2_M and the springs' part of f(v') of one body at `v` [J]."""
    rows, springs = system.rows, system.springs
    total = 0.0
    for r in range(span.first_row, span.last_row):
        ux = rows.v[r, 0] - rows.v_star[r, 0]
        uy = rows.v[r, 1] - rows.v_star[r, 1]
        total += 0.5 * rows.mass[r] * (ux * ux + uy * uy)
    for k in range(span.first_spring, span.last_spring):
        a = springs.row_a[k]
        b = springs.row_b[k]
        dx, dy = difference(a, b, rows.position)
        ux, uy = difference(a, b, rows.v)
        growth = _growth(dx, dy, ux, uy, springs.length[k], h)
        error = springs.error[k] / h
        after = error + growth
        # (10)
        total += 0.5 * (springs.K[k] * growth * growth + springs.K_beta[k] * (after * after - growth * growth))
    return total


@inner_kernel
def spring_slope(span: Span, system: System) -> float:
    """The derivative along D of the same."""
    # -(right side) . D
    rows, springs = system.rows, system.springs
    free_count = system.matrix.diagonal.shape[0]
    total = 0.0
    for r in range(span.first_row, span.last_row):
        total -= rows.mass[r] * (
            (rows.v_star[r, 0] - rows.v[r, 0]) * rows.delta_v[r, 0]
            + (rows.v_star[r, 1] - rows.v[r, 1]) * rows.delta_v[r, 1]
        )
    for k in range(span.first_spring, span.last_spring):
        a = springs.row_a[k]
        b = springs.row_b[k]
        jx = springs.impulse[k] * springs.normal[k, 0]
        jy = springs.impulse[k] * springs.normal[k, 1]
        if a < free_count:
            total += jx * rows.delta_v[a, 0] + jy * rows.delta_v[a, 1]
        if b < free_count:
            total -= jx * rows.delta_v[b, 0] + jy * rows.delta_v[b, 1]
    return total


@inner_kernel
def spring_potential(
    span: Span, system: System, position: FloatRows, velocity: FloatRows, rest: Floats, time: float, h: float
) -> float:
    """Energy of one body's springs at position + time velocity [J]; rest (k,): the rest lengths it is measured from."""
    # sum of k h^2 x^2 / (2 h^2)
    springs = system.springs
    total = 0.0
    for k in range(span.first_spring, span.last_spring):
        a = springs.row_a[k]
        b = springs.row_b[k]
        dx = position[b, 0] - position[a, 0] + time * (velocity[b, 0] - velocity[a, 0])
        dy = position[b, 1] - position[a, 1] + time * (velocity[b, 1] - velocity[a, 1])
        error = (math.sqrt(dx * dx + dy * dy) - rest[k]) / h
        total += 0.5 * springs.k_h2[k] * error * error
    return total
