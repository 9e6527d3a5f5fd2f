"""Which way three places turn, and whether the circle through three holds a fourth: exact, of places in whole numbers.

Floats decide where their error cannot, which is nearly always (Shewchuk 1997); else whole numbers in digits.
"""

from sandbox.physics.arrays import SlotRows, Slots
from sandbox.physics.jit import inner_kernel

# Coordinates stay below this, whatever the frame adds: differences are whole as floats, and have two digits.
FARTHEST = 2.0**40
# Bits of a digit. Products of two digits, and sums of some of them, have 64 bits.
BITS, DIGIT = 24, (1 << 24) - 1
# A determinant of floats is as far from the true one at most, as a share of the sum of its terms without their signs.
TURN_ERROR, CIRCLE_ERROR = 3.3306690738754716e-16, 1.1102230246251577e-15
# Scratch: digits of a sum, and of two factors.
SUM, FACTOR = 9, 5
SCRATCH = SUM + 2 * FACTOR


@inner_kernel
def turn_of(a: int, b: int, c: int, site: SlotRows) -> int:
    """1 where c lies on the left of the way from a to b, -1 on its right, 0 on it; a, b, c: rows of sites (n, 2)."""
    ux = site[b, 0] - site[a, 0]
    uy = site[b, 1] - site[a, 1]
    vx = site[c, 0] - site[a, 0]
    vy = site[c, 1] - site[a, 1]
    one = float(ux) * float(vy)
    other = float(uy) * float(vx)
    bound = TURN_ERROR * (abs(one) + abs(other))
    if one - other > bound:
        return 1
    if other - one > bound:
        return -1
    low = (ux & DIGIT) * (vy & DIGIT) - (uy & DIGIT) * (vx & DIGIT)
    middle = (ux >> BITS) * (vy & DIGIT) + (ux & DIGIT) * (vy >> BITS)
    middle -= (uy >> BITS) * (vx & DIGIT) + (uy & DIGIT) * (vx >> BITS)
    middle += low >> BITS
    high = (ux >> BITS) * (vy >> BITS) - (uy >> BITS) * (vx >> BITS) + (middle >> BITS)
    return _sign(high, (low & DIGIT) | (middle & DIGIT))


@inner_kernel
def _sign(high: int, rest: int) -> int:
    # The sign of a number by its highest digit, and by those below, of which none is below 0.
    if high != 0:
        return 1 if high > 0 else -1
    return 1 if rest > 0 else 0


@inner_kernel
def circle_holds(a: int, b: int, c: int, d: int, site: SlotRows, scratch: Slots) -> bool:
    """Whether d lies inside the circle through a, b and c, counter-clockwise; rows of sites (n, 2)."""
    x = site[d, 0]
    y = site[d, 1]
    ax = site[a, 0] - x
    ay = site[a, 1] - y
    bx = site[b, 0] - x
    by = site[b, 1] - y
    cx = site[c, 0] - x
    cy = site[c, 1] - y
    of_a, bound_a = _term(float(ax), float(ay), float(bx), float(by), float(cx), float(cy))
    of_b, bound_b = _term(float(bx), float(by), float(cx), float(cy), float(ax), float(ay))
    of_c, bound_c = _term(float(cx), float(cy), float(ax), float(ay), float(bx), float(by))
    found = of_a + of_b + of_c
    bound = CIRCLE_ERROR * (bound_a + bound_b + bound_c)
    if abs(found) > bound:
        return found > 0.0
    for k in range(SUM):
        scratch[k] = 0
    _add_term(ax, ay, bx, by, cx, cy, scratch)
    _add_term(bx, by, cx, cy, ax, ay, scratch)
    _add_term(cx, cy, ax, ay, bx, by, scratch)
    rest = 0
    for k in range(SUM - 1):
        scratch[k + 1] += scratch[k] >> BITS
        rest |= scratch[k] & DIGIT
    return _sign(scratch[SUM - 1], rest) > 0


@inner_kernel
def _term(px: float, py: float, qx: float, qy: float, rx: float, ry: float) -> tuple[float, float]:
    # |p|^2 times q x r, and the same without signs.
    lifted = px * px + py * py
    one = qx * ry
    other = qy * rx
    return lifted * (one - other), lifted * (abs(one) + abs(other))


@inner_kernel
def _add_term(px: int, py: int, qx: int, qy: int, rx: int, ry: int, scratch: Slots) -> None:
    # The same in digits, added to a sum.
    for k in range(SUM, SCRATCH):
        scratch[k] = 0
    _add_product(px, px, 1, SUM, scratch)
    _add_product(py, py, 1, SUM, scratch)
    _add_product(qx, ry, 1, SUM + FACTOR, scratch)
    _add_product(qy, rx, -1, SUM + FACTOR, scratch)
    for first in (SUM, SUM + FACTOR):
        for k in range(first, first + FACTOR - 1):
            scratch[k + 1] += scratch[k] >> BITS
            scratch[k] &= DIGIT
    for k in range(FACTOR):
        for other in range(FACTOR):
            scratch[k + other] += scratch[SUM + k] * scratch[SUM + FACTOR + other]


@inner_kernel
def _add_product(one: int, other: int, sign: int, first: int, scratch: Slots) -> None:
    scratch[first] += sign * (one & DIGIT) * (other & DIGIT)
    scratch[first + 1] += sign * ((one >> BITS) * (other & DIGIT) + (one & DIGIT) * (other >> BITS))
    scratch[first + 2] += sign * (one >> BITS) * (other >> BITS)
