"""Feel search: Cs and Cd of a thing's springs with which it overshoots and settles as asked (Broyden 1965).

What a thing makes of Cs and Cd, as the single spring that comes nearest to it, is brought to what a single spring would
need. Whoever has a copy of its world measures what is tried: Python and pages do.
"""

import math

from sandbox.physics.analysis.step_response import (
    OVERSHOOT,
    RESPONSE,
    SETTLING,
    TICK,
    UNSEEN,
    find_shape,
    next_error,
)
from sandbox.physics.arena import NO_ARENA, Arena, begin, is_full, new_floats
from sandbox.physics.arrays import Floats
from sandbox.physics.equation import HIGHEST_COEFFICIENT, TURN, highest_frequency, pole_match
from sandbox.physics.geometry.elementary import exponential, logarithm
from sandbox.physics.jit import inner_kernel, kernel

# Rounds in which a single spring is brought to an overshoot, and in which Cs and Cd of a thing are sought.
ROUNDS, SOUGHT = 12, 10
# The highest frequency that is tried, as a share of the highest that there is, and in a tick; halvings until one
# settles in time.
HIGH, HIGHEST, BISECTIONS = 0.99, 0.4, 40
# How far the search goes at once, and where it has come to what it aimed at, in logarithms.
FARTHEST, REACHED = 3.0, 0.03
# How far off the single spring's Cs and Cd are at most that the search goes on from there alone.
ENOUGH = 0.25
# How near a thing's curve comes to what is asked for until that is enough.
NEAR = 0.01
# Cs and Cd are this at least, and so is what is left by Cd: beyond, a thing is rigid.
LEAST, RIGID, RIGID_WORTH = 1e-12, 1e-4, 9.2

# Numbers of a search: overshoot [1] and settling [s] that are asked, and the tick [s]; Cs and Cd as they are; Cs and Cd
# to try next; whether those have a curve, its overshoot and settling, and Cs and Cd of the single spring nearest to it.
ASKED, STEP_TIME, NOW, TRIED, HAS, GOT, MADE = 0, 2, 3, 5, 7, 8, 10
# How far the best so far is from what is asked, as a share, its Cs and Cd, and its round; this round.
MISSED, BEST, BEST_ROUND, ROUND = 12, 13, 15, 16
# The soonest that a spring settles which overshoots as asked [s], where none does as asked.
SOONEST = 17
# What is aimed at, as overshoot and settling; in logarithms: what a single spring of that is worth, where the search
# is, what is made there, and where it goes; by how much what is made changes with that (2, 2); whether it has yet to
# begin from Cs and Cd as they are, and whether it is anywhere.
AIM, AIMED, AT, AT_MADE, THERE, SLOPES, BEGINS, HAS_AT, SEARCH = 18, 20, 22, 24, 26, 28, 32, 33, 34
# What follows: measure what is to be tried and ask again; the best is found; or why there is none: nothing that was
# tried has a curve; nothing overshoots or settles so; nothing settles as soon.
TRY, OVER, NO_CURVE, NO_SUCH, TOO_SOON = range(5)


@kernel
def seek(arena: Arena, search: Floats) -> int:
    """What follows, TRY to TOO_SOON, of a search whose numbers behind NOW are 0 at first."""
    begin(arena)
    tick, settling = search[STEP_TIME], search[ASKED + 1]
    if not settling > 2.0 * tick:
        return NO_SUCH
    has_curve = search[HAS] != 0.0
    if has_curve:
        # What is aimed at next, if that is to be.
        settling = search[AIM + 1] * settling / max(search[GOT + 1], tick)
    errors = new_floats(arena, _steps(max(settling, search[ASKED + 1]), tick))
    response = new_floats(arena, RESPONSE)
    if is_full(arena):
        return NO_ARENA
    response[TICK] = tick
    if search[ROUND] == 0.0:
        return _begin(search, errors, response)
    if not has_curve and search[MISSED] == math.inf and search[BEGINS] == 0.0:
        return NO_CURVE
    missed = math.inf
    if has_curve:
        missed = max(abs(search[GOT] - search[ASKED]), abs(search[GOT + 1] / search[ASKED + 1] - 1.0))
    if missed < search[MISSED]:
        search[MISSED], search[BEST_ROUND] = missed, search[ROUND]
        search[BEST], search[BEST + 1] = search[TRIED], search[TRIED + 1]
    if missed < NEAR:
        return OVER
    is_nearer = has_curve and _take(search)
    if missed > ENOUGH and search[BEGINS] != 0.0:
        search[BEGINS] = 0.0
        search[THERE], search[THERE + 1] = _worth(search[NOW], search[NOW + 1])
        _try(search)
        search[TRIED], search[TRIED + 1] = search[NOW], search[NOW + 1]
        return TRY
    search[BEGINS] = 0.0
    if not is_nearer and search[ROUND] > 2.0:
        # Too far: springs that are that soft let it lie on something, or turn over.
        for k in range(2):
            search[THERE + k] = 0.5 * (search[THERE + k] + search[AT + k])
        return _try(search)
    if is_nearer and _apart(search) < REACHED * REACHED:
        # It is that single spring by now, and its curve is another one nevertheless: aim to the other side of it.
        overshoot = max(search[AIM] + search[ASKED] - search[GOT], 0.0)
        if _aim(search, overshoot, settling, errors, response) != TRY:
            return OVER
    _leap(search)
    return _try(search)


@inner_kernel
def _take(search: Floats) -> bool:
    # Learn of what was tried, and go on from there if it is nearer to what is aimed at than where the search is.
    made_s, made_d = _worth(search[MADE], search[MADE + 1])
    # What lies on something as a single spring would not says nothing of where it hangs, nor does what is rigid.
    if search[ROUND] > 2.0 and 1.0 - search[MADE + 1] > RIGID and search[AT_MADE + 1] < RIGID_WORTH:
        _learn(search, made_s, made_d)
    before_s, before_d, apart = search[AT_MADE], search[AT_MADE + 1], _apart(search)
    search[AT_MADE], search[AT_MADE + 1] = made_s, made_d
    if search[HAS_AT] != 0.0 and not _apart(search) < apart:
        search[AT_MADE], search[AT_MADE + 1] = before_s, before_d
        return False
    search[HAS_AT] = 1.0
    search[AT], search[AT + 1] = search[THERE], search[THERE + 1]
    return True


@inner_kernel
def _apart(search: Floats) -> float:
    # The square of how far what is made is from what is aimed at.
    s, d = search[AT_MADE] - search[AIMED], search[AT_MADE + 1] - search[AIMED + 1]
    return s * s + d * d


@inner_kernel
def _begin(search: Floats, errors: Floats, response: Floats) -> int:
    # From where it is now, or where a single spring would be: from what is nearer.
    answer = _aim(search, search[ASKED], search[ASKED + 1], errors, response)
    if answer != TRY:
        return answer
    for k in range(2):
        search[THERE + k] = search[AT + k] = search[AIMED + k]
        search[SLOPES + 3 * k] = 1.0
    search[MISSED], search[BEGINS] = math.inf, 1.0
    return _try(search)


@inner_kernel
def _try(search: Floats) -> int:
    if search[ROUND] == SOUGHT:
        return OVER
    search[ROUND] += 1.0
    stiff, firm = exponential(search[THERE]), exponential(search[THERE + 1])
    search[TRIED] = min(stiff / (1.0 + firm), HIGHEST_COEFFICIENT)
    search[TRIED + 1] = min(firm / (1.0 + firm), HIGHEST_COEFFICIENT)
    return TRY


@inner_kernel
def _learn(search: Floats, made_s: float, made_d: float) -> None:
    # How what is made has changed from where the best is to here.
    change_s, change_d = search[THERE] - search[AT], search[THERE + 1] - search[AT + 1]
    square = change_s * change_s + change_d * change_d
    if not square > 0.0:
        return
    for k in range(2):
        made = made_s if k == 0 else made_d
        row = SLOPES + 2 * k
        rest = made - search[AT_MADE + k] - (search[row] * change_s + search[row + 1] * change_d)
        search[row] += rest * change_s / square
        search[row + 1] += rest * change_d / square


@inner_kernel
def _leap(search: Floats) -> None:
    # To where what is made would be what is aimed at, but not too far.
    s, d = search[AIMED] - search[AT_MADE], search[AIMED + 1] - search[AT_MADE + 1]
    a, b, c, e = search[SLOPES], search[SLOPES + 1], search[SLOPES + 2], search[SLOPES + 3]
    determinant = a * e - b * c
    if determinant != 0.0:
        s, d = (e * s - b * d) / determinant, (a * d - c * s) / determinant
    search[THERE] = search[AT] + min(max(s, -FARTHEST), FARTHEST)
    search[THERE + 1] = search[AT + 1] + min(max(d, -FARTHEST), FARTHEST)


@inner_kernel
def _worth(stiffness: float, damping: float) -> tuple[float, float]:
    # Logarithms of Cs / (1 - Cd) and Cd / (1 - Cd): of K beta and K in the implicit form (7), for a mass of 1. A body
    # makes the same share of both, as long as one mode of its moves: in logarithms, the same is added to both.
    left = max(1.0 - damping, RIGID)
    return logarithm(max(stiffness, LEAST) / left), logarithm(max(damping, LEAST) / left)


# ---- single springs


@inner_kernel
def _steps(settling: float, tick: float) -> int:
    return math.ceil(8.0 * settling / tick) + 60


@inner_kernel
def _aim(search: Floats, overshoot: float, settling: float, errors: Floats, response: Floats) -> int:
    # Aim at the single spring that overshoots and settles so. errors, response: scratch for its errors and numbers.
    tick = response[TICK]
    if not (0.0 <= overshoot < 1.0 and settling > 2.0 * tick):
        return NO_SUCH
    errors = errors[0 : _steps(settling, tick)]
    search[AIM], search[AIM + 1] = overshoot, settling
    asked, stiffness, damping = overshoot, 0.0, 0.0
    for _ in range(ROUNDS):
        # exp(-pi z / sqrt(1 - z^2)) of the overshoot, which a spring in ticks misses by a little.
        fall = -2.0 * logarithm(max(asked, UNSEEN)) / TURN
        ratio = fall / math.sqrt(1.0 + fall * fall) if overshoot > UNSEEN else 1.0
        stiffness, damping = _settling_in(settling, ratio, errors, response)
        if stiffness < 0.0:
            search[SOONEST] = damping
            return TOO_SOON
        if overshoot <= UNSEEN or abs(response[OVERSHOOT] - overshoot) < 1e-4 * overshoot:
            break
        asked = min(0.999, asked * overshoot / max(response[OVERSHOOT], UNSEEN))
    search[AIMED], search[AIMED + 1] = _worth(stiffness, damping)
    return TRY


@inner_kernel
def _settling_in(settling: float, ratio: float, errors: Floats, response: Floats) -> tuple[float, float]:
    # Cs and Cd of the spring of a damping ratio that settles in time: the higher its frequency, the sooner it does.
    # Its numbers are in response; below 0, and the soonest: none does.
    tick = response[TICK]
    low, high = 0.1 / settling, min(HIGH * highest_frequency(ratio, tick), HIGHEST / tick)
    soonest = _settles(high, ratio, errors, response)
    if soonest > settling:
        return -1.0, soonest
    for _ in range(BISECTIONS):
        middle = math.sqrt(low * high)
        if _settles(middle, ratio, errors, response) > settling:
            low = middle
        else:
            high = middle
    _settles(high, ratio, errors, response)
    stiffness, damping = pole_match(high, ratio, tick)
    return min(max(stiffness, 0.0), 1.0), damping


@inner_kernel
def _settles(frequency: float, ratio: float, errors: Floats, response: Floats) -> float:
    # When a spring of a frequency [Hz] and a damping ratio has settled [s]; its errors and numbers are found.
    stiffness, damping = pole_match(frequency, ratio, response[TICK])
    before, now = 1.0, 1.0
    for k in range(errors.shape[0]):
        errors[k] = now
        before, now = now, next_error(before, now, stiffness, damping)
    find_shape(errors, response)
    return response[SETTLING]
