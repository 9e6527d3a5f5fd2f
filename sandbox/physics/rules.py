"""Rules: what a level asks at the end of each tick, and how the value of what is asked is measured.

What a run makes of the rules is state (state.py).
"""

import math
from typing import NamedTuple

from sandbox.physics.arrays import Flags, FloatRows, Floats, Slots
from sandbox.physics.geometry.segment import difference
from sandbox.physics.jit import inner_kernel
from sandbox.physics.state import State
from sandbox.physics.ways import Ways
from sandbox.physics.zones import Zones, depth_inside, may_be_inside

# What a term asks. Of those from CENTRE_X on a value lies between bounds; of the last, terms are asked.
TOUCHES, CROSSES, CENTRE_X, CENTRE_Y, SPEED, DISTANCE, INSIDE, FASTEST, STRAIN, MOTION, BROKEN, UNSOUND = range(12)
SETTLED, COUNTER, TIME, KEY, ALL, ANY, NOT = range(12, 19)
# Of things, what no rule names.
NOBODY = -1
# A body that is no faster [m/s] has settled.
STILL = 0.05
# What is at rest for so long is as still as one for longer [ticks].
_LONGEST_STILL = 1_000_000_000


class Terms(NamedTuple):
    """The questions of rules, each below the one that asks it; those of TOUCHES come first."""

    kind: Slots
    first: Slots  # first, last: the slots of what it is about; of ALL, ANY and NOT the members
    last: Slots
    zone: Slots  # of INSIDE; of TOUCHES the first thing
    other: Slots  # the second thing or NOBODY, slot, counter, key, first row of ways or first of `still_ticks`
    low: Floats  # low, high: the bounds, both included
    high: Floats
    slot: Slots  # particles, or springs of STRAIN and BROKEN
    member: Slots  # terms
    value: Floats  # value, holds: as they were found last
    holds: Flags


class Things(NamedTuple):
    """The number of the body, loose particle or piece of terrain that each belongs to, or NOBODY."""

    of_particle: Slots
    of_spring: Slots
    of_terrain: Slots


class Rules(NamedTuple):
    """The rules of a level, in the order of the file."""

    zones: Zones
    terms: Terms
    things: Things
    term: Slots  # what each asks
    delay: Slots  # [ticks] that it must have held before
    once: Flags


@inner_kernel
def measure(rules: Rules, t: int, state: State, ways: Ways, tick: int, rate: int) -> float:
    """The value of a term that bounds are compared with: 1 or 0 where there is none, infinite of nothing."""
    terms = rules.terms
    kind, other = terms.kind[t], terms.other[t]
    if kind == TIME:
        return tick / rate
    if kind == COUNTER:
        return state.counter[other]
    if kind == KEY:
        return 1.0 if state.key_down[other] else 0.0
    if kind == SETTLED:
        return _still_ticks(terms, t, state) / rate
    if kind == CROSSES:
        return 1.0 if _crosses(rules, t, state, ways) else 0.0
    if kind == INSIDE:
        return _depth(rules, t, state)
    if kind == DISTANCE:
        dx, dy = difference(terms.slot[terms.first[t]], other, state.position)
        return math.sqrt(dx * dx + dy * dy)
    if kind == STRAIN:
        return _largest_strain(terms, t, state)
    if kind == BROKEN:
        return _broken(terms, t, state)
    if kind == UNSOUND:
        return _unsound(terms, t, state)
    if kind == FASTEST:
        return math.sqrt(_fastest(terms, t, state))
    if kind == MOTION:
        return _motion(terms, t, state)
    return _of_centre(terms, t, state)


@inner_kernel
def _of_centre(terms: Terms, t: int, state: State) -> float:
    """x, y or speed of the centre of mass; infinite of nothing."""
    kind = terms.kind[t]
    rows = state.velocity if kind == SPEED else state.position
    mass, x, y = 0.0, 0.0, 0.0
    for at in range(terms.first[t], terms.last[t]):
        p = terms.slot[at]
        if state.particle_active[p]:
            mass += state.mass[p]
            x += state.mass[p] * rows[p, 0]
            y += state.mass[p] * rows[p, 1]
    if not mass > 0.0:
        return math.inf
    x, y = x / mass, y / mass
    if kind == CENTRE_X:
        return x
    return y if kind == CENTRE_Y else math.sqrt(x * x + y * y)


@inner_kernel
def _depth(rules: Rules, t: int, state: State) -> float:
    """How far inside its zone the outermost particle is; infinite of nothing."""
    terms, zones, z = rules.terms, rules.zones, rules.terms.zone[t]
    least, low = math.inf, terms.low[t]
    for at in range(terms.first[t], terms.last[t]):
        p = terms.slot[at]
        if not state.particle_active[p]:
            continue
        x, y = state.position[p, 0], state.position[p, 1]
        # One that lies too far out settles it; the value is no more than a bound then.
        if low >= 0.0 and not may_be_inside(zones, z, x, y):
            return -math.inf
        least = min(least, depth_inside(zones, z, x, y))
        if least < low:
            return least
    return least


@inner_kernel
def _crosses(rules: Rules, t: int, state: State, ways: Ways) -> bool:
    """Whether the way of a particle in this tick meets the zone."""
    terms, span = rules.terms, ways.span
    for at in range(terms.first[t], terms.last[t]):
        k = terms.other[t] + at - terms.first[t]
        if state.particle_active[terms.slot[at]] and span[k, 0] <= span[k, 1]:
            return True
    return False


@inner_kernel
def _fastest(terms: Terms, t: int, state: State) -> float:
    """Square of the speed of the fastest particle [m^2/s^2]."""
    most = 0.0
    for at in range(terms.first[t], terms.last[t]):
        p = terms.slot[at]
        if state.particle_active[p]:
            most = max(most, _squared(state.velocity, p))
    return most


@inner_kernel
def _squared(rows: FloatRows, p: int) -> float:
    return rows[p, 0] * rows[p, 0] + rows[p, 1] * rows[p, 1]


@inner_kernel
def _still_ticks(terms: Terms, t: int, state: State) -> int:
    """For how many ticks on end nothing has been faster than STILL; counts this one."""
    k = terms.other[t]
    is_still = _fastest(terms, t, state) <= STILL * STILL
    state.still_ticks[k] = min(state.still_ticks[k] + 1, _LONGEST_STILL) if is_still else 0
    return state.still_ticks[k]


@inner_kernel
def _motion(terms: Terms, t: int, state: State) -> float:
    """Kinetic energy [J] of free particles, rotation included."""
    total = 0.0
    for at in range(terms.first[t], terms.last[t]):
        p = terms.slot[at]
        if state.particle_active[p] and state.inverse_mass[p] > 0.0:
            turning = state.radius[p] * state.spin[p]
            total += 0.5 * state.mass[p] * (_squared(state.velocity, p) + 0.5 * turning * turning)
    return total


@inner_kernel
def _largest_strain(terms: Terms, t: int, state: State) -> float:
    """The largest strain, stretched or pressed, of springs that bear a load."""
    most = 0.0
    for at in range(terms.first[t], terms.last[t]):
        s = terms.slot[at]
        a, b, rest = state.particle_a[s], state.particle_b[s], state.rest_length[s]
        is_free = state.inverse_mass[a] > 0.0 or state.inverse_mass[b] > 0.0
        if state.spring_active[s] and rest > 0.0 and is_free:
            dx, dy = difference(a, b, state.position)
            most = max(most, abs((math.sqrt(dx * dx + dy * dy) - rest) / rest))
    return most


@inner_kernel
def _broken(terms: Terms, t: int, state: State) -> int:
    """How many springs are gone."""
    gone = 0
    for at in range(terms.first[t], terms.last[t]):
        if not state.spring_active[terms.slot[at]]:
            gone += 1
    return gone


@inner_kernel
def _unsound(terms: Terms, t: int, state: State) -> int:
    """How many particles have a place or a velocity that is no number."""
    count = 0
    for at in range(terms.first[t], terms.last[t]):
        p = terms.slot[at]
        sums = _squared(state.position, p) + _squared(state.velocity, p)
        if state.particle_active[p] and not sums < math.inf:
            count += 1
    return count
