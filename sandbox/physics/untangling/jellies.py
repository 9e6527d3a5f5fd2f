"""Jellies: groups of triangles that share sides, and which of them springs and areas alone may not bring back to form.

Topology alone decides the groups. A jelly is inverted while a triangle of it is turned over, or drawn out to LARGEST
times its area, or while the triangles about one of its inner particles do not wind round that just once. It is wound
where those about a particle of its outline go on round that beyond where they began: then its outline crosses itself
there though no triangle is turned over, and what is next to it, which may not touch it, does not hold it apart. Where a
jelly lies folded over in its own form, some of its triangles counter-clockwise and others not, no turns are counted:
there is no number of them that is right.
"""

from typing import Annotated, NamedTuple

from sandbox.physics.arena import Arena, give_back, is_full, mark, new_flags, new_slot_rows, new_slots, new_tuple
from sandbox.physics.arrays import Flags, FloatRows, SlotRows, Slots
from sandbox.physics.components import join, root_of
from sandbox.physics.constraints import AREA
from sandbox.physics.geometry.segment import doubled_area, doubled_area_of, winding_of_side
from sandbox.physics.jit import inlined_kernel, inner_kernel
from sandbox.physics.state import State
from sandbox.physics.topology.sorting import list_by_key, sort_by_key

# Of `begin` and `end`: no side of the rim begins or ends there; several do.
NO_SIDE, SEVERAL = -1, -2
# A jelly of which a triangle is drawn out to so many times its area wants to be back in a step, and cannot be without
# turning others over on its way: held from that, it would stand still. The softest jelly comes to a hundredth of it
# when it is stirred at 80 m/s.
LARGEST = 1e4


class Jellies(NamedTuple):
    """Jellies of t triangles: g of them, with k particles in all."""

    group: Annotated[Slots, "triangles"]  # (t,) of a triangle
    member: Annotated[SlotRows, "triangles, 3"]  # (t, 3): its corners among the k
    first: Annotated[Slots, "triangles"]  # (g,): a triangle of each jelly
    start: Annotated[Slots, "triangles + 1"]  # (g + 1,): where its particles begin
    particle: Annotated[Slots, "3 * triangles"]  # (k,)
    corner: Annotated[Slots, "3 * triangles"]  # (k,): one of the 3 t corners that stands there
    inner: Annotated[Flags, "3 * triangles"]  # (k,): triangles are all round it
    # (f, 4): particle of an outline, the next, the other corners of each triangle about it but the first
    fan: Annotated[SlotRows, "3 * triangles, 4"]
    fan_start: Annotated[Slots, "triangles + 1"]  # fans of jelly g: fan[fan_start[g]:fan_start[g + 1]]
    # (q, 4): triangle where those about a particle of an outline begin, it, the one before and the next
    gap: Annotated[SlotRows, "3 * triangles, 4"]


class TriangleScratch(NamedTuple):
    """Scratch for t triangles of particles below b: label, lies_flat (t,); start (b+1,), or as many as corners.

    By side, 3 t of them, each named by the corner that it begins at: its ends, low and high; one, other; whether it is
    at_rim. By corner of a jelly: the side of the rim that begins there, and the one that ends there; number.
    """

    label: Annotated[Slots, "triangles"]
    start: Annotated[Slots, "marks"]
    low: Annotated[Slots, "3 * triangles"]
    high: Annotated[Slots, "3 * triangles"]
    one: Annotated[Slots, "3 * triangles"]
    other: Annotated[Slots, "3 * triangles"]
    at_rim: Annotated[Flags, "3 * triangles"]
    lies_flat: Annotated[Flags, "triangles"]
    begin: Annotated[Slots, "3 * triangles"]
    end: Annotated[Slots, "3 * triangles"]
    number: Annotated[Slots, "3 * triangles"]


class Triangles(NamedTuple):
    """The triangles of a world that keep their areas, t of them: constraint (t,), corners (t, 3), and their jellies."""

    constraint: Slots
    corners: SlotRows
    jellies: Jellies


class Inversions(NamedTuple):
    """By corner of a jelly: turns of triangles round it; by jelly: whether it is inverted. Filled in by each step."""

    turns: Slots
    is_inverted: Flags


@inner_kernel
def group_triangles(corners: SlotRows, is_left: Flags, bound: int, arena: Arena) -> Jellies:
    """The jellies that triangles of particles below a bound (t, 3) make, in the order of their first triangles.

    is_left (t,): whether their forms have them run counter-clockwise.
    """
    triangles = corners.shape[0]
    made = new_tuple(Jellies, arena, triangles=triangles)
    start = mark(arena)
    work = new_tuple(TriangleScratch, arena, triangles=triangles, marks=max(bound, 3 * triangles) + 1)
    if triangles == 0 or is_full(arena):
        return made
    groups = _group(corners, bound, made, work)
    members = _number_corners(corners, bound, groups, made, work)
    _find_inner(members, groups, made, is_left, work)
    fans, gaps = _find_fans(corners, members, groups, made, work)
    give_back(arena, start)
    return Jellies(
        made.group, made.member, made.first[:groups], made.start[: groups + 1], made.particle[:members],
        made.corner[:members], made.inner[:members], made.fan[:fans], made.fan_start[: groups + 1], made.gap[:gaps],
    )  # fmt: skip


@inner_kernel
def _group(corners: SlotRows, bound: int, jellies: Jellies, work: TriangleScratch) -> int:
    # Find the sides that triangles share, work.one in the order of their ends, and number what hangs together.
    triangles = corners.shape[0]
    for t in range(triangles):
        work.label[t] = t
        for c in range(3):
            p = corners[t, c]
            q = corners[t, (c + 1) % 3]
            work.low[3 * t + c] = min(p, q)
            work.high[3 * t + c] = max(p, q)
    list_by_key(work.high, 3 * triangles, bound, work.start, work.other)
    sort_by_key(work.low, work.other, 3 * triangles, bound, work.start, work.one)
    for at in range(3 * triangles):
        side = work.one[at]
        work.at_rim[side] = True
        if at > 0 and _is_same(work.one[at - 1], side, work):
            before = work.one[at - 1]
            work.at_rim[side] = work.at_rim[before] = False
            join(work.label, before // 3, side // 3)
    groups = 0
    for t in range(triangles):
        label = root_of(work.label, t)
        if label == t:
            jellies.first[groups] = t
            jellies.group[t] = groups
            groups += 1
        else:
            jellies.group[t] = jellies.group[label]
    return groups


@inlined_kernel
def _is_same(side: int, other: int, work: TriangleScratch) -> bool:
    return work.low[side] == work.low[other] and work.high[side] == work.high[other]


@inner_kernel
def _number_corners(corners: SlotRows, bound: int, groups: int, jellies: Jellies, work: TriangleScratch) -> int:
    # Number the particles of jellies by jelly and slot; how many there are. work.other becomes corners in that order.
    count = 3 * corners.shape[0]
    for i in range(count):
        work.begin[i] = corners[i // 3, i % 3]
        work.end[i] = jellies.group[i // 3]
    list_by_key(work.begin, count, bound, work.start, work.number)
    sort_by_key(work.end, work.number, count, groups, work.start, work.other)
    members = 0
    jellies.start[0] = 0
    for at in range(count):
        i = work.other[at]
        before = work.other[at - 1] if at > 0 else i
        if at == 0 or work.begin[i] != work.begin[before] or work.end[i] != work.end[before]:
            jellies.particle[members] = work.begin[i]
            jellies.corner[members] = i
            members += 1
        jellies.member[i // 3, i % 3] = members - 1
        jellies.start[work.end[i] + 1] = members
    return members


@inner_kernel
def _find_inner(members: int, groups: int, jellies: Jellies, is_left: Flags, work: TriangleScratch) -> None:
    # Once round: as many triangles as neighbours. The same triangle twice is round nothing.
    triangles = jellies.group.shape[0]
    for g in range(groups):
        work.begin[g] = 0
        work.end[g] = 0
    for t in range(triangles):
        work.begin[jellies.group[t]] += 1
        if is_left[t]:
            work.end[jellies.group[t]] += 1
    for g in range(groups):
        work.lies_flat[g] = work.end[g] % work.begin[g] == 0
    # Triangles less neighbours, and triangles.
    for i in range(members):
        work.number[i] = 0
        work.begin[i] = 0
    for at in range(3 * triangles):
        side = work.one[at]
        work.number[jellies.member[side // 3, side % 3]] += 1
        work.begin[jellies.member[side // 3, side % 3]] += 1
        if at == 0 or not _is_same(work.one[at - 1], side, work):
            work.number[jellies.member[side // 3, side % 3]] -= 1
            work.number[jellies.member[side // 3, (side + 1) % 3]] -= 1
    for g in range(groups):
        for i in range(jellies.start[g], jellies.start[g + 1]):
            jellies.inner[i] = work.lies_flat[g] and work.number[i] == 0 and work.begin[i] > 2


@inner_kernel
def _find_fans(
    corners: SlotRows, members: int, groups: int, jellies: Jellies, work: TriangleScratch
) -> tuple[int, int]:
    # The fans of triangles about particles of outlines, and their gaps; how many rows there are of both.
    # By corner of a jelly, the side of the rim that begins there, and the one that ends there. Where two fans meet in a
    # particle, neither is told from the other.
    for i in range(members):
        work.begin[i] = NO_SIDE
        work.end[i] = NO_SIDE
    for side in range(3 * jellies.group.shape[0]):
        if not work.at_rim[side]:
            continue
        t = side // 3
        i = jellies.member[t, side % 3]
        if work.lies_flat[jellies.group[t]]:
            work.begin[i] = side if work.begin[i] == NO_SIDE else SEVERAL
        i = jellies.member[t, (side + 1) % 3]
        work.end[i] = side if work.end[i] == NO_SIDE else SEVERAL
    gaps = 0
    for i in range(members):
        begin = work.begin[i]
        # What begins with one side ends with one, but where triangles lie over each other.
        if begin >= 0 and work.end[i] >= 0:
            jellies.gap[gaps, 0] = begin // 3
            jellies.gap[gaps, 1] = jellies.particle[i]
            jellies.gap[gaps, 2] = corners[work.end[i] // 3, work.end[i] % 3]
            jellies.gap[gaps, 3] = corners[begin // 3, (begin + 1) % 3]
            gaps += 1
    list_by_key(jellies.group, jellies.group.shape[0], groups, work.start, work.label)
    fans = 0
    jellies.fan_start[0] = 0
    for g in range(groups):
        for at in range(work.start[g], work.start[g + 1]):
            t = work.label[at]
            for c in range(3):
                begin = work.begin[jellies.member[t, c]]
                if begin < 0 or corners[t, (c + 1) % 3] == corners[begin // 3, (begin + 1) % 3]:
                    continue
                jellies.fan[fans, 0] = corners[t, c]
                jellies.fan[fans, 1] = corners[begin // 3, (begin + 1) % 3]
                jellies.fan[fans, 2] = corners[t, (c + 1) % 3]
                jellies.fan[fans, 3] = corners[t, (c + 2) % 3]
                fans += 1
        jellies.fan_start[g + 1] = fans
    return fans, gaps


@inner_kernel
def triangles_of(state: State, arena: Arena) -> Triangles:
    """The triangles of a world, as its constraints are now."""
    capacity = state.constraint_kind.shape[0]
    constraint, corners = new_slots(arena, capacity), new_slot_rows(arena, capacity, 3)
    is_left = new_flags(arena, capacity)
    count = 0
    if not is_full(arena):
        for k in range(capacity):
            if state.constraint_kind[k] == AREA and state.constraint_corners[k] == 3 and state.constraint_active[k]:
                constraint[count] = k
                for c in range(3):
                    corners[count, c] = state.corner_particle[state.constraint_first[k] + c]
                is_left[count] = state.constraint_rest[k, 1] > 0.0
                count += 1
    jellies = group_triangles(corners[:count], is_left[:count], state.owner.shape[0], arena)
    return Triangles(constraint[:count], corners[:count], jellies)


@inner_kernel
def new_inversions(jellies: Jellies, arena: Arena) -> Inversions:
    """Lay out inversions for a step to fill in."""
    return Inversions(new_slots(arena, jellies.particle.shape[0]), new_flags(arena, jellies.first.shape[0]))


@inner_kernel
def find_inverted(
    position: FloatRows, constraint_rest: FloatRows, triangles: Triangles, found: Inversions, inverted: Flags
) -> None:
    """Find the inverted jellies; mark the particles, of all those in jellies, that belong to them or to wound ones."""
    corners = triangles.corners
    jellies = triangles.jellies
    turns = found.turns
    for i in range(turns.shape[0]):
        turns[i] = 0
    for g in range(found.is_inverted.shape[0]):
        found.is_inverted[g] = False
    for t in range(corners.shape[0]):
        doubled = wind(position, corners[t, 0], corners[t, 1], corners[t, 2], jellies.member, t, turns)
        k = triangles.constraint[t]
        if is_out_of_shape(0.5 * doubled, constraint_rest[k, 0], constraint_rest[k, 1]):
            found.is_inverted[jellies.group[t]] = True
    for i in range(turns.shape[0]):
        inverted[jellies.particle[i]] = False
    for g in range(found.is_inverted.shape[0]):
        once = 1 if constraint_rest[triangles.constraint[jellies.first[g]], 1] > 0.0 else -1
        for i in range(jellies.start[g], jellies.start[g + 1]):
            if jellies.inner[i] and turns[i] != once:
                found.is_inverted[g] = True
        if found.is_inverted[g] or is_wound(g, once, position, jellies.fan, jellies.fan_start):
            for i in range(jellies.start[g], jellies.start[g + 1]):
                inverted[jellies.particle[i]] = True


@inlined_kernel
def wind(place: FloatRows, a: int, b: int, c: int, member: SlotRows, at: int, turns: Slots) -> float:
    """Count the turns of triangle a b c, whose corners are member[at], round each of them; its area, doubled."""
    ax = place[a, 0]
    ay = place[a, 1]
    bx = place[b, 0]
    by = place[b, 1]
    cx = place[c, 0]
    cy = place[c, 1]
    turns[member[at, 0]] += _crossing(ax, ay, bx, by, cx, cy)
    turns[member[at, 1]] += _crossing(bx, by, cx, cy, ax, ay)
    turns[member[at, 2]] += _crossing(cx, cy, ax, ay, bx, by)
    return doubled_area(ax, ay, bx, by, cx, cy)


@inlined_kernel
def _crossing(px: float, py: float, ax: float, ay: float, bx: float, by: float) -> int:
    # +1 where the corner at p, from a to b, sweeps over the direction (1, 0) counter-clockwise, -1 clockwise.
    return winding_of_side(ay < py, by < py, doubled_area(px, py, ax, ay, bx, by))


@inner_kernel
def is_wound(g: int, once: int, place: FloatRows, fan: SlotRows, fan_start: Slots) -> bool:
    """Whether jelly g is wound. once: 1 where its triangles run counter-clockwise, else -1; fan: see Jellies."""
    for f in range(fan_start[g], fan_start[g + 1]):
        p = fan[f, 0]
        begin = fan[f, 1]
        if (
            once * doubled_area_of(p, fan[f, 2], begin, place) >= 0.0
            and once * doubled_area_of(p, begin, fan[f, 3], place) > 0.0
        ):
            return True
    return False


@inlined_kernel
def is_out_of_shape(area: float, rest: float, form: float) -> bool:
    """Whether a triangle of this area [m^2], which wants and at rest has those, is turned over or drawn out."""
    return rest * form > 0.0 and not 0.0 < area * rest < LARGEST * rest * rest
