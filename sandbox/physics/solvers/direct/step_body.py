"""One body's step in the direct solver, where no contact and no joint acts on it.

A step is one linear solve with the springs' directions taken ahead of the present ones, less the slow part of the
velocity: that damps fast vibration and leaves slow turning alone. It is taken only if the body's energy stays within
what it had plus what its bank holds of earlier losses; else it gives way, and at last f itself is minimised.
"""

import math

from sandbox.physics.arrays import Slots
from sandbox.physics.geometry.rigid import RigidMotion, velocity_at
from sandbox.physics.integrate import follow
from sandbox.physics.jit import inner_kernel
from sandbox.physics.solvers.direct.energy_bank import (
    ENERGY_ROUNDING,
    GAVE_WAY,
    LAST_HALVINGS,
    MINIMISED,
    PASSED,
    SLOWED_DOWN,
    SOLVED_ON,
    bank_limit,
    body_energy,
    open_bank,
    reserve,
)
from sandbox.physics.solvers.direct.factor import refine, solve_linear
from sandbox.physics.solvers.direct.families import find_tension, keep_tension, linearise, load, potential, update
from sandbox.physics.solvers.direct.giving_way import FALLING, MORE_SOLVES, share_to_give
from sandbox.physics.solvers.direct.motion import copy, hold_triangles, kinetic, scale
from sandbox.physics.solvers.direct.newton import minimise
from sandbox.physics.solvers.direct.rigid_turn import (
    begin_turn,
    halve_within,
    hold_spin,
    kinetic_at_end,
    spin_of_body,
)
from sandbox.physics.solvers.direct.shape_matching import find_inverted, match_shape, release_shape
from sandbox.physics.solvers.direct.slow_motion import AHEAD
from sandbox.physics.solvers.direct.system import Rows, Span, System, span_of
from sandbox.physics.solvers.inputs import Inputs
from sandbox.physics.state import State
from sandbox.physics.untangling.triangle_clamp import AS_IT_WAS, JOINED

# A body of which a spring, after a linear solve, misses the length that was predicted by more than this share of it
# times h^2 [1/s^2] (1e-4 at 60 Hz) gets another: what turns fast, a whipping tip or a dragged end, stretches 5 to 20
# times less for it. Lower costs time on every swing, higher stretch; with h^2 so that substeps keep their gain.
MISFIT_RATE = 0.36
# Linear solves of a step at most. With 2, whipping ropes stretch up to 10 times as much and a hundredth of their steps
# has to be minimised; a fourth is hardly ever asked for.
LINEAR_SOLVES = 3
# Halvings of what moves beside the motion of a body as a whole, before that is slowed down too.
INNER_HALVINGS = 30
# Relative error of the energy of a rigid motion, which has no more than was there.
RIGID_ROUNDING = 1e-10


@inner_kernel
def open_body(
    body: int, span: Span, system: System, state: State, inputs: Inputs, arc: float, auto_substeps: int, h: float
) -> None:
    """Load a body's springs and constraints, its energies and its bank, and match its shape where that is lost."""
    bodies, rows = system.bodies, system.rows
    underdamped, moved = load(span, system, state, inputs, not bodies.anchored[body], auto_substeps, h)
    bodies.underdamped[body] = underdamped
    bodies.energy0[body] = kinetic(span, rows.mass, rows.v_star) + moved  # (13)
    bodies.bank[body] = open_bank(body, span, system, state.energy_bank, moved, h)
    begin_turn(body, span, system, state, arc, h)
    bodies.inverted[body] = False
    bodies.matched[body] = False
    if span.last_constraint > span.first_constraint:
        inverted, drawn = find_inverted(body, span, system)
        bodies.inverted[body] = inverted
        if drawn:
            bodies.matched[body] = match_shape(body, span, system, h)


@inner_kernel
def _take_candidate(body: int, span: Span, system: System, spin: RigidMotion, h: float) -> tuple[float, float]:
    # v' = v + D;  J = q - K n.(D_b - D_a);  T = max(0, -J) for what follows. Returned: H, and the largest misfit.
    rows, bodies = system.rows, system.bodies
    linearise(span, system, h, AHEAD, AHEAD)
    solve_linear(span, system)
    elastic = 0.0
    misfit = 0.0
    for _refinement in range(2):
        for r in range(span.first_row, span.last_row):
            rows.v[r, 0] += rows.delta_v[r, 0]
            rows.v[r, 1] += rows.delta_v[r, 1]
        hold_spin(span, rows, spin, bodies.pivot[body] >= 0, True, spin.momentum, h)
        elastic, misfit, rounded = update(span, system, h)
        if not rounded:
            break
        refine(span, system)
    keep_tension(span, system)
    taken = hold_triangles(span, system, h)
    if taken != AS_IT_WAS:
        elastic = potential(span, system, rows.position, rows.v, h, h)
        find_tension(span, system, h)
    if taken == JOINED:
        # So far from what is possible that it would stand still: f has to show the way.
        return math.inf, misfit
    return kinetic_at_end(body, span, system, h) + elastic, misfit


@inner_kernel
def _solve_within(
    body: int, span: Span, system: System, spin: RigidMotion, allowed: float, h: float
) -> tuple[float, float]:  # fmt: skip
    # Linear solves until one fits and has no more energy than is allowed, or they get no nearer to that; the energy of
    # the last that is taken, and of the one before it.
    bodies, rows = system.bodies, system.rows
    before = after = math.inf
    solves = 0
    while solves < LINEAR_SOLVES:
        before = after
        within = solves > 0 and before <= allowed
        if within:
            copy(span, rows.v, rows.v_best)
        after, misfit = _take_candidate(body, span, system, spin, h)
        solves += 1
        if within and not after <= allowed:
            copy(span, rows.v_best, rows.v)
            find_tension(span, system, h)
            after = before
            break
        if after <= allowed and not misfit > MISFIT_RATE * h * h:
            break
        failing = not after <= allowed
        if failing and bodies.matched[body] and solves == LINEAR_SOLVES:
            # Without its target, from the start.
            bodies.matched[body] = False
            solves = 0
            release_shape(span, rows)
            copy(span, rows.v_star, rows.v)
        elif failing and not bodies.matched[body] and not after - allowed < FALLING * (before - allowed):
            break
    return after, before


@inner_kernel
def _give_way(
    body: int, span: Span, system: System, spin: RigidMotion, energies: tuple[float, float], allowed: float, h: float
) -> tuple[float, int]:  # fmt: skip
    # Solve on while each solve leaves less of what is too much, or for a target that is lower by just that: see
    # giving_way.py; the energy in the end, and the way. energies: of the last solve, and of the one before.
    after, before = energies
    way = SOLVED_ON
    for _solve in range(MORE_SOLVES):
        if not after - allowed < FALLING * (before - allowed):
            if not _lower_target(span, system.rows, spin, after - allowed):
                break
            after = math.inf
            way = GAVE_WAY
        before = after
        after, _ = _take_candidate(body, span, system, spin, h)
        if after <= allowed:
            break
    return after, way


@inner_kernel
def _lower_target(span: Span, rows: Rows, spin: RigidMotion, excess: float) -> bool:
    # Lower what a body aims at by what it has too much [J], or not. What stays is its motion as a whole, or rest where
    # pins hold it.
    moves = 0.0
    for r in range(span.first_row, span.last_row):
        u, v = velocity_at(spin, rows.position[r, 0], rows.position[r, 1])
        u = rows.v[r, 0] - u
        v = rows.v[r, 1] - v
        moves += 0.5 * rows.mass[r] * (u * u + v * v)
    share = share_to_give(excess, moves)
    if not share > 0.0:
        return False
    for r in range(span.first_row, span.last_row):
        u, v = velocity_at(spin, rows.position[r, 0], rows.position[r, 1])
        rows.v_star_matched[r, 0] -= share * (rows.v_star_matched[r, 0] - u)
        rows.v_star_matched[r, 1] -= share * (rows.v_star_matched[r, 1] - v)
    return True


@inner_kernel
def step_body(body: int, span: Span, system: System, state: State, h: float) -> int:
    """Bring a body that was opened to the end of a step of h [s], in `v`, and its bank; its way, see energy_bank.py."""
    bodies, rows = system.bodies, system.rows
    energy0 = bodies.energy0[body]
    bank = bodies.bank[body]
    allowed = energy0 * (1.0 + ENERGY_ROUNDING) + bank  # (14)
    spin = spin_of_body(body, system)
    energies = _solve_within(body, span, system, spin, allowed, h)
    after, _ = energies
    way = PASSED
    if not after <= allowed:
        after, way = _give_way(body, span, system, spin, energies, allowed, h)
    if not after <= allowed:
        way = MINIMISED
        copy(span, rows.v_star, rows.v_star_matched)
        minimise(span, system, h)
        hold_spin(span, rows, spin, bodies.pivot[body] >= 0, False, spin.momentum, h)
        copy(span, rows.v, rows.v_best)
        hold_triangles(span, system, h)
        after = body_energy(body, span, system, h)
        if not after <= allowed:
            way = SLOWED_DOWN
            after = _damp(body, span, system, spin, allowed, h)
    limit = bank_limit(body, system)
    saved = bank + energy0 - after  # (14)
    # An inverted body keeps all that it lost for the way back to its form; one that grabs move, no more than others do.
    if saved > limit and not (bodies.inverted[body] and not bodies.anchored[body]):
        reserve(body, span, system, state, saved - limit)
        saved = limit
    state.energy_bank[bodies.lowest[body]] = saved if saved > 0.0 else 0.0
    return way


@inner_kernel
def _damp(body: int, span: Span, system: System, spin: RigidMotion, allowed: float, h: float) -> float:
    # Halve the free velocities, as they were found, until the energy test holds; at rest it always does. First only
    # what moves beside the motion of the whole.
    rows = system.rows
    after = 0.0
    if spin.inertia > 0.0:
        copy(span, rows.v_best, rows.delta_v)
        for _halving in range(INNER_HALVINGS):
            halve_within(span, rows, spin, 0.5, h, rows.delta_v)
            copy(span, rows.delta_v, rows.v)
            hold_triangles(span, system, h)
            after = body_energy(body, span, system, h)
            if after <= allowed:
                find_tension(span, system, h)
                return after
        # That motion itself: no length changes in it.
        halve_within(span, rows, spin, 0.0, h, rows.v)
        hold_triangles(span, system, h)
        after = body_energy(body, span, system, h)
        if after <= allowed * (1.0 + RIGID_ROUNDING):
            find_tension(span, system, h)
            return after
    for _halving in range(LAST_HALVINGS):
        # Not of what triangles have left: what was found leads downwards, once it is so short that none turns over.
        scale(span, 0.5, rows.v_best)
        copy(span, rows.v_best, rows.v)
        hold_triangles(span, system, h)
        after = body_energy(body, span, system, h)
        if after <= allowed:
            break
    if not after <= allowed:
        for r in range(span.first_row, span.last_row):
            rows.v[r, 0] = 0.0
            rows.v[r, 1] = 0.0
        after = body_energy(body, span, system, h)
    find_tension(span, system, h)
    return after


@inner_kernel
def step_bodies(
    system: System, state: State, inputs: Inputs, ways: Slots, touched: bool, auto_substeps: int, h: float
) -> None:
    """Advance the bodies that nothing touches by a step of h [s], and update s of all (11); rows are loaded.

    ways: counts, see energy_bank.py; touched: some bodies are, and at that end already.
    """
    bodies, rows, springs = system.bodies, system.rows, system.springs
    for body in range(bodies.lowest.shape[0]):
        if touched and bodies.touched[body]:
            continue
        span = span_of(system, body)
        open_body(body, span, system, state, inputs, 1.0, auto_substeps, h)
        ways[step_body(body, span, system, state, h)] += 1
        for r in range(span.first_row, span.last_row):
            state.velocity[rows.particle[r], 0] = rows.v[r, 0]
            state.velocity[rows.particle[r], 1] = rows.v[r, 1]
        for k in range(span.first_spring, span.last_spring):
            state.tension[springs.slot[k]] = springs.tension[k]
    follow(state.velocity, state.slow_velocity, state.slow_change, state.particle_active)
