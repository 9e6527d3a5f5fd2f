"""Constraints of several corners: areas of polygons and angles between two links, in the same equation.

Any scalar constraint C(x) of gradient g has the effective mass 1 / (sum of w |g|^2); with C for the distance error and
dC/dt for the velocity error, Cs and Cd mean what they mean for a spring (Nissen 2019). The mass is that of the rest
shape: that of the present one is infinite where a triangle lies flat.

    area constraint      C = A - A0 [m^2], A signed and counter-clockwise, of a polygon of three corners or more
    bending constraint   C = 4 sin(phi / 4), phi = the angle at the middle corner less its angle at rest

The bend's torque is that of 2 sin(phi / 2): most for a link that is folded back, where sin(phi) would let go.
"""

import math
from typing import NamedTuple

import numpy as np

from sandbox.physics.arrays import Flags, FloatRows, Floats, Int8s, Int32s
from sandbox.physics.geometry.segment import SHORTEST, lengths, polygon_area
from sandbox.physics.jit import inlined_kernel, inner_kernel, kernel
from sandbox.physics.state import GoodValues, State, StateArrays

AREA = 0
BEND = 1
# For a person: what each kind is called, and the corner that it is at.
CONSTRAINT_NAMES = {AREA: ("area", 0), BEND: ("bend", 1)}
# Corners of an area that is all shape: it and its sides agree in one.
TRIANGLE = 3
# Cs and Cd at most of an area of more corners, whose size its sides may not allow: at 0.999 a rigid skin that is blown
# up shakes for seconds at 20 m/s, at 1 for ever at 90; at 0.95 it breathes.
HIGHEST_RING_COEFFICIENT = 0.99
# The gradient of an angle grows as 1 / length; a link shorter than its rest length over this [1] bends as if it were
# that long. A higher bound makes crushed links stiffer than a factorisation can hold, a lower one costs them spin.
STEEPEST = 30.0
# The direct solver holds a triangle from outside at this share of its area. Higher stiffens what is merely squeezed,
# lower leaves more to the clamp of triangles, which takes motion where this stores its energy.
FLOOR = 0.25
# Strength of the floor, k h^2 / m of a spring at FLOOR_RATE [Hz]: somewhat more than Cs 0.9, Cd 0.99; one k [N/m] for
# every number of substeps. Weaker lets loads through, stronger makes what lands on its floors rebound.
FLOOR_STRENGTH = 100.0
FLOOR_RATE = 60.0


class ConstraintArrays(NamedTuple):
    """Constraints as kernels read them: t of them, whose corners lie one after another in q rows.

    kind (t,), first (t,) and corners (t,) = where its corners begin and how many they are, rest (t, 2) = area wanted
    and area of the form [m^2], or cosine and sine of the angle at rest; active (t,); particle (q,) = slots, weight
    (q,) = |g|^2 at rest.
    """

    kind: Int8s
    first: Int32s
    corners: Int32s
    rest: FloatRows
    active: Flags
    particle: Int32s
    weight: Floats


@inlined_kernel
def constraints_of(state: State | StateArrays) -> ConstraintArrays:
    """The constraints among the arrays of a world."""
    return ConstraintArrays(
        state.constraint_kind, state.constraint_first, state.constraint_corners, state.constraint_rest,
        state.constraint_active, state.corner_particle, state.corner_weight,
    )  # fmt: skip


@inner_kernel
def _bend(place: FloatRows, first: int, cosine: float, sine: float, weight: Floats, slope: FloatRows) -> float:
    # e = the first link, turned by the rest angle; phi from e to the second link: cos(phi / 2) = |e + n| / 2,
    # sin(phi / 2) = |n - e| / 2, and the halves of those; no trigonometry.
    ax, ay = place[first + 1, 0] - place[first, 0], place[first + 1, 1] - place[first, 1]
    bx, by = place[first + 2, 0] - place[first + 1, 0], place[first + 2, 1] - place[first + 1, 1]
    a, b = math.sqrt(ax * ax + ay * ay), math.sqrt(bx * bx + by * by)
    if not (a > SHORTEST and b > SHORTEST):
        # A link of no length has no angle.
        for c in range(first, first + 3):
            slope[c, 0] = slope[c, 1] = 0.0
        return 0.0
    ax /= a
    ay /= a
    bx /= b
    by /= b
    ex = ax * cosine - ay * sine
    ey = ax * sine + ay * cosine
    half_cosine = 0.5 * math.sqrt((ex + bx) * (ex + bx) + (ey + by) * (ey + by))
    half_sine = 0.5 * math.sqrt((bx - ex) * (bx - ex) + (by - ey) * (by - ey))
    if ex * by - ey * bx < 0.0:
        half_sine = -half_sine
    quarter_cosine = math.sqrt(0.5 * (1.0 + half_cosine))
    at_a = quarter_cosine * min(1.0 / a, STEEPEST * math.sqrt(weight[first]))
    at_b = quarter_cosine * min(1.0 / b, STEEPEST * math.sqrt(weight[first + 2]))
    slope[first, 0] = -ay * at_a
    slope[first, 1] = ax * at_a
    slope[first + 2, 0] = -by * at_b
    slope[first + 2, 1] = bx * at_b
    slope[first + 1, 0] = -(slope[first, 0] + slope[first + 2, 0])
    slope[first + 1, 1] = -(slope[first, 1] + slope[first + 2, 1])
    return 2.0 * half_sine / quarter_cosine


@inner_kernel
def evaluate(
    kind: int, place: FloatRows, first: int, last: int, rest: FloatRows, at: int, weight: Floats, slope: FloatRows
) -> float:
    """C of the constraint of rest[at] whose corners first..last are at place (q, 2); its gradient into slope (q, 2)."""
    if kind != AREA:
        return _bend(place, first, rest[at, 0], rest[at, 1], weight, slope)
    # dA / dx_i = the vector between its two neighbours, turned, over 2
    for c in range(first, last):
        previous = c - 1 if c > first else last - 1
        following = c + 1 if c + 1 < last else first
        slope[c, 0] = 0.5 * (place[following, 1] - place[previous, 1])
        slope[c, 1] = 0.5 * (place[previous, 0] - place[following, 0])
    return polygon_area(place, first, last) - rest[at, 0]


@inner_kernel
def rest_mass(first: int, last: int, inverse_mass: Floats, particle: Int32s, weight: Floats) -> float:
    """Effective mass of the corners first..last at rest; 0 where nothing of them can move."""
    # m = 1 / (sum of w |g|^2)  (17)
    total = 0.0
    for c in range(first, last):
        total += inverse_mass[particle[c]] * weight[c]
    return 1.0 / total if total > 0.0 else 0.0


@inner_kernel
def look(first: int, last: int, position: FloatRows, particle: Int32s, place: FloatRows) -> None:
    """Bring the corners first..last to where their particles are."""
    for c in range(first, last):
        place[c, 0] = position[particle[c], 0]
        place[c, 1] = position[particle[c], 1]


@inner_kernel
def constraint_rate(first: int, last: int, velocity: FloatRows, particle: Int32s, slope: FloatRows) -> float:
    """dC/dt of the constraint of the corners first..last whose gradient is slope (q, 2)."""
    rate = 0.0
    for c in range(first, last):
        rate += slope[c, 0] * velocity[particle[c], 0] + slope[c, 1] * velocity[particle[c], 1]
    return rate


@kernel
def constraint_values(
    position: FloatRows, inverse_mass: Floats, constraints: ConstraintArrays, place: FloatRows, value: Floats,
    mass: Floats, slope: FloatRows,
) -> None:  # fmt: skip
    """C (t,) and effective mass (t,) of all active constraints, 0 of others, with their gradients (q, 2)."""
    for k in range(constraints.kind.shape[0]):
        first = constraints.first[k]
        last = first + constraints.corners[k]
        value[k] = mass[k] = 0.0
        if constraints.active[k]:
            look(first, last, position, constraints.particle, place)
            value[k] = evaluate(constraints.kind[k], place, first, last, constraints.rest, k, constraints.weight, slope)
            mass[k] = rest_mass(first, last, inverse_mass, constraints.particle, constraints.weight)


@inner_kernel
def explicit_mass(
    first: int, last: int, inverse_mass: Floats, particle: Int32s, weight: Floats, slope: FloatRows
) -> tuple[float, float]:
    """Effective mass for a step on the old velocities: the less of the rest shape's and the present one's.

    Second: its share of the present one's.
    """
    # No impulse then changes dC/dt by more than was wanted, however a corner is crushed.
    rest = 0.0
    present = 0.0
    for c in range(first, last):
        w = inverse_mass[particle[c]]
        rest += w * weight[c]
        present += w * (slope[c, 0] * slope[c, 0] + slope[c, 1] * slope[c, 1])
    most = max(rest, present)
    return (1.0 / most, present / most) if most > 0.0 else (0.0, 0.0)


@inner_kernel
def measure_rest(kind: int, form: FloatRows, first: int, last: int, rest: FloatRows, at: int, weight: Floats) -> None:
    """Rest of the constraint of the corners first..last that has this form [m] (q, 2), and their weights (q,).

    Of an area that wants what it has there.
    """
    if kind == AREA:
        rest[at, 0] = rest[at, 1] = polygon_area(form, first, last)
        for c in range(first, last):
            previous = c - 1 if c > first else last - 1
            following = c + 1 if c + 1 < last else first
            dx, dy = form[following, 0] - form[previous, 0], form[following, 1] - form[previous, 1]
            weight[c] = 0.25 * (dx * dx + dy * dy)
        return
    ax, ay = form[first + 1, 0] - form[first, 0], form[first + 1, 1] - form[first, 1]
    bx, by = form[first + 2, 0] - form[first + 1, 0], form[first + 2, 1] - form[first + 1, 1]
    a, b = math.sqrt(ax * ax + ay * ay), math.sqrt(bx * bx + by * by)
    if not (a > 0.0 and b > 0.0):
        rest[at, 0], rest[at, 1] = 1.0, 0.0
        weight[first] = weight[first + 1] = weight[first + 2] = 0.0
        return
    ax /= a
    ay /= a
    bx /= b
    by /= b
    rest[at, 0], rest[at, 1] = ax * bx + ay * by, ax * by - ay * bx
    middle_x, middle_y = ax / a + bx / b, ay / a + by / b
    weight[first], weight[first + 2] = 1.0 / (a * a), 1.0 / (b * b)
    weight[first + 1] = middle_x * middle_x + middle_y * middle_y


@inner_kernel
def measure_constraint(state: State, good: GoodValues, k: int, factor: float) -> None:
    """Measure the rest of a constraint by its form, as values to return to too; factor: area wanted over the form's."""
    first = state.constraint_first[k]
    last = first + state.constraint_corners[k]
    rest, weight = state.constraint_rest, state.corner_weight
    measure_rest(state.constraint_kind[k], state.corner_form, first, last, rest, k, weight)
    if state.constraint_kind[k] == AREA:
        rest[k, 0] *= factor
    for axis in range(2):
        good.constraint_rest[k, axis] = rest[k, axis]
    for c in range(first, last):
        good.corner_weight[c] = weight[c]


@kernel
def measure_rests(kind: int, form: FloatRows, rest: FloatRows, weight: Floats) -> None:
    """`measure_rest` of constraints of one kind (t,), each of the same number of corners."""
    count = rest.shape[0]
    size = form.shape[0] // max(1, count)
    for k in range(count):
        measure_rest(kind, form, k * size, (k + 1) * size, rest, k, weight)


def rests_of(kind: int, places: Floats, inflation: Floats) -> tuple[Floats, Floats]:
    """Rest (t, 2) and weights (t k,) of constraints of one kind that have these forms [m] (t, k, 2).

    inflation (t,): area wanted as a multiple of the form's. Raises ValueError for a bend with a link of no length.
    """
    rest, weight = np.zeros((len(places), 2)), np.zeros(places.shape[0] * places.shape[1])
    if kind == BEND and not np.all(lengths(np.diff(places, axis=1)) > 0.0):
        raise ValueError("a bend joins two links, each with a length")
    measure_rests(kind, np.ascontiguousarray(places.reshape(-1, 2)), rest, weight)
    if kind == AREA:
        rest[:, 0] = inflation * rest[:, 1]
    return rest, weight
