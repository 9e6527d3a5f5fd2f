"""Constraints of many corners (areas and bends) in the network of a body: their part in its linear system and energies.

A constraint stands in f (spring_terms.py) as a spring does, with C for x: K (C' - C)^2 + K beta (C'^2 - (C' - C)^2);
its part of the matrix is K g g^T. That of three corners is added to the matrix. More corners would all be joined with
each other, so a wide constraint is taken in after the factorisation (network.py).

Under the area of every triangle lies a floor: a second spring of the same gradient, x = A - FLOOR A0, only pushing,
J = max(0, -K (u' + b)), b = x / h above it and beta x / h below. It stands in the triangle's own blocks of the matrix
where it is foreseen to push, and has the same strength whatever Cs and Cd are: the softest jelly lies on its floors.
"""

from sandbox.physics.arrays import FloatRows
from sandbox.physics.constraints import (
    AREA,
    FLOOR,
    FLOOR_RATE,
    FLOOR_STRENGTH,
    HIGHEST_RING_COEFFICIENT,
    TRIANGLE,
    evaluate,
)
from sandbox.physics.equation import capped, implicit_impulse, implicit_masses
from sandbox.physics.geometry.segment import polygon_area
from sandbox.physics.jit import inlined_kernel, inner_kernel
from sandbox.physics.solvers.direct.spring_terms import moved_mass, restoring_mass
from sandbox.physics.solvers.direct.system import Constraints, Rows, Span, System
from sandbox.physics.solvers.inputs import Inputs
from sandbox.physics.state import State

# beta of the floor: the part of what is missing to it that a step wants back.
FLOOR_BETA = 0.9
# A bend misses what was predicted by so much of this [rad], where an area is held against its own size.
WHOLE_BEND = 1.0


@inner_kernel
def load_constraints(
    span: Span, system: System, state: State, inputs: Inputs, auto_substeps: int, h: float
) -> tuple[bool, float]:
    """Bring a body's constraints into their scratch, and return what `load_springs` does of springs."""
    rows, constraints = system.rows, system.constraints
    underdamped = False
    moved = 0.0
    for k in range(span.first_constraint, span.last_constraint):
        # What the step's own arrays say of a constraint.
        s = constraints.slot[k]
        constraints.stiffness[k] = inputs.constraint_stiffness[s]
        constraints.damping[k] = inputs.constraint_damping[s]
        for axis in range(2):
            constraints.rest[k, axis] = state.constraint_rest[s, axis]
        for c in range(constraints.first[k], constraints.first[k + 1]):
            constraints.weight[c] = state.corner_weight[constraints.corner[c]]
        mass = _effective_mass(k, rows, constraints)
        constraints.floor[k] = 0.0
        if system.shape_match_groups.group[k] >= 0 and constraints.rest[k, 0] * constraints.rest[k, 1] > 0.0:
            constraints.floor[k] = FLOOR_STRENGTH * mass * (FLOOR_RATE * h) * (FLOOR_RATE * h)
        stiff, restoring = implicit_masses(constraints.stiffness[k], constraints.damping[k], mass)
        constraints.K[k] = stiff
        constraints.K_beta[k] = restoring
        if restoring > stiff:
            underdamped = True
        constraints.k_h2[k] = restoring
        if auto_substeps > 1:
            # K beta [kg] of a constraint in a tick of one part.
            stiffness = state.constraint_stiffness[constraints.slot[k]]
            damping = state.constraint_damping[constraints.slot[k]]
            if constraints.first[k + 1] - constraints.first[k] > TRIANGLE:
                stiffness, damping = capped(stiffness, damping, HIGHEST_RING_COEFFICIENT)
            _, restoring = implicit_masses(stiffness, damping, mass)
            constraints.k_h2[k] = restoring / (auto_substeps * auto_substeps * inputs.drag_factor)
        _look(k, constraints, rows.x_moved, rows.x_moved, 0.0)
        error = _error(k, constraints, constraints.spare)
        moved += _floor_energy(k, constraints, error, h)
        error /= h
        moved += 0.5 * constraints.k_h2[k] * error * error
        _look(k, constraints, rows.position, rows.position, 0.0)
        constraints.error[k] = _error(k, constraints, constraints.spare)
    return underdamped, moved


@inner_kernel
def _look(k: int, constraints: Constraints, position: FloatRows, velocity: FloatRows, time: float) -> None:
    # The corners of a constraint at position + time velocity.
    for c in range(constraints.first[k], constraints.first[k + 1]):
        r = constraints.row[c]
        constraints.place[c, 0] = position[r, 0] + time * velocity[r, 0]
        constraints.place[c, 1] = position[r, 1] + time * velocity[r, 1]


@inner_kernel
def _error(k: int, constraints: Constraints, gradient: FloatRows) -> float:
    # C of the corners that were looked at, and its gradient.
    first = constraints.first[k]
    last = constraints.first[k + 1]
    return evaluate(
        constraints.kind[k], constraints.place, first, last, constraints.rest, k, constraints.weight, gradient
    )  # fmt: skip


@inner_kernel
def _floor_energy(k: int, constraints: Constraints, error: float, h: float) -> float:
    # k min(0, x)^2 / 2
    if not constraints.floor[k] > 0.0:
        return 0.0
    below = min(0.0, _above_floor(k, constraints, error)) / h
    return 0.5 * constraints.floor[k] * below * below


@inlined_kernel
def _above_floor(k: int, constraints: Constraints, error: float) -> float:
    # A - FLOOR A0, turned positive as A0 is.
    above = error + (1.0 - FLOOR) * constraints.rest[k, 0]
    return above if constraints.rest[k, 0] > 0.0 else -above


@inner_kernel
def linearise_constraints(span: Span, system: System, h: float, ahead: float, behind: float) -> None:
    """Gradients and impulses of a body's constraints for one linear solve, as `linearise_springs` has of springs."""
    rows, constraints = system.rows, system.constraints
    for k in range(span.first_constraint, span.last_constraint):
        for c in range(constraints.first[k], constraints.first[k + 1]):
            r = constraints.row[c]
            for axis in range(2):
                constraints.place[c, axis] = rows.position[r, axis] + h * (
                    ahead * rows.v[r, axis] - behind * rows.slow[r, axis]
                )
        _error(k, constraints, constraints.gradient)
        growth = _growth(k, system, h)
        constraints.impulse[k] = implicit_impulse(
            constraints.K[k], constraints.K_beta[k], growth, constraints.error[k], h
        )  # fmt: skip
        constraints.predicted[k] = constraints.error[k] + h * growth
        constraints.K_with_floor[k] = constraints.K[k]
        push = _floor_push(k, constraints, growth, h)
        if push > 0.0:
            constraints.K_with_floor[k] += constraints.floor[k] / FLOOR_BETA
            constraints.impulse[k] += push if constraints.rest[k, 0] > 0.0 else -push


@inner_kernel
def _growth(k: int, system: System, h: float) -> float:
    # (C' - C) / h; of an area dA/dt + h A(v), which does not cancel
    rows, constraints = system.rows, system.constraints
    if constraints.kind[k] != AREA:
        _look(k, constraints, rows.position, rows.v, h)
        return (_error(k, constraints, constraints.spare) - constraints.error[k]) / h
    first = constraints.first[k]
    last = constraints.first[k + 1]
    _look(k, constraints, rows.v, rows.v, 0.0)
    growth = h * polygon_area(constraints.place, first, last)
    base = constraints.row[first]
    previous = constraints.row[last - 1]
    here = base
    for c in range(first, last):
        following = constraints.row[c + 1] if c + 1 < last else base
        growth += 0.5 * (
            (rows.position[following, 1] - rows.position[previous, 1]) * (rows.v[here, 0] - rows.v[base, 0])
            - (rows.position[following, 0] - rows.position[previous, 0]) * (rows.v[here, 1] - rows.v[base, 1])
        )
        previous = here
        here = following
    return growth


@inner_kernel
def _floor_push(k: int, constraints: Constraints, growth: float, h: float) -> float:
    # The impulse of the floor at dA/dt = growth; 0: none, or no triangle.
    if not constraints.floor[k] > 0.0:
        return 0.0
    gap = _above_floor(k, constraints, constraints.error[k]) / h
    if gap < 0.0:
        gap *= FLOOR_BETA
    rate = growth if constraints.rest[k, 0] > 0.0 else -growth
    return max(0.0, -(rate + gap) * constraints.floor[k] / FLOOR_BETA)  # (19)


@inner_kernel
def assemble_constraints(span: Span, system: System, fronted: bool) -> None:
    """Add K g g^T of a body's narrow constraints to its matrix."""
    constraints = system.constraints
    free_count = system.matrix.diagonal.shape[0]
    for k in range(span.first_constraint, span.last_constraint):
        if constraints.wide[k] >= 0:
            continue
        first = constraints.first[k]
        for corner in range(3):
            c = first + corner
            r = constraints.row[c]
            gx = constraints.gradient[c, 0]
            gy = constraints.gradient[c, 1]
            kx = constraints.K_with_floor[k] * gx
            ky = constraints.K_with_floor[k] * gy
            if r < free_count:
                at = system.fronts.diagonal[r] if fronted else r
                _add_block(system, fronted, r, r, at, kx * gx, kx * gy, kx * gy, ky * gy)
            at = constraints.block[k, corner]
            if at >= 0:
                d = first + (corner + 1) % 3
                s = constraints.row[d]
                ex = constraints.gradient[d, 0]
                ey = constraints.gradient[d, 1]
                if r > s:
                    _add_block(system, fronted, r, s, at, kx * ex, kx * ey, ky * ex, ky * ey)
                else:
                    _add_block(system, fronted, s, r, at, ex * kx, ex * ky, ey * kx, ey * ky)


@inner_kernel
def _add_block(
    system: System, fronted: bool, r: int, s: int, at: int, xx: float, xy: float, yx: float, yy: float
) -> None:
    # Row r >= s, column s of the matrix, whose block lies at `at`.
    matrix = system.matrix
    if fronted:
        # The upper triangle by rows: turned over.
        numbers = system.fronts.numbers
        width = system.fronts.row_width[s]
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
def push_constraints(span: Span, system: System) -> None:
    """Add the impulses of a body's constraints to the right side, in `delta_v`."""
    rows, constraints = system.rows, system.constraints
    free_count = system.matrix.diagonal.shape[0]
    for k in range(span.first_constraint, span.last_constraint):
        for c in range(constraints.first[k], constraints.first[k + 1]):
            r = constraints.row[c]
            if r < free_count:
                rows.delta_v[r, 0] += constraints.impulse[k] * constraints.gradient[c, 0]
                rows.delta_v[r, 1] += constraints.impulse[k] * constraints.gradient[c, 1]


@inner_kernel
def restore_constraints(span: Span, system: System, h: float) -> None:
    """The impulses that bring a body's constraints to their rest, as `restore_springs` has of springs."""
    rows, constraints = system.rows, system.constraints
    for k in range(span.first_constraint, span.last_constraint):
        _look(k, constraints, rows.position, rows.v, h)
        constraints.predicted[k] = _error(k, constraints, constraints.spare)
        mass = restoring_mass(constraints.K[k], constraints.k_h2[k], _effective_mass(k, rows, constraints))
        constraints.impulse[k] = -mass * constraints.predicted[k] / h


@inner_kernel
def unrestored_constraint_energy(span: Span, system: System, h: float) -> float:
    """What a body's constraints hold [J] then, as `unrestored_energy` has of springs."""
    rows, constraints = system.rows, system.constraints
    free_count = system.matrix.diagonal.shape[0]
    total = 0.0
    for k in range(span.first_constraint, span.last_constraint):
        error = constraints.predicted[k] / h + gradient_dot(k, constraints, rows.delta_v, free_count)
        total += 0.5 * moved_mass(constraints.k_h2[k], _effective_mass(k, rows, constraints)) * error * error
    return total


@inner_kernel
def _effective_mass(k: int, rows: Rows, constraints: Constraints) -> float:
    total = 0.0
    for c in range(constraints.first[k], constraints.first[k + 1]):
        total += rows.inverse_mass[constraints.row[c]] * constraints.weight[c]
    return 1.0 / total if total > 0.0 else 0.0  # (17)


@inner_kernel
def update_constraints(span: Span, system: System, h: float) -> tuple[float, float]:
    """Bring a body's constraints to `v`, which D has been added to: their energy [J] after the step and misfit.

    The misfit is the largest difference between C and what was predicted, as a share of the area, or [rad]; of a
    triangle that is below its floor, which was not foreseen, the way to it.
    """
    # J = q - K g.D
    rows, constraints = system.rows, system.constraints
    free_count = system.matrix.diagonal.shape[0]
    energy = 0.0
    misfit = 0.0
    for k in range(span.first_constraint, span.last_constraint):
        u = gradient_dot(k, constraints, rows.delta_v, free_count)
        constraints.predicted[k] += h * u
        constraints.impulse[k] -= constraints.K_with_floor[k] * u
        _look(k, constraints, rows.position, rows.v, h)
        error = _error(k, constraints, constraints.spare)
        extent = WHOLE_BEND
        if constraints.kind[k] == AREA:
            extent = abs(constraints.rest[k, 0]) + abs(constraints.error[k] + constraints.rest[k, 0])
        missed = abs(error - constraints.predicted[k])
        if missed > misfit * extent and extent > 0.0:
            misfit = missed / extent
        if constraints.floor[k] > 0.0:
            energy += _floor_energy(k, constraints, error, h)
            if constraints.K_with_floor[k] == constraints.K[k]:
                misfit = max(misfit, -_above_floor(k, constraints, error) / extent)
        error /= h
        energy += 0.5 * constraints.k_h2[k] * error * error
    return energy, misfit


@inner_kernel
def gradient_dot(k: int, constraints: Constraints, delta_v: FloatRows, free_count: int) -> float:
    """g . delta_v of a constraint."""
    total = 0.0
    for c in range(constraints.first[k], constraints.first[k + 1]):
        r = constraints.row[c]
        if r < free_count:
            total += constraints.gradient[c, 0] * delta_v[r, 0] + constraints.gradient[c, 1] * delta_v[r, 1]
    return total


@inner_kernel
def constraint_objective(span: Span, system: System, h: float) -> float:
    """The constraints' part of f(v') of a body at `v` [J]."""
    constraints = system.constraints
    total = 0.0
    for k in range(span.first_constraint, span.last_constraint):
        growth = _growth(k, system, h)
        after = constraints.error[k] / h + growth
        total += 0.5 * (constraints.K[k] * growth * growth + constraints.K_beta[k] * (after * after - growth * growth))
        push = _floor_push(k, constraints, growth, h)
        if push > 0.0:
            total += 0.5 * push * push * FLOOR_BETA / constraints.floor[k]
    return total


@inner_kernel
def constraint_slope(span: Span, system: System) -> float:
    """The constraints' part of the derivative of f along D."""
    constraints = system.constraints
    free_count = system.matrix.diagonal.shape[0]
    total = 0.0
    for k in range(span.first_constraint, span.last_constraint):
        total -= constraints.impulse[k] * gradient_dot(k, constraints, system.rows.delta_v, free_count)
    return total


@inner_kernel
def constraint_potential(
    span: Span, system: System, position: FloatRows, velocity: FloatRows, time: float, h: float
) -> float:
    """Energy of a body's constraints, and of the floors under its triangles, at position + time velocity [J]."""
    # sum of k h^2 C^2 / (2 h^2)
    constraints = system.constraints
    total = of_floors = 0.0
    for k in range(span.first_constraint, span.last_constraint):
        _look(k, constraints, position, velocity, time)
        error = _error(k, constraints, constraints.spare)
        of_floors += _floor_energy(k, constraints, error, h)
        error /= h
        total += 0.5 * constraints.k_h2[k] * error * error
    return total + of_floors
