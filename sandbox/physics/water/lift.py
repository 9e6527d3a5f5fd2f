"""Lift: the gradient of the energy U of all that water cannot enter, as its mean over the way of a step.

    triangle  density g A times the integral of each corner's shape function over what is wet; A = the area that its
              constraint wants, so that soft bodies are not crushed by the depth
    hull      as triangles from its middle to each edge, with the area that it is to have
    disc      density g times the area that is wet

A pool is what lies below its surface less what lies below its floor, between its sides. So what floors, seams and sides
cut is lifted by the part that is in, and pools flush on each other are one.

Velocities are half a step behind places. At x - h v / 2 and x + h v' / 2 they belong together, and a lift that is the
mean of U's gradient on the straight way between the two gives just what U loses (a discrete gradient: Gonzalez 1996),

    (m / 2) (v'^2 - v^2) = h F (v + v') / 2 = U(x - h v / 2) - U(x + h v' / 2)

whatever the step, the density and the speed.
"""

import math

from sandbox.physics.jit import inner_kernel
from sandbox.physics.state import State
from sandbox.physics.water.displacers import BOTTOM, DENSITY, FY, LEFT, RIGHT, TOP, Water
from sandbox.physics.water.shapes import (
    PI,
    disc_depth,
    disc_share_within,
    mean_disc_area,
    shares_within,
)

# Places at which what passes a surface is looked at on its way.
PLACES = 4
# [m]: on ways shorter than that the difference of two energies is rounding.
SHORT_WAY = 1e-6
# Columns of a corner [m]: where it is across, and how high at the start of its way and at the end.
ACROSS, BEFORE, AFTER = range(3)
# A height [m] that no water has.
ABOVE_ALL = 1e300


@inner_kernel
def lift_due(water: Water, state: State, g: float) -> None:
    """Lift the particles that are due, on the way from `before` to `after`: FY [N] of their load; those are `wet`."""
    for p in range(water.due.shape[0]):
        if water.due[p]:
            water.load[p, FY] = 0.0
    for k in range(water.pool.shape[0]):
        weight = water.pool[k, DENSITY] * g
        for i in range(water.triangle.shape[0]):
            _lift_triangle(water, k, i, weight * abs(state.constraint_rest[water.constraint[i], 0]))
        for o in range(water.shell_start.shape[0] - 1):
            _lift_shell(water, k, o, weight * area_of(water, o, state))
        for i in range(water.disc.shape[0]):
            p = water.disc[i]
            if water.due[p]:
                add_lift(water, p, weight * _mean_area(water, k, i, state))


@inner_kernel
def add_lift(water: Water, p: int, force: float) -> None:
    """Lift a particle, if it is due."""
    if water.due[p] and force != 0.0:
        water.load[p, FY] += force
        water.wet[p] = True


@inner_kernel
def _set_corner(water: Water, row: int, p: int) -> None:
    water.corner[row, ACROSS] = 0.5 * (water.before[p, 0] + water.after[p, 0])
    water.corner[row, BEFORE] = water.before[p, 1]
    water.corner[row, AFTER] = water.after[p, 1]


@inner_kernel
def _lift_triangle(water: Water, k: int, i: int, weight: float) -> None:
    p, q, r = water.triangle[i, 0], water.triangle[i, 1], water.triangle[i, 2]
    if not (water.due[p] or water.due[q] or water.due[r]):
        return
    _set_corner(water, 0, p)
    _set_corner(water, 1, q)
    _set_corner(water, 2, r)
    at_p, at_q, at_r = _mean_shares(water, k)
    add_lift(water, p, weight * at_p)
    add_lift(water, q, weight * at_q)
    add_lift(water, r, weight * at_r)


@inner_kernel
def _set_middle(water: Water, o: int) -> None:
    # The mean of the corners of a hull.
    first, last, corner = water.shell_start[o], water.shell_start[o + 1], water.corner
    for column in range(3):
        corner[0, column] = 0.0
    for e in range(first, last):
        _set_corner(water, 1, water.shell_a[e])
        for column in range(3):
            corner[0, column] += corner[1, column] / (last - first)


@inner_kernel
def area_of(water: Water, o: int, state: State) -> float:
    """Area [m^2] that hull o displaces when it is all wet."""
    k = water.shell_constraint[o]
    return abs(state.constraint_rest[k, 0]) if k >= 0 else water.shell_area[o]


@inner_kernel
def _lift_shell(water: Water, k: int, o: int, weight: float) -> None:
    # Triangles from the middle to each edge; what lifts the middle lifts all corners alike.
    first, last = water.shell_start[o], water.shell_start[o + 1]
    is_due = False
    for e in range(first, last):
        is_due = is_due or water.due[water.shell_a[e]]
    if not is_due:
        return
    at_middle, is_wet = 0.0, False
    _set_middle(water, o)
    for e in range(first, last):
        a, b = water.shell_a[e], water.shell_b[e]
        _set_corner(water, 1, a)
        _set_corner(water, 2, b)
        at_c, at_a, at_b = _mean_shares(water, k)
        part = weight * water.shell_share[e]
        add_lift(water, a, part * at_a)
        add_lift(water, b, part * at_b)
        at_middle += part * at_c
        is_wet = is_wet or at_c + at_a + at_b > 0.0
    if is_wet:
        for e in range(first, last):
            add_lift(water, water.shell_a[e], at_middle / (last - first))
            water.wet[water.shell_a[e]] = True


@inner_kernel
def _is_beside(water: Water, k: int) -> bool:
    # Whether the corners are all on one side of a pool.
    x, left, right = water.corner, water.pool[k, LEFT], water.pool[k, RIGHT]
    return (x[0, ACROSS] <= left and x[1, ACROSS] <= left and x[2, ACROSS] <= left) or (
        x[0, ACROSS] >= right and x[1, ACROSS] >= right and x[2, ACROSS] >= right
    )


@inner_kernel
def _mean_shares(water: Water, k: int) -> tuple[float, float, float]:
    # Of the corners, a triangle: the mean over their way of each one's share of what is in a pool, over the area.
    at = water.corner
    lowest = min(at[0, BEFORE], at[0, AFTER], at[1, BEFORE], at[1, AFTER])
    lowest = min(lowest, at[2, BEFORE], at[2, AFTER])
    if lowest >= water.pool[k, TOP] or _is_beside(water, k):
        return 0.0, 0.0, 0.0
    x, y, z = _mean_below(water, k, water.pool[k, TOP])
    if lowest < water.pool[k, BOTTOM]:
        e, f, g = _mean_below(water, k, water.pool[k, BOTTOM])
        x, y, z = x - e, y - f, z - g
    return x, y, z


@inner_kernel
def _shares_below(water: Water, k: int, a: float, b: float, c: float) -> tuple[float, float, float]:
    corner = water.corner
    x, y, z = shares_within(
        corner[0, ACROSS], corner[1, ACROSS], corner[2, ACROSS], water.pool[k, LEFT], water.pool[k, RIGHT], a, b, c
    )
    return x, y, z


@inner_kernel
def _mean_below(water: Water, k: int, level: float) -> tuple[float, float, float]:
    # The same of what is below a level.
    at = water.corner
    a, b, c = level - at[0, BEFORE], level - at[1, BEFORE], level - at[2, BEFORE]
    d, e, f = at[0, BEFORE] - at[0, AFTER], at[1, BEFORE] - at[1, AFTER], at[2, BEFORE] - at[2, AFTER]
    if max(a, a + d, b, b + e) <= 0.0 and max(c, c + f) <= 0.0:
        return 0.0, 0.0, 0.0
    if min(a, a + d, b, b + e) >= 0.0 and min(c, c + f) >= 0.0:
        x, y, z = _shares_below(water, k, 1.0, 1.0, 1.0)
        return x, y, z
    p = q = r = 0.0
    for place in range(PLACES):
        s = (place + 0.5) / PLACES
        x, y, z = _shares_below(water, k, a + s * d, b + s * e, c + s * f)
        p, q, r = p + x / PLACES, q + y / PLACES, r + z / PLACES
    # Of the sum of those that which makes it the energy.
    squared = d * d + e * e + f * f
    if squared > SHORT_WAY * SHORT_WAY:
        later = _depth_below(water, k, a + d, b + e, c + f) - _depth_below(water, k, a, b, c)
        more = (later - (p * d + q * e + r * f)) / squared
        p, q, r = p + more * d, q + more * e, r + more * f
    return p, q, r


@inner_kernel
def _depth_below(water: Water, k: int, a: float, b: float, c: float) -> float:
    # Integral of the depth over the area.
    x, y, z = _shares_below(water, k, a, b, c)
    return a * x + b * y + c * z


@inner_kernel
def radius_of(water: Water, i: int, state: State) -> float:
    """Radius [m] of the disc that displaces water."""
    area = water.disc_area[i]
    return math.sqrt(area / PI) if area > 0.0 else state.radius[water.disc[i]]


@inner_kernel
def disc_within(water: Water, k: int, x: float, radius: float) -> float:
    """The part of a disc that is between the sides of a pool."""
    if not radius > 0.0:
        return 0.0
    return disc_share_within(x - water.pool[k, LEFT], water.pool[k, RIGHT] - x, radius)


@inner_kernel
def _mean_area(water: Water, k: int, i: int, state: State) -> float:
    # Mean over its way of the area of a disc that is in a pool.
    p, radius = water.disc[i], radius_of(water, i, state)
    low, high = water.before[p, 1], water.after[p, 1]
    top, bottom = water.pool[k, TOP], water.pool[k, BOTTOM]
    if min(low, high) >= top + radius:
        return 0.0
    within = disc_within(water, k, 0.5 * (water.before[p, 0] + water.after[p, 0]), radius)
    if not within > 0.0:
        return 0.0
    area = mean_disc_area(top - low, top - high, radius)
    if min(low, high) < bottom + radius:
        area -= mean_disc_area(bottom - low, bottom - high, radius)
    return within * area


@inner_kernel
def add_energies(water: Water, state: State, g: float) -> None:
    """Add what U [J] of all that is due gains on the way from `before` to `after` to `lifted` at a particle of each."""
    for k in range(water.pool.shape[0]):
        weight = water.pool[k, DENSITY] * g
        for i in range(water.triangle.shape[0]):
            p = _free_of(state, water.triangle[i, 0], water.triangle[i, 1], water.triangle[i, 2])
            if water.due[p]:
                for corner in range(3):
                    _set_corner(water, corner, water.triangle[i, corner])
                area = abs(state.constraint_rest[water.constraint[i], 0])
                water.lifted[p] += weight * area * _gain_of_corners(water, k)
        for o in range(water.shell_start.shape[0] - 1):
            first = water.shell_start[o]
            p = _free_of(state, water.shell_a[first], water.shell_b[first], water.shell_a[first])
            if not water.due[p]:
                continue
            _set_middle(water, o)
            area = area_of(water, o, state)
            for e in range(first, water.shell_start[o + 1]):
                _set_corner(water, 1, water.shell_a[e])
                _set_corner(water, 2, water.shell_b[e])
                water.lifted[p] += weight * area * water.shell_share[e] * _gain_of_corners(water, k)
        for i in range(water.disc.shape[0]):
            p = water.disc[i]
            if water.due[p]:
                water.lifted[p] += weight * _gain_of_disc(water, k, i, state)


@inner_kernel
def _gain_of_corners(water: Water, k: int) -> float:
    # What the integral of the depth in a pool, below its floor that of all of it, gains on the way, over the area.
    at, top, bottom = water.corner, water.pool[k, TOP], water.pool[k, BOTTOM]
    lowest = min(at[0, BEFORE], at[0, AFTER], at[1, BEFORE], at[1, AFTER])
    lowest = min(lowest, at[2, BEFORE], at[2, AFTER])
    if lowest >= top or _is_beside(water, k):
        return 0.0
    gain = _depth_below(water, k, top - at[0, AFTER], top - at[1, AFTER], top - at[2, AFTER])
    gain -= _depth_below(water, k, top - at[0, BEFORE], top - at[1, BEFORE], top - at[2, BEFORE])
    if lowest < bottom:
        gain -= _depth_below(water, k, bottom - at[0, AFTER], bottom - at[1, AFTER], bottom - at[2, AFTER])
        gain += _depth_below(water, k, bottom - at[0, BEFORE], bottom - at[1, BEFORE], bottom - at[2, BEFORE])
    return gain


@inner_kernel
def _gain_of_disc(water: Water, k: int, i: int, state: State) -> float:
    p, radius, top, bottom = water.disc[i], radius_of(water, i, state), water.pool[k, TOP], water.pool[k, BOTTOM]
    low, high = water.before[p, 1], water.after[p, 1]
    if min(low, high) >= top + radius:
        return 0.0
    within = disc_within(water, k, 0.5 * (water.before[p, 0] + water.after[p, 0]), radius)
    if not within > 0.0:
        return 0.0
    gain = disc_depth(top - high, radius) - disc_depth(top - low, radius)
    if min(low, high) < bottom + radius:
        gain -= disc_depth(bottom - high, radius) - disc_depth(bottom - low, radius)
    return within * gain


@inner_kernel
def _free_of(state: State, p: int, q: int, r: int) -> int:
    # The first of some particles that can move, or the last.
    if state.inverse_mass[p] > 0.0:
        return p
    return q if state.inverse_mass[q] > 0.0 else r
