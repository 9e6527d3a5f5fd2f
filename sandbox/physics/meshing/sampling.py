"""Where the particles of a mesh begin: evenly on its outline, and on a lattice of even triangles well inside."""

import math
from typing import Annotated, NamedTuple

from sandbox.physics.arena import Arena, give_back, is_full, mark, new_flags, new_float_rows, new_tuple
from sandbox.physics.arrays import Flags, FloatRows, Floats, Slots
from sandbox.physics.geometry.segment import segment_of
from sandbox.physics.jit import inlined_kernel, inner_kernel
from sandbox.physics.meshing.loops import GridPart, grid_part, mark_grid, next_of
from sandbox.physics.topology.sorting import sort_ascending, sort_by_value

# Cosine of the turn from which on a corner is kept: 20 degrees. No regular polygon turns by just this.
KEPT_COSINE = 0.94
# Rows of the lattice inside are this far apart, and what is nearer to the border than its share is left out.
ROW = math.sqrt(0.75)
CLEARANCE = 0.6
# How far around a side's box such points are looked for; the lattice is slanted.
AROUND = 1.1
# Added and taken away again, it rounds what is below 2^51 to a whole number, halves to even ones.
ROUNDING = 6755399441055744.0


@inlined_kernel
def rounded(value: float) -> float:
    """The nearest whole number."""
    return (value + ROUNDING) - ROUNDING


# ---- on the outline


class Way(NamedTuple):
    """A closed outline [m] as a way along it, from its first corner; and what of its corners is kept."""

    corner: Annotated[FloatRows, "corners, 2"]
    side: Annotated[FloatRows, "corners, 2"]
    reach: Annotated[Floats, "corners"]
    start: Annotated[Floats, "corners + 1"]
    cosine: Annotated[Floats, "corners"]  # of the turn at a corner
    sine: Annotated[Floats, "corners"]
    order: Annotated[Slots, "corners"]  # corners by their cosines; then those that are kept
    merge_buffer: Annotated[Slots, "corners"]


@inner_kernel
def way_along(places: FloatRows, first: int, last: int, is_outer: bool, arena: Arena) -> Way:
    """The way along the loop first..last (n, 2): counter-clockwise, or, not being the outer one, against that."""
    count = last - first
    way = new_tuple(Way, arena, corners=count)
    if is_full(arena):
        return way
    doubled = 0.0
    for k in range(first, last):
        after = next_of(k, first, last)
        doubled += places[k, 0] * places[after, 1] - places[k, 1] * places[after, 0]
    is_turned = (doubled > 0.0) != is_outer
    for k in range(count):
        for axis in range(2):
            way.corner[k, axis] = places[last - k if is_turned and k > 0 else first + k, axis]
    for k in range(count):
        _, _, dx, dy = segment_of(k, next_of(k, 0, count), way.corner)
        way.side[k, 0] = dx
        way.side[k, 1] = dy
        way.reach[k] = math.sqrt(dx * dx + dy * dy)
        way.start[k + 1] = way.start[k] + way.reach[k]
    return way


@inlined_kernel
def length_of(way: Way) -> float:
    """Length of the whole way [m]."""
    return way.start[way.start.shape[0] - 1]


@inner_kernel
def place_at(along: float, way: Way) -> tuple[float, float]:
    """The place at a distance [m] along a way, at most once around either way."""
    length = length_of(way)
    if along < 0.0:
        along += length
    elif along >= length:
        along -= length
    low = 0
    high = way.reach.shape[0]
    while high - low > 1:
        middle = (low + high) // 2
        if way.start[middle] <= along:
            low = middle
        else:
            high = middle
    share = min(max((along - way.start[low]) / way.reach[low], 0.0), 1.0)
    return way.corner[low, 0] + share * way.side[low, 0], way.corner[low, 1] + share * way.side[low, 1]


@inner_kernel
def kept_corners(way: Way, spacing: float) -> tuple[int, float]:
    """How many corners are kept, which `order` has then; and the cotangent of half the angle at the sharpest inside.

    Of corners that turn alike as near as half a spacing, the sharper one stays.
    """
    count = way.reach.shape[0]
    length = length_of(way)
    window = min(spacing / 2.0, length / 8.0)
    for k in range(count):
        way.order[k] = k
        x, y = place_at(way.start[k] - window, way)
        back_x = way.corner[k, 0] - x
        back_y = way.corner[k, 1] - y
        x, y = place_at(way.start[k] + window, way)
        ahead_x = x - way.corner[k, 0]
        ahead_y = y - way.corner[k, 1]
        both = math.sqrt(back_x * back_x + back_y * back_y) * math.sqrt(ahead_x * ahead_x + ahead_y * ahead_y)
        way.cosine[k] = (back_x * ahead_x + back_y * ahead_y) / both
        way.sine[k] = (back_x * ahead_y - back_y * ahead_x) / both
    sort_by_value(way.cosine, way.order, 0, count, way.merge_buffer)
    kept = 0
    for k in range(count):
        corner = way.order[k]
        if way.cosine[corner] > KEPT_COSINE:
            break
        is_alone = True
        for other in range(kept):
            apart = abs(way.start[corner] - way.start[way.order[other]])
            is_alone = is_alone and min(apart, length - apart) >= spacing / 2.0
        if is_alone:
            way.order[kept] = corner
            kept += 1
    sort_ascending(way.order, 0, kept)
    # Corners that stick out alone bound the angles inside. The border has what is filled on its left. The angle inside
    # is half a turn less that of the way: the cotangent of half of it is (1 - cosine) / sine of that.
    sharpest = 0.0
    for k in range(kept):
        corner = way.order[k]
        if way.sine[corner] > 0.0:
            sharpest = max(sharpest, (1.0 - way.cosine[corner]) / way.sine[corner])
    return kept, sharpest


@inner_kernel
def sample_way(way: Way, kept: int, spacing: float, to: int, border: FloatRows) -> int:
    """Write places (n, 2) on a way, on kept corners and evenly between, from row `to` on; the row after the last."""
    length = length_of(way)
    for k in range(max(kept, 1)):
        start = way.start[way.order[k]] if kept > 0 else 0.0
        first = way.start[way.order[0]] if kept > 0 else 0.0
        end = way.start[way.order[k + 1]] if k + 1 < kept else first + length
        parts = max(1, math.floor(rounded((end - start) / spacing)))
        for part in range(parts):
            x, y = place_at(start + (end - start) * float(part) / float(parts), way)
            # Corners stand where they are, to the bit.
            is_corner = part == 0 and kept > 0
            border[to, 0] = way.corner[way.order[k], 0] if is_corner else x
            border[to, 1] = way.corner[way.order[k], 1] if is_corner else y
            to += 1
    return to


# ---- inside


@inner_kernel
def lattice(border: FloatRows, start: Slots, spacing: float, arena: Arena) -> FloatRows:
    """Points (k, 2) [m] of a lattice of even triangles about [0, 0] well inside loops, by rows from the bottom left."""
    loops = start.shape[0] - 1
    # In units of its two directions, along x and 60 degrees from there, the lattice is all whole numbers.
    slanted = new_float_rows(arena, border.shape[0], 2)
    if is_full(arena):
        return slanted
    for k in range(border.shape[0]):
        up = border[k, 1] / (spacing * ROW)
        slanted[k, 0] = border[k, 0] / spacing - up / 2.0
        slanted[k, 1] = up
    part = grid_part(slanted, start[0], start[1], 1.0)
    points = new_flags(arena, part.rows * part.columns)
    if is_full(arena):
        return slanted
    mark_grid(slanted, start[0], start[1], 1.0, part, points, arena)
    for loop in range(1, loops):
        _leave_out(slanted, start[loop], start[loop + 1], part, points, arena)
    if is_full(arena):
        return slanted
    for loop in range(loops):
        for k in range(start[loop], start[loop + 1]):
            _clear(k, next_of(k, start[loop], start[loop + 1]), border, slanted, spacing, part, points)
    count = 0
    for at in range(points.shape[0]):
        count += 1 if points[at] else 0
    found = new_float_rows(arena, count, 2)
    if is_full(arena):
        return found
    count = 0
    for row in range(part.rows):
        up = float(part.bottom + row)
        for column in range(part.columns):
            if points[row * part.columns + column]:
                found[count, 0] = (float(part.left + column) + up / 2.0) * spacing
                found[count, 1] = up * ROW * spacing
                count += 1
    return found


@inner_kernel
def _leave_out(slanted: FloatRows, first: int, last: int, part: GridPart, points: Flags, arena: Arena) -> None:
    # Take out what a hole holds.
    bottom = mark(arena)
    own = grid_part(slanted, first, last, 1.0)
    held = new_flags(arena, own.rows * own.columns)
    if is_full(arena):
        return
    mark_grid(slanted, first, last, 1.0, own, held, arena)
    if is_full(arena):
        return
    for row in range(own.rows):
        for column in range(own.columns):
            if held[row * own.columns + column]:
                at = (row + own.bottom - part.bottom) * part.columns + column + own.left - part.left
                points[at] = False
    give_back(arena, bottom)


@inner_kernel
def _clear(
    a: int, b: int, border: FloatRows, slanted: FloatRows, spacing: float, part: GridPart, points: Flags
) -> None:
    # Take out points near a side.
    start_x = border[a, 0] / spacing
    start_y = border[a, 1] / spacing
    side_x = border[b, 0] / spacing - start_x
    side_y = border[b, 1] / spacing - start_y
    low = math.floor(min(slanted[a, 1], slanted[b, 1]) - AROUND)
    left = math.floor(min(slanted[a, 0], slanted[b, 0]) - AROUND)
    high = math.floor(max(slanted[a, 1], slanted[b, 1]) + AROUND)
    right = math.floor(max(slanted[a, 0], slanted[b, 0]) + AROUND)
    for row in range(max(low - part.bottom, 0), min(high - part.bottom + 1, part.rows)):
        v = float(row + part.bottom)
        for column in range(max(left - part.left, 0), min(right - part.left + 1, part.columns)):
            u = float(column + part.left)
            x = u + v / 2.0 - start_x
            y = v * ROW - start_y
            share = min(max((x * side_x + y * side_y) / (side_x * side_x + side_y * side_y), 0.0), 1.0)
            x -= share * side_x
            y -= share * side_y
            if x * x + y * y < CLEARANCE * CLEARANCE:
                points[row * part.columns + column] = False
