"""Jellies: groups of triangles that share sides, as topology alone decides."""

from typing import Annotated, NamedTuple

from sandbox.physics.arena import Arena, give_back, is_full, mark, new_flags, new_slot_rows, new_slots, new_tuple
from sandbox.physics.arrays import Flags, SlotRows, Slots
from sandbox.physics.components import join, root_of
from sandbox.physics.jit import inlined_kernel, inner_kernel
from sandbox.physics.topology.sorting import list_by_key, sort_by_key

# Places in `counts`: jellies, their particles, rows of fans and of gaps.
GROUPS, PARTICLES, FANS, GAPS, COUNTS = range(5)
# Of `begin` and `end`: no side of the rim begins or ends there; several do.
NO_SIDE, SEVERAL = -1, -2


class Jellies(NamedTuple):
    """Jellies of t triangles: g of them, with k particles in all."""

    group: Slots  # (t,) of a triangle
    member: SlotRows  # (t, 3): its corners among the k
    first: Slots  # (g,): a triangle of each jelly
    start: Slots  # (g + 1,): where its particles begin
    particle: Slots  # (k,)
    corner: Slots  # (k,): one of the 3 t corners that stands there
    inner: Flags  # (k,): triangles are all round it
    fan: SlotRows  # (f, 4): particle of an outline, the next, the other corners of each triangle about it but the first
    fan_start: Slots  # fans of jelly g: fan[fan_start[g]:fan_start[g + 1]]
    gap: SlotRows  # (q, 4): triangle where those about a particle of an outline begin, it, the one before and the next


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
def _find_rims(members: int, jellies: Jellies, work: TriangleScratch) -> None:
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


@inner_kernel
def _find_fans(
    corners: SlotRows, members: int, groups: int, jellies: Jellies, work: TriangleScratch
) -> tuple[int, int]:
    # The fans of triangles about particles of outlines, and their gaps; how many rows there are of both.
    _find_rims(members, jellies, work)
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
def derive_jellies(
    corners: SlotRows, is_left: Flags, bound: int, jellies: Jellies, counts: Slots, work: TriangleScratch
) -> None:
    """Fill in the jellies of triangles of particles below a bound, and say in counts (COUNTS,) how much of them."""
    groups = _group(corners, bound, jellies, work)
    members = _number_corners(corners, bound, groups, jellies, work)
    _find_inner(members, groups, jellies, is_left, work)
    fans, gaps = _find_fans(corners, members, groups, jellies, work)
    counts[GROUPS] = groups
    counts[PARTICLES] = members
    counts[FANS] = fans
    counts[GAPS] = gaps


@inner_kernel
def new_jellies(triangles: int, arena: Arena) -> Jellies:
    """Jellies of so many triangles, to be filled in."""
    corners = 3 * triangles
    return Jellies(
        new_slots(arena, triangles), new_slot_rows(arena, triangles, 3), new_slots(arena, triangles),
        new_slots(arena, triangles + 1), new_slots(arena, corners), new_slots(arena, corners),
        new_flags(arena, corners), new_slot_rows(arena, corners, 4), new_slots(arena, triangles + 1),
        new_slot_rows(arena, corners, 4),
    )  # fmt: skip


@inner_kernel
def group_triangles(corners: SlotRows, is_left: Flags, bound: int, arena: Arena) -> Jellies:
    """The jellies that triangles of particles below a bound (t, 3) make, in the order of their first triangles.

    is_left (t,): whether their forms have them run counter-clockwise.
    """
    triangles = corners.shape[0]
    room, counts = new_jellies(triangles, arena), new_slots(arena, COUNTS)
    start = mark(arena)
    work = new_tuple(TriangleScratch, arena, triangles=triangles, marks=max(bound, 3 * triangles) + 1)
    if triangles == 0 or is_full(arena):
        return room
    derive_jellies(corners, is_left, bound, room, counts, work)
    give_back(arena, start)
    groups, members = counts[GROUPS], counts[PARTICLES]
    return Jellies(
        room.group, room.member, room.first[:groups], room.start[: groups + 1], room.particle[:members],
        room.corner[:members], room.inner[:members], room.fan[: counts[FANS]], room.fan_start[: groups + 1],
        room.gap[: counts[GAPS]],
    )  # fmt: skip
