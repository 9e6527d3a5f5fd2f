"""The shape goal of a tangled jelly: what its springs and areas cannot find alone, since a step up lies before it.

While a jelly is tangled (inversion.py), each of its particles is joined by a spring of the jelly's own Cs and Cd to its
place in the form, moved and turned to fit the particles (Mueller and others 2005, shape matching). Those springs push
no jelly as a whole, and let it lose its spin; what they add to the body's energy was lost by the body before.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.collision.inversion import group_triangles, wind
from sandbox.physics.constraints import AREA
from sandbox.physics.jit import inner_kernel
from sandbox.physics.solvers.direct.constraint_terms import Shapes, implicit_masses
from sandbox.physics.world import Floats, Slots

# No turn fits where the fit of the best is below this share [1] of what it is to itself: in one point, or a square
# turned inside out. Any value well above rounding will do.
ROUND = 1e-3


class Goals(NamedTuple):
    """The jellies of the matrix by body: g groups of triangles that share sides, of k particles in all.

    of_body (b+1,): first group of each body; start (g+1,): first particle of each; row (k,), form [m] (k, 2); sample
    (g,): an element of each. Of elements (t,): group, -1: in none, and member (t, 3) = their corners among the k.
    inner (k,): whether triangles are all round a particle. turns (k,) and tangled (g,) are scratch.
    """

    of_body: Slots
    start: Slots
    row: Slots
    form: Floats
    sample: Slots
    group: Slots
    member: Slots
    inner: NDArray[np.bool_]
    turns: Slots
    tangled: NDArray[np.bool_]


def lay_out_goals(shapes: Shapes, shape_body: Slots, bodies: int, form: Floats) -> Goals:
    """The jellies among the elements of a pattern, whose corners stand at `form` [m] (q, 2) at rest."""
    count = len(shapes.slot)
    chosen = np.flatnonzero((shapes.kind == AREA) & (shapes.wide < 0))
    corners = shapes.first[:-1][chosen, None] + np.array([0, 1, 2])
    jellies = group_triangles(shapes.row[corners])
    group, member = np.full(count, -1, dtype=np.int64), np.full((count, 3), -1, dtype=np.int64)
    group[chosen], member[chosen] = jellies.group, jellies.member
    # Elements lie by body, and so do their groups, in the order of the first of each.
    sample = chosen[jellies.first]
    return Goals(
        of_body=np.searchsorted(shape_body[sample], np.arange(bodies + 1)),
        start=jellies.start,
        row=jellies.particle,
        form=form[corners.reshape(-1)[jellies.corner]],
        sample=sample,
        group=group,
        member=member,
        inner=jellies.inner,
        turns=np.zeros(len(jellies.particle), dtype=np.int64),
        tangled=np.zeros(len(sample), dtype=np.bool_),
    )


@inner_kernel
def find_tangled(body, low, high, rows, shapes, goals):  # type: ignore[no-untyped-def]
    """Whether any jelly of a body is tangled, and which: into `tangled`."""
    first_group = goals.of_body[body]
    last_group = goals.of_body[body + 1]
    if first_group == last_group:
        return False
    for i in range(goals.start[first_group], goals.start[last_group]):
        goals.turns[i] = 0
    for g in range(first_group, last_group):
        goals.tangled[g] = False
    for k in range(low, high):
        g = goals.group[k]
        if g < 0:
            continue
        wanted = shapes.rest[k, 0]
        if wanted * shapes.rest[k, 1] > 0.0 and not (shapes.error[k] + wanted) * wanted > 0.0:
            goals.tangled[g] = True
        first = shapes.first[k]
        wind(
            rows.position, shapes.row[first], shapes.row[first + 1], shapes.row[first + 2], goals.member, k, goals.turns
        )  # fmt: skip
    any_tangled = False
    for g in range(first_group, last_group):
        round_once = 1 if shapes.rest[goals.sample[g], 1] > 0.0 else -1
        for i in range(goals.start[g], goals.start[g + 1]):
            if goals.inner[i] and goals.turns[i] != round_once:
                goals.tangled[g] = True
        any_tangled = any_tangled or goals.tangled[g]
    return any_tangled


@inner_kernel
def _fit(g, rows, goals):  # type: ignore[no-untyped-def]
    # Centres of a jelly and of its form, its velocity, and cosine and sine of the turn that fits best; 0, 0: none.
    mass = 0.0
    x = y = p = q = u = v = 0.0
    for i in range(goals.start[g], goals.start[g + 1]):
        r = goals.row[i]
        m = rows.mass[r]
        mass += m
        x += m * rows.position[r, 0]
        y += m * rows.position[r, 1]
        p += m * goals.form[i, 0]
        q += m * goals.form[i, 1]
        u += m * rows.target[r, 0]
        v += m * rows.target[r, 1]
    x /= mass
    y /= mass
    p /= mass
    q /= mass
    cosine = sine = own = 0.0
    for i in range(goals.start[g], goals.start[g + 1]):
        r = goals.row[i]
        m = rows.mass[r]
        dx = rows.position[r, 0] - x
        dy = rows.position[r, 1] - y
        ex = goals.form[i, 0] - p
        ey = goals.form[i, 1] - q
        cosine += m * (ex * dx + ey * dy)
        sine += m * (ex * dy - ey * dx)
        own += m * math.sqrt((dx * dx + dy * dy) * (ex * ex + ey * ey))
    length = math.sqrt(cosine * cosine + sine * sine)
    if not length > ROUND * own:
        return x, y, p, q, u / mass, v / mass, 0.0, 0.0
    return x, y, p, q, u / mass, v / mass, cosine / length, sine / length


@inner_kernel
def aim_at_form(body, row_count, anchored, rows, shapes, goals, h, free_count):  # type: ignore[no-untyped-def]
    """Join the tangled jellies of a body, of row_count rows, to their form: into `inertia` and `aim`; if there are any.

    K |v' - w|^2 / 2 with w = the jelly's velocity - Cs / Cd times the way from the place to the particle / h.
    """
    aimed = False
    for g in range(goals.of_body[body], goals.of_body[body + 1]):
        # Of a free body with other parts it would push those: its momentum is kept.
        if not goals.tangled[g] or not (anchored or goals.start[g + 1] - goals.start[g] == row_count):
            continue
        k = goals.sample[g]
        along, pull = implicit_masses(shapes.stiffness[k], shapes.damping[k], 1.0)
        x, y, p, q, u, v, cosine, sine = _fit(g, rows, goals)
        if not along > 0.0 or (cosine == 0.0 and sine == 0.0):
            continue
        aimed = True
        share = min(1.0, pull / along) / h
        for i in range(goals.start[g], goals.start[g + 1]):
            r = goals.row[i]
            if r >= free_count:
                continue
            ex = goals.form[i, 0] - p
            ey = goals.form[i, 1] - q
            wx = u - share * (rows.position[r, 0] - (x + ex * cosine - ey * sine))
            wy = v - share * (rows.position[r, 1] - (y + ex * sine + ey * cosine))
            mass = along * rows.mass[r]
            total = rows.inertia[r] + mass
            rows.aim[r, 0] = (rows.inertia[r] * rows.aim[r, 0] + mass * wx) / total
            rows.aim[r, 1] = (rows.inertia[r] * rows.aim[r, 1] + mass * wy) / total
            rows.inertia[r] = total
    return aimed


@inner_kernel
def let_go(first_row, last_row, rows):  # type: ignore[no-untyped-def]
    """Join the rows of a body to nothing: their inertia is their mass, and they aim at v*."""
    for r in range(first_row, last_row):
        rows.inertia[r] = rows.mass[r]
        rows.aim[r, 0] = rows.target[r, 0]
        rows.aim[r, 1] = rows.target[r, 1]
