"""One body's step in the direct solver, where no contact and no joint acts on it.

A step is one linear solve with the springs' directions taken ahead of the present ones, less the slow part of the
velocity: that damps fast vibration and leaves slow turning alone. It is taken only if the body's energy stays within
what it had plus what its energy budget holds of earlier losses; else it is solved on, at last f itself is minimised,
and what moves beside the motion of the whole is slowed down (energy_budget.py).

Shape matching brings tangled jellies back to their form, which springs and areas cannot find: the energy rises on the
way. While a jelly is inverted or wound (jellies.py), each of its particles is joined by a spring of the jelly's own Cs
and Cd to its target: its place in the form, moved and turned to fit the particles (Mueller and others 2005). Those push
no jelly as a whole, and let it lose its spin; what they add to the body's energy was lost by the body before.
"""

import math

from sandbox.physics.arrays import Slots
from sandbox.physics.equation import implicit_masses
from sandbox.physics.geometry.rigid import RigidMotion, WeightedSums, best_turn, centre_of, with_pair, with_point
from sandbox.physics.integrate import follow
from sandbox.physics.jit import inner_kernel, parallel
from sandbox.physics.marks import BANK_UNOPENED
from sandbox.physics.solvers.direct.energy_budget import (
    ENERGY_ROUNDING,
    FALLING,
    MORE_SOLVES,
    ROUNDS,
    SETTLED,
    SLOWING_ROUNDS,
    body_energy,
    budget_limit,
    first_ratio,
    keeps_lengths,
    next_ratio,
    open_budget,
    reserve,
    unreturnable,
    without_turn,
)
from sandbox.physics.solvers.direct.network import (
    AHEAD,
    find_tension,
    keep_tension,
    linearise,
    load,
    minimise,
    potential,
    refine,
    solve_linear,
    update,
)
from sandbox.physics.solvers.direct.rigid_turn import (
    begin_turn,
    hold_spin,
    kinetic_at_end,
    kinetic_beside,
    slow_beside,
    spin_of_body,
)
from sandbox.physics.solvers.direct.system import (
    MINIMISED,
    PASSED,
    SLOWED_DOWN,
    SOLVED_ON,
    Rows,
    ShapeMatchGroups,
    Span,
    System,
    copy,
    hold_triangles,
    kinetic,
    span_of,
    store,
)
from sandbox.physics.solvers.inputs import Inputs
from sandbox.physics.state import State
from sandbox.physics.untangling.jellies import is_out_of_shape, is_wound, wind
from sandbox.physics.untangling.triangle_clamp import AS_IT_WAS, JOINED

# A body of which a spring, after a linear solve, misses the length that was predicted by more than this share of it
# times h^2 [1/s^2] (1e-4 at 60 Hz) gets another: what turns fast, a whipping tip or a dragged end, stretches 5 to 20
# times less for it. Lower costs time on every swing, higher stretch; with h^2 so that substeps keep their gain.
MISFIT_RATE = 0.36
# Linear solves of a step at most. With 2, whipping ropes stretch up to 10 times as much and a hundredth of their steps
# has to be minimised; a fourth is hardly ever asked for.
LINEAR_SOLVES = 3
# Relative error of the energy of a rigid motion, which has no more than was there.
RIGID_ROUNDING = 1e-10
# No turn fits where the fit of the best is below this share [1] of what it is to itself: in one point, or a square
# turned inside out. Any value well above rounding will do.
ROUND = 1e-3


@inner_kernel
def step_bodies(
    system: System, state: State, inputs: Inputs, ways: Slots, touched: bool, auto_substeps: int, h: float
) -> None:
    """Advance the bodies that nothing touches by a step of h [s], and update s of all (11); rows are loaded.

    ways: counts, see system.py; touched: some bodies are, and at that end already.
    """
    bodies, count = system.bodies, system.bodies.lowest.shape[0]
    for body in parallel(count, bodies.work[count]):
        _step_alone(body, system, state, inputs, touched, auto_substeps, h)
    for body in range(count):
        if not (touched and bodies.touched[body]):
            ways[bodies.way[body]] += 1
    follow(state.velocity, state.slow_velocity, state.slow_change, state.particle_active)


@inner_kernel
def _step_alone(
    body: int, system: System, state: State, inputs: Inputs, touched: bool, auto_substeps: int, h: float
) -> None:  # fmt: skip
    # Advance one body that nothing touches.
    bodies = system.bodies
    if touched and bodies.touched[body]:
        return
    span = span_of(system, body)
    open_body(body, span, system, state, inputs, 1.0, auto_substeps, h)
    bodies.way[body] = step_body(body, span, system, state, h)
    store(span, system, state)


@inner_kernel
def open_body(
    body: int, span: Span, system: System, state: State, inputs: Inputs, arc: float, auto_substeps: int, h: float
) -> None:
    """Load a body's springs and constraints, its energies and its budget, and match its shape where that is lost."""
    bodies, rows = system.bodies, system.rows
    underdamped, moved = load(span, system, state, inputs, not bodies.anchored[body], auto_substeps, h)
    bodies.underdamped[body] = underdamped
    # What was found not to come back does not count, until something outside changes the body.
    lowest = bodies.lowest[body]
    kept = min(moved, state.unreturnable[lowest]) if state.energy_bank[lowest] != BANK_UNOPENED else 0.0
    bodies.unreturnable0[body] = kept
    bodies.unreturnable[body] = state.unreturnable[lowest] = 0.0
    bodies.energy0[body] = kinetic(span, rows.mass, rows.v_star) + (moved - kept)  # (13)
    bodies.budget[body] = open_budget(body, span, system, state.energy_bank, moved, h)
    begin_turn(body, span, system, state, arc, h)
    bodies.inverted[body] = False
    bodies.matched[body] = False
    if span.last_constraint > span.first_constraint:
        inverted, drawn = find_inverted(body, span, system)
        bodies.inverted[body] = inverted
        if drawn:
            bodies.matched[body] = match_shape(body, span, system, h)


@inner_kernel
def find_inverted(body: int, span: Span, system: System) -> tuple[bool, bool]:
    """Mark a body's inverted jellies in `inverted`, those and wound ones in `drawn`; whether there are any of each."""
    rows, constraints, groups = system.rows, system.constraints, system.shape_match_groups
    first_group = groups.of_body[body]
    last_group = groups.of_body[body + 1]
    if first_group == last_group:
        return False, False
    for i in range(groups.start[first_group], groups.start[last_group]):
        groups.turns[i] = 0
    for g in range(first_group, last_group):
        groups.inverted[g] = False
    for k in range(span.first_constraint, span.last_constraint):
        g = groups.group[k]
        if g < 0:
            continue
        rest = constraints.rest[k, 0]
        if is_out_of_shape(constraints.error[k] + rest, rest, constraints.rest[k, 1]):
            groups.inverted[g] = True
        first = constraints.first[k]
        wind(
            rows.position, constraints.row[first], constraints.row[first + 1], constraints.row[first + 2],
            groups.member, k, groups.turns,
        )  # fmt: skip
    any_inverted = False
    any_drawn = False
    for g in range(first_group, last_group):
        round_once = 1 if constraints.rest[groups.sample[g], 1] > 0.0 else -1
        for i in range(groups.start[g], groups.start[g + 1]):
            if groups.inner[i] and groups.turns[i] != round_once:
                groups.inverted[g] = True
        groups.drawn[g] = groups.inverted[g] or is_wound(g, round_once, rows.position, groups.fan, groups.fan_start)
        any_inverted = any_inverted or groups.inverted[g]
        any_drawn = any_drawn or groups.drawn[g]
    return any_inverted, any_drawn


@inner_kernel
def match_shape(body: int, span: Span, system: System, h: float) -> bool:
    """Join the jellies of a body that are out of shape to their form: into `inertia` and `v_star_matched`.

    True: there are such jellies.

    K |v' - w|^2 / 2 with w = the jelly's velocity - Cs / Cd times the way from the target to the particle / h.
    """
    rows, constraints, groups = system.rows, system.constraints, system.shape_match_groups
    free_count = system.matrix.diagonal.shape[0]
    matched = False
    for g in range(groups.of_body[body], groups.of_body[body + 1]):
        # Of a free body with other parts it would push those: its momentum is kept.
        whole = groups.start[g + 1] - groups.start[g] == span.last_row - span.first_row
        if not groups.drawn[g] or not (system.bodies.anchored[body] or whole):
            continue
        k = groups.sample[g]
        stiff, restoring = implicit_masses(constraints.stiffness[k], constraints.damping[k], 1.0)
        x, y, p, q, u, v, cosine, sine = _fit(g, rows, groups)
        if not stiff > 0.0 or (cosine == 0.0 and sine == 0.0):
            continue
        matched = True
        rate = min(1.0, restoring / stiff) / h
        for i in range(groups.start[g], groups.start[g + 1]):
            r = groups.row[i]
            if r >= free_count:
                continue
            ex = groups.form[i, 0] - p
            ey = groups.form[i, 1] - q
            wx = u - rate * (rows.position[r, 0] - (x + ex * cosine - ey * sine))
            wy = v - rate * (rows.position[r, 1] - (y + ex * sine + ey * cosine))
            mass = stiff * rows.mass[r]
            total = rows.inertia[r] + mass
            rows.v_star_matched[r, 0] = (rows.inertia[r] * rows.v_star_matched[r, 0] + mass * wx) / total
            rows.v_star_matched[r, 1] = (rows.inertia[r] * rows.v_star_matched[r, 1] + mass * wy) / total
            rows.inertia[r] = total
    return matched


@inner_kernel
def _fit(g: int, rows: Rows, groups: ShapeMatchGroups) -> tuple[float, float, float, float, float, float, float, float]:
    # Centres of a jelly and of its form, its velocity, and cosine and sine of the turn that fits best; 0, 0: none.
    sums = form = WeightedSums(0.0, 0.0, 0.0, 0.0, 0.0)
    for i in range(groups.start[g], groups.start[g + 1]):
        r = groups.row[i]
        m = rows.mass[r]
        sums = with_point(sums, m, rows.position[r, 0], rows.position[r, 1], rows.v_star[r, 0], rows.v_star[r, 1])
        form = with_point(form, m, groups.form[i, 0], groups.form[i, 1], 0.0, 0.0)
    x, y, u, v, _, _ = centre_of(sums)
    p, q, _, _, _, _ = centre_of(form)
    along = across = own = 0.0
    for i in range(groups.start[g], groups.start[g + 1]):
        r = groups.row[i]
        m = rows.mass[r]
        dx = rows.position[r, 0] - x
        dy = rows.position[r, 1] - y
        ex = groups.form[i, 0] - p
        ey = groups.form[i, 1] - q
        along, across = with_pair(along, across, m, ex, ey, dx, dy)
        own += m * math.sqrt((dx * dx + dy * dy) * (ex * ex + ey * ey))
    if not math.sqrt(along * along + across * across) > ROUND * own:
        return x, y, p, q, u, v, 0.0, 0.0
    cosine, sine = best_turn(along, across)
    return x, y, p, q, u, v, cosine, sine


@inner_kernel
def step_body(body: int, span: Span, system: System, state: State, h: float) -> int:
    """Bring a body that was opened to the end of a step of h [s], in `v`, and its budget; its way, see system.py."""
    bodies = system.bodies
    energy0 = bodies.energy0[body]
    budget = bodies.budget[body]
    allowed = energy0 * (1.0 + ENERGY_ROUNDING) + budget  # (14)
    spin = spin_of_body(body, system)
    energies = _solve_within(body, span, system, spin, allowed, h)
    after, _ = energies
    way = PASSED
    if not after <= allowed:
        after = _solve_on(body, span, system, spin, energies, allowed, h)
        way = SOLVED_ON
    if not after <= allowed:
        after = _minimise(body, span, system, spin, h)
        way = MINIMISED
    if not after <= allowed:
        after = _slow_down(body, span, system, spin, allowed, h)
        way = SLOWED_DOWN
    state.unreturnable[bodies.lowest[body]] = bodies.unreturnable[body]
    limit = budget_limit(body, system)
    saved = budget + energy0 - after  # (14)
    # An inverted body keeps all that it lost for the way back to its form; one that grabs move, no more than others do.
    if saved > limit and not (bodies.inverted[body] and not bodies.anchored[body]):
        reserve(body, span, system, state, saved - limit)
        saved = limit
    state.energy_bank[bodies.lowest[body]] = saved if saved > 0.0 else 0.0
    return way


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
def _solve_on(
    body: int, span: Span, system: System, spin: RigidMotion, energies: tuple[float, float], allowed: float, h: float
) -> float:  # fmt: skip
    # Solve on while that brings lengths nearer, or until what springs can give back is allowed; the energy in the end.
    # energies: of the last solve, and of the one before.
    after, before = energies
    for _solve in range(MORE_SOLVES):
        if not after - allowed < FALLING * (before - allowed) and after < math.inf:
            kept = unreturnable(body, span, system, False, h)
            if after - kept <= allowed:
                return after - kept
            system.bodies.unreturnable[body] = 0.0
            if abs(after - before) < SETTLED * (after - allowed):
                break
        before = after
        after, _ = _take_candidate(body, span, system, spin, h)
        if after <= allowed:
            break
    return after


@inner_kernel
def _minimise(body: int, span: Span, system: System, spin: RigidMotion, h: float) -> float:
    # Bring a body to the minimum of f, without its shape matching; its energy then.
    rows = system.rows
    copy(span, rows.v_star, rows.v_star_matched)
    minimise(span, system, h)
    hold_spin(span, rows, spin, system.bodies.pivot[body] >= 0, False, spin.momentum, h)
    hold_triangles(span, system, h)
    return body_energy(body, span, system, h) - unreturnable(body, span, system, False, h)


@inner_kernel
def _slow_down(body: int, span: Span, system: System, spin: RigidMotion, allowed: float, h: float) -> float:
    # Take off what moves beside the motion of the whole, then what that turns, until the energy test holds, by as
    # little as that asks for; its energy then. Neither changes a length in the end.
    rows = system.rows
    after = body_energy(body, span, system, h) - unreturnable(body, span, system, False, h)
    motion, ratio = spin, 1.0
    for done in range(SLOWING_ROUNDS):
        if done % ROUNDS == 0:
            if done > 0:
                motion = without_turn(motion)
            copy(span, rows.v, rows.saved_delta_v)
            ratio = first_ratio(after - allowed, kinetic_beside(span, rows, motion))
        else:
            ratio = next_ratio(ratio, done)
            copy(span, rows.saved_delta_v, rows.v)
        slow_beside(span, rows, motion, ratio, h)
        hold_triangles(span, system, h)
        after = body_energy(body, span, system, h) - unreturnable(body, span, system, keeps_lengths(done), h)
        # The motion of the whole alone has no more than was there.
        if after <= allowed or (done == ROUNDS - 1 and after <= allowed * (1.0 + RIGID_ROUNDING)):
            break
    find_tension(span, system, h)
    return after


@inner_kernel
def release_shape(span: Span, rows: Rows) -> None:
    """Join the rows of a body to nothing: their inertia is their mass, and they aim at v*."""
    for r in range(span.first_row, span.last_row):
        rows.inertia[r] = rows.mass[r]
        rows.v_star_matched[r, 0] = rows.v_star[r, 0]
        rows.v_star_matched[r, 1] = rows.v_star[r, 1]
