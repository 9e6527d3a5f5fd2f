"""The families of a body's network through one interface: its rows, springs and constraints.

Each family loops over its own arrays; what calls them knows spans alone. Another family is called here, and nowhere
else in this folder.
"""

from sandbox.physics.arrays import FloatRows
from sandbox.physics.integrate import SLOW_SHARE
from sandbox.physics.jit import inner_kernel
from sandbox.physics.solvers.direct.constraint_terms import (
    assemble_constraints,
    constraint_objective,
    constraint_potential,
    constraint_slope,
    floor_potential,
    linearise_constraints,
    load_constraints,
    push_constraints,
    update_constraints,
)
from sandbox.physics.solvers.direct.motion import copy
from sandbox.physics.solvers.direct.spring_terms import (
    assemble_springs,
    assemble_springs_in_fronts,
    linearise_springs,
    load_springs,
    push_springs,
    spring_objective,
    spring_potential,
    spring_slope,
    update_springs,
)
from sandbox.physics.solvers.direct.system import Span, System
from sandbox.physics.solvers.inputs import Inputs
from sandbox.physics.solvers.linear.fronts import clear_fronts
from sandbox.physics.state import State

# The velocities predicted before a first solve are v + PREDICTOR_GAIN (v - s): where v changes evenly, s lags behind by
# the change of 1 / PREDICTOR_GAIN steps. With a smaller gain, smooth turning takes two solves where one is enough.
PREDICTOR_GAIN = SLOW_SHARE / (1.0 - SLOW_SHARE)


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
    rows = system.rows
    # Gravity moves a body without anchors as a whole: started there, it falls without rounding.
    if free:
        copy(span, rows.v_star, rows.v)
    underdamped, moved = load_springs(span, system, state, inputs, auto_substeps, h)
    if span.last_constraint > span.first_constraint:
        more_underdamped, more_moved = load_constraints(span, system, state, inputs, auto_substeps, h)
        underdamped = underdamped or more_underdamped
        moved += more_moved
    return underdamped, moved


@inner_kernel
def linearise(span: Span, system: System, h: float, ahead: float, behind: float) -> None:
    """Bring a body to a linear system about `v`, gradients at x + h (ahead v' - behind s)."""
    linearise_springs(span, system, h, ahead, behind)
    if span.last_constraint > span.first_constraint:
        linearise_constraints(span, system, h, ahead, behind)


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
def assemble(span: Span, system: System) -> None:
    """A = M + sum [K n n^T + g (I - n n^T)] + sum K g g^T, of springs and narrow constraints."""
    rows, matrix = system.rows, system.matrix
    constrained = span.last_constraint > span.first_constraint
    if system.fronts.of_row[span.first_row] >= 0:
        clear_fronts(span.first_row, span.last_row, rows.inertia, system.fronts)
        assemble_springs_in_fronts(span, system)
        if constrained:
            assemble_constraints(span, system, True)
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
def objective(span: Span, system: System, h: float) -> float:
    """f(v') of one body at `v` [J] (spring_terms.py)."""
    springs_hold = spring_objective(span, system, h)
    return springs_hold + constraint_objective(span, system, h)


@inner_kernel
def slope(span: Span, system: System) -> float:
    """The derivative of f along D."""
    return spring_slope(span, system) + constraint_slope(span, system)


@inner_kernel
def _constraint_energy(
    span: Span, system: System, position: FloatRows, velocity: FloatRows, time: float, h: float
) -> float:
    # With what is below its floor.
    return constraint_potential(span, system, position, velocity, system.constraints.k_h2, time, h) + floor_potential(
        span, system, position, velocity, time, h
    )


@inner_kernel
def potential(span: Span, system: System, position: FloatRows, velocity: FloatRows, time: float, h: float) -> float:
    """Energy of one body's springs and constraints at position + time velocity [J]."""
    springs = system.springs
    return spring_potential(span, system, position, velocity, springs.k_h2, springs.rest, time, h) + _constraint_energy(
        span, system, position, velocity, time, h
    )


@inner_kernel
def start_potential(span: Span, system: System, h: float) -> float:
    """Energy of one body's springs and constraints before forces, pins and drives have moved [J]."""
    rows, springs = system.rows, system.springs
    return spring_potential(
        span, system, rows.position, rows.start, springs.k_h2, springs.start_rest, 0.0, h
    ) + _constraint_energy(span, system, rows.position, rows.start, 0.0, h)
