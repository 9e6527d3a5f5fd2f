"""Direct: the article's spring solved for a whole network at once, with a test that bounds the energy.

spring_terms.py states the equation. A step is one linear solve with the springs' directions taken ahead of the present
ones, less the slow part of the velocity: that damps fast vibration and leaves slow turning alone. It is taken only if
the body's energy stays within what it had plus what its bank holds of earlier losses; else f itself is minimised.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.forces import Before
from sandbox.physics.jit import contents, inner_kernel, kernel
from sandbox.physics.settings import AUTO
from sandbox.physics.solvers.direct.constraint_terms import (
    HIGHEST_COEFFICIENT,
    linearise_shapes,
    update_shapes,
)
from sandbox.physics.solvers.direct.energy_bank import (
    BANK_SHARE,
    BOUNCY_BANK_SHARE,
    SLOW_SHARE,
    body_energy,
    body_hidden,
    load_body,
    load_rows,
    open_bank,
)
from sandbox.physics.solvers.direct.energy_norm import cap, extremes
from sandbox.physics.solvers.direct.newton import copy, keep_tension, minimise, scale
from sandbox.physics.solvers.direct.shape_matching import aim_at_form, find_tangled, let_go
from sandbox.physics.solvers.direct.spring_terms import (
    hold_spin,
    kinetic,
    linearise,
    refine,
    solve_linear,
    update_impulses,
)
from sandbox.physics.solvers.direct.system import Pattern, make_pattern
from sandbox.physics.solvers.linear.parallel import hire
from sandbox.physics.solvers.single_pass import Pair, apply_explicit
from sandbox.physics.world import Floats, World

# Directions are those at x + h AHEAD (v' - s). Lower explodes taut ropes, higher gains nothing.
AHEAD = 0.75
# A body of which a spring, after a linear solve, misses the length that was foreseen by more than this share of it
# times h^2 [1/s^2] (1e-4 at 60 Hz) gets another: what turns fast, a whipping tip or a dragged end, stretches 5 to 20
# times less for it. Lower costs time on every swing, higher stretch; with h^2 so that substeps keep their gain.
MISFIT_RATE = 0.36
# Linear solves of a step at most. With 2, whipping ropes stretch up to 10 times as much and a hundredth of their steps
# has to be minimised; a fourth is hardly ever asked for.
LINEAR_SOLVES = 3
# Relative error of an energy summed over a large body; less rejects steps for rounding alone.
ENERGY_ROUNDING = 1e-12
# Halvings of the velocities before a body is stopped.
LAST_HALVINGS = 60
# The measures of springs where the number of parts is fixed: none.
NOTHING = np.zeros(0)
# The bodies that are solved elsewhere: none.
NOBODY = np.zeros(0, dtype=np.bool_)

Push = Callable[[World, Pattern, Floats, Floats, Floats, Floats, int, float, Before], NDArray[np.bool_]]


@inner_kernel
def _take_candidate(  # type: ignore[no-untyped-def]
    first_row, last_row, first, last, low, high, rows, springs, shapes, matrix, rest_length, free, h
):
    # v' = v + D;  J = q - K n.(D_b - D_a);  T = max(0, -J) for what follows. Returned: H, and the largest misfit.
    free_count = matrix.diagonal.shape[0]
    linearise(first, last, rows, springs, h, AHEAD, AHEAD)
    if high > low:
        linearise_shapes(low, high, rows, shapes, h, AHEAD, AHEAD)
    solve_linear(first_row, last_row, first, last, low, high, rows, springs, shapes, matrix)
    held = 0.0
    misfit = 0.0
    for _refinement in range(2):
        for r in range(first_row, last_row):
            rows.trial[r, 0] += rows.change[r, 0]
            rows.trial[r, 1] += rows.change[r, 1]
        if free and high > low:
            hold_spin(first_row, last_row, rows)
        held, misfit, rounded = update_impulses(first, last, rows, springs, rest_length, h, free_count)
        if high > low:
            held_by_shapes, missed = update_shapes(low, high, rows, shapes, h, free_count)
            held += held_by_shapes
            misfit = max(misfit, missed)
        if not rounded:
            break
        refine(first_row, last_row, first, last, low, high, rows, springs, shapes, matrix)
    for k in range(first, last):
        springs.tension[k] = max(0.0, -springs.impulse[k])
    return kinetic(first_row, last_row, rows.mass, rows.trial) + held, misfit


@inner_kernel
def _step_body(  # type: ignore[no-untyped-def]
    first_row, last_row, first, last, low, high, rows, springs, shapes, matrix, rest_length, rest_before, free,
    tangled, aimed, lowest, bank, bouncy, spread, moved, h,
):  # fmt: skip
    kinetic_after = kinetic(first_row, last_row, rows.mass, rows.target)
    before = kinetic_after + moved
    held = open_bank(
        first_row, last_row, first, last, low, high, rows, springs, shapes, bank, lowest, bouncy, spread,
        kinetic_after, moved, rest_length, rest_before, h,
    )  # fmt: skip
    allowed = before * (1.0 + ENERGY_ROUNDING) + held
    after = 0.0
    solves = 0
    while solves < LINEAR_SOLVES:
        once = after
        within = solves > 0 and once <= allowed
        if within:
            copy(first_row, last_row, rows.trial, rows.best)
        after, misfit = _take_candidate(
            first_row, last_row, first, last, low, high, rows, springs, shapes, matrix, rest_length, free, h
        )
        solves += 1
        if within and not after <= allowed:
            copy(first_row, last_row, rows.best, rows.trial)
            keep_tension(first, last, rows, springs, h)
            after = once
            break
        if after <= allowed and not misfit > MISFIT_RATE * h * h:
            break
        if aimed and solves == LINEAR_SOLVES and not after <= allowed:
            # Without the goal, from the start.
            aimed = False
            solves = 0
            let_go(first_row, last_row, rows)
            copy(first_row, last_row, rows.target, rows.trial)
    if not after <= allowed:
        minimise(first_row, last_row, first, last, low, high, rows, springs, shapes, matrix, h)
        after = body_energy(first_row, last_row, first, last, low, high, rows, springs, shapes, rest_length, h)
        if not after <= allowed:
            after = _brake(
                first_row, last_row, first, last, low, high, rows, springs, shapes, rest_length, allowed, h
            )  # fmt: skip
    share = BOUNCY_BANK_SHARE if bouncy else BANK_SHARE
    limit = share * before
    if spread:
        limit += body_hidden(first, last, low, high, rows.position, rows.trial, springs, shapes, rest_length, h, h)
    saved = held + before - after
    # A tangled body keeps all that it lost for the way back to its form; one that hands move, no more than others do.
    if not (tangled and free):
        saved = min(saved, limit)
    bank[lowest] = saved if saved > 0.0 else 0.0


@inner_kernel
def _brake(  # type: ignore[no-untyped-def]
    first_row, last_row, first, last, low, high, rows, springs, shapes, rest_length, allowed, h
):
    # Halve the free velocities until the energy test holds; at rest it always does.
    after = 0.0
    for _halving in range(LAST_HALVINGS):
        scale(first_row, last_row, 0.5, rows.trial)
        after = body_energy(first_row, last_row, first, last, low, high, rows, springs, shapes, rest_length, h)
        if after <= allowed:
            break
    if not after <= allowed:
        for r in range(first_row, last_row):
            rows.trial[r, 0] = 0.0
            rows.trial[r, 1] = 0.0
        after = body_energy(first_row, last_row, first, last, low, high, rows, springs, shapes, rest_length, h)
    keep_tension(first, last, rows, springs, h)
    return after


@kernel
def _solve_bodies(  # type: ignore[no-untyped-def]
    position, velocity, mass, inverse_mass, slow_velocity, energy_bank, particle_active, rest_length, stiffness,
    damping, material, tension, numbers, least, most, parts, before, rest_before, h, touched,
):  # fmt: skip
    bodies, rows, springs, shapes, matrix, goals = contents(numbers)
    load_rows(position, velocity, mass, slow_velocity, before, h, matrix.diagonal.shape[0], rows)
    for body in range(bodies.lowest.shape[0]):
        if touched.shape[0] > 0 and touched[body]:
            continue
        first_row = bodies.row_start[body]
        last_row = bodies.row_start[body + 1]
        first = bodies.spring_start[body]
        last = bodies.spring_start[body + 1]
        low = bodies.shape_start[body]
        high = bodies.shape_start[body + 1]
        free = not bodies.anchored[body]
        bouncy, spread, moved = load_body(
            first_row, last_row, first, last, low, high, free, inverse_mass, rest_length, stiffness, damping, material,
            tension, rows, springs, shapes, least, most, parts, h, matrix.diagonal.shape[0],
        )  # fmt: skip
        tangled = False
        aimed = False
        if high > low:
            tangled = find_tangled(body, low, high, rows, shapes, goals)
            if tangled:
                aimed = aim_at_form(
                    body, last_row - first_row, not free, rows, shapes, goals, h, matrix.diagonal.shape[0]
                )  # fmt: skip
        _step_body(
            first_row, last_row, first, last, low, high, rows, springs, shapes, matrix, rest_length, rest_before, free,
            tangled, aimed, bodies.lowest[body], energy_bank, bouncy, spread, moved, h,
        )  # fmt: skip
        for r in range(first_row, last_row):
            velocity[rows.particle[r], 0] = rows.trial[r, 0]
            velocity[rows.particle[r], 1] = rows.trial[r, 1]
        for k in range(first, last):
            tension[springs.slot[k]] = springs.tension[k]
    # s += 0.3 (v' - s)
    for p in range(particle_active.shape[0]):
        if particle_active[p]:
            slow_velocity[p, 0] += SLOW_SHARE * (velocity[p, 0] - slow_velocity[p, 0])
            slow_velocity[p, 1] += SLOW_SHARE * (velocity[p, 1] - slow_velocity[p, 1])


def pattern_of(world: World) -> Pattern:
    """The pattern of a world's matrix, made anew where topology or pins have changed since the last step."""
    return world.derived(_hired_pattern)


def _hired_pattern(world: World) -> Pattern:
    pattern = make_pattern(world)
    hire(pattern, pattern.matrix.fronts, pattern.rows.change)
    return pattern


def solve(world: World, springs: Pair, elements: Pair, h: float, before: Before, push: Push | None = None) -> None:
    """Bring the velocities to the end of a step of h [s]; slow_velocity, energy_bank and tension go with them.

    push: solves the bodies that contacts push and tells which they are (bodies,); the others never hear of it.
    """
    pattern = pattern_of(world)
    if pattern.has_hooke:
        apply_explicit(world, pattern.hooke, springs, h)
    stiffness, damping = springs
    least, most, parts = NOTHING, NOTHING, 0
    if world.settings.substeps == AUTO:
        parts = round(1.0 / (h * world.settings.tick_rate))
        stiffness, damping = cap(stiffness, damping, parts)
        least, most = extremes(world.stiffness, world.damping)
    if len(pattern.shapes.slot):
        load_constants(pattern, world, elements, parts)
    touched = NOBODY if push is None else push(world, pattern, stiffness, damping, least, most, parts, h, before)
    _solve_bodies(
        world.position, world.velocity, world.mass, world.inverse_mass, world.slow_velocity, world.energy_bank,
        world.particle_active, world.rest_length, stiffness, damping, world.material, world.tension,
        pattern.numbers, least, most, parts, before.velocity, before.rest_length, h, touched,
    )  # fmt: skip


def load_constants(pattern: Pattern, world: World, elements: Pair, parts: int) -> None:
    """Copy the constants of a step's elements into the pattern's scratch; parts: 0, or those of a tick that chooses."""
    shapes = pattern.shapes
    if parts:
        elements = cap(*elements, parts)
        least, most = extremes(*world.element_coefficients)
        shapes.least[:], shapes.most[:] = least[shapes.slot], most[shapes.slot]
    shapes.stiffness[:], shapes.damping[:] = elements[0][shapes.slot], elements[1][shapes.slot]
    shapes.rest[:] = world.element_rest[shapes.slot]
    shapes.weight[:] = world.corner_weight[pattern.corners]


def spring_constant(stiffness: Floats, damping: Floats, mass: Floats, h: float) -> Floats:
    """k [N/m] of springs: Cs m_r / ((1 - Cd) h^2), with both capped as the solver caps them."""
    capped = np.where(damping > HIGHEST_COEFFICIENT, np.minimum(stiffness, HIGHEST_COEFFICIENT), stiffness)
    return capped * mass / ((1.0 - np.minimum(damping, HIGHEST_COEFFICIENT)) * h * h)
