"""Ways: where particles go within a tick, corner by corner, and when each is in a zone that somebody asks about.

What bounces within a tick goes to where it bounces and back. A way has a corner where a small step of free contacts
(free_contacts.py) or a substep ends, and where something is met in it. Rules follow particles so, and so does who
watches a run. Nothing of a tick depends on it.
"""

import math
from typing import NamedTuple

import numpy as np

from sandbox.physics.arrays import FloatRows, Floats, SlotRows, Slots, with_empty
from sandbox.physics.collision.surfaces import SLOWEST_BOUNCE
from sandbox.physics.collision.types import TOUCHING, Colliders, Contacts, weight_of
from sandbox.physics.jit import inlined_kernel, inner_kernel
from sandbox.physics.state import State
from sandbox.physics.zones import Zones, span_inside

# Things that a particle of a body meets in a substep, at most.
MOST_HITS = 4
# A substep ends where its velocity leads from where it began, however late it bounces: the way back takes its time too.
UNTIL_MET = 0.5
# Columns of `clock`: the time in a tick, and how much of a tick a second is.
NOW, RATE = range(2)
# Columns of `before`: place, time, span and velocity.
PLACE_X, PLACE_Y, SINCE, FIRST, LAST, GOING_X, GOING_Y, COLUMNS = range(8)
# Columns of `flight`: time in the substep [s], place [m], velocity [m/s]; when it meets something next, and when the
# body with this label does first.
AT, X, Y, VX, VY, SOONEST, BODY, FLIGHT = range(8)


class Ways(NamedTuple):
    """What is followed: a row for each particle and zone. Times are shares of the tick; none of it is state."""

    zones: Zones
    first: Slots  # (n,): the first row of a particle, -1: it is not followed
    next: Slots  # (k,): the next row of the same particle, -1: none
    particle: Slots
    zone: Slots
    place: FloatRows  # [m] (k, 2): the last corner
    since: Floats  # (k,): when it was there
    span: FloatRows  # (k, 2): when it was in the zone first and last in the tick; the first is above the last: never
    before: FloatRows  # (k, COLUMNS): as it met something last, or the substep began, and what it was to end with
    flight: FloatRows  # (n, FLIGHT): scratch
    hit: Slots  # (n,): the contact that a particle meets next
    clock: Floats


def followed(zones: Zones, rows: SlotRows, particle_count: int) -> Ways:
    """Ways of a particle and a zone in each row (k, 2); nothing has been in a zone yet."""
    count = len(rows)
    if count == 0:
        return with_empty(Ways)
    particle, zone = np.ascontiguousarray(rows.T)
    first, following = np.full(particle_count, -1), np.full(count, -1)
    for k in reversed(range(count)):
        following[k], first[particle[k]] = first[particle[k]], k
    return Ways(
        zones, first, following, particle, zone, np.zeros((count, 2)), np.zeros(count),
        np.tile([math.inf, -math.inf], (count, 1)), np.zeros((count, COLUMNS)), np.zeros((particle_count, FLIGHT)),
        np.zeros(particle_count, np.int64), np.zeros(2),
    )  # fmt: skip


def rows_of(ways: Ways) -> SlotRows:
    """The particle and the zone of each row (k, 2)."""
    return np.stack((ways.particle, ways.zone), axis=1)


def of_present(ways: Ways, particle_count: int) -> Ways:
    """Ways of those particles alone that are there: what joined the world may be undone while it is followed."""
    if len(ways.first) <= particle_count:
        return ways
    rows = rows_of(ways)
    return followed(ways.zones, rows[ways.particle < particle_count], particle_count)


@inlined_kernel
def is_followed(ways: Ways, p: int) -> bool:
    """Whether any row is of a particle, which may have joined the world while it ran."""
    return p < ways.first.shape[0] and ways.first[p] >= 0


@inner_kernel
def begin_ways(ways: Ways, state: State, rate: int) -> None:
    """Begin a tick: ways of rules where the last tick ended, whatever has moved a particle since."""
    ways.clock[NOW], ways.clock[RATE] = 0.0, 1.0 * rate
    probe = state.probe_position
    for k in range(ways.particle.shape[0]):
        p = ways.particle[k]
        ways.span[k, 0], ways.span[k, 1] = math.inf, -math.inf
        ways.since[k] = 0.0
        for axis in range(2):
            ways.place[k, axis] = probe[k, axis] if k < probe.shape[0] else state.position[p, axis]
        _go(ways, k, state.position[p, 0], state.position[p, 1], 0.0)


@inner_kernel
def store_places(ways: Ways, state: State) -> None:
    """Store where the ways of rules have ended, at the end of a tick."""
    probe = state.probe_position
    for k in range(min(probe.shape[0], ways.particle.shape[0])):
        for axis in range(2):
            probe[k, axis] = state.position[ways.particle[k], axis]


@inner_kernel
def go(ways: Ways, p: int, x: float, y: float, late: float, meets: bool) -> None:
    """Lead all rows of a particle straight to a place [m], so late in the substep [s]. meets: something is there."""
    k = ways.first[p]
    while k >= 0:
        _go(ways, k, x, y, ways.clock[NOW] + late * ways.clock[RATE])
        if meets:
            _keep(ways, k)
        k = ways.next[k]


@inner_kernel
def _go(ways: Ways, k: int, x: float, y: float, when: float) -> None:
    if not abs(x) + abs(y) < math.inf:
        return
    begun, span = ways.since[k], ways.span
    when = max(begun, when)
    first, last = span_inside(ways.zones, ways.zone[k], ways.place[k, 0], ways.place[k, 1], x, y)
    if first <= last:
        span[k, 0] = min(span[k, 0], begun + first * (when - begun))
        span[k, 1] = max(span[k, 1], begun + last * (when - begun))
    ways.place[k, 0], ways.place[k, 1], ways.since[k] = x, y, when


@inner_kernel
def begin_step(ways: Ways, now: float) -> None:
    """Begin a substep at that share of the tick."""
    ways.clock[NOW] = now
    for k in range(ways.particle.shape[0]):
        _keep(ways, k)


@inner_kernel
def _keep(ways: Ways, k: int) -> None:
    for axis in range(2):
        ways.before[k, PLACE_X + axis] = ways.place[k, axis]
        ways.before[k, FIRST + axis] = ways.span[k, axis]
    ways.before[k, SINCE] = ways.since[k]


@inner_kernel
def end_step(ways: Ways, position: FloatRows, late: float) -> None:
    """Lead everything to where it is at the end of a substep of so long [s]."""
    for k in range(ways.particle.shape[0]):
        p = ways.particle[k]
        _go(ways, k, position[p, 0], position[p, 1], ways.clock[NOW] + late * ways.clock[RATE])


@inner_kernel
def note_velocities(ways: Ways, velocity: FloatRows) -> None:
    """Note with which velocities a substep is to end."""
    for k in range(ways.particle.shape[0]):
        for axis in range(2):
            ways.before[k, GOING_X + axis] = velocity[ways.particle[k], axis]


@inner_kernel
def take_back_cut(ways: Ways, velocity: FloatRows) -> None:
    """Take ways that were cut since back to what they met last: later corners may lie behind what has cut them."""
    before = ways.before
    for k in range(ways.particle.shape[0]):
        p = ways.particle[k]
        if velocity[p, 0] != before[k, GOING_X] or velocity[p, 1] != before[k, GOING_Y]:
            for axis in range(2):
                ways.place[k, axis] = before[k, PLACE_X + axis]
                ways.span[k, axis] = before[k, FIRST + axis]
            ways.since[k] = before[k, SINCE]


@inner_kernel
def follow_hits(
    ways: Ways, contacts: Contacts, count: int, colliders: Colliders, solid_of: Slots, state: State, start: FloatRows,
    label: Slots, h: float,
) -> None:  # fmt: skip
    """Lead what is followed to where it meets something in a step of h [s], of the first contacts, which are solved.

    Until it meets something a particle goes on as at the start, then as it bounces. Where a body meets something, its
    other particles turn as well, and what is behind in a solid meets nothing, though it is pushed.
    start [m/s] (n, 2): velocities before anything acted; label (n,): see label_bodies; solid_of: see Outline.
    """
    flight = ways.flight
    for p in range(flight.shape[0]):
        flight[p, AT], flight[p, SOONEST], flight[p, BODY] = 0.0, math.inf, math.inf
        for axis in range(2):
            flight[p, X + axis], flight[p, VX + axis] = state.position[p, axis], start[p, axis]
    for passed in range(MOST_HITS):
        if not _find_next(ways, contacts, count, state, start, h):
            return
        if passed == 0:
            _turn_bodies(ways, colliders, solid_of, state, start, label)
        for p in range(flight.shape[0]):
            if flight[p, SOONEST] < math.inf:
                _meet_next(ways, p, contacts, start)


@inner_kernel
def _turn_bodies(
    ways: Ways, colliders: Colliders, solid_of: Slots, state: State, start: FloatRows, label: Slots
) -> None:  # fmt: skip
    # Lead what is followed to where its body first meets something; what is behind in a solid meets nothing later on.
    flight = ways.flight
    for p in range(flight.shape[0]):
        flight[label[p], BODY] = min(flight[label[p], BODY], flight[p, SOONEST])
    for p in range(flight.shape[0]):
        late, vx, vy, shape = flight[label[p], BODY], start[p, 0], start[p, 1], colliders.shape[p]
        if not late < math.inf or state.inverse_mass[p] == 0.0:
            continue
        if is_followed(ways, p):
            go(ways, p, flight[p, X] + late * vx, flight[p, Y] + late * vy, UNTIL_MET * late, False)
        further = (flight[p, SOONEST] - late) * math.sqrt(vx * vx + vy * vy)
        if shape >= 0 and solid_of[shape] >= 0 and further > state.radius[p]:
            flight[p, SOONEST], flight[p, VX], flight[p, VY] = math.inf, 0.0, 0.0


@inner_kernel
def _find_next(ways: Ways, contacts: Contacts, count: int, state: State, start: FloatRows, h: float) -> bool:
    # Find what each particle meets next; whether any meets something.
    found = False
    for c in range(count):
        if not contacts.impulse[c, 0] > 0.0:
            continue
        for end in range(TOUCHING):
            p, weight = weight_of(contacts, c, end)
            if p < 0 or p >= ways.first.shape[0] or state.inverse_mass[p] == 0.0:
                continue
            late = _time_of(ways, p, weight, contacts, c, state, start)
            if late <= h and late < ways.flight[p, SOONEST]:
                ways.flight[p, SOONEST], ways.hit[p] = late, c
                found = True
    return found


@inner_kernel
def _closing(
    ways: Ways, p: int, weight: float, contacts: Contacts, c: int, start: FloatRows
) -> tuple[float, float]:  # fmt: skip
    # Velocities along the normal of a contact [m/s]: that of its ends at the start, and with that of a particle by now.
    nx, ny = contacts.normal[c, 0], contacts.normal[c, 1]
    begun = 0.0
    for end in range(TOUCHING):
        q, share = weight_of(contacts, c, end)
        if q >= 0:
            begun += share * (nx * start[q, 0] + ny * start[q, 1])
    flight = ways.flight
    return begun, begun + weight * (nx * (flight[p, VX] - start[p, 0]) + ny * (flight[p, VY] - start[p, 1]))


@inner_kernel
def _time_of(
    ways: Ways, p: int, weight: float, contacts: Contacts, c: int, state: State, start: FloatRows
) -> float:  # fmt: skip
    # When a particle meets what a contact is with [s]; infinite: it does not.
    begun, closing = _closing(ways, p, weight, contacts, c, start)
    if not closing < -SLOWEST_BOUNCE:
        return math.inf
    flight, at = ways.flight, ways.flight[p, AT]
    aside_x = flight[p, X] - state.position[p, 0] - at * start[p, 0]
    aside_y = flight[p, Y] - state.position[p, 1] - at * start[p, 1]
    gap = contacts.gap[c] + at * begun
    gap += weight * (contacts.normal[c, 0] * aside_x + contacts.normal[c, 1] * aside_y)
    return at - max(0.0, gap) / closing


@inner_kernel
def _meet_next(ways: Ways, p: int, contacts: Contacts, start: FloatRows) -> None:
    # Lead a particle to what it meets next, and turn it there.
    flight, c = ways.flight, ways.hit[p]
    late = flight[p, SOONEST]
    for axis in range(2):
        flight[p, X + axis] += (late - flight[p, AT]) * flight[p, VX + axis]
    flight[p, AT], flight[p, SOONEST] = late, math.inf
    if is_followed(ways, p):
        go(ways, p, flight[p, X], flight[p, Y], UNTIL_MET * late, True)
    for end in range(TOUCHING):
        q, weight = weight_of(contacts, c, end)
        if q == p and weight != 0.0:
            _, closing = _closing(ways, p, weight, contacts, c, start)
            back = (1.0 + contacts.restitution[c]) * closing
            for axis in range(2):
                flight[p, VX + axis] -= (back if weight > 0.0 else -back) * contacts.normal[c, axis]
            return
