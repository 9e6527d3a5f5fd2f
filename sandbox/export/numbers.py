"""Numbers as texts for people and for programs."""

import math
from collections.abc import Callable
from decimal import ROUND_FLOOR, Context

DIGITS = 3
# Below and from these, three digits are shown with a power of ten.
SMALLEST, LARGEST = 1e-4, 1e7


def short(value: float) -> str:
    """A number with three digits, for a person, without powers of ten where that can be read."""
    if value == 0.0 or not math.isfinite(value):
        return "0" if value == 0.0 else "infinite"
    if not SMALLEST <= abs(value) < LARGEST:
        return f"{value:.{DIGITS}g}"
    return written_out(value, DIGITS)


def written_out(value: float, digits: int) -> str:
    """A number other than 0 in this many significant digits, without a power of ten; none below 1e-12 is shown."""
    rounded = float(f"{value:.{digits}g}")
    decimals = max(0, digits - 1 - math.floor(math.log10(abs(rounded))))
    text = f"{rounded:.{min(decimals, 12)}f}"
    return text.rstrip("0").rstrip(".") if "." in text else text


def exact(value: float) -> str:
    """A number with all its digits, as programs read it back."""
    return repr(float(value) + 0.0)


def percent(fraction: float) -> str:
    """A share as per cent, with three digits."""
    return f"{short(100.0 * fraction)} %"


def floored(value: float, inside: Callable[[float], bool]) -> float:
    """The largest number of three digits that is at most `value` and inside; 0 where there is none but that."""
    context = Context(prec=DIGITS, rounding=ROUND_FLOOR)
    number = context.create_decimal(repr(float(value)))
    # A value that lies on the edge of what is inside is one step below it at most, but for rounding.
    for _ in range(3):
        if inside(float(number)):
            return float(number)
        number = context.next_minus(number)
    return 0.0
