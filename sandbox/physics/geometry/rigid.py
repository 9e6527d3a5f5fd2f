"""The rigid motion of a set of points, and the turn by which a form fits it best.

X = sum m x / M,  V = sum m v / M,  I = sum m |x - X|^2,  L = sum m (x - X) x (v - V)
v = V + L / I perp(x - X)                          at any place x of a rigid body
cos : sin = sum w f . d : sum w f x d              turns places f of the form to d, both about their means:
                                                   shape matching (Mueller and others 2005)
"""

import math
from typing import NamedTuple

from sandbox.physics.arrays import FloatRows, Slots
from sandbox.physics.jit import inlined_kernel, inner_kernel, scalar_kernel


class WeightedSums(NamedTuple):
    """Sums of weights, and of two vectors (x, y) and (u, v) times these: of masses, say, with places and velocities."""

    weight: float
    x: float
    y: float
    u: float
    v: float


class RigidMotion(NamedTuple):
    """Rigid motion of points: centre of mass (x, y) [m], velocity (u, v) [m/s], inertia [kg m^2] and angular momentum
    [kg m^2/s] about that.
    """

    x: float
    y: float
    u: float
    v: float
    inertia: float
    momentum: float


class FormFit(NamedTuple):
    """Fit of a form to places: the middle of those (x, y) [m] and that of the form, and both sums of the best turn."""

    x: float
    y: float
    form_x: float
    form_y: float
    along: float
    across: float


@inlined_kernel
def with_point(sums: WeightedSums, m: float, x: float, y: float, u: float, v: float) -> WeightedSums:
    """The sums with one more point of weight m and its vectors."""
    return WeightedSums(sums.weight + m, sums.x + m * x, sums.y + m * y, sums.u + m * u, sums.v + m * v)


@inlined_kernel
def centre_of(sums: WeightedSums) -> RigidMotion:
    """The means of both vectors, about which inertia and angular momentum are still to be summed up."""
    m = sums.weight
    return RigidMotion(sums.x / m, sums.y / m, sums.u / m, sums.v / m, 0.0, 0.0)


@inlined_kernel
def momentum_about(motion: RigidMotion, m: float, x: float, y: float, u: float, v: float) -> float:
    """The angular momentum [kg m^2/s] of a mass at (x, y), of the velocity (u, v), beside a motion of its centre."""
    return m * ((x - motion.x) * (v - motion.v) - (y - motion.y) * (u - motion.u))


@inlined_kernel
def with_spin(motion: RigidMotion, inertia: float, momentum: float) -> RigidMotion:
    """A motion with so much more inertia [kg m^2] and angular momentum [kg m^2/s]."""
    return RigidMotion(motion.x, motion.y, motion.u, motion.v, motion.inertia + inertia, motion.momentum + momentum)


@inlined_kernel
def with_turn(motion: RigidMotion, m: float, x: float, y: float, u: float, v: float) -> RigidMotion:
    """A motion with the inertia and angular momentum of one more mass at (x, y), of the velocity (u, v)."""
    dx, dy = x - motion.x, y - motion.y
    return with_spin(motion, m * (dx * dx + dy * dy), momentum_about(motion, m, x, y, u, v))


@inlined_kernel
def turn_rate(motion: RigidMotion) -> float:
    """The spin [rad/s] of a rigid body of this motion; 0 for a point."""
    return motion.momentum / motion.inertia if motion.inertia > 0.0 else 0.0


@inlined_kernel
def velocity_at(motion: RigidMotion, x: float, y: float) -> tuple[float, float]:
    """The velocity [m/s] at (x, y) of a rigid body of this motion."""
    turn = turn_rate(motion)
    return motion.u - turn * (y - motion.y), motion.v + turn * (x - motion.x)


@scalar_kernel
def best_turn(along: float, across: float) -> tuple[float, float]:
    """Cosine and sine of the turn that fits best, by the sums that `with_pair` adds up; none where these are 0."""
    length = math.sqrt(along * along + across * across)
    return (along / length, across / length) if length > 0.0 else (1.0, 0.0)


@inlined_kernel
def with_pair(
    along: float, across: float, weight: float, fx: float, fy: float, dx: float, dy: float
) -> tuple[float, float]:
    """Both sums of the best turn with one more place d, whose place in the form is f."""
    return along + weight * (fx * dx + fy * dy), across + weight * (fx * dy - fy * dx)


@inlined_kernel
def rotated(cosine: float, sine: float, x: float, y: float) -> tuple[float, float]:
    """A vector turned by the angle of this cosine and sine."""
    return cosine * x - sine * y, sine * x + cosine * y


@inner_kernel
def fit_of(form: FloatRows, place: FloatRows, rows: Slots) -> FormFit:
    """How the form [m] (n, 2) of some rows fits their places [m] (n, 2) best; all of them weigh the same."""
    sums = WeightedSums(0.0, 0.0, 0.0, 0.0, 0.0)
    for i in range(rows.shape[0]):
        p = rows[i]
        sums = with_point(sums, 1.0, place[p, 0], place[p, 1], form[p, 0], form[p, 1])
    x, y, form_x, form_y, _, _ = centre_of(sums)
    along = across = 0.0
    for i in range(rows.shape[0]):
        p = rows[i]
        along, across = with_pair(
            along, across, 1.0, form[p, 0] - form_x, form[p, 1] - form_y, place[p, 0] - x, place[p, 1] - y
        )
    return FormFit(x, y, form_x, form_y, along, across)
