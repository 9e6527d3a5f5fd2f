"""The fallback of a step: projected Newton, f itself (spring_terms.py) minimised.

Its matrix is positive definite at every iterate, since the geometric stiffness of what pushes is left out.
"""

from sandbox.physics.jit import inner_kernel
from sandbox.physics.solvers.direct.factor import solve_linear
from sandbox.physics.solvers.direct.families import find_tension, linearise, objective, slope
from sandbox.physics.solvers.direct.motion import copy, hold_triangles, scale
from sandbox.physics.solvers.direct.system import Span, System

# Newton rounds of the minimisation, sufficient decrease (Armijo), halvings of a round, and the relative decrease at
# which it ends. With 3 rounds, a whipping rope can lose most of its motion in one step.
NEWTON_ROUNDS = 10
ARMIJO = 1e-4
NEWTON_HALVINGS = 30
NEWTON_TOLERANCE = 1e-6


@inner_kernel
def _start(span: Span, system: System, h: float) -> float:
    # From the best of the candidate, v* and all at rest, none of which turns over a triangle; f there.
    rows = system.rows
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
    return value


@inner_kernel
def minimise(span: Span, system: System, h: float) -> None:
    """Bring a body's `v` towards the minimum of f, no triangle turned over, and its springs' tension too."""
    # Newton's method on f with A = M + sum [K n' n'^T + h^2 max(0, t) / l' (I - n' n'^T)].
    rows = system.rows
    value = _start(span, system, h)
    for _ in range(NEWTON_ROUNDS):
        linearise(span, system, h, 1.0, 0.0)
        copy(span, rows.v, rows.v_best)
        solve_linear(span, system)
        descent = slope(span, system)
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
