"""Cs and Cd of a body as a whole, from what is asked of it; and the nearest that can be had.

A body's slowest wobble moves as one spring with a Cs and Cd of its own (`of_body`). Firmness gives these two: by the
frequency and damping ratio of the wobble, or by the part of its height by which a square of that height and wobble sags
under its weight,

    sag = STANDING g / (F^2 H),   (2 pi F)^2 = k / m = Cs / ((1 - Cd) h^2),   H = height of the form along gravity g

F is the frequency f of the wobble where h is short; at Cs and Cd near 1 the wobble is slower than its k says. What a
body of another form sags by, standing.py says.
"""

import math
from functools import lru_cache
from typing import NamedTuple

from sandbox.physics.arrays import Floats
from sandbox.physics.equation import HIGHEST_COEFFICIENT, TURN, is_reachable, of_springs, pole_match
from sandbox.physics.geometry.elementary import cosine, exponential, rounded, to_three_digits
from sandbox.physics.jit import inner_kernel, kernel, scalar_kernel

# Ways to ask: the sag; the frequency [Hz], at the usual ratio; that and the damping ratio; Cs and Cd themselves.
BY_SAG, BY_FREQUENCY, BY_WOBBLE, BY_PAIR = range(4)
# What comes of it: it is so; no body of that number; its form is not stiff without pins; it has no height along gravity
# to sag by; no Cs and Cd give that, and the nearest is given; the arena is too small.
FIRMED, NO_BODY, NOT_STIFF, NO_HEIGHT, OUT_OF_REACH, NO_ROOM = 0, 1, 2, 3, 4, -1

# F^2 sag H / g of a box that stands on the floor, which holds its foot: 0.75 of that of a free column.
STANDING = 0.0565
# Damping ratio of a sag, where no higher one is needed: it wobbles a few times. Then the least that is possible, and
# a little more.
USUAL_RATIO = 0.15
SPARE_RATIO = 1.05
# Cs and Cd have so many decimals.
DECIMALS = 1e13
# Wobbles that are kept.
KEPT = 256
# Steps of damping ratios, where the least is looked for, and halvings of ranges of frequencies and sags.
RATIO_STEPS = 1_000
HALVINGS = 100


class Asked(NamedTuple):
    """The firmness that is asked for: a way; the sag, frequency [Hz] or Cs; the damping ratio or Cd."""

    way: int
    value: float
    second: float


class Reach(NamedTuple):
    """The limits of a body's firmness: its lowest mode, its height [m] along gravity [m/s^2], and the tick h [s]."""

    lowest_mode: float
    height: float
    gravity: float
    h: float


@scalar_kernel
def sag_of(height: float, gravity: float, h: float, stiffness: float, damping: float) -> float:
    """The sag of a body of these Cs and Cd as a whole; inf where Cs is 0."""
    step = TURN * h
    per_second = stiffness / (1.0 - min(damping, HIGHEST_COEFFICIENT)) / (step * step)
    squares = height * per_second
    return STANDING * gravity / squares if squares > 0.0 else math.inf


@scalar_kernel
def _is_passive(ratio: float, phase: float) -> bool:
    # Cs <= Cd: e <= cos(w h sqrt(1 - z^2)), e = exp(-z w h)
    turn = phase * math.sqrt(max(0.0, 1.0 - ratio * ratio))
    return turn < 0.25 * TURN and exponential(-ratio * phase) <= cosine(turn)


@scalar_kernel
def least_ratio(hz: float, h: float) -> float:
    """The least damping ratio, in thousandths, at which a frequency [Hz] has Cs <= Cd in ticks of h [s].

    So that it makes no energy of nothing: about pi f h.
    """
    phase = TURN * hz * h
    low, high = 0, RATIO_STEPS
    while high - low > 1:
        middle = (low + high) // 2
        if _is_passive(middle / RATIO_STEPS, phase):
            high = middle
        else:
            low = middle
    return high / RATIO_STEPS


@scalar_kernel
def usual_ratio(hz: float, h: float) -> float:
    """Damping ratio of a sag of that frequency [Hz] in ticks of h [s]."""
    return max(USUAL_RATIO, min(1.0, to_three_digits(SPARE_RATIO * least_ratio(hz, h), True)))


@scalar_kernel
def _pair(hz: float, ratio: float, h: float) -> tuple[float, float]:
    stiffness, damping = pole_match(hz, ratio, h)
    stiffness, damping = rounded(min(max(stiffness, 0.0), 1.0), DECIMALS), rounded(damping, DECIMALS)
    # At the least ratio the two are equal but for rounding.
    return min(stiffness, damping), damping


@inner_kernel
def _can_share(reach: Reach, hz: float, ratio: float) -> bool:
    # Whether springs can give the body that, whose Cd is capped.
    if not is_reachable(hz, ratio, reach.h):
        return False
    stiffness, damping = _pair(hz, ratio, reach.h)
    _, shared = of_springs(stiffness, damping, reach.lowest_mode)
    return shared <= HIGHEST_COEFFICIENT


@inner_kernel
def _standing(reach: Reach, sag: float) -> tuple[float, float]:
    # Frequency [Hz] and damping ratio of the wobble of a body that sags so far.
    highest = math.sqrt(STANDING * reach.gravity / (sag * reach.height))
    ratio = usual_ratio(highest, reach.h)
    low, high = 0.0, SPARE_RATIO * highest
    for _ in range(HALVINGS):
        hz = 0.5 * (low + high)
        is_softer = is_reachable(hz, ratio, reach.h)
        if is_softer:
            stiffness, damping = pole_match(hz, ratio, reach.h)
            stiffness = min(max(stiffness, 0.0), 1.0)
            is_softer = sag_of(reach.height, reach.gravity, reach.h, stiffness, damping) > sag
        if hz == (low if is_softer else high):
            break
        if is_softer:
            low = hz
        else:
            high = hz
    return low, ratio


@inner_kernel
def _can_stand(reach: Reach, sag: float) -> bool:
    # Along a ratio that is the least possible anyhow, there is no highest frequency.
    hz, ratio = _standing(reach, sag)
    return _can_share(reach, hz, ratio)


@inner_kernel
def _by_sag(reach: Reach, sag: float, found: Floats) -> int:
    if sag == 0.0:
        found[0] = found[1] = 1.0
        return FIRMED
    if not reach.height > 0.0:
        return NO_HEIGHT
    hz, ratio = _standing(reach, sag)
    if _can_share(reach, hz, ratio):
        found[0], found[1] = _pair(hz, ratio, reach.h)
        return FIRMED
    low, high = 0.0, 1.0 - sag
    for _ in range(HALVINGS):
        less = 0.5 * (low + high)
        can_stand = _can_stand(reach, 1.0 - less)
        if less == (low if can_stand else high):
            break
        if can_stand:
            low = less
        else:
            high = less
    least = to_three_digits(1.0 - low, True)
    found[0], found[1] = least if _can_stand(reach, least) else 0.0, 0.0
    return OUT_OF_REACH


@inner_kernel
def _by_wobble(reach: Reach, asked: Asked, found: Floats) -> int:
    hz, least = asked.value, least_ratio(asked.value, reach.h)
    ratio = asked.second if asked.way == BY_WOBBLE else usual_ratio(hz, reach.h)
    if ratio >= least and _can_share(reach, hz, ratio):
        found[0], found[1] = _pair(hz, ratio, reach.h)
        return FIRMED
    ratio = max(ratio, least)
    if not _can_share(reach, hz, ratio):
        low, high = 0.0, hz
        for _ in range(HALVINGS):
            hz = 0.5 * (low + high)
            if _can_share(reach, hz, ratio):
                low = hz
            else:
                high = hz
        hz = to_three_digits(low, False)
    found[0], found[1] = hz, ratio
    return OUT_OF_REACH


@inner_kernel
def share_out(reach: Reach, asked: Asked, found: Floats) -> int:
    """FIRMED: found (2,) has Cs and Cd of the body as a whole; OUT_OF_REACH: the nearest, as `asked` says it; or none.

    Of a sag the nearest is one; of a frequency, one with a damping ratio.
    """
    if asked.way == BY_SAG:
        return _by_sag(reach, asked.value, found)
    if asked.way == BY_PAIR:
        found[0], found[1] = asked.value, asked.second
        return FIRMED
    return _by_wobble(reach, asked, found)


@kernel
def coefficients_within(
    lowest_mode: float, height: float, gravity: float, h: float, way: int, value: float, second: float, found: Floats
) -> int:
    """`share_out`, for who has no world; see Reach and Asked."""
    return share_out(Reach(lowest_mode, height, gravity, h), Asked(way, value, second), found)


@lru_cache(KEPT)
def wobble_of_square(reach: Reach, sag: float) -> tuple[float, float]:
    """Frequency [Hz] and damping ratio of the wobble that BY_SAG makes of a sag, from which it makes Cs and Cd."""
    hz, ratio = _standing(reach, sag)
    return hz, ratio
