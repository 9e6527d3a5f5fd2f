"""Shape matching brings tangled jellies back to their form, which springs and areas cannot find: the energy rises on
the way.

While a jelly is inverted or wound (inversion.py), each of its particles is joined by a spring of the jelly's own Cs
and Cd to its target: its place in the form, moved and turned to fit the particles (Mueller and others 2005). Those push
no jelly as a whole, and let it lose its spin; what they add to the body's energy was lost by the body before.
"""

import math

from sandbox.physics.equation import implicit_masses
from sandbox.physics.geometry.rigid import WeightedSums, best_turn, centre_of, with_pair, with_point
from sandbox.physics.jit import inner_kernel
from sandbox.physics.solvers.direct.system import Rows, ShapeMatchGroups, Span, System
from sandbox.physics.untangling.inversion import is_out_of_shape, is_wound, wind

# No turn fits where the fit of the best is below this share [1] of what it is to itself: in one point, or a square
# turned inside out. Any value well above rounding will do.
ROUND = 1e-3


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
        wanted = constraints.rest[k, 0]
        if is_out_of_shape(constraints.error[k] + wanted, wanted, constraints.rest[k, 1]):
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
        share = min(1.0, restoring / stiff) / h
        for i in range(groups.start[g], groups.start[g + 1]):
            r = groups.row[i]
            if r >= free_count:
                continue
            ex = groups.form[i, 0] - p
            ey = groups.form[i, 1] - q
            wx = u - share * (rows.position[r, 0] - (x + ex * cosine - ey * sine))
            wy = v - share * (rows.position[r, 1] - (y + ex * sine + ey * cosine))
            mass = stiff * rows.mass[r]
            total = rows.inertia[r] + mass
            rows.v_star_matched[r, 0] = (rows.inertia[r] * rows.v_star_matched[r, 0] + mass * wx) / total
            rows.v_star_matched[r, 1] = (rows.inertia[r] * rows.v_star_matched[r, 1] + mass * wy) / total
            rows.inertia[r] = total
    return matched


@inner_kernel
def release_shape(span: Span, rows: Rows) -> None:
    """Join the rows of a body to nothing: their inertia is their mass, and they aim at v*."""
    for r in range(span.first_row, span.last_row):
        rows.inertia[r] = rows.mass[r]
        rows.v_star_matched[r, 0] = rows.v_star[r, 0]
        rows.v_star_matched[r, 1] = rows.v_star[r, 1]
