"""Wet shapes: what of a disc, a triangle or a side lies below a surface, and between the sides of a pool.

The integral of the depth over what is wet is homogeneous of degree 1 in the depths of a triangle's corners, whose
shares are its gradient (Euler). So it is the sum of the depths times the shares, whichever part of it is meant.
"""

import math

from sandbox.physics.jit import inner_kernel, scalar_kernel

PI = 3.141592653589793
THIRD = 1.0 / 3.0
# On a way of less than this share of the radius the mean is that in its middle, to 1e-6; differences are rounding.
SHORT_WAY = 0.01


@scalar_kernel
def arc_cosine(x: float) -> float:
    """acos(x) to 2e-8, of sums, products and roots alone, so that it has the same bits everywhere."""
    # Abramowitz and Stegun 4.4.46.
    t = abs(x)
    if t >= 1.0:
        return 0.0 if x > 0.0 else PI
    s = 0.0066700901 - 0.0012624911 * t
    s = -0.0170881256 + s * t
    s = 0.0308918810 + s * t
    s = -0.0501743046 + s * t
    s = 0.0889789874 + s * t
    s = -0.2145988016 + s * t
    s = 1.5707963050 + s * t
    s *= math.sqrt(1.0 - t)
    return s if x >= 0.0 else PI - s


@scalar_kernel
def disc_area_below(depth: float, radius: float) -> float:
    """Area [m^2] of a disc below a surface that lies so far [m] above its centre."""
    if depth <= -radius:
        return 0.0
    if depth >= radius:
        return PI * radius * radius
    return radius * radius * arc_cosine(-depth / radius) + depth * math.sqrt(radius * radius - depth * depth)


@scalar_kernel
def disc_depth(depth: float, radius: float) -> float:
    """Integral of the depth over what is wet of a disc [m^3]; depth [m] of its centre."""
    if depth <= -radius:
        return 0.0
    if depth >= radius:
        return PI * radius * radius * depth
    # d A(d) + 2/3 (r^2 - d^2)^(3/2)
    inside = radius * radius - depth * depth
    return depth * disc_area_below(depth, radius) + 2.0 * THIRD * inside * math.sqrt(inside)


@inner_kernel
def clipped(x: float, dx: float, low: float, high: float, s0: float, s1: float) -> tuple[float, float]:
    """The part of s0..s1 in which low <= x + s dx <= high; empty where the second is not above the first."""
    if dx == 0.0:
        return (s0, s1) if low <= x and x <= high else (1.0, 0.0)
    to_low, to_high = (low - x) / dx, (high - x) / dx
    return max(s0, min(to_low, to_high)), min(s1, max(to_low, to_high))


@scalar_kernel
def wet_shares(a: float, b: float, c: float) -> tuple[float, float, float]:
    """Of a triangle whose corners lie so deep [m]: the integral over what is wet of each corner's shape function, over
    the area; 1/3 each where all is wet.
    """
    if a > 0.0 and b > 0.0 and c > 0.0:
        return THIRD, THIRD, THIRD
    if a <= 0.0 and b <= 0.0 and c <= 0.0:
        return 0.0, 0.0, 0.0
    # One corner is alone on its side of the surface.
    if (a > 0.0) != (b > 0.0) and (a > 0.0) != (c > 0.0):
        x, y, z = _beside_alone(a, b, c)
        return x, y, z
    if (b > 0.0) != (a > 0.0) and (b > 0.0) != (c > 0.0):
        y, z, x = _beside_alone(b, c, a)
        return x, y, z
    z, x, y = _beside_alone(c, a, b)
    return x, y, z


@scalar_kernel
def _beside_alone(alone: float, one: float, other: float) -> tuple[float, float, float]:
    # It cuts off the part f = s t of the triangle, with shares (3 - s - t, s, t) f / 3.
    s, t = alone / (alone - one), alone / (alone - other)
    f = s * t * THIRD
    x, y, z = (3.0 - s - t) * f, s * f, t * f
    if alone > 0.0:
        return x, y, z
    return THIRD - x, THIRD - y, THIRD - z


@scalar_kernel
def shares_within(
    x: float, y: float, z: float, left: float, right: float, a: float, b: float, c: float
) -> tuple[float, float, float]:
    """`wet_shares` of what lies between two sides; x, y, z [m]: where the corners are across."""
    p, q, r = wet_shares(a, b, c)
    if min(x, y, z) < left:
        e, f, g = _shares_beyond(left - x, left - y, left - z, a, b, c)
        p, q, r = p - e, q - f, r - g
    if max(x, y, z) > right:
        e, f, g = _shares_beyond(x - right, y - right, z - right, a, b, c)
        p, q, r = p - e, q - f, r - g
    return p, q, r


@scalar_kernel
def _shares_beyond(
    x: float, y: float, z: float, a: float, b: float, c: float
) -> tuple[float, float, float]:  # fmt: skip
    # `wet_shares` of what is beyond a side by more than 0; x, y, z: by how much the corners are.
    if x <= 0.0 and y <= 0.0 and z <= 0.0:
        return 0.0, 0.0, 0.0
    if x > 0.0 and y > 0.0 and z > 0.0:
        p, q, r = wet_shares(a, b, c)
        return p, q, r
    if (x > 0.0) != (y > 0.0) and (x > 0.0) != (z > 0.0):
        p, q, r = _beyond_alone(x, y, z, a, b, c)
        return p, q, r
    if (y > 0.0) != (x > 0.0) and (y > 0.0) != (z > 0.0):
        q, r, p = _beyond_alone(y, z, x, b, c, a)
        return p, q, r
    r, p, q = _beyond_alone(z, x, y, c, a, b)
    return p, q, r


@scalar_kernel
def _beyond_alone(
    alone: float, one: float, other: float, a: float, b: float, c: float
) -> tuple[float, float, float]:  # fmt: skip
    # The side cuts off a triangle like the whole, with one corner on each of the two edges: of those shares of its own.
    s, t = alone / (alone - one), alone / (alone - other)
    p, q, r = wet_shares(a, a + s * (b - a), a + t * (c - a))
    x, y, z = s * t * (p + q * (1.0 - s) + r * (1.0 - t)), s * t * s * q, s * t * t * r
    if alone > 0.0:
        return x, y, z
    p, q, r = wet_shares(a, b, c)
    return p - x, q - y, r - z


@scalar_kernel
def disc_share_within(to_left: float, to_right: float, radius: float) -> float:
    """The part of a disc between two sides that lie so far [m] on its left and on its right."""
    if to_left >= radius and to_right >= radius:
        return 1.0
    whole = PI * radius * radius
    return max(0.0, disc_area_below(to_left, radius) + disc_area_below(to_right, radius) - whole) / whole


@scalar_kernel
def mean_disc_area(depth: float, later: float, radius: float) -> float:
    """The mean of `disc_area_below` on the way from one depth [m] to another."""
    way = later - depth
    if abs(way) <= SHORT_WAY * radius:
        return disc_area_below(depth + 0.5 * way, radius)
    return (disc_depth(later, radius) - disc_depth(depth, radius)) / way
