"""Fitted meshes: particles at equal distances on outlines, even triangles inside, and empty holes.

The same kernels mesh for levels, for the editor, for what is drawn in play, and for pages. What they find lies in their
arena, and its first words say where; `found_in` reads it.
"""

import math
from typing import NamedTuple

import numpy as np

from sandbox.physics.arena import (
    Arena,
    begin,
    give_back,
    is_full,
    mark,
    new_flags,
    new_float_rows,
    new_slot_rows,
    new_slots,
    new_tuple,
)
from sandbox.physics.arrays import FloatRows, Floats, SlotRows, Slots
from sandbox.physics.geometry.segment import difference, polygon_area
from sandbox.physics.jit import float_rows_in, floats_in, inner_kernel, kernel, scalar_kernel, slot_rows_in
from sandbox.physics.meshing.loops import (
    ROW,
    box_of,
    is_simple_part,
    kept_corners,
    lattice,
    loops_touch_each_other,
    next_of,
    rounded,
    sample_way,
    simplify,
    way_along,
    without_overshoot,
)
from sandbox.physics.meshing.triangulation import (
    FARTHEST,
    Net,
    Stars,
    apex_of,
    even_out,
    force,
    keep_inside,
    table_size,
    triangulate,
)

# Triangulated are whole multiples of this part of the spacing.
GRAIN = 1.0 / 65536.0
# Cotangents of the smallest angle that a triangle may have: 20 degrees; of an outline with sharper corners than twice
# that, half its sharpest, and never below 5 degrees, where a triangle is little more than a line.
LEAST_ANGLE, SLIVER = 2.7475, 11.43
# Work of a mesh in units of the limit of polygons: for each particle, and for each pair of sides of the border.
PARTICLE_WORK, PAIR_WORK, MOST_WORK = 200.0, 0.25, 1e12
# What is too coarse is tried so much finer, so often; each to three digits, which are whole numbers from the first to
# below the second. No spacing is below the least [m].
FINER, TRIES, LEAST_SPACING = 0.8, 16, 1e-6
HUNDRED, THOUSAND = 100.0, 1000.0
# Particles that a drawn body's mesh is made for, and that it has at most where an outline needs a finer one; at most
# this part of its corners is left out at its end, where a hand ran over what it began with; places are rounded to
# millimetres, or to this part of the spacing where that is finer.
PARTICLES, MOST_PARTICLES = 30, 240
OVERSHOOT = 0.2
PER_METRE, FINEST = 1000.0, 0.01
# What kernels say of an outline: a mesh fits; it is too small; it crosses or touches itself; it is too fine: at this
# spacing sides would touch or triangles would be slivers, or else it takes more particles than it may have.
FITS, TOO_SMALL, CROSSES, TOO_FINE = range(4)
# Words of an arena: spacing [m] and area [m^2]; where places, triangles and pairs lie, each with how many.
NUMBERS, PLACES, TRIANGLES, PAIRS, HEAD = 1, 3, 5, 7, 8
# Words of an arena in which most meshes find room.
USUAL_ARENA = 1 << 15


class FoundMesh(NamedTuple):
    """A mesh: places [m] (n, 2), those on borders first; triangles (t, 3), counter-clockwise; their sides (m, 2).

    Triangles begin with their lowest corner, sides with their lower end; both are in order. spacing [m] and area [m^2]:
    of what was drawn.
    """

    places: FloatRows
    triangles: SlotRows
    pairs: SlotRows
    spacing: float
    area: float


def found_in(arena: Arena) -> FoundMesh:
    """The mesh that lies in an arena."""
    rows = [
        arena[arena[at] : arena[at] + width * arena[at + 1]].reshape(-1, width).copy()
        for at, width in ((PLACES, 2), (TRIANGLES, 3), (PAIRS, 2))
    ]
    spacing, area = arena[NUMBERS : NUMBERS + 2].view(np.float64).tolist()
    return FoundMesh(rows[0].view(np.float64), rows[1], rows[2], spacing, area)


# ---- what Python and pages call


@kernel
def mesh_loops(arena: Arena, places: FloatRows, start: Slots, spacing: float, is_sampled: bool) -> int:
    """Mesh an outline with holes, simple loops at places (n, 2) [m], loop k from start[k] on; or say TOO_FINE.

    is_sampled: whether particles are put on the outline, whose corners they are otherwise.
    """
    _begin(arena)
    return _fit(places, start, spacing, is_sampled, arena)


@kernel
def mesh_work(places: FloatRows, start: Slots, spacing: float) -> int:
    """An estimate of the work for the mesh of loops [m], in the unit of the limit of polygons."""
    return _work(places, start, spacing)


@kernel
def outline_fault(corners: FloatRows, least_area: float) -> int:
    """The fault of a drawn outline (n, 2) [m], by itself; FITS: none."""
    return _fault(corners, least_area)


@kernel
def fill_outline(arena: Arena, corners: FloatRows) -> int:
    """Mesh a drawn outline (n, 2) [m], as fine as it needs; the fault if it cannot be meshed."""
    _begin(arena)
    return _fill(corners, 0.0, arena)


@kernel
def fill_stroke(arena: Arena, numbers: Floats) -> int:
    """`fill_outline` of a stroke: its tolerance [m], the least area [m^2], and its places [m], each x and y."""
    _begin(arena)
    corners = new_float_rows(arena, numbers.shape[0] // 2 - 1, 2)
    if is_full(arena):
        return TOO_FINE
    for k in range(corners.shape[0]):
        corners[k, 0] = numbers[2 * k + 2]
        corners[k, 1] = numbers[2 * k + 3]
    count = simplify(corners, numbers[0], arena)
    return _fill(corners[0 : without_overshoot(corners, count, OVERSHOOT)], numbers[1], arena)


@scalar_kernel
def finer_spacing(spacing: float, tries: int) -> float:
    """The spacing [m] that is tried after so many were too coarse, to three digits; the first one as it is."""
    if tries == 0:
        return spacing
    finer = spacing
    for _ in range(tries):
        finer *= FINER
    up = 1.0
    while finer * up < HUNDRED and up < THOUSAND / LEAST_SPACING:
        up *= 10.0
    down = 1.0
    while finer / down >= THOUSAND:
        down *= 10.0
    return rounded(finer * up / down) * down / up


# ---- drawn by hand


@inner_kernel
def _fault(corners: FloatRows, least_area: float) -> int:
    if corners.shape[0] < 3:
        return TOO_SMALL
    if not is_simple_part(corners, 0, corners.shape[0]):
        return CROSSES
    area = abs(polygon_area(corners, 0, corners.shape[0]))
    return TOO_SMALL if area < least_area or not area > 0.0 else FITS


@inner_kernel
def _fill(corners: FloatRows, least_area: float, arena: Arena) -> int:
    fault = _fault(corners, least_area)
    if fault != FITS:
        return fault
    start = new_slots(arena, 2)
    if is_full(arena):
        return TOO_FINE
    numbers = floats_in(arena, NUMBERS, 2)
    start[1] = corners.shape[0]
    numbers[1] = abs(polygon_area(corners, 0, corners.shape[0]))
    for tries in range(TRIES):
        numbers[0] = finer_spacing(math.sqrt(numbers[1] / float(PARTICLES)), tries)
        work = _work(corners, start, numbers[0])
        if float(work) > float(MOST_PARTICLES) * PARTICLE_WORK or numbers[0] < LEAST_SPACING:
            return TOO_FINE
        bottom = mark(arena)
        if _fit(corners, start, numbers[0], True, arena) == FITS:
            if not is_full(arena):
                _round_places(numbers[0], arena)
            return FITS
        if is_full(arena):
            return TOO_FINE
        give_back(arena, bottom)
    return TOO_FINE


@inner_kernel
def _round_places(spacing: float, arena: Arena) -> None:
    per_metre = PER_METRE
    while FINEST * spacing * per_metre < 1.0:
        per_metre *= 10.0
    places = float_rows_in(arena, arena[PLACES], arena[PLACES + 1], 2)
    for k in range(places.shape[0]):
        for axis in range(2):
            # Never -0.
            places[k, axis] = rounded(places[k, axis] * per_metre) / per_metre + 0.0


# ---- meshes


@inner_kernel
def _begin(arena: Arena) -> None:
    begin(arena)
    new_slots(arena, HEAD)


@inner_kernel
def _length(places: FloatRows, start: Slots) -> float:
    # Of all loops together.
    total = 0.0
    for loop in range(start.shape[0] - 1):
        for k in range(start[loop], start[loop + 1]):
            dx, dy = difference(k, next_of(k, start[loop], start[loop + 1]), places)
            total += math.sqrt(dx * dx + dy * dy)
    return total


@inner_kernel
def _work(places: FloatRows, start: Slots, spacing: float) -> int:
    border = _length(places, start) / spacing
    left, low, right, high = box_of(places, 0, start[1])
    height = high - low
    cell = ROW * spacing * spacing
    particles = abs(polygon_area(places, 0, start[1])) / cell + border / 2.0
    # The lattice is looked through in a slanted box.
    box = (right - left + height) * height / cell
    return math.ceil(min(PARTICLE_WORK * particles + PAIR_WORK * border * border + box, MOST_WORK))


@inner_kernel
def _fit(places: FloatRows, start: Slots, spacing: float, is_sampled: bool, arena: Arena) -> int:
    first = new_slots(arena, start.shape[0])
    room = new_float_rows(arena, _most_on_border(places, start, spacing), 2)
    if is_full(arena):
        return TOO_FINE
    sharpest = LEAST_ANGLE
    for loop in range(start.shape[0] - 1):
        to = first[loop]
        if loop > 0 or is_sampled:
            bottom = mark(arena)
            way = way_along(places, start[loop], start[loop + 1], loop == 0, arena)
            if is_full(arena):
                return TOO_FINE
            kept, sharp = kept_corners(way, spacing)
            first[loop + 1] = sample_way(way, kept, spacing, to, room)
            sharpest = max(sharpest, sharp)
            give_back(arena, bottom)
        else:
            for k in range(start[1]):
                room[k, 0] = places[k, 0]
                room[k, 1] = places[k, 1]
            first[1] = start[1]
        if first[loop + 1] - to < 3:
            return TOO_FINE
    border = room[0 : first[start.shape[0] - 1]]
    if not _is_separate(border, first, spacing, arena) or is_full(arena):
        return TOO_FINE
    inner = lattice(border, first, spacing, arena)
    if is_full(arena) or not _triangulated(border, first, inner, spacing, arena) or is_full(arena):
        return TOO_FINE
    return TOO_FINE if _sharpest(arena) > min(sharpest, SLIVER) else FITS


@inner_kernel
def _most_on_border(places: FloatRows, start: Slots, spacing: float) -> int:
    # No fewer places than outlines are given.
    return math.ceil(_length(places, start) / spacing) + 2 * places.shape[0] + 2


@inner_kernel
def _is_separate(border: FloatRows, first: Slots, spacing: float, arena: Arena) -> bool:
    # Whether, at whole grains, each loop is simple, none touches another, and none is too far away for exact decisions.
    bottom = mark(arena)
    whole = new_float_rows(arena, border.shape[0], 2)
    if is_full(arena):
        return False
    for k in range(border.shape[0]):
        for axis in range(2):
            whole[k, axis] = rounded(border[k, axis] * _grains(spacing))
            if not abs(whole[k, axis]) < FARTHEST:
                return False
    for loop in range(first.shape[0] - 1):
        if not is_simple_part(whole, first[loop], first[loop + 1]):
            return False
    if loops_touch_each_other(whole, first):
        return False
    give_back(arena, bottom)
    return True


@inner_kernel
def _grains(spacing: float) -> float:
    return 1.0 / (spacing * GRAIN)


@inner_kernel
def _triangulated(border: FloatRows, first: Slots, inner: FloatRows, spacing: float, arena: Arena) -> bool:
    # Lay out the mesh of places on borders and inside; False: a place lies on the side of a border.
    fixed = border.shape[0]
    count = fixed + inner.shape[0]
    places = new_float_rows(arena, count, 2)
    net = new_tuple(Net, arena, sites=count + 3, places=table_size(count + 3))
    kept = new_tuple(
        Net, arena, site=net.site, second=net.second, after=net.after, scratch=net.scratch, places=table_size(count + 3)
    )
    stars = new_tuple(Stars, arena, sites=count + 3)
    active = new_flags(arena, count)
    moved = new_flags(arena, count)
    if is_full(arena):
        return False
    grains = _grains(spacing)
    for k in range(count):
        for axis in range(2):
            place = border[k, axis] if k < fixed else inner[k - fixed, axis]
            places[k, axis] = place
            net.site[k, axis] = math.floor(rounded(place * grains))
    triangulate(net, arena)
    for loop in range(first.shape[0] - 1):
        for k in range(first[loop], first[loop + 1]):
            if not force(k, next_of(k, first[loop], first[loop + 1]), net, arena):
                return False
    if is_full(arena):
        return False
    for loop in range(first.shape[0] - 1):
        for k in range(first[loop], first[loop + 1]):
            net.after[k] = next_of(k, first[loop], first[loop + 1])
    keep_inside(net, kept, arena)
    even_out(fixed, kept, stars, active, moved, arena)
    if is_full(arena):
        return False
    for k in range(fixed, count):
        for axis in range(2):
            places[k, axis] = float(net.site[k, axis]) / grains
    _lay_out(places, first, kept, stars, arena)
    return True


@inner_kernel
def _lay_out(places: FloatRows, first: Slots, net: Net, stars: Stars, arena: Arena) -> None:
    # Places, and the triangles and sides of a net, in order.
    count = places.shape[0]
    sides = int(stars.start[count])
    arena[PLACES] = mark(arena)
    arena[PLACES + 1] = count
    found = new_float_rows(arena, count, 2)
    arena[TRIANGLES] = mark(arena)
    arena[TRIANGLES + 1] = sides // 3
    triangles = new_slot_rows(arena, sides // 3, 3)
    arena[PAIRS] = mark(arena)
    pair_count = int(sides + first[first.shape[0] - 1]) // 2
    arena[PAIRS + 1] = pair_count
    pairs = new_slot_rows(arena, pair_count, 2)
    if is_full(arena):
        return
    triangle = 0
    pair = 0
    for a in range(count):
        found[a, 0] = places[a, 0]
        found[a, 1] = places[a, 1]
        # To what is before it on a border, no side leads from here.
        before = _before(a, first)
        for at in range(stars.start[a], stars.start[a + 1]):
            b = stars.near[at]
            if a < before < b:
                pair = _put_pair(a, before, pair, pairs)
                before = -1
            if a < b:
                pair = _put_pair(a, b, pair, pairs)
                c = apex_of(a, b, net)
                if a < c:
                    triangles[triangle, 0] = a
                    triangles[triangle, 1] = b
                    triangles[triangle, 2] = c
                    triangle += 1
        if a < before:
            pair = _put_pair(a, before, pair, pairs)


@inner_kernel
def _before(k: int, first: Slots) -> int:
    # The place before k on its border; -1 for those inside.
    for loop in range(first.shape[0] - 1):
        if k < first[loop + 1]:
            return k - 1 if k > first[loop] else first[loop + 1] - 1
    return -1


@inner_kernel
def _put_pair(a: int, b: int, pair: int, pairs: SlotRows) -> int:
    pairs[pair, 0] = a
    pairs[pair, 1] = b
    return pair + 1


@inner_kernel
def _sharpest(arena: Arena) -> float:
    # Cotangent of the smallest angle of all triangles; infinite if one is turned over.
    places = float_rows_in(arena, arena[PLACES], arena[PLACES + 1], 2)
    triangles = slot_rows_in(arena, arena[TRIANGLES], arena[TRIANGLES + 1], 3)
    sharpest = 0.0
    for t in range(triangles.shape[0]):
        for k in range(3):
            ux, uy = difference(triangles[t, k], triangles[t, (k + 1) % 3], places)
            vx, vy = difference(triangles[t, k], triangles[t, (k + 2) % 3], places)
            across = ux * vy - uy * vx
            if not across > 0.0:
                return math.inf
            sharpest = max(sharpest, (ux * vx + uy * vy) / across)
    return sharpest
