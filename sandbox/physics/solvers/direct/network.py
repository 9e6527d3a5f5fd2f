"""A body's network of rows, springs and constraints: loaded, linearised, factored and solved; and f itself minimised.

Each family loops over its own arrays (spring_terms.py, constraint_terms.py); what calls them knows spans alone. Another
family is called here, and nowhere else in this folder.

The matrix is sparse, or in fronts where the body is large. Wide constraints are taken in after the factorisation:
(A + K g g^T)^-1 = A^-1 - z z^T / (1 / K + g . z), z = A^-1 g (Sherman and Morrison 1950). Right sides and solutions are
in `delta_v`.

Directions are taken ahead, by the fast part of velocities: slow motion then keeps its energy.

    s += c,  c = SLOW_SHARE (v' - s);   r += SLOW_SHARE (c - r)                   per step (integrate.py)
    directions at  x + h FAST [(2 - SLOW_SHARE) SLOW_SHARE (v' - s) - (1 - SLOW_SHARE) r]  =  x + h AHEAD (v' - slow)

A transverse mode that turns by theta a step would lose some theta^3 of its energy a radian with s alone, and theta^5
with both. The fallback of a step is projected Newton, f minimised: its matrix is positive definite at every iterate,
since the geometric stiffness of what pushes is left out.
"""

from sandbox.physics.arrays import FloatRows
from sandbox.physics.geometry.rigid import WeightedSums, centre_of, velocity_at, with_point, with_turn
from sandbox.physics.integrate import SLOW_SHARE
from sandbox.physics.jit import inner_kernel
from sandbox.physics.solvers.direct.constraint_terms import (
    assemble_constraints,
    constraint_objective,
    constraint_potential,
    constraint_slope,
    gradient_dot,
    linearise_constraints,
    load_constraints,
    push_constraints,
    restore_constraints,
    unrestored_constraint_energy,
    update_constraints,
)
from sandbox.physics.solvers.direct.spring_terms import (
    assemble_springs,
    assemble_springs_in_fronts,
    linearise_springs,
    load_springs,
    push_springs,
    spring_objective,
    spring_potential,
    spring_slope,
    unrestored_energy,
    update_springs,
)
from sandbox.physics.solvers.direct.system import Rows, Span, System, clear, copy, hold_triangles, kinetic, scale
from sandbox.physics.solvers.inputs import Inputs
from sandbox.physics.solvers.linear.fronts import clear_fronts, solve_fronts
from sandbox.physics.solvers.linear.sparse_ldl import back_substitute, factorise
from sandbox.physics.state import State

# The velocities predicted before a first solve are v + PREDICTOR_GAIN (v - s): where v changes evenly, s lags behind by
# the change of 1 / PREDICTOR_GAIN steps. With a smaller gain, smooth turning takes two solves where one is enough.
PREDICTOR_GAIN = SLOW_SHARE / (1.0 - SLOW_SHARE)
# Newton rounds of the minimisation, sufficient decrease (Armijo), halvings of a round, and the relative decrease at
# which it ends. With 3 rounds, a whipping rope can lose most of its motion in one step.
NEWTON_ROUNDS = 10
ARMIJO = 1e-4
NEWTON_HALVINGS = 30
NEWTON_TOLERANCE = 1e-6
# Below 0.9 it is unstable at the taut end; higher damps swings more.
FAST = 1.2
AHEAD = FAST * SLOW_SHARE * (2.0 - SLOW_SHARE)
CHANGE_BEHIND = (1.0 - SLOW_SHARE) / (SLOW_SHARE * (2.0 - SLOW_SHARE))


@inner_kernel
def load_rows(system: System, state: State, inputs: Inputs, h: float) -> None:
    """Bring every row to the start of a step of h [s], with a first guess of its end in `v`."""
    rows = system.rows
    free_count = system.matrix.diagonal.shape[0]
    for r in range(rows.particle.shape[0]):
        p = rows.particle[r]
        rows.mass[r] = state.mass[p]
        rows.inertia[r] = state.mass[p]
        rows.inverse_mass[r] = state.inverse_mass[p]
        for axis in range(2):
            rows.position[r, axis] = state.position[p, axis]
            rows.x_moved[r, axis] = state.position[p, axis]
            rows.v_star[r, axis] = state.velocity[p, axis]
            rows.v_star_matched[r, axis] = state.velocity[p, axis]
            rows.start[r, axis] = inputs.start[p, axis]
            rows.slow[r, axis] = state.velocity[p, axis]
        if r >= free_count:
            rows.x_moved[r, 0] += state.velocity[p, 0] * h
            rows.x_moved[r, 1] += state.velocity[p, 1] * h
        for axis in range(2):
            rows.v[r, axis] = rows.start[r, axis]
            if r < free_count:
                rows.v[r, axis] += PREDICTOR_GAIN * (rows.start[r, axis] - state.slow_velocity[p, axis])


@inner_kernel
def load(
    span: Span, system: System, state: State, inputs: Inputs, free: bool, auto_substeps: int, h: float
) -> tuple[bool, float]:
    """Load a body's springs and constraints: whether one is underdamped, and their energy.

    free: nothing of it is pinned. See `load_springs`.
    """
    underdamped, moved = load_springs(span, system, state, inputs, auto_substeps, h)
    if span.last_constraint > span.first_constraint:
        more_underdamped, more_moved = load_constraints(span, system, state, inputs, auto_substeps, h)
        underdamped = underdamped or more_underdamped
        moved += more_moved
    if free:
        _predict(span, system, h)
    return underdamped, moved


@inner_kernel
def _predict(span: Span, system: System, h: float) -> None:
    # A first guess of the end of the step of a body without anchors, in `v`. Gravity moves it as a whole: started at v*
    # it falls without rounding. What pulls at a part of it moves that alone or all of it: what f says.
    rows = system.rows
    copy(span, rows.v_star, rows.v)
    first = span.first_row
    x, y = rows.v_star[first, 0] - rows.start[first, 0], rows.v_star[first, 1] - rows.start[first, 1]
    differs = False
    for r in range(first, span.last_row):
        differs = differs or rows.v_star[r, 0] - rows.start[r, 0] != x or rows.v_star[r, 1] - rows.start[r, 1] != y
    if not differs:
        return
    sums = WeightedSums(0.0, 0.0, 0.0, 0.0, 0.0)
    for r in range(first, span.last_row):
        sums = with_point(
            sums, rows.mass[r], rows.position[r, 0], rows.position[r, 1], rows.v_star[r, 0] - rows.start[r, 0],
            rows.v_star[r, 1] - rows.start[r, 1],
        )  # fmt: skip
    motion = centre_of(sums)
    for r in range(first, span.last_row):
        motion = with_turn(
            motion, rows.mass[r], rows.position[r, 0], rows.position[r, 1], rows.v_star[r, 0] - rows.start[r, 0],
            rows.v_star[r, 1] - rows.start[r, 1],
        )  # fmt: skip
    alone = objective(span, system, h)
    for r in range(first, span.last_row):
        u, v = velocity_at(motion, rows.position[r, 0], rows.position[r, 1])
        rows.v[r, 0] = rows.start[r, 0] + u
        rows.v[r, 1] = rows.start[r, 1] + v
    if not objective(span, system, h) < alone:
        copy(span, rows.v_star, rows.v)


@inner_kernel
def find_slow(span: Span, rows: Rows, state: State) -> None:
    """Find what directions ahead leave out of the velocities of one body's rows."""
    for r in range(span.first_row, span.last_row):
        p = rows.particle[r]
        for axis in range(2):
            rows.slow[r, axis] = state.slow_velocity[p, axis] + CHANGE_BEHIND * state.slow_change[p, axis]


@inner_kernel
def linearise(span: Span, system: System, h: float, ahead: float, behind: float) -> None:
    """Bring a body to a linear system about `v`, gradients at x + h (ahead v' - behind s)."""
    linearise_springs(span, system, h, ahead, behind)
    if span.last_constraint > span.first_constraint:
        linearise_constraints(span, system, h, ahead, behind)


@inner_kernel
def solve_linear(span: Span, system: System) -> None:
    """Solve A D = right side for one body as it is linearised; D is left in `delta_v`, the factor in the matrix."""
    # A = M + sum [K n n^T + g (I - n n^T)] + sum K g g^T, of springs and narrow constraints
    rows, matrix, fronts = system.rows, system.matrix, system.fronts
    constrained = span.last_constraint > span.first_constraint
    load_residual(span, system)
    if fronts.of_row[span.first_row] >= 0:
        clear_fronts(span.first_row, span.last_row, rows.inertia, fronts)
        assemble_springs_in_fronts(span, system)
        if constrained:
            assemble_constraints(span, system, True)
        solve_fronts(False, span.last_row, fronts, rows.delta_v)
    else:
        for r in range(span.first_row, span.last_row):
            mass = rows.inertia[r]  # (9)
            matrix.diagonal[r, 0] = mass
            matrix.diagonal[r, 1] = 0.0
            matrix.diagonal[r, 2] = mass
        for at in range(matrix.column_start[span.first_row], matrix.column_start[span.last_row]):
            matrix.lower[at, 0] = 0.0
            matrix.lower[at, 1] = 0.0
            matrix.lower[at, 2] = 0.0
            matrix.lower[at, 3] = 0.0
        assemble_springs(span, system)
        if constrained:
            assemble_constraints(span, system, False)
        factorise(span.first_row, span.last_row, matrix)
        back_substitute(span.first_row, span.last_row, matrix, rows.delta_v)
    if constrained:
        _take_in_wide(span, system)


@inner_kernel
def load_residual(span: Span, system: System) -> None:
    """The right side M (v* - v') + sum of impulses of one body, into `delta_v`."""
    rows = system.rows
    for r in range(span.first_row, span.last_row):
        rows.delta_v[r, 0] = rows.inertia[r] * (rows.v_star_matched[r, 0] - rows.v[r, 0])  # (9)
        rows.delta_v[r, 1] = rows.inertia[r] * (rows.v_star_matched[r, 1] - rows.v[r, 1])
    push_springs(span, system)
    if span.last_constraint > span.first_constraint:
        push_constraints(span, system)


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
        clear(span, rows.delta_v)
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
        constraints.scale[k] = constraints.K[k] / (1.0 + constraints.K[k] * max(0.0, yields))
    copy(span, rows.saved_delta_v, rows.delta_v)
    _correct_wide(span, system, span.last_constraint)


@inner_kernel
def _substitute(span: Span, system: System) -> None:
    # Without wide constraints.
    rows, fronts = system.rows, system.fronts
    if fronts.of_row[span.first_row] >= 0:
        solve_fronts(True, span.last_row, fronts, rows.delta_v)
    else:
        back_substitute(span.first_row, span.last_row, system.matrix, rows.delta_v)


@inner_kernel
def _correct_wide(span: Span, system: System, last: int) -> None:
    # x -= scale (g . x) z, for the wide constraints before the last.  (18)
    rows, constraints = system.rows, system.constraints
    free_count = system.matrix.diagonal.shape[0]
    for k in range(span.first_constraint, last):
        number = constraints.wide[k]
        if number < 0:
            continue
        taken = constraints.scale[k] * gradient_dot(k, constraints, rows.delta_v, free_count)
        for r in range(span.first_row, span.last_row):
            rows.delta_v[r, 0] -= taken * constraints.response[number, r, 0]
            rows.delta_v[r, 1] -= taken * constraints.response[number, r, 1]


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
def update(span: Span, system: System, h: float) -> tuple[float, float, bool]:
    """Bring a body's impulses to `v`, which D has been added to: energy [J] after the step, misfit, if to refine.

    See `update_springs`.
    """
    energy, misfit, rounded = update_springs(span, system, h)
    if span.last_constraint > span.first_constraint:
        energy_of_constraints, missed = update_constraints(span, system, h)
        energy += energy_of_constraints
        misfit = max(misfit, missed)
    return energy, misfit, rounded


@inner_kernel
def keep_tension(span: Span, system: System) -> None:
    """T = max(0, -J) of a body's springs, for what follows."""
    springs = system.springs
    for k in range(span.first_spring, span.last_spring):
        springs.tension[k] = max(0.0, -springs.impulse[k])


@inner_kernel
def find_tension(span: Span, system: System, h: float) -> None:
    """T = max(0, -J) of a body's springs, whose impulses are not known at `v`."""
    linearise_springs(span, system, h, 1.0, 0.0)
    keep_tension(span, system)


@inner_kernel
def potential(span: Span, system: System, position: FloatRows, velocity: FloatRows, time: float, h: float) -> float:
    """Energy of one body's springs and constraints at position + time velocity [J]."""
    of_springs = spring_potential(span, system, position, velocity, system.springs.rest, time, h)
    return of_springs + constraint_potential(span, system, position, velocity, time, h)


@inner_kernel
def returnable(span: Span, system: System, h: float) -> float:
    """What a body's springs, which are to be restored, and constraints can give back after the step [J].

    |D|^2_M / 2 of the motion D that restores them, which the factor of the last linear solve finds, and what they hold
    then.
    """
    rows = system.rows
    clear(span, rows.delta_v)
    push_springs(span, system)
    if span.last_constraint > span.first_constraint:
        restore_constraints(span, system, h)
        push_constraints(span, system)
    solve_again(span, system)
    unrestored = unrestored_energy(span, system, h) + unrestored_constraint_energy(span, system, h)
    return kinetic(span, rows.mass, rows.delta_v) + unrestored


@inner_kernel
def start_potential(span: Span, system: System, h: float) -> float:
    """Energy of one body's springs and constraints before forces, pins and drives have moved [J]."""
    rows = system.rows
    of_springs = spring_potential(span, system, rows.position, rows.start, system.springs.start_rest, 0.0, h)
    return of_springs + constraint_potential(span, system, rows.position, rows.start, 0.0, h)


@inner_kernel
def minimise(span: Span, system: System, h: float) -> None:
    """Bring a body's `v` towards the minimum of f, no triangle turned over, and its springs' tension too."""
    # Newton's method on f with A = M + sum [K n' n'^T + h^2 max(0, t) / l' (I - n' n'^T)].
    rows = system.rows
    # From the best of the candidate, v* and all at rest, none of which turns over a triangle; f there.
    copy(span, rows.v, rows.v_best)
    lowest = objective(span, system, h)
    copy(span, rows.v_star, rows.v)
    hold_triangles(span, system, h)
    value = objective(span, system, h)
    if not lowest <= value:
        lowest = value
        copy(span, rows.v, rows.v_best)
    scale(span, 0.0, rows.v)
    value = objective(span, system, h)
    if lowest <= value:
        copy(span, rows.v_best, rows.v)
        value = lowest
    for _ in range(NEWTON_ROUNDS):
        linearise(span, system, h, 1.0, 0.0)
        copy(span, rows.v, rows.v_best)
        solve_linear(span, system)
        descent = spring_slope(span, system) + constraint_slope(span, system)
        if not descent < 0.0:
            break
        length = 1.0
        better = False
        for _halving in range(NEWTON_HALVINGS):
            for r in range(span.first_row, span.last_row):
                rows.v[r, 0] = rows.v_best[r, 0] + length * rows.delta_v[r, 0]
                rows.v[r, 1] = rows.v_best[r, 1] + length * rows.delta_v[r, 1]
            hold_triangles(span, system, h)
            reached = objective(span, system, h)
            if reached <= value + ARMIJO * length * descent:
                value = reached
                better = True
                break
            length *= 0.5
        if not better:
            copy(span, rows.v_best, rows.v)
            break
        if not -descent > NEWTON_TOLERANCE * value:
            break
    find_tension(span, system, h)


@inner_kernel
def objective(span: Span, system: System, h: float) -> float:
    """f(v') of one body at `v` [J] (spring_terms.py)."""
    springs_hold = spring_objective(span, system, h)
    return springs_hold + constraint_objective(span, system, h)
