"""Exponential, cosine, their inverses, decimals and sums in + - * / and roots alone: the same bits everywhere.

Within exponential and cosine a number is a pair: the nearest one, and what that lacks, some 32 digits together. So
results are the nearest numbers there are, but for one in many millions, and those of a good library. Logarithms and arc
cosines are right but for their last bits. Sums are made in an order of ours.
Sources: Dekker 1971, of pairs; Taylor, after halving the argument.
"""

import math

import numpy as np

from sandbox.physics.arrays import Floats
from sandbox.physics.jit import scalar_kernel

# Numbers times this, and what is left, are the upper and the lower half of their digits.
_SPLITTER = 134217729.0
# ln 2 and the full turn as pairs.
_LN2, _LN2_REST = 0.6931471805599453, 2.3190468138462996e-17
_TURN, _TURN_REST = 6.283185307179586, 2.4492935982947064e-16
# Below this power of e there are no numbers.
_LOWEST_POWER = -750.0
# Doublings of the argument after the series, and terms of it.
_EXPONENT_DOUBLINGS, _EXPONENT_TERMS = 3, 14
_COSINE_DOUBLINGS, _COSINE_TERMS = 4, 10
# Terms of the series of inverses, whose argument is below a fifth; what numbers are halved or doubled to be below of.
_INVERSE_TERMS, _ROOT_OF_TWO = 13, 1.4142135623730951


@scalar_kernel
def sum_pair(a: float, b: float) -> tuple[float, float]:
    """The sum of two numbers as a pair."""
    total = a + b
    of_b = total - a
    return total, (a - (total - of_b)) + (b - of_b)


@scalar_kernel
def product_pair(a: float, b: float) -> tuple[float, float]:
    """The product of two numbers as a pair."""
    product = a * b
    a_up, b_up = _SPLITTER * a, _SPLITTER * b
    a_up, b_up = a_up - (a_up - a), b_up - (b_up - b)
    a_low, b_low = a - a_up, b - b_up
    return product, ((a_up * b_up - product) + a_up * b_low + a_low * b_up) + a_low * b_low


@scalar_kernel
def _times(a: float, a_rest: float, b: float, b_rest: float) -> tuple[float, float]:
    product, rest = product_pair(a, b)
    return sum_pair(product, rest + (a * b_rest + a_rest * b))


@scalar_kernel
def _over(a: float, a_rest: float, divisor: float) -> tuple[float, float]:
    quotient = a / divisor
    product, rest = product_pair(quotient, divisor)
    return sum_pair(quotient, (((a - product) - rest) + a_rest) / divisor)


@scalar_kernel
def _less(whole: float, a: float, a_rest: float) -> tuple[float, float]:
    # whole - a
    total, rest = sum_pair(whole, -a)
    return sum_pair(total, rest - a_rest)


@scalar_kernel
def _remainder(x: float, count: float, unit: float, unit_rest: float) -> tuple[float, float]:
    # x less so many units, where little of x is left.
    product, rest = product_pair(count, unit)
    return sum_pair(x - product, -(rest + count * unit_rest))


@scalar_kernel
def exponential(x: float) -> float:
    """e^x of a number of at most 700."""
    if not x > _LOWEST_POWER:
        return 0.0
    halves = math.floor(x / _LN2 + 0.5)
    small = 1.0 / (1 << _EXPONENT_DOUBLINGS)
    r, r_rest = _remainder(x, halves * 1.0, _LN2, _LN2_REST)
    r, r_rest = small * r, small * r_rest
    # e^r = 1 + r (1 + r/2 (1 + r/3 (...)))
    power, rest = 1.0, 0.0
    for back in range(_EXPONENT_TERMS):
        power, rest = _times(power, rest, r, r_rest)
        power, rest = _over(power, rest, 1.0 * (_EXPONENT_TERMS - back))
        power, rest = _less(1.0, -power, -rest)
    for _ in range(_EXPONENT_DOUBLINGS):
        power, rest = _times(power, rest, power, rest)
    for _ in range(abs(halves)):
        power = 2.0 * power if halves > 0 else 0.5 * power
    return power


@scalar_kernel
def cosine(x: float) -> float:
    """The cosine of an angle, at most some millions."""
    turns = math.floor(x / _TURN + 0.5)
    small = 1.0 / (1 << _COSINE_DOUBLINGS)
    r, r_rest = _remainder(x, turns * 1.0, _TURN, _TURN_REST)
    square, square_rest = _times(small * r, small * r_rest, small * r, small * r_rest)
    # 1 - cos r = r^2 / 2 (1 - r^2 / (3 4) (1 - r^2 / (5 6) (...)))
    lack, rest = 1.0, 0.0
    for back in range(_COSINE_TERMS):
        odd = 2.0 * (_COSINE_TERMS - back) + 1.0
        lack, rest = _times(lack, rest, square, square_rest)
        lack, rest = _over(lack, rest, odd * (odd + 1.0))
        lack, rest = _less(1.0, lack, rest)
    lack, rest = _times(lack, rest, 0.5 * square, 0.5 * square_rest)
    for _ in range(_COSINE_DOUBLINGS):
        # 1 - cos 2 r = 2 (1 - cos r) (2 - (1 - cos r))
        other, other_rest = _less(2.0, lack, rest)
        lack, rest = _times(2.0 * lack, 2.0 * rest, other, other_rest)
    lack, rest = _less(1.0, lack, rest)
    return lack


@scalar_kernel
def logarithm(x: float) -> float:
    """The natural logarithm of a positive, finite number."""
    doublings = 0
    while x > _ROOT_OF_TWO:
        x *= 0.5
        doublings += 1
    while x * _ROOT_OF_TWO < 1.0:
        x *= 2.0
        doublings -= 1
    part = (x - 1.0) / (x + 1.0)
    return doublings * _LN2 + (doublings * _LN2_REST + 2.0 * part * _odd_series(part * part))


@scalar_kernel
def logarithm_beside_one(x: float) -> float:
    """The natural logarithm of 1 + x, which keeps the digits of a small x, above -1."""
    if abs(x) > 0.4:
        return logarithm(1.0 + x)
    part = x / (2.0 + x)
    return 2.0 * part * _odd_series(part * part)


@scalar_kernel
def arc_cosine(x: float) -> float:
    """The angle, 0 to half a turn, of this cosine, -1 to 1."""
    # x = (1 - t^2) / (1 + t^2) of the tangent t of half the angle; of a steep one the rest of a quarter turn.
    is_steep = x < 0.0
    tangent = math.sqrt((1.0 - abs(x)) / (1.0 + abs(x)))
    for _ in range(2):
        tangent /= 1.0 + math.sqrt(1.0 + tangent * tangent)
    angle = 8.0 * tangent * _odd_series(-(tangent * tangent))
    return 0.5 * _TURN - angle if is_steep else angle


@scalar_kernel
def _odd_series(square: float) -> float:
    # 1 + x^2 / 3 + x^4 / 5 + ...
    total = 0.0
    for back in range(_INVERSE_TERMS):
        total = total * square + 1.0 / (2.0 * (_INVERSE_TERMS - 1 - back) + 1.0)
    return total


@scalar_kernel
def rounded(value: float, decimals: float) -> float:
    """The nearest number of some decimals: `decimals` is a power of ten; of two as near, the even one, as round gives.

    A value of 2^53 units of the last decimal or more is given back.
    """
    units, rest = product_pair(value, decimals)
    if not abs(units) < 9007199254740992.0:
        return value
    whole = math.floor(units)
    beyond = (units - whole) - 0.5
    if beyond > -rest or (beyond == -rest and whole % 2 == 1):
        whole += 1
    return whole / decimals


@scalar_kernel
def to_three_digits(value: float, is_up: bool) -> float:
    """A number of 0 or more, of some 1e-19 to 1e15, at three digits: the nearest from above or from below."""
    if not value > 0.0:
        return 0.0
    # 100 <= value parts / units < 1000
    parts, units = 1.0, 1.0
    while value * parts < 100.0:
        parts *= 10.0
    while value >= 1000.0 * units:
        units *= 10.0
    # Exact, as a product of the smaller of the two.
    scaled, rest = product_pair(value, parts)
    digits = math.floor(scaled / units)
    if digits * units > scaled or (digits * units == scaled and rest < 0.0):
        digits -= 1
    if digits < 100:
        # It rounds to what it is below of.
        digits, parts = 999, 10.0 * parts
        scaled, rest = product_pair(value, parts)
    if is_up and (digits * units < scaled or rest > 0.0):
        digits += 1
    return digits * units / parts


def sum_in_order(values: Floats) -> float:
    """The sum of values (n,), added one after another from the first; 0 of none."""
    # Partial sums can only be made in order, other than by numpy.sum.
    return float(np.add.accumulate(values)[-1]) if len(values) else 0.0
