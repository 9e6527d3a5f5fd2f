"""Delaunay triangulations of points in a plane, with borders forced into them, trimmed to the inside and smoothed.

Points are whole numbers and every decision is exact. So the same points give the same triangles in the same order on
any machine. An outline often has four points on one circle, where rounding would decide. Turns and circles are decided
by doubles where those suffice, else by digits.
"""

import math
from typing import Annotated, NamedTuple

from sandbox.physics.arena import Arena, give_back, is_full, mark
from sandbox.physics.arrays import Flags, SlotRows, Slots
from sandbox.physics.jit import inner_kernel
from sandbox.physics.topology.sorting import end_lists, sort_ascending

# Rounds of evening out; each moves what gets better by it, and almost all of the gain comes with the first few.
ROUNDS = 12
# Cotangent of the smallest angle that is good enough to be left alone: 38 degrees.
EVEN = 1.28
# The corners of the frame are so many times as far away as any site.
AWAY = 64
# Places of the table of sides for each site, of which six are in use at most; and what spreads keys over the table.
PLACES, SPREAD, SPREAD_BITS = 12, 40503, 4
# Coordinates stay below this, whatever the frame adds: differences are whole as floats, and have two digits.
FARTHEST = 2.0**40
# Bits of a digit. Products of two digits, and sums of some of them, have 64 bits.
BITS, DIGIT = 24, (1 << 24) - 1
# A determinant of floats is as far from the true one at most, as a share of the sum of its terms without their signs.
TURN_ERROR, CIRCLE_ERROR = 3.3306690738754716e-16, 1.1102230246251577e-15
# Scratch: digits of a sum, and of two factors.
SUM, FACTOR = 9, 5
SCRATCH = SUM + 2 * FACTOR


class Net(NamedTuple):
    """Triangles by their sides: in a counter-clockwise triangle a b c the apex of (a, b) is c, of (b, c) it is a.

    Built point by point (Lawson 1977) in a frame of three far corners, the last sites, which `keep_inside` leaves out.
    """

    site: Annotated[SlotRows, "sites, 2"]
    second: Annotated[Slots, "sites"]  # the second one of some side that begins with it
    after: Annotated[Slots, "sites"]  # the next one on a border, which is to its left and never flipped; -1: on none
    key: Annotated[Slots, "places"]  # a table of sides: 1 + a sites + b, and where none is 0
    apex: Annotated[Slots, "places"]
    scratch: Annotated[Slots, "19"]


class Stars(NamedTuple):
    """The neighbours of each site, ascending: those of site k are near[start[k]:start[k + 1]]."""

    start: Annotated[Slots, "sites + 1"]
    near: Annotated[Slots, "6 * sites"]


# ---- the table of sides


@inner_kernel
def table_size(sites: int) -> int:
    """Places of the table of sides of a net: a power of 2."""
    size = 1
    while size < PLACES * sites:
        size *= 2
    return size


@inner_kernel
def _home(key: int, net: Net) -> int:
    return ((key * SPREAD) >> SPREAD_BITS) & (net.key.shape[0] - 1)


@inner_kernel
def _place_of(a: int, b: int, net: Net) -> int:
    # Where a side is in the table, or would be.
    key = 1 + a * net.site.shape[0] + b
    at = _home(key, net)
    while net.key[at] != 0 and net.key[at] != key:
        at = (at + 1) & (net.key.shape[0] - 1)
    return at


@inner_kernel
def apex_of(a: int, b: int, net: Net) -> int:
    """The third corner of the triangle on the left of a side; -1: there is none."""
    at = _place_of(a, b, net)
    return net.apex[at] if net.key[at] != 0 else -1


@inner_kernel
def _put(a: int, b: int, c: int, net: Net) -> None:
    at = _place_of(a, b, net)
    net.key[at] = 1 + a * net.site.shape[0] + b
    net.apex[at] = c


@inner_kernel
def _take_out(a: int, b: int, net: Net) -> None:
    # What lies behind it moves up, if it is looked for from there on.
    last = net.key.shape[0] - 1
    hole = _place_of(a, b, net)
    at = (hole + 1) & last
    while net.key[at] != 0:
        if (at - _home(net.key[at], net)) & last >= (at - hole) & last:
            net.key[hole] = net.key[at]
            net.apex[hole] = net.apex[at]
            hole = at
        at = (at + 1) & last
    net.key[hole] = 0


# ---- building


@inner_kernel
def _push(a: int, b: int, net: Net, arena: Arena) -> None:
    # Sides that are waiting lie behind all else in the arena.
    at = arena[0]
    arena[0] = at + 1
    if at < arena.shape[0]:
        arena[at] = a * net.site.shape[0] + b


@inner_kernel
def _pop(net: Net, arena: Arena) -> tuple[int, int]:
    at = arena[0] - 1
    side = arena[at]
    arena[at] = 0
    arena[0] = at
    return side // net.site.shape[0], side % net.site.shape[0]


@inner_kernel
def _add(a: int, b: int, c: int, net: Net) -> None:
    _put(a, b, c, net)
    _put(b, c, a, net)
    _put(c, a, b, net)
    net.second[a] = b
    net.second[b] = c
    net.second[c] = a


@inner_kernel
def _flip(a: int, b: int, net: Net) -> None:
    left = apex_of(a, b, net)
    right = apex_of(b, a, net)
    _take_out(a, b, net)
    _take_out(b, a, net)
    _add(left, right, b, net)
    _add(right, left, a, net)


@inner_kernel
def _settle(bottom: int, net: Net, arena: Arena) -> None:
    # Flip waiting sides and their neighbours until no circle around a triangle contains the apex of the next one.
    while arena[0] > bottom and not is_full(arena):
        a, b = _pop(net, arena)
        left = apex_of(a, b, net)
        right = apex_of(b, a, net)
        if left < 0 or right < 0 or net.after[a] == b or net.after[b] == a:
            continue
        if circle_holds(a, b, left, right, net.site, net.scratch):
            _flip(a, b, net)
            _push(a, right, net, arena)
            _push(right, b, net, arena)
            _push(b, left, net, arena)
            _push(left, a, net, arena)


@inner_kernel
def triangulate(net: Net, arena: Arena) -> None:
    """Fill an empty net with the triangles of its sites (n, 2), of which the last three, the frame, are set here."""
    count = net.site.shape[0] - 3
    reach = 1
    for site in range(count):
        reach = max(reach, 1 + max(abs(net.site[site, 0]), abs(net.site[site, 1])))
    for corner in range(3):
        net.site[count + corner, 0] = AWAY * reach * (corner - 1) if corner < 1 else AWAY * reach * (2 - corner)
        net.site[count + corner, 1] = AWAY * reach * (1 if corner == 2 else -1)
    for site in range(count + 3):
        net.after[site] = -1
    _add(count, count + 1, count + 2, net)
    last = count
    for site in range(count):
        _insert(site, last, net, arena)
        last = site


@inner_kernel
def _insert(site: int, last: int, net: Net, arena: Arena) -> None:
    a = last
    b = net.second[last]
    c = apex_of(a, b, net)
    while True:
        if turn_of(b, c, site, net.site) < 0:
            a = c
        elif turn_of(c, a, site, net.site) < 0:
            b = c
        elif turn_of(a, b, site, net.site) < 0:
            a, b = b, a
        else:
            break
        c = apex_of(a, b, net)
    corners = net.scratch
    corners[0] = a
    corners[1] = b
    corners[2] = c
    count = 3
    for k in range(3):
        if count == 3 and turn_of(corners[k], corners[(k + 1) % 3], site, net.site) == 0:
            _open(k, net)
            count = 4
    bottom = mark(arena)
    for k in range(count):
        _add(corners[k], corners[(k + 1) % count], site, net)
        _push(corners[k], corners[(k + 1) % count], net, arena)
    _settle(bottom, net, arena)


@inner_kernel
def _open(k: int, net: Net) -> None:
    # A site lies on the side from corner k to the next one: both triangles at that are parted.
    corners = net.scratch
    first = corners[k]
    second = corners[(k + 1) % 3]
    beyond = apex_of(second, first, net)
    _take_out(second, first, net)
    _take_out(first, second, net)
    for moved in range(2 - k):
        corners[3 - moved] = corners[2 - moved]
    corners[k + 1] = beyond


@inner_kernel
def force(a: int, b: int, net: Net, arena: Arena) -> bool:
    """Make the line between two sites a side, by flips of sides across it (Sloan 1993); False: a site lies on it."""
    if apex_of(a, b, net) >= 0 or apex_of(b, a, net) >= 0:
        return True
    bottom = mark(arena)
    if not _push_crossing(a, b, net, arena):
        return False
    at = bottom
    while at < arena[0] and not is_full(arena):
        first = arena[at] // net.site.shape[0]
        second = arena[at] % net.site.shape[0]
        at += 1
        left = apex_of(first, second, net)
        right = apex_of(second, first, net)
        if turn_of(left, right, first, net.site) >= 0 or turn_of(left, right, second, net.site) <= 0:
            # The four are not convex: later, when what is about them has changed.
            _push(first, second, net, arena)
            continue
        _flip(first, second, net)
        is_apart = left not in (a, b) and right not in (a, b)
        if is_apart and turn_of(a, b, left, net.site) * turn_of(a, b, right, net.site) < 0:
            _push(left, right, net, arena)
    if not is_full(arena):
        give_back(arena, bottom)
    return True


@inner_kernel
def _push_crossing(a: int, b: int, net: Net, arena: Arena) -> bool:
    # The sides that cross the line from a to b, in order.
    first = net.second[a]
    second = first
    third = apex_of(a, second, net)
    while not (turn_of(a, b, second, net.site) < 0 and turn_of(a, b, third, net.site) > 0):
        second = third
        if second == first:
            return False
        third = apex_of(a, second, net)
    while True:
        _push(second, third, net, arena)
        beyond = apex_of(third, second, net)
        if beyond == b:
            return True
        if turn_of(a, b, beyond, net.site) < 0:
            second = beyond
        else:
            third = beyond


@inner_kernel
def keep_inside(net: Net, kept: Net, arena: Arena) -> None:
    """Enter in `kept`, an empty table, the triangles of a net to the left of its borders, which are made of sides."""
    bottom = mark(arena)
    for site in range(net.site.shape[0]):
        if net.after[site] >= 0:
            _push(site, net.after[site], net, arena)
    while arena[0] > bottom and not is_full(arena):
        a, b = _pop(net, arena)
        if apex_of(a, b, kept) >= 0:
            continue
        c = apex_of(a, b, net)
        for _side in range(3):
            _put(a, b, c, kept)
            if net.after[a] != b:
                _push(b, a, net, arena)
            a, b, c = b, c, a


# ---- evening out


@inner_kernel
def list_stars(net: Net, stars: Stars) -> None:
    """List the neighbours of each site to which a side leads from there."""
    sites = net.site.shape[0]
    for k in range(sites + 1):
        stars.start[k] = 0
    for at in range(net.key.shape[0]):
        if net.key[at] > 0:
            stars.start[(net.key[at] - 1) // sites] += 1
    end_lists(sites, stars.start)
    for at in range(net.key.shape[0]):
        if net.key[at] > 0:
            site = (net.key[at] - 1) // sites
            stars.start[site] -= 1
            stars.near[stars.start[site]] = (net.key[at] - 1) % sites
    for site in range(sites):
        sort_ascending(stars.near, stars.start[site], stars.start[site + 1])


@inner_kernel
def even_out(fixed: int, net: Net, stars: Stars, active: Flags, moved: Flags, arena: Arena) -> None:
    """Move each site from the number `fixed` on, if that makes the smallest angle at it larger; then list the stars."""
    count = net.site.shape[0] - 3
    list_stars(net, stars)
    for site in range(count):
        moved[site] = True
        active[site] = False
    _settle_about(net, stars, moved, arena)
    for site in range(fixed, count):
        active[site] = _worst(site, net, stars) > EVEN
    for _round in range(ROUNDS):
        is_better = False
        for site in range(fixed, count):
            moved[site] = active[site] and _improve(site, net, stars)
            is_better = is_better or moved[site]
        if not is_better or is_full(arena):
            return
        for site in range(fixed):
            moved[site] = False
        _settle_about(net, stars, moved, arena)
        for site in range(fixed, count):
            active[site] = moved[site]
            for at in range(stars.start[site], stars.start[site + 1]):
                active[site] = active[site] or moved[stars.near[at]]
            active[site] = active[site] and _worst(site, net, stars) > EVEN


@inner_kernel
def _settle_about(net: Net, stars: Stars, moved: Flags, arena: Arena) -> None:
    # Flip what is about sites that were moved, and list the stars again.
    bottom = mark(arena)
    for site in range(net.site.shape[0] - 3):
        if moved[site]:
            for at in range(stars.start[site], stars.start[site + 1]):
                _push(site, stars.near[at], net, arena)
                _push(stars.near[at], apex_of(site, stars.near[at], net), net, arena)
    _settle(bottom, net, arena)
    list_stars(net, stars)


@inner_kernel
def _worst(site: int, net: Net, stars: Stars) -> float:
    # Cotangent of the smallest angle of the triangles at an inner site; infinite if one is turned over.
    worst = -math.inf
    for at in range(stars.start[site], stars.start[site + 1]):
        worst = max(worst, _sharpest(site, stars.near[at], apex_of(site, stars.near[at], net), net.site))
    return worst


@inner_kernel
def _sharpest(a: int, b: int, c: int, site: SlotRows) -> float:
    # Triangles inside are as small as the spacing: products of their sides are whole as floats.
    ux, uy = float(site[b, 0] - site[a, 0]), float(site[b, 1] - site[a, 1])
    vx, vy = float(site[c, 0] - site[a, 0]), float(site[c, 1] - site[a, 1])
    double = ux * vy - uy * vx
    if double <= 0.0:
        return math.inf
    wx, wy = vx - ux, vy - uy
    # The angles at a, b and c.
    return max(ux * vx + uy * vy, max(-(ux * wx) - uy * wy, vx * wx + vy * wy)) / double


@inner_kernel
def _improve(site: int, net: Net, stars: Stars) -> bool:
    # Move a site toward the middle of its neighbours if that makes the smallest angle larger.
    first = stars.start[site]
    last = stars.start[site + 1]
    before = _worst(site, net, stars)
    x, y = net.site[site, 0], net.site[site, 1]
    # Neighbours weigh as their triangles do, so that many on one side draw no more than few on the other.
    middle_x, middle_y = 0, 0
    for at in range(first, last):
        middle_x += net.site[stars.near[at], 0]
        middle_y += net.site[stars.near[at], 1]
    middle_x, middle_y = middle_x // (last - first), middle_y // (last - first)
    for part in (1, 2, 4):
        net.site[site, 0] = x + (middle_x - x) // part
        net.site[site, 1] = y + (middle_y - y) // part
        if _worst(site, net, stars) < before:
            return True
    net.site[site, 0] = x
    net.site[site, 1] = y
    return False


# ---- which way three places turn, and whether a circle holds a fourth


@inner_kernel
def turn_of(a: int, b: int, c: int, site: SlotRows) -> int:
    """1 where c lies on the left of the way from a to b, -1 on its right, 0 on it; a, b, c: rows of sites (n, 2)."""
    ux, uy = site[b, 0] - site[a, 0], site[b, 1] - site[a, 1]
    vx, vy = site[c, 0] - site[a, 0], site[c, 1] - site[a, 1]
    one = float(ux) * float(vy)
    other = float(uy) * float(vx)
    bound = TURN_ERROR * (abs(one) + abs(other))
    if one - other > bound:
        return 1
    if other - one > bound:
        return -1
    low = (ux & DIGIT) * (vy & DIGIT) - (uy & DIGIT) * (vx & DIGIT)
    middle = (ux >> BITS) * (vy & DIGIT) + (ux & DIGIT) * (vy >> BITS)
    middle -= (uy >> BITS) * (vx & DIGIT) + (uy & DIGIT) * (vx >> BITS)
    middle += low >> BITS
    high = (ux >> BITS) * (vy >> BITS) - (uy >> BITS) * (vx >> BITS) + (middle >> BITS)
    return _sign(high, (low & DIGIT) | (middle & DIGIT))


@inner_kernel
def _sign(high: int, rest: int) -> int:
    # The sign of a number by its highest digit, and by those below, of which none is below 0.
    if high != 0:
        return 1 if high > 0 else -1
    return 1 if rest > 0 else 0


@inner_kernel
def circle_holds(a: int, b: int, c: int, d: int, site: SlotRows, scratch: Slots) -> bool:
    """Whether d lies inside the circle through a, b and c, counter-clockwise; rows of sites (n, 2)."""
    x, y = site[d, 0], site[d, 1]
    ax, ay = site[a, 0] - x, site[a, 1] - y
    bx, by = site[b, 0] - x, site[b, 1] - y
    cx, cy = site[c, 0] - x, site[c, 1] - y
    of_a, bound_a = _term(float(ax), float(ay), float(bx), float(by), float(cx), float(cy))
    of_b, bound_b = _term(float(bx), float(by), float(cx), float(cy), float(ax), float(ay))
    of_c, bound_c = _term(float(cx), float(cy), float(ax), float(ay), float(bx), float(by))
    found = of_a + of_b + of_c
    bound = CIRCLE_ERROR * (bound_a + bound_b + bound_c)
    if abs(found) > bound:
        return found > 0.0
    for k in range(SUM):
        scratch[k] = 0
    _add_term(ax, ay, bx, by, cx, cy, scratch)
    _add_term(bx, by, cx, cy, ax, ay, scratch)
    _add_term(cx, cy, ax, ay, bx, by, scratch)
    rest = 0
    for k in range(SUM - 1):
        scratch[k + 1] += scratch[k] >> BITS
        rest |= scratch[k] & DIGIT
    return _sign(scratch[SUM - 1], rest) > 0


@inner_kernel
def _term(px: float, py: float, qx: float, qy: float, rx: float, ry: float) -> tuple[float, float]:
    # |p|^2 times q x r, and the same without signs.
    lifted = px * px + py * py
    one = qx * ry
    other = qy * rx
    return lifted * (one - other), lifted * (abs(one) + abs(other))


@inner_kernel
def _add_term(px: int, py: int, qx: int, qy: int, rx: int, ry: int, scratch: Slots) -> None:
    # The same in digits, added to a sum.
    for k in range(SUM, SCRATCH):
        scratch[k] = 0
    _add_product(px, px, 1, SUM, scratch)
    _add_product(py, py, 1, SUM, scratch)
    _add_product(qx, ry, 1, SUM + FACTOR, scratch)
    _add_product(qy, rx, -1, SUM + FACTOR, scratch)
    for first in (SUM, SUM + FACTOR):
        for k in range(first, first + FACTOR - 1):
            scratch[k + 1] += scratch[k] >> BITS
            scratch[k] &= DIGIT
    for k in range(FACTOR):
        for other in range(FACTOR):
            scratch[k + other] += scratch[SUM + k] * scratch[SUM + FACTOR + other]


@inner_kernel
def _add_product(one: int, other: int, sign: int, first: int, scratch: Slots) -> None:
    scratch[first] += sign * (one & DIGIT) * (other & DIGIT)
    scratch[first + 1] += sign * ((one >> BITS) * (other & DIGIT) + (one & DIGIT) * (other >> BITS))
    scratch[first + 2] += sign * (one >> BITS) * (other >> BITS)
