"""Direct: the article's spring solved for a whole network at once, with a test that bounds the energy.

network.py states the equation. A step is one linear solve with the springs' directions taken ahead of the present
ones, less the slow part of the velocity: that damps fast vibration and leaves slow turning alone. It is taken only if
the body's energy stays within what it had plus what its bank holds of earlier losses; else f itself is minimised.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.forces import Before
from sandbox.physics.jit import bundle_kernel, inner_kernel
from sandbox.physics.settings import AUTO
from sandbox.physics.solvers.halves import hire
from sandbox.physics.solvers.measure import cap, extremes
from sandbox.physics.solvers.network import (
    HIGHEST_COEFFICIENT,
    kinetic,
    linearise,
    load_springs,
    objective,
    potential,
    refine,
    solve_linear,
    update_impulses,
)
from sandbox.physics.solvers.pattern import Pattern, is_current, make_pattern
from sandbox.physics.solvers.single_pass import apply_explicit
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
# s += SLOW_SHARE (v' - s), per step. Higher leaves fast vibration undamped, lower damps slow turning.
SLOW_SHARE = 0.3
# The velocities foreseen before a first solve are v + CHANGE_AHEAD (v - s): of an even change, s lags behind by that of
# 1 / CHANGE_AHEAD steps. Without it, or with less, smooth turning takes two solves where one is enough.
CHANGE_AHEAD = SLOW_SHARE / (1.0 - SLOW_SHARE)
# A body's bank holds at most this share of its energy: where every spring has Cs <= Cd, and where one has not (its
# energy in this measure swings by up to 3 within a period). 0 would reject most steps at Cs = Cd = 1.
BANK_SHARE = 0.05
BOUNCY_BANK_SHARE = 3.0
# Relative error of an energy summed over a large body; less rejects steps for rounding alone.
ENERGY_ROUNDING = 1e-12
# Newton rounds of the minimisation, sufficient decrease (Armijo), halvings of a round, and the relative decrease at
# which it ends. With 3 rounds, a whipping rope can lose most of its motion in one step.
NEWTON_ROUNDS = 10
ARMIJO = 1e-4
NEWTON_HALVINGS = 30
NEWTON_TOLERANCE = 1e-6
# Halvings of the velocities before a body is stopped.
LAST_HALVINGS = 60
# The measures of springs where the number of parts is fixed: none.
NOTHING = np.zeros(0)
# The bodies that are solved elsewhere: none.
NOBODY = np.zeros(0, dtype=np.bool_)

Push = Callable[[World, Pattern, Floats, Floats, Floats, Floats, int, float, Before], NDArray[np.bool_]]


@inner_kernel
def load_rows(position, velocity, mass, slow_velocity, before, h, free_count, rows):  # type: ignore[no-untyped-def]
    """Bring every row to the start of a step of h [s], with a first guess of its end in `trial`."""
    for r in range(rows.particle.shape[0]):
        p = rows.particle[r]
        rows.mass[r] = mass[p]
        for axis in range(2):
            rows.position[r, axis] = position[p, axis]
            rows.moved[r, axis] = position[p, axis]
            rows.target[r, axis] = velocity[p, axis]
            rows.start[r, axis] = before[p, axis]
            rows.slow[r, axis] = slow_velocity[p, axis]
        if r >= free_count:
            rows.moved[r, 0] += velocity[p, 0] * h
            rows.moved[r, 1] += velocity[p, 1] * h
        for axis in range(2):
            rows.trial[r, axis] = rows.start[r, axis]
            if r < free_count:
                rows.trial[r, axis] += CHANGE_AHEAD * (rows.start[r, axis] - rows.slow[r, axis])


@inner_kernel
def copy_rows(first, last, source, destination):  # type: ignore[no-untyped-def]
    """Copy the rows first..last of one array to another."""
    for r in range(first, last):
        destination[r, 0] = source[r, 0]
        destination[r, 1] = source[r, 1]


@inner_kernel
def _scale(first, last, factor, vector):  # type: ignore[no-untyped-def]
    for r in range(first, last):
        vector[r, 0] *= factor
        vector[r, 1] *= factor


@inner_kernel
def _take_candidate(first_row, last_row, first, last, rows, springs, matrix, rest_length, h):  # type: ignore[no-untyped-def]
    # v' = v + D;  J = q - K n.(D_b - D_a);  T = max(0, -J) for what follows. Returned: H, and the largest misfit.
    linearise(first, last, rows, springs, h, AHEAD, AHEAD)
    solve_linear(first_row, last_row, first, last, rows, springs, matrix)
    held = 0.0
    misfit = 0.0
    for _refinement in range(2):
        for r in range(first_row, last_row):
            rows.trial[r, 0] += rows.change[r, 0]
            rows.trial[r, 1] += rows.change[r, 1]
        held, misfit, rounded = update_impulses(
            first, last, rows, springs, rest_length, h, matrix.diagonal.shape[0]
        )  # fmt: skip
        if not rounded:
            break
        refine(first_row, last_row, first, last, rows, springs, matrix)
    for k in range(first, last):
        springs.tension[k] = max(0.0, -springs.impulse[k])
    return kinetic(first_row, last_row, rows.mass, rows.trial) + held, misfit


@inner_kernel
def _start_minimisation(first_row, last_row, first, last, rows, springs, h):  # type: ignore[no-untyped-def]
    # From the best of the candidate, v* and all at rest; f there.
    copy_rows(first_row, last_row, rows.trial, rows.best)
    lowest = objective(first_row, last_row, first, last, rows, springs, h)
    copy_rows(first_row, last_row, rows.target, rows.trial)
    value = objective(first_row, last_row, first, last, rows, springs, h)
    if not lowest <= value:
        lowest = value
        copy_rows(first_row, last_row, rows.trial, rows.best)
    _scale(first_row, last_row, 0.0, rows.trial)
    value = objective(first_row, last_row, first, last, rows, springs, h)
    if lowest <= value:
        copy_rows(first_row, last_row, rows.best, rows.trial)
        value = lowest
    return value


@inner_kernel
def _minimise(first_row, last_row, first, last, rows, springs, matrix, h):  # type: ignore[no-untyped-def]
    # Newton's method on f with A = M + sum [K n' n'^T + h^2 max(0, t) / l' (I - n' n'^T)].
    value = _start_minimisation(first_row, last_row, first, last, rows, springs, h)
    for _ in range(NEWTON_ROUNDS):
        linearise(first, last, rows, springs, h, 1.0, 0.0)
        copy_rows(first_row, last_row, rows.trial, rows.best)
        solve_linear(first_row, last_row, first, last, rows, springs, matrix)
        slope = _slope(first_row, last_row, first, last, rows, springs)
        if not slope < 0.0:
            break
        length = 1.0
        better = False
        for _halving in range(NEWTON_HALVINGS):
            for r in range(first_row, last_row):
                rows.trial[r, 0] = rows.best[r, 0] + length * rows.change[r, 0]
                rows.trial[r, 1] = rows.best[r, 1] + length * rows.change[r, 1]
            reached = objective(first_row, last_row, first, last, rows, springs, h)
            if reached <= value + ARMIJO * length * slope:
                value = reached
                better = True
                break
            length *= 0.5
        if not better:
            copy_rows(first_row, last_row, rows.best, rows.trial)
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
    """Keep the tension of one body's springs at `trial`."""
    linearise(first, last, rows, springs, h, 1.0, 0.0)
    for k in range(first, last):
        springs.tension[k] = max(0.0, -springs.impulse[k])


@inner_kernel
def body_energy(first_row, last_row, first, last, rows, springs, rest_length, h):  # type: ignore[no-untyped-def]
    """Energy of one body after the step [J]: kinetic at `trial`, and that of its springs."""
    # H = KE(v') + PE(x + h v')
    return kinetic(first_row, last_row, rows.mass, rows.trial) + potential(
        first, last, rows.position, rows.trial, springs, springs.measured, rest_length, h, h
    )


@inner_kernel
def open_bank(  # type: ignore[no-untyped-def]
    first_row, last_row, first, last, rows, springs, bank, lowest, bouncy, spread, kinetic_after, moved, rest_length,
    rest_before, h,
):  # fmt: skip
    """What one body's bank holds before the step [J]; moved: its springs' energy once pins and drives have moved."""
    # The body's bank before the step. It is begun anew where a particle says so (-1): after any change from outside.
    # A body that broke off begins with none: what is saved stays with the particle that was the lowest, once.
    begun = True
    for r in range(first_row, last_row):
        p = rows.particle[r]
        if bank[p] < 0.0:
            begun = False
        if p != lowest:
            bank[p] = 0.0
    held = bank[lowest] if begun else 0.0
    if spread:
        # What the most k adds to the measure: of the start, and of the work of hands and drives.
        hidden = potential(first, last, rows.position, rows.start, springs, springs.hidden, rest_before, 0.0, h)
        hidden_moved = potential(first, last, rows.moved, rows.moved, springs, springs.hidden, rest_length, 0.0, h)
        held += max(0.0, hidden_moved - hidden)
        if not begun:
            held += hidden
    if not bouncy:
        return held
    before = kinetic(first_row, last_row, rows.mass, rows.start)
    present = potential(first, last, rows.position, rows.start, springs, springs.measured, rest_before, 0.0, h)
    if not begun:
        held += BOUNCY_BANK_SHARE * (before + present)
    # Work done by forces, hands and drives since then counts as energy of the start.
    return max(0.0, held + BOUNCY_BANK_SHARE * (kinetic_after - before + moved - present))


@inner_kernel
def _step_body(  # type: ignore[no-untyped-def]
    first_row, last_row, first, last, rows, springs, matrix, rest_length, rest_before, lowest, bank, bouncy, spread,
    moved, h,
):  # fmt: skip
    kinetic_after = kinetic(first_row, last_row, rows.mass, rows.target)
    before = kinetic_after + moved
    held = open_bank(
        first_row, last_row, first, last, rows, springs, bank, lowest, bouncy, spread, kinetic_after, moved,
        rest_length, rest_before, h,
    )  # fmt: skip
    allowed = before * (1.0 + ENERGY_ROUNDING) + held
    after, misfit = _take_candidate(first_row, last_row, first, last, rows, springs, matrix, rest_length, h)
    for _solve in range(LINEAR_SOLVES - 1):
        within = after <= allowed
        if within and not misfit > MISFIT_RATE * h * h:
            break
        copy_rows(first_row, last_row, rows.trial, rows.best)
        once = after
        after, misfit = _take_candidate(first_row, last_row, first, last, rows, springs, matrix, rest_length, h)
        if within and not after <= allowed:
            copy_rows(first_row, last_row, rows.best, rows.trial)
            keep_tension(first, last, rows, springs, h)
            after = once
            break
    if not after <= allowed:
        _minimise(first_row, last_row, first, last, rows, springs, matrix, h)
        after = body_energy(first_row, last_row, first, last, rows, springs, rest_length, h)
        if not after <= allowed:
            after = _brake(first_row, last_row, first, last, rows, springs, rest_length, allowed, h)
    share = BOUNCY_BANK_SHARE if bouncy else BANK_SHARE
    limit = share * before
    if spread:
        limit += potential(first, last, rows.position, rows.trial, springs, springs.hidden, rest_length, h, h)
    saved = min(held + before - after, limit)
    bank[lowest] = saved if saved > 0.0 else 0.0


@inner_kernel
def _brake(first_row, last_row, first, last, rows, springs, rest_length, allowed, h):  # type: ignore[no-untyped-def]
    # Halve the free velocities until the energy test holds; at rest it always does.
    after = 0.0
    for _halving in range(LAST_HALVINGS):
        _scale(first_row, last_row, 0.5, rows.trial)
        after = body_energy(first_row, last_row, first, last, rows, springs, rest_length, h)
        if after <= allowed:
            break
    if not after <= allowed:
        for r in range(first_row, last_row):
            rows.trial[r, 0] = 0.0
            rows.trial[r, 1] = 0.0
        after = body_energy(first_row, last_row, first, last, rows, springs, rest_length, h)
    keep_tension(first, last, rows, springs, h)
    return after


@bundle_kernel
def _solve_bodies(  # type: ignore[no-untyped-def]
    position, velocity, mass, inverse_mass, slow_velocity, energy_bank, particle_active, rest_length, stiffness,
    damping, material, tension, numbers, least, most, parts, before, rest_before, h, touched,
):  # fmt: skip
    bodies, rows, springs, matrix = numbers.items
    load_rows(position, velocity, mass, slow_velocity, before, h, matrix.diagonal.shape[0], rows)
    for body in range(bodies.lowest.shape[0]):
        if touched.shape[0] > 0 and touched[body]:
            continue
        first_row = bodies.row_start[body]
        last_row = bodies.row_start[body + 1]
        first = bodies.spring_start[body]
        last = bodies.spring_start[body + 1]
        body_mass = 0.0
        for r in range(first_row, last_row):
            body_mass += rows.mass[r]
        # Gravity moves a body without anchors as a whole: started there, it falls without rounding.
        if not bodies.anchored[body]:
            copy_rows(first_row, last_row, rows.target, rows.trial)
        bouncy, spread, moved = load_springs(
            first, last, body_mass, inverse_mass, rest_length, stiffness, damping, material, tension, rows, springs,
            least, most, parts, h, matrix.diagonal.shape[0],
        )  # fmt: skip
        _step_body(
            first_row, last_row, first, last, rows, springs, matrix, rest_length, rest_before, bodies.lowest[body],
            energy_bank, bouncy, spread, moved, h,
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
    pattern = world.solver_cache
    if pattern is None or not is_current(
        world.inverse_mass, world.particle_a, world.particle_b, world.spring_active, world.law, *pattern.signature
    ):
        pattern = world.solver_cache = make_pattern(world)
        hire(pattern, pattern.matrix.fronts, pattern.rows.change)
    return pattern


def solve(world: World, stiffness: Floats, damping: Floats, h: float, before: Before, push: Push | None = None) -> None:
    """Bring the velocities to the end of a step of h [s]; slow_velocity, energy_bank and tension go with them.

    push: solves the bodies that contacts push and tells which they are (bodies,); the others never hear of it.
    """
    pattern = pattern_of(world)
    if pattern.has_hooke:
        apply_explicit(world, pattern.hooke, stiffness, damping, h)
    least, most, parts = NOTHING, NOTHING, 0
    if world.settings.substeps == AUTO:
        parts = round(1.0 / (h * world.settings.tick_rate))
        stiffness, damping = cap(stiffness, damping, parts)
        least, most = extremes(world)
    touched = NOBODY if push is None else push(world, pattern, stiffness, damping, least, most, parts, h, before)
    _solve_bodies(
        world.position, world.velocity, world.mass, world.inverse_mass, world.slow_velocity, world.energy_bank,
        world.particle_active, world.rest_length, stiffness, damping, world.material, world.tension,
        pattern.numbers, least, most, parts, before.velocity, before.rest_length, h, touched,
    )  # fmt: skip


def spring_constant(stiffness: Floats, damping: Floats, mass: Floats, h: float) -> Floats:
    """k [N/m] of springs: Cs m_r / ((1 - Cd) h^2), with both capped as the solver caps them."""
    capped = np.where(damping > HIGHEST_COEFFICIENT, np.minimum(stiffness, HIGHEST_COEFFICIENT), stiffness)
    return capped * mass / ((1.0 - np.minimum(damping, HIGHEST_COEFFICIENT)) * h * h)
