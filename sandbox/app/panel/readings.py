"""Readings in words: numbers, lengths of time, motions and sags as a person says them."""

import math
from collections.abc import Collection

import numpy as np

from sandbox.app.base.sag_map import NO_SAG, sag_sentence, size_word
from sandbox.export.numbers import written_out
from sandbox.physics.analysis.stability import CoefficientLimits
from sandbox.physics.arrays import Floats
from sandbox.physics.softness.body_motion import FLAT, SpringMotion
from sandbox.physics.softness.settling import Support
from sandbox.physics.solvers import SOLVERS

# Names of powers of a thousand, the least first.
_PREFIXES = {-9: "n", -6: "\u00b5", -3: "m", 0: "", 3: "k", 6: "M", 9: "G", 12: "T"}
DIGITS = 3
# What swings for longer than this [s] swings on; what is at rest before is back at once.
LONG, AT_ONCE = 600.0, 0.04
# A smaller share is said to be nothing.
UNSEEN = 1e-5


def number(value: float, digits: int = DIGITS) -> str:
    """A number without an exponent, in this many significant digits; large ones keep all before the point."""
    if not math.isfinite(value):
        return "\u221e" if value > 0.0 else "\u2212\u221e" if value < 0.0 else "?"
    if value == 0.0 or abs(value) < 1e-12:
        return "0"
    return written_out(value, digits)


def with_unit(value: float, unit: str) -> str:
    """A quantity whose unit has a prefix, as in 2.1 mJ or 13 kJ; what rounds to nothing is 0."""
    if not math.isfinite(value):
        return f"{number(value)} {unit}"
    power = 0 if value == 0.0 else 3 * math.floor(math.log10(abs(value)) / 3.0)
    if power < min(_PREFIXES):
        return f"0 {unit}"
    power = min(power, max(_PREFIXES))
    text = number(value / 10.0**power)
    if text in ("1000", "-1000") and power < max(_PREFIXES):
        text, power = text.removesuffix("000"), power + 3
    return f"{text} {_PREFIXES[power]}{unit}"


def seconds(value: float) -> str:
    """A length of time."""
    if value >= 6000.0:
        return "hours"
    return f"{number(value / 60.0, 2)} min" if value >= 100.0 else f"{number(value, 2)} s"


def per_cent(fraction: float, digits: int = 2) -> str:
    """A fraction as per cent."""
    return f"{number(100.0 * fraction, digits)} %" if abs(fraction) >= UNSEEN else "0 %"


def seen(sag: str) -> str:
    """A sag [%] as a text for who need not know how little it is."""
    try:
        return f"< {100.0 * NO_SAG:g}" if 0.0 < float(sag) < 100.0 * NO_SAG else sag
    except ValueError:
        return sag


def motion_words(motion: SpringMotion) -> str:
    """In words how an error decays, and when it is gone."""
    if motion.swings:
        goes_on = motion.rest > LONG
        return "swings on and on" if goes_on else f"swings, at rest after {seconds(motion.rest)}"
    if math.isinf(motion.half):
        return "does not come back"
    if motion.rest < AT_ONCE:
        return "is back at once"
    return f"creeps back, half in {seconds(motion.half)}"


def sag_words(least: float, most: float, name: str | None, supports: Collection[Support]) -> str:
    """How far bodies sag that are held so, from the least to the most; name: of the one that it is, None: several."""
    if name is not None:
        (support,) = supports
        said = sag_sentence(name, support)
        return said.flat if most >= FLAT else said.none if most < NO_SAG else said.sag.format(per_cent(most))
    if least >= FLAT and set(supports) == {Support.FLOOR}:
        return "They lie flat under their own weight"
    sizes = {size_word(support) for support in supports}
    of = f"{sizes.pop()}s" if len(sizes) == 1 else "size"
    if most < NO_SAG:
        return "They do not sag"
    if per_cent(least) == per_cent(most):
        return f"They sag by {per_cent(most)} of their {of}"
    if least < NO_SAG:
        return f"They sag by at most {'more than half' if most > FLAT else per_cent(most)} of their {of}"
    return f"They sag by {per_cent(least)} to {'more than half' if most > FLAT else per_cent(most)} of their {of}"


def stability_words(
    solver: str, limits: CoefficientLimits, stiffness: Floats, damping: Floats, is_plain: bool = False
) -> str:
    """Whether springs of these Cs and Cd (k,) may explode in a solver, in a sentence; is_plain: "" unless they may."""
    is_known = limits.stiffness is not None and limits.damping is not None
    if is_plain and (SOLVERS[solver].bounded or not is_known):
        return ""
    if SOLVERS[solver].bounded:
        if np.any(stiffness > damping):
            return "Cs is above Cd: it may bounce up to four times as high, but never explodes."
        return "Stable: it can only lose energy."
    if limits.stiffness is None or limits.damping is None:
        return "Nothing is proven of this solver: stiff things may explode."
    for values, limit in ((stiffness, limits.stiffness), (damping, limits.damping)):
        if np.any(values >= limit) and limit < 1.0:
            both = f"Cs = Cd = {number(limits.both, 2)}" if limits.both else "nothing"
            return f"May explode: too stiff for a single pass (limit {both} here)."
    return "" if is_plain else "Stable: proven for a single pass."
