"""Free contacts as constraints: their islands and small steps, in which order they are solved, and how they move.

An island is what movable particles connect by touching. Contacts of one with a particle that a spring or a constraint
holds are coupled: the solver solves them with springs. Contacts of other islands are free, and solved in small steps.
Islands that take as many of them are solved side by side: what does not touch does not wait for each other.
"""

import math
from typing import Annotated, NamedTuple

from sandbox.physics.arrays import Flags, FloatRows, Floats, SlotRows, Slots
from sandbox.physics.collision.surfaces import rolling_ratios
from sandbox.physics.collision.types import ENDS, Colliders, Contacts, weight_of
from sandbox.physics.components import root_of, united
from sandbox.physics.geometry.segment import SHORTEST, difference
from sandbox.physics.jit import inlined_kernel, inner_kernel
from sandbox.physics.topology.sorting import list_by_key

# A small step is no longer than this [s]: 8 of them at 60 Hz. With a quarter of them, heaps of 50 layers sink into each
# other by a seventh of a radius; twice as many double the time.
SMALL_STEP = 1.0 / 480.0
# Small steps of a step at most, where an island would sink too deep.
MOST_SMALL_STEPS = 64
# Part of an overlap that a small step removes, and 1 - Cd of a contact while it does. More of the first, or less of the
# second, shakes heaps; less of the first, or more of the second, lets them sink into each other.
OVERLAP_SHARE = 0.05
SOFTNESS = 0.013
# Share of the smaller radius to which contacts sink in under the load of the last step; less costs small steps.
DEEPEST = 0.04
# The normal of discs is that of their centres where these lie off it by more than this share of the radii. More costs
# angular momentum, less time.
ALONG_CENTRES = 1e-12
# Columns of a contact constraint, a row that lies together. What every iteration reads of it: normal; gap [m] by now;
# impulse [N s] of a small step along, bounce [m/s], and the way of its normal: FOLLOWS the centres of discs, is COMING
# where they are followed along their way and have not met yet, STANDS where one of those is pinned, or is no disc, and
# RISES so where that is an edge of a hollow that the particle comes to within the step.
NX, NY, GAP, ALONG, BOUNCE, WAY = range(6)
FOLLOWS, COMING, STANDS, RISES = 0.0, 1.0, 2.0, 3.0
# And where it pushes: impulse across, friction, effective mass [kg] along and across, weight [1/kg] of its particles
# and of their surfaces (0: it does not turn), the arm of friction as a share of the radii; rolling resistance, its
# effective mass [kg], the smaller radius over each one's, and that times its TURN.
ACROSS, FRICTION, MASS, MASS_ACROSS, WEIGHT_P, WEIGHT_Q, TURN_P, TURN_Q, ARM = range(6, 15)
ROLLING, ROLLING_MASS, RATIO_P, RATIO_Q, ROLL_P, ROLL_Q = range(15, 21)
# What the gap comes from: without what its particles are apart [m], of two discs minus their radii; how far two discs
# are apart at the start [m], else 0; 1 over the radii [1/m]. Restitution; how hard it is, 1 / (1 + softness); impulse
# [N s] of the step's impacts along.
REACH, APART_X, APART_Y, PER_REACH, RESTITUTION, HARDNESS, IMPACT = range(21, 28)
COLUMNS = 28
# Columns of a place: velocity [m/s], way [m] so far, speed of its surface [m/s] = spin times radius; and what the
# impulses of a small step add to the first and the last.
VX, VY, WX, WY, SURFACE, PUSHED_X, PUSHED_Y, PUSHED_SURFACE = range(8)


class Islands(NamedTuple):
    """Islands of a step's contacts, filled in by each step; there is room for more contacts."""

    label: Annotated[Slots, "particles"]  # the first particle of its island
    is_coupled: Annotated[Flags, "particles"]  # by label
    contact_label: Annotated[Slots, "rows"]  # by contact, as found
    first: Annotated[Slots, "rows + 1"]  # free contacts of the g-th island: first[g]:first[g + 1], as sorted
    at: Annotated[Slots, "particles + 2"]  # scratch


class FreeContactScratch(NamedTuple):
    """Free contacts island by island, and as constraints in the order in which they are solved; and their particles.

    Contacts that share no particle that can move are solved in any order with the same result. So those of islands that
    are solved side by side are sorted by level, one above the highest before it at the same particles: what lies in a
    level does not wait for each other's velocities, which makes an iteration twice as fast.

    There is room for more contacts. What cannot move has a place for each contact.
    """

    place: Annotated[SlotRows, "rows, 2"]  # of a contact's particle and of what it pushes
    level: Annotated[Slots, "rows"]  # of a contact, as way
    way: Annotated[Floats, "rows"]
    constraint: Annotated[FloatRows, f"rows, {COLUMNS}"]  # see the columns
    end: Annotated[SlotRows, "rows, 2"]  # places of a constraint
    contact: Annotated[Slots, "rows"]  # that of a constraint
    at: Annotated[Slots, "rows + 1"]  # scratch, where each level goes on
    begin: Annotated[Slots, "rows + 1"]  # (g + 1,): first place of an island
    steps: Annotated[Slots, "rows"]  # (g,): small steps of an island
    hardness: Annotated[Floats, "rows"]  # (g,)
    alone: Annotated[Flags, "rows"]  # (g,): nothing is solved beside the island
    allowed: Annotated[Floats, "rows"]  # [J] (g,): energy that the island may end with
    beside: Annotated[Slots, "rows"]  # (g,): islands that are solved side by side
    particle: Annotated[Slots, "2 * rows"]  # that of a place
    weight: Annotated[Floats, "2 * rows"]  # [1/kg]
    turning: Annotated[Floats, "2 * rows"]  # [1/kg]: the weight of its surface
    motion: Annotated[FloatRows, "2 * rows, 8"]  # see the columns of a place
    gain: Annotated[FloatRows, "2 * rows, 2"]  # [m/s]: what forces add to the velocity in the step
    highest: Annotated[Slots, "2 * rows"]  # level so far
    local: Annotated[Slots, "particles"]  # the place of a particle, -1: none
    ahead: Annotated[FloatRows, "particles, 2"]  # [m]: how much further than h v' a particle has gone in the step
    added: Annotated[FloatRows, "2 * rows, 2"]  # [m/s]: what forces and the last small step add in this one
    stamp: Annotated[Slots, "2 * rows"]  # the pass that it was hit in
    since: Annotated[Floats, "2 * rows"]  # [s]: when that was
    hit: Annotated[Slots, "rows"]  # the constraint of a hit; by hit, as all down to last
    pushed: Annotated[Floats, "rows"]  # [N s]: impulse along
    across: Annotated[Floats, "rows"]  # [N s]: impulse across
    met: Annotated[Floats, "rows"]  # [s]: when
    speed: Annotated[Floats, "rows"]  # [m/s]: along, before it
    target: Annotated[Floats, "rows"]  # [m/s]: along, after it
    slip: Annotated[Floats, "rows"]  # [m/s]: across, before it
    last_across: Annotated[Floats, "rows"]  # [N s]: across before the last friction
    last: Annotated[Floats, "rows"]  # [N s]: what pushed for that
    first: Annotated[Floats, "2 * rows"]  # [s]: when the first hit of a pass is
    turned: Annotated[Floats, "2 * rows"]  # [s]: when in a small step it met an edge that rises, 0: it has not
    onto: Annotated[Slots, "2 * rows"]  # the constraint with that edge


@inlined_kernel
def small_steps(h: float) -> int:
    """Number of small steps in a step of h [s] for particles that nothing holds and no load presses."""
    count = 1
    while count < MOST_SMALL_STEPS and h > SMALL_STEP * count * (1.0 + 1e-9):
        count *= 2
    return count


@inner_kernel
def find_islands(contacts: Contacts, count: int, inverse_mass: Floats, attached: Flags, islands: Islands) -> int:
    """Find the islands of the first `count` contacts; return how many contacts are coupled.

    attached (n,): particles that a spring or a constraint holds.
    """
    label = islands.label
    # Label the particles that touch each other alike; what cannot move joins nothing.
    for p in range(label.shape[0]):
        label[p] = p
    for c in range(count):
        first = -1
        for end in range(ENDS):
            p, _ = weight_of(contacts, c, end)
            if p < 0 or inverse_mass[p] == 0.0:
                continue
            node = root_of(label, p)
            first = united(label, first, node)
    for p in range(label.shape[0]):
        label[p] = root_of(label, p)
        islands.is_coupled[p] = False
    for p in range(label.shape[0]):
        if attached[p] and inverse_mass[p] > 0.0:
            islands.is_coupled[label[p]] = True
    coupled = 0
    for c in range(count):
        for end in range(3):
            p, _ = weight_of(contacts, c, end)
            if p >= 0 and inverse_mass[p] > 0.0:
                # All that move have the same.
                islands.contact_label[c] = label[p]
                break
        if islands.is_coupled[islands.contact_label[c]]:
            coupled += 1
    return coupled


@inner_kernel
def list_contacts(islands: Islands, key: Slots, source: Slots) -> int:
    """List contacts: coupled ones first, then the free ones by island, each as found; how many islands those make.

    key: scratch, as long as source.
    """
    at, count = islands.at, source.shape[0]
    for c in range(count):
        label = islands.contact_label[c]
        key[c] = 0 if islands.is_coupled[label] else 1 + label
    list_by_key(key, count, at.shape[0] - 1, at, source)
    found = 0
    for k in range(1, at.shape[0] - 1):
        if at[k + 1] > at[k]:
            islands.first[found] = at[k]
            found += 1
    islands.first[found] = count
    return found


@inner_kernel
def plan_islands(
    contacts: Contacts, islands: Islands, island_count: int, colliders: Colliders, start: FloatRows, spin: Floats,
    h: float, work: FreeContactScratch,
) -> None:  # fmt: skip
    """Find the places of all islands, and in how many small steps of h [s] each is solved.

    start [m/s] (n, 2): the velocities before anything acted in this step.
    """
    count = 0
    for g in range(island_count):
        work.begin[g] = count
        for c in range(islands.first[g], islands.first[g + 1]):
            count = _place_contact(contacts, c, colliders, start, spin, work, count)
        _plan(contacts, islands, g, colliders, h, work)
    work.begin[island_count] = count


@inner_kernel
def _place_contact(
    contacts: Contacts, c: int, colliders: Colliders, start: FloatRows, spin: Floats, work: FreeContactScratch,
    count: int,
) -> int:  # fmt: skip
    # The places, level and way of a contact; the number of places then.
    disc = _disc_of(contacts, c)
    if disc >= 0:
        q, count = _place_of(disc, colliders, start, spin, work, count)
    else:
        # An edge that cannot move, be it of terrain or of a body, with the velocity of its surface.
        a = contacts.end_a[c]
        b = contacts.end_b[c]
        ratio = contacts.share[c]
        _open_place(count, contacts.particle[c], 0.0, 0.0, work)
        if b >= 0:
            for axis in range(2):
                work.motion[count, VX + axis] = (1.0 - ratio) * start[a, axis] + ratio * start[b, axis]
        work.motion[count, VX] += contacts.belt[c] * contacts.normal[c, 1]
        work.motion[count, VY] -= contacts.belt[c] * contacts.normal[c, 0]
        q, count = count, count + 1
    level = work.highest[q]
    p, count = _place_of(contacts.particle[c], colliders, start, spin, work, count)
    level = max(level, work.highest[p])
    if work.weight[p] > 0.0:
        work.highest[p] = level + 1
    if work.weight[q] > 0.0:
        work.highest[q] = level + 1
    work.place[c, 0] = p
    work.place[c, 1] = q
    work.level[c] = level
    work.way[c] = _way_of(contacts, c, colliders)
    return count


@inlined_kernel
def _disc_of(contacts: Contacts, c: int) -> int:
    # The disc that a contact pushes, -1: it is an edge.
    return contacts.end_a[c] if contacts.end_b[c] < 0 else -1


@inner_kernel
def _place_of(
    p: int, colliders: Colliders, start: FloatRows, spin: Floats, work: FreeContactScratch, count: int
) -> tuple[int, int]:
    # The place of a particle, and the number of places then.
    if colliders.inverse_mass[p] > 0.0 and work.local[p] >= 0:
        return work.local[p], count
    work.local[p] = count
    _open_place(count, p, colliders.inverse_mass[p], colliders.turning[p], work)
    for axis in range(2):
        work.motion[count, VX + axis] = start[p, axis]
        work.gain[count, axis] = colliders.velocity[p, axis] - start[p, axis]
    work.motion[count, SURFACE] = spin[p] * colliders.radius[p]
    return count, count + 1


@inner_kernel
def _open_place(place: int, p: int, weight: float, turning: float, work: FreeContactScratch) -> None:
    # A place for a particle, at rest.
    work.particle[place], work.weight[place], work.turning[place] = p, weight, turning
    work.highest[place] = work.stamp[place] = 0
    work.turned[place] = 0.0
    for axis in range(2):
        work.added[place, axis] = work.gain[place, axis] = 0.0
    for column in range(8):
        work.motion[place, column] = 0.0


@inner_kernel
def _way_of(contacts: Contacts, c: int, colliders: Colliders) -> float:
    # Discs that are followed along their way will meet with their centres along the normal, but do not lie so yet.
    p, q = contacts.particle[c], _disc_of(contacts, c)
    if q < 0:
        return RISES if contacts.ahead[c] else STANDS
    dx, dy = difference(q, p, colliders.position)
    reach = colliders.radius[p] + colliders.radius[q]
    if not abs(contacts.normal[c, 0] * dy - contacts.normal[c, 1] * dx) > ALONG_CENTRES * reach:
        return FOLLOWS
    return COMING if colliders.inverse_mass[p] > 0.0 and colliders.inverse_mass[q] > 0.0 else STANDS


@inner_kernel
def _plan(
    contacts: Contacts, islands: Islands, g: int, colliders: Colliders, h: float, work: FreeContactScratch
) -> None:
    # Small steps of an island, and its softness: so deep sinks a contact that carries J in each step,
    # SOFTNESS J h / (m OVERLAP_SHARE count^2).
    count = small_steps(h)
    deep = SOFTNESS * h / (OVERLAP_SHARE * count * count)
    most = 1.0
    work.alone[g] = False
    for c in range(islands.first[g], islands.first[g + 1]):
        if work.way[c] == COMING:
            work.alone[g] = True
            continue
        smaller = colliders.radius[contacts.particle[c]]
        disc = _disc_of(contacts, c)
        deepest = DEEPEST * (min(smaller, colliders.radius[disc]) if disc >= 0 else smaller)
        if deepest > 0.0:
            mass = 1.0 / (work.weight[work.place[c, 0]] + work.weight[work.place[c, 1]])
            most = max(most, contacts.impulse[c, 0] * deep / (mass * deepest))
    stiffer = 1.0
    while count < MOST_SMALL_STEPS and stiffer < most:
        count *= 2
        stiffer *= 4.0
    work.steps[g] = count
    work.hardness[g] = 1.0 / (1.0 + SOFTNESS * (stiffer / most if stiffer > most else 1.0))


@inner_kernel
def fill_constraints(
    contacts: Contacts, islands: Islands, colliders: Colliders, besides: int, work: FreeContactScratch
) -> int:
    """The constraints of the islands that are solved side by side, so many of work.beside, by level; their number."""
    at = work.at
    total = 0
    for b in range(besides):
        total += islands.first[work.beside[b] + 1] - islands.first[work.beside[b]]
    for level in range(total + 1):
        at[level] = 0
    for b in range(besides):
        for c in range(islands.first[work.beside[b]], islands.first[work.beside[b] + 1]):
            at[work.level[c] + 1] += 1
    for level in range(total):
        at[level + 1] += at[level]
    for b in range(besides):
        g = work.beside[b]
        for c in range(islands.first[g], islands.first[g + 1]):
            k = at[work.level[c]]
            at[work.level[c]] += 1
            work.constraint[k, HARDNESS] = work.hardness[g]
            _fill_constraint(contacts, c, k, colliders, work)
    return total


@inner_kernel
def _fill_constraint(contacts: Contacts, c: int, k: int, colliders: Colliders, work: FreeContactScratch) -> None:
    row = work.constraint
    p = work.place[c, 0]
    q = work.place[c, 1]
    work.contact[k] = c
    work.end[k, 0] = p
    work.end[k, 1] = q
    mass = work.weight[p] + work.weight[q]
    row[k, WEIGHT_P], row[k, WEIGHT_Q] = work.weight[p], work.weight[q]
    row[k, APART_X], row[k, APART_Y] = 0.0, 0.0
    row[k, TURN_P], row[k, TURN_Q] = work.turning[p], work.turning[q]
    row[k, ARM], row[k, PER_REACH], row[k, WAY] = 1.0, 0.0, work.way[c]
    row[k, REACH] = contacts.gap[c]
    row[k, NX], row[k, NY] = contacts.normal[c, 0], contacts.normal[c, 1]
    row[k, ALONG], row[k, ACROSS] = contacts.impulse[c, 0], contacts.impulse[c, 1]
    row[k, MASS] = 1.0 / mass
    row[k, MASS_ACROSS] = 1.0 / (mass + work.turning[p] + work.turning[q])
    row[k, FRICTION], row[k, BOUNCE] = contacts.friction[c], -1.0
    row[k, RESTITUTION], row[k, IMPACT] = contacts.restitution[c], 0.0
    disc = _disc_of(contacts, c)
    if disc >= 0:
        # What the constraint of two discs has of their places.
        p = contacts.particle[c]
        q = contacts.end_a[c]
        dx, dy = difference(q, p, colliders.position)
        reach = colliders.radius[p] + colliders.radius[q]
        row[k, APART_X], row[k, APART_Y] = dx, dy
        row[k, REACH] = -reach
        row[k, PER_REACH] = 1.0 / reach if reach > 0.0 else 0.0
        if row[k, WAY] == FOLLOWS:
            row[k, ARM] = (contacts.normal[c, 0] * dx + contacts.normal[c, 1] * dy) * row[k, PER_REACH]
        elif row[k, WAY] == COMING:
            row[k, ALONG], row[k, ACROSS] = 0.0, 0.0
    ratio_p, ratio_q = rolling_ratios(contacts.particle[c], disc, colliders)
    row[k, RATIO_P], row[k, RATIO_Q] = ratio_p, ratio_q
    row[k, ROLL_P], row[k, ROLL_Q] = ratio_p * row[k, TURN_P], ratio_q * row[k, TURN_Q]
    answer = ratio_p * row[k, ROLL_P] + ratio_q * row[k, ROLL_Q]
    row[k, ROLLING] = contacts.rolling[c] if answer > 0.0 else 0.0
    row[k, ROLLING_MASS] = 1.0 / answer if answer > 0.0 else 0.0


@inner_kernel
def look(work: FreeContactScratch, first: int, last: int) -> None:
    """Update the gaps of contacts, and the normals and arms of discs, which follow the centres."""
    row, end, motion = work.constraint, work.end, work.motion
    for i in range(first, last):
        p = end[i, 0]
        q = end[i, 1]
        nx, ny = row[i, NX], row[i, NY]
        wx = row[i, APART_X] + (motion[p, WX] - motion[q, WX])
        wy = row[i, APART_Y] + (motion[p, WY] - motion[q, WY])
        gap = row[i, REACH] + nx * wx + ny * wy
        if row[i, WAY] == FOLLOWS:
            if abs(nx * wy - ny * wx) > -ALONG_CENTRES * row[i, REACH]:
                distance = math.sqrt(wx * wx + wy * wy)
                if distance > SHORTEST:
                    per_distance = 1.0 / distance
                    row[i, NX] = wx * per_distance
                    row[i, NY] = wy * per_distance
                gap = row[i, REACH] + distance
            row[i, ARM] = 1.0 + gap * row[i, PER_REACH]
        row[i, GAP] = gap


@inner_kernel
def look_at(work: FreeContactScratch, i: int, late: float) -> None:
    """Find a contact's normal so much later [s] within the small step; its gap is that of now along this normal."""
    row, motion = work.constraint, work.motion
    p, q = work.end[i, 0], work.end[i, 1]
    wx = row[i, APART_X] + (motion[p, WX] - motion[q, WX])
    wy = row[i, APART_Y] + (motion[p, WY] - motion[q, WY])
    if row[i, WAY] == FOLLOWS:
        dx = wx + late * (motion[p, VX] - motion[q, VX])
        dy = wy + late * (motion[p, VY] - motion[q, VY])
        distance = math.sqrt(dx * dx + dy * dy)
        if distance > SHORTEST:
            row[i, NX] = dx / distance
            row[i, NY] = dy / distance
        row[i, ARM] = distance * row[i, PER_REACH]
    row[i, GAP] = row[i, REACH] + row[i, NX] * wx + row[i, NY] * wy


@inner_kernel
def meet(work: FreeContactScratch, i: int, p: int, q: int, small: float) -> float:
    """When two discs that are coming meet [s], and so the normal then; infinite: not in this small step [s]."""
    row, motion = work.constraint, work.motion
    ux, uy = motion[p, VX] - motion[q, VX], motion[p, VY] - motion[q, VY]
    wx = row[i, APART_X] + (motion[p, WX] - motion[q, WX])
    wy = row[i, APART_Y] + (motion[p, WY] - motion[q, WY])
    late = _time_until(wx, wy, ux, uy, -row[i, REACH])
    if not late < small:
        return math.inf
    row[i, WAY] = FOLLOWS
    row[i, BOUNCE] = 0.0
    look_at(work, i, late)
    return late


@inner_kernel
def _time_until(dx: float, dy: float, ux: float, uy: float, reach: float) -> float:
    # When two discs meet that are d apart and move by u; infinite where they never do.
    # |d + t u| = reach
    squared = ux * ux + uy * uy
    along = dx * ux + dy * uy
    apart = dx * dx + dy * dy - reach * reach
    if apart <= 0.0:
        return 0.0
    inside = along * along - squared * apart
    if not (along < 0.0 and inside >= 0.0):
        return math.inf
    return apart / (math.sqrt(inside) - along)


@inlined_kernel
def approach(work: FreeContactScratch, i: int) -> float:
    """Velocity of two ends of a contact apart along its normal [m/s]."""
    row, motion = work.constraint, work.motion
    p, q = work.end[i, 0], work.end[i, 1]
    return row[i, NX] * (motion[p, VX] - motion[q, VX]) + row[i, NY] * (motion[p, VY] - motion[q, VY])


@inlined_kernel
def slip(work: FreeContactScratch, i: int) -> float:
    """Velocity of two surfaces against each other across the normal [m/s]."""
    row, motion = work.constraint, work.motion
    p, q = work.end[i, 0], work.end[i, 1]
    ux, uy = motion[p, VX] - motion[q, VX], motion[p, VY] - motion[q, VY]
    return row[i, NX] * uy - row[i, NY] * ux - row[i, ARM] * (motion[p, SURFACE] + motion[q, SURFACE])


@inlined_kernel
def apply(
    work: FreeContactScratch, i: int, nx: float, ny: float, jn: float, jt: float, arm: float, late: float, rolls: bool
) -> None:  # fmt: skip
    """Push both ends of a contact by an impulse [N s], jn along its normal and jt across, so late [s].

    rolls: against their turn on each other acts a torque as well, as an impulse at the smaller radius, of at most
    ROLLING times that along the normal.
    """
    # v += J / m, and what it does to the surfaces.
    row, motion = work.constraint, work.motion
    p, q = work.end[i, 0], work.end[i, 1]
    jx, jy = jn * nx - jt * ny, jn * ny + jt * nx
    weight_p, weight_q = row[i, WEIGHT_P], row[i, WEIGHT_Q]
    surface_p, surface_q = motion[p, SURFACE], motion[q, SURFACE]
    roll_p, roll_q = row[i, ROLL_P], row[i, ROLL_Q]
    turn = row[i, RATIO_P] * surface_p - row[i, RATIO_Q] * surface_q
    surface_p -= jt * (arm * row[i, TURN_P])  # (35)
    surface_q -= jt * (arm * row[i, TURN_Q])
    if rolls and row[i, ROLLING] > 0.0:
        most = row[i, ROLLING] * row[i, ALONG]
        turn -= jt * (arm * (roll_p - roll_q))
        j = min(most, max(-most, -turn * row[i, ROLLING_MASS]))
        surface_p += j * roll_p
        surface_q -= j * roll_q
    motion[p, VX] += jx * weight_p
    motion[p, VY] += jy * weight_p
    motion[q, VX] -= jx * weight_q
    motion[q, VY] -= jy * weight_q
    motion[p, SURFACE], motion[q, SURFACE] = surface_p, surface_q
    if late > 0.0:
        # It acts where discs meet that are coming: what it changes of their ways until then is taken off.
        motion[p, WX] -= late * jx * weight_p
        motion[p, WY] -= late * jy * weight_p
        motion[q, WX] += late * jx * weight_q
        motion[q, WY] += late * jy * weight_q
