"""Step response: how a thing comes back that is pulled aside in a copy of its world and let go, tick by tick.

One particle is held a little aside until all else rests, and let go; how far it is from its place, as a share of the
first, is the curve. A second copy, in which nothing is pulled, says where its place is, as it is held and later: what
moves by itself does not count. Whoever has the copies steps them as `follow_release` says: Python and pages do.

Its numbers are those of a step response: overshoot, settling time, and the single spring that comes nearest to it.
"""

import math

from sandbox.physics.arena import Arena, begin, is_full, new_flags, new_slots
from sandbox.physics.arrays import Flags, Floats, Slots
from sandbox.physics.commands.command import Commanded
from sandbox.physics.components import find_joined
from sandbox.physics.equation import HIGHEST_COEFFICIENT, frequency_from_coefficients
from sandbox.physics.jit import Bundle, inlined_kernel, inner_kernel, kernel, unpack
from sandbox.physics.settings import GRAVITY_X, GRAVITY_Y, TICK_RATE
from sandbox.physics.state import State

# Pulls that are tried, as shares of the thing's size: as a finger pokes, then so little that nothing slips or yields.
POKE, LEAST_PULL = 0.01, 1e-4
# Longest wait for all to rest before the pull and while it lasts, and longest curve [s].
MOST_BEFORE, MOST_HELD, MOST_SECONDS = 10.0, 10.0, 30.0
# It rests once nothing of it moves further in a second than this share of the pull, three ticks in a row. The curve
# rests where it stays as near for so long [s], or for this part of it: slow swings stand still as they turn.
STILL, STILL_TICKS, WINDOW, WINDOW_PART = 1e-3, 3, 0.5, 0.3
# What does not come back within this share of the pull has been moved for good.
LEFT = 0.05
# The share of the work that is the wait before the pull, and that of one pull.
WAIT, PULL = 0.2, 0.4
# An error has settled once no more than this share of the first is left; overshoots below the other are none.
SETTLED, UNSEEN = 0.02, 0.002
# How far points of a curve may be from it, as a share of the way, and what is left when a curve ends.
CLOSE, ENDED = 0.005, 0.002
# Rounds in which a single spring is fitted to a curve, and what ends them; the lowest Cs and Cd that it may have.
FITS, FITTED, LEAST_FITTED = 40, 1e-15, 1e-9

# Numbers of a release: what is pulled, along which way (2), the size of its thing [m], ticks in a second.
PARTICLE, ALONG, SIZE, RATE = 0, 1, 3, 4
# How much of it is done, 0..1; place [m] and velocity [m/s] at which the particle is held; how far it is pulled [m];
# the share of that which is left in the end; how many errors there are.
DONE, HELD, PULLED, REST, COUNT = 5, 6, 10, 11, 12
# Its stage, the number of its pull, ticks of the stage, and those that rested one after another; then the errors.
STAGE, NUMBER, TICKS, RESTED, ERRORS = 13, 14, 15, 16, 17
WAITING, BEGINNING, HOLDING, COMING_BACK = range(4)
# What follows: step the copy that nothing pulls; keep it, copy it twice and pin the particle in the second copy; hold
# the particle there, before both copies are stepped; unpin it first, hold it, and step both; step both; there is the
# curve. Or why there is none: it moves on, it goes further than it was pulled, it stays away.
STEP, BEGIN, HOLD, LET_GO, FREE, FOUND, MOVES_ON, GOES_FURTHER, STAYS_AWAY = range(9)
# Why nothing can be pulled: nothing of it is free to move; nothing holds it; it has no size.
NOTHING_FREE, NOTHING_HOLDS, NO_SIZE = -1, -2, -3
# Numbers of a response: its tick [s], which is given; overshoot [1] and settling [s]; how often it passes its place by
# more than SETTLED; Cs and Cd of the nearest spring, its frequency [Hz] and damping ratio; how far both are apart.
TICK, OVERSHOOT, SETTLING, SWINGS, STIFFNESS, DAMPING, FREQUENCY, RATIO, DIFFERENCE, RESPONSE = range(10)


def release_length(rate: int) -> int:
    """How many numbers a release has at a tick rate [1/s]."""
    return ERRORS + round(MOST_SECONDS * rate) + 2


# ---- what is pulled


@kernel
def choose_pull(
    arena: Arena, pointer: Bundle[Commanded], springs: Slots, touching: Slots, is_aside: int, release: Floats
) -> int:
    """The particle to pull of the thing of some springs, or why there is none; and a release of it begins.

    It is what is farthest from all that holds the thing: pins that it is joined to, and what it lies on. touching: the
    particles of all contacts. It is pulled as gravity has it, or across that.
    """
    begin(arena)
    world = unpack(pointer)
    state = world.state
    count = state.inverse_mass.shape[0]
    label = new_slots(arena, count)
    is_own = new_flags(arena, count)
    is_joined = new_flags(arena, count)
    holds = new_flags(arena, count)
    if is_full(arena):
        return NOTHING_FREE
    find_joined(state, state.spring_active, state.particle_active, label)
    for s in range(springs.shape[0]):
        for p in (state.particle_a[springs[s]], state.particle_b[springs[s]]):
            is_own[p] = True
            is_joined[label[p]] = True
    for p in range(count):
        holds[p] = is_joined[label[p]] and state.particle_active[p] and state.inverse_mass[p] == 0.0
    for k in range(touching.shape[0]):
        holds[touching[k]] = holds[touching[k]] or is_joined[label[touching[k]]]
    _aim(world, is_own, is_aside != 0, release)
    chosen = _farthest(state, is_own, holds) if release[SIZE] > 0.0 else NO_SIZE
    release[PARTICLE] = 1.0 * max(chosen, 0)
    return chosen


@inner_kernel
def _aim(world: Commanded, is_own: Flags, is_aside: bool, release: Floats) -> None:
    # Which way a thing is pulled, its size, and the tick rate.
    x, y = world.numbers[GRAVITY_X], world.numbers[GRAVITY_Y]
    length = math.sqrt(x * x + y * y)
    if not length > 0.0:
        x, y, length = 0.0, -1.0, 1.0
    if is_aside:
        x, y = -y, x
    release[ALONG], release[ALONG + 1] = x / length, y / length
    position = world.state.position
    size = 0.0
    for axis in range(2):
        low, high = math.inf, -math.inf
        for p in range(is_own.shape[0]):
            if is_own[p]:
                low, high = min(low, position[p, axis]), max(high, position[p, axis])
        size = max(size, high - low)
    release[SIZE] = size
    release[RATE] = 1.0 * world.choices[TICK_RATE]


@inner_kernel
def _farthest(state: State, is_own: Flags, holds: Flags) -> int:
    # The free particle of a thing that is farthest from the nearest of what holds it.
    chosen, most = NOTHING_FREE, -1.0
    for p in range(is_own.shape[0]):
        if not is_own[p] or not state.inverse_mass[p] > 0.0:
            continue
        nearest = math.inf
        for q in range(holds.shape[0]):
            if holds[q]:
                dx = state.position[q, 0] - state.position[p, 0]
                dy = state.position[q, 1] - state.position[p, 1]
                nearest = min(nearest, dx * dx + dy * dy)
        if nearest == math.inf:
            return NOTHING_HOLDS
        if nearest > most:
            chosen, most = p, nearest
    return chosen


# ---- how it is pulled and comes back


@kernel
def follow_release(release: Floats, still: Floats, still_v: Floats, pulled: Floats, pulled_v: Floats) -> int:
    """What follows, STEP to STAYS_AWAY; after BEGIN and after each step it is asked again.

    still, pulled: places (2 n,) [m] of the particles of both copies, still_v, pulled_v: their velocities [m/s]. The
    numbers of a release behind RATE are 0 after the first step, when it is asked first.
    """
    stage = int(release[STAGE])
    if stage == WAITING:
        ticks = math.floor(MOST_BEFORE * release[RATE] + 0.5)
        if _goes_on(release, _fastest(still_v) <= STILL * release[SIZE], ticks, 0.0, WAIT):
            return STEP
        _turn_to(release, BEGINNING)
        return BEGIN
    first = WAIT + PULL * release[NUMBER]
    if stage == BEGINNING:
        release[PULLED] = release[SIZE] * (POKE if release[NUMBER] == 0.0 else LEAST_PULL)
        _hold(release, still, still_v)
        _turn_to(release, HOLDING)
        return HOLD
    if stage == HOLDING:
        ticks = math.floor(MOST_HELD * release[RATE] + 0.5)
        is_still = _apart(release, still_v, pulled_v) <= STILL * release[PULLED]
        _hold(release, still, still_v)
        if _goes_on(release, is_still, ticks, first, 0.5 * PULL):
            return HOLD
        _turn_to(release, COMING_BACK)
        release[COUNT] = 0.0
        _note(release, still, release[HELD], release[HELD + 1])
        return LET_GO
    at = 2 * int(release[PARTICLE])
    _note(release, still, pulled[at], pulled[at + 1])
    ticks = math.floor(MOST_SECONDS * release[RATE] + 0.5)
    if _goes_on(release, False, ticks, first + 0.5 * PULL, 0.5 * PULL) and not _rests(release):
        return FREE
    return _judge(release)


@inner_kernel
def _turn_to(release: Floats, stage: int) -> None:
    release[STAGE], release[TICKS], release[RESTED] = 1.0 * stage, 0.0, 0.0


@inner_kernel
def _goes_on(release: Floats, is_still: bool, ticks: int, first: float, part: float) -> bool:
    # Whether a stage of at most so many ticks goes on, which is a part of the work from the first on.
    release[TICKS] += 1.0
    release[RESTED] = release[RESTED] + 1.0 if is_still else 0.0
    release[DONE] = first + part * release[TICKS] / ticks
    return release[RESTED] < STILL_TICKS and release[TICKS] < ticks


@inner_kernel
def _fastest(velocity: Floats) -> float:
    fastest = 0.0
    for k in range(velocity.shape[0]):
        fastest = max(fastest, abs(velocity[k]))
    return fastest


@inner_kernel
def _apart(release: Floats, still_v: Floats, pulled_v: Floats) -> float:
    # How fast both copies part, and how fast the place is where the particle is held.
    at = 2 * int(release[PARTICLE])
    fastest = max(abs(still_v[at]), abs(still_v[at + 1]))
    for k in range(still_v.shape[0]):
        if k != at and k != at + 1:
            fastest = max(fastest, abs(pulled_v[k] - still_v[k]))
    return fastest


@inner_kernel
def _hold(release: Floats, still: Floats, still_v: Floats) -> None:
    # Where it would be moves by itself, where a motor runs or what holds it swings.
    at = 2 * int(release[PARTICLE])
    for axis in range(2):
        release[HELD + axis] = still[at + axis] + release[PULLED] * release[ALONG + axis]
        release[HELD + 2 + axis] = still_v[at + axis]


@inner_kernel
def _note(release: Floats, still: Floats, x: float, y: float) -> None:
    # How far the particle is from where it would be without a pull.
    at = 2 * int(release[PARTICLE])
    error = (x - still[at]) * release[ALONG] + (y - still[at + 1]) * release[ALONG + 1]
    release[ERRORS + int(release[COUNT])] = error
    release[COUNT] += 1.0


@inner_kernel
def _window(release: Floats) -> int:
    return max(2, math.floor(WINDOW * release[RATE]), math.floor(WINDOW_PART * release[COUNT]))


@inner_kernel
def _rests(release: Floats) -> bool:
    count, window = int(release[COUNT]), _window(release)
    if count <= window:
        return False
    low, high = math.inf, -math.inf
    for k in range(count - window, count):
        low, high = min(low, release[ERRORS + k]), max(high, release[ERRORS + k])
    return high - low <= STILL * release[PULLED]


@inner_kernel
def _judge(release: Floats) -> int:
    # Whether a pull gave a curve, whose errors become shares of the way; else the next pull, or why there is none.
    count = int(release[COUNT])
    window, first = min(_window(release), count), release[ERRORS]
    total, most = 0.0, 0.0
    for k in range(count):
        most = max(most, abs(release[ERRORS + k]))
        if k >= count - window:
            total += release[ERRORS + k]
    end = total / window
    release[REST] = end / first
    # What is let go from rest never goes further than it was pulled, as long as it neither slips nor breaks.
    is_further = most > (1.0 + LEFT) * first
    if abs(release[REST]) <= LEFT and not is_further:
        for k in range(count):
            release[ERRORS + k] = (release[ERRORS + k] - end) / (first - end)
        release[DONE] = 1.0
        return FOUND
    if release[NUMBER] == 0.0:
        release[NUMBER] = 1.0
        _turn_to(release, BEGINNING)
        return BEGIN
    if count > MOST_SECONDS * release[RATE]:
        return MOVES_ON
    return GOES_FURTHER if is_further else STAYS_AWAY


# ---- its numbers


@kernel
def measure_response(errors: Floats, response: Floats) -> None:
    """Find the numbers of a curve of errors, a tick apart, which is 1 first. response: its TICK is given."""
    find_shape(errors, response)
    stiffness, damping = _nearest_spring(errors)
    response[STIFFNESS], response[DAMPING] = stiffness, damping
    response[FREQUENCY], response[RATIO] = frequency_from_coefficients(stiffness, damping, response[TICK])
    miss = 0.0
    before, now = 1.0, 1.0
    for k in range(errors.shape[0]):
        miss = max(miss, abs(now - errors[k]))
        before, now = now, next_error(before, now, stiffness, damping)
    response[DIFFERENCE] = miss


@kernel
def find_shape(errors: Floats, response: Floats) -> None:
    """Overshoot, settling and swings alone of a curve of errors."""
    count = errors.shape[0]
    last = 0
    lowest, swings = 0.0, 0
    for k in range(count):
        if abs(errors[k]) > SETTLED:
            last = k
        if k > 0 and k < count - 1 and _turns(errors, k):
            peak = _peak(errors[k - 1], errors[k], errors[k + 1])
            lowest = min(lowest, peak)
            swings += 1 if abs(peak) > SETTLED else 0
    before = abs(errors[last])
    after, is_across = 0.0, True
    if last + 1 < count:
        after, is_across = abs(errors[last + 1]), not errors[last] * errors[last + 1] > 0.0
    share = 0.0
    if before > SETTLED:
        share = (before - SETTLED) / (before + after if is_across else before - after)
    response[OVERSHOOT] = -lowest if -lowest > UNSEEN else 0.0
    response[SETTLING] = response[TICK] * (last + share)
    response[SWINGS] = 1.0 * swings


@inner_kernel
def _turns(errors: Floats, k: int) -> bool:
    # Whether an error after the start is a turning point.
    a, b, c = errors[k - 1], errors[k], errors[k + 1]
    return (b - a) * (c - b) < 0.0 or (b == a and b != c and k > 1)


@inner_kernel
def _peak(a: float, b: float, c: float) -> float:
    # The turning point of a cosine about 0 through three ticks: parabolas cut quick swings short.
    if not abs(a + c) < 2.0 * abs(b):
        return b
    cosine = (a + c) / (2.0 * b)
    across = (c - a) / (2.0 * math.sqrt(1.0 - cosine * cosine))
    peak = math.sqrt(b * b + across * across)
    return peak if b > 0.0 else -peak


@inlined_kernel
def next_error(before: float, now: float, stiffness: float, damping: float) -> float:
    """The error of a single spring a tick later: x'' = (2 - Cs - Cd) x' - (1 - Cd) x, with x' = x first."""
    return now - stiffness * now + (1.0 - damping) * (now - before)


@inner_kernel
def _nearest_spring(errors: Floats) -> tuple[float, float]:
    # Cs and Cd of the single spring whose errors come nearest, by least squares (Levenberg 1944, Marquardt 1963).
    stiffness, damping = _recurrence(errors)
    value, damp = _squares(errors, stiffness, damping), 1e-3
    for _ in range(FITS):
        ss, sd, dd, s, d = _slopes(errors, stiffness, damping)
        is_fitted = True
        for _ in range(FITS):
            a, c = ss + damp * (ss + 1e-12), dd + damp * (dd + 1e-12)
            determinant = a * c - sd * sd
            if not determinant > 0.0:
                break
            next_s = _within(stiffness - (c * s - sd * d) / determinant)
            next_d = _within(damping - (a * d - sd * s) / determinant)
            reached = _squares(errors, next_s, next_d)
            if reached < value:
                is_fitted = value - reached <= FITTED * (1.0 + value)
                stiffness, damping, value = next_s, next_d, reached
                damp *= 0.25
                break
            damp *= 8.0
        if is_fitted:
            break
    return stiffness, damping


@inner_kernel
def _within(coefficient: float) -> float:
    return min(max(coefficient, LEAST_FITTED), HIGHEST_COEFFICIENT)


@inner_kernel
def _squares(errors: Floats, stiffness: float, damping: float) -> float:
    # The sum of the squared misses of a spring.
    before, now, total = 1.0, 1.0, 0.0
    for k in range(errors.shape[0]):
        total += (now - errors[k]) * (now - errors[k])
        before, now = now, next_error(before, now, stiffness, damping)
    return total


@inner_kernel
def _slopes(errors: Floats, stiffness: float, damping: float) -> tuple[float, float, float, float, float]:
    # Products of the slopes of a spring's errors by Cs and by Cd with each other, and with its misses.
    before, now = 1.0, 1.0
    s_before, s_now, d_before, d_now = 0.0, 0.0, 0.0, 0.0
    ss, sd, dd, s, d = 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(errors.shape[0]):
        miss = now - errors[k]
        ss += s_now * s_now
        sd += s_now * d_now
        dd += d_now * d_now
        s += s_now * miss
        d += d_now * miss
        s_next = next_error(s_before, s_now, stiffness, damping) - now
        d_next = next_error(d_before, d_now, stiffness, damping) - (now - before)
        s_before, s_now, d_before, d_now = s_now, s_next, d_now, d_next
        before, now = now, next_error(before, now, stiffness, damping)
    return ss, sd, dd, s, d


@inner_kernel
def _recurrence(errors: Floats) -> tuple[float, float]:
    # x'' - 2 x' + x = -Cs x' - Cd (x' - x) by least squares, with the step before it was let go: x' = x.
    ss, sd, dd, s, d = 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(errors.shape[0] - 1):
        now = errors[k]
        change = now - errors[k - 1] if k > 0 else 0.0
        bend = errors[k + 1] - now - change
        ss += now * now
        sd += now * change
        dd += change * change
        s -= now * bend
        d -= change * bend
    determinant = ss * dd - sd * sd
    if not determinant > 0.0:
        return min(max(s / ss if ss > 0.0 else 0.5, 1e-6), HIGHEST_COEFFICIENT), HIGHEST_COEFFICIENT
    stiffness, damping = (dd * s - sd * d) / determinant, (ss * d - sd * s) / determinant
    return min(max(stiffness, 1e-6), HIGHEST_COEFFICIENT), min(max(damping, 1e-6), HIGHEST_COEFFICIENT)


@kernel
def thin_curve(errors: Floats, kept: Floats) -> int:
    """As few ticks as come near enough to a curve of errors that straight lines join; how many they are.

    kept (n,): the ticks; the curve ends where no more than ENDED is left for good, at no error.
    """
    last = 0
    for k in range(errors.shape[0]):
        if abs(errors[k]) > ENDED:
            last = k
    last = min(last + 1, errors.shape[0] - 1)
    count, at = 1, 0
    kept[0] = 0.0
    while at < last:
        to = last
        while to > at + 1 and not _is_straight(errors, at, to, last):
            to -= 1
        kept[count] = 1.0 * to
        count += 1
        at = to
    return count


@inner_kernel
def _is_straight(errors: Floats, first: int, to: int, last: int) -> bool:
    # Whether no error between two ticks is far from the line from one to the other; that of the last is none.
    begin_at, end_at = errors[first], 0.0 if to == last else errors[to]
    for k in range(first + 1, to):
        line = begin_at + (end_at - begin_at) * (k - first) / (to - first)
        if not abs(errors[k] - line) <= CLOSE:
            return False
    return True
