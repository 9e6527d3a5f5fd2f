"""Loops: whether closed lines are simple, and touch; which points of a grid they hold; what a hand meant to draw;
where particles lie along them and inside.

Loop k of several is places[start[k]:start[k + 1]] (n, 2) [m].
"""

import math
from typing import Annotated, NamedTuple

from sandbox.physics.arena import (
    Arena,
    begin,
    give_back,
    is_full,
    mark,
    new_flags,
    new_float_rows,
    new_floats,
    new_slots,
    new_tuple,
)
from sandbox.physics.arrays import Flags, FloatRows, Floats, Slots
from sandbox.physics.geometry.segment import doubled_area_of, nearest_share, segment_of
from sandbox.physics.jit import inlined_kernel, inner_kernel, kernel
from sandbox.physics.topology.sorting import end_lists, sort_ascending, sort_by_value

# Grid points this close to the border, in units of the spacing, count as on it: beyond rounding, below what is seen.
BORDER = 1e-9
# No grid has points farther out, in units of its spacing: floats are whole numbers there.
GRID_END = 2.0**52
# Cosine of the turn from which on a corner is kept: 20 degrees. No regular polygon turns by just this.
KEPT_COSINE = 0.94
# Rows of the lattice inside are this far apart, and what is nearer to the border than its share is left out.
ROW = math.sqrt(0.75)
CLEARANCE = 0.6
# How far around a side's box such points are looked for; the lattice is slanted.
AROUND = 1.1
# Added and taken away again, it rounds what is below 2^51 to a whole number, halves to even ones.
ROUNDING = 6755399441055744.0


class GridPart(NamedTuple):
    """The part of a grid that a loop's box takes: the numbers of its first column and row, and how many there are."""

    left: int
    bottom: int
    columns: int
    rows: int


class _Crossings(NamedTuple):
    """edges: how many parts begin and end at each point of a row; x: where sides cross rows, those of each together."""

    edges: Annotated[Slots, "rows * width"]
    start: Annotated[Slots, "rows + 1"]


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


@inlined_kernel
def _between(value: float, low: float, high: float) -> float:
    return min(max(value, low), high)


@inlined_kernel
def next_of(k: int, first: int, last: int) -> int:
    """The corner after k of the loop first..last."""
    return k + 1 if k + 1 < last else first


# ---- simple or not


@kernel
def is_simple_loop(places: FloatRows) -> bool:
    """Whether all corners of a loop (n, 2) differ and no sides touch, except neighbours at their common corner."""
    return is_simple_part(places, 0, places.shape[0])


@inner_kernel
def is_simple_part(places: FloatRows, first: int, last: int) -> bool:
    """Whether the loop first..last is simple."""
    for side in range(first, last):
        after = next_of(side, first, last)
        if _folds_back(side, after, next_of(after, first, last), places):
            return False
        for other in range(side + 2, last):
            is_beside = side == first and other == last - 1
            if not is_beside and _touch(side, after, other, next_of(other, first, last), places):
                return False
    return True


@kernel
def loops_meet(places: FloatRows, start: Slots) -> bool:
    """Whether any two of the loops touch."""
    return loops_touch_each_other(places, start)


@inner_kernel
def loops_touch_each_other(places: FloatRows, start: Slots) -> bool:
    """`loops_meet`, for kernels."""
    for loop in range(start.shape[0] - 1):
        for side in range(start[loop], start[loop + 1]):
            after = next_of(side, start[loop], start[loop + 1])
            for before in range(loop):
                for other in range(start[before], start[before + 1]):
                    if _touch(side, after, other, next_of(other, start[before], start[before + 1]), places):
                        return True
    return False


@inner_kernel
def _touch(a: int, b: int, c: int, d: int, places: FloatRows) -> bool:
    # Whether the segments a b and c d have a point in common.
    for axis in range(2):
        if min(places[a, axis], places[b, axis]) > max(places[c, axis], places[d, axis]):
            return False
        if min(places[c, axis], places[d, axis]) > max(places[a, axis], places[b, axis]):
            return False
    return _lie_across(a, b, c, d, places) and _lie_across(c, d, a, b, places)


@inner_kernel
def _lie_across(a: int, b: int, c: int, d: int, places: FloatRows) -> bool:
    # Whether c and d do not lie on the same side of a b.
    one = doubled_area_of(a, b, c, places)
    other = doubled_area_of(a, b, d, places)
    return not ((one > 0.0 and other > 0.0) or (one < 0.0 and other < 0.0))


@inner_kernel
def _folds_back(p: int, q: int, r: int, places: FloatRows) -> bool:
    if places[p, 0] == places[q, 0] and places[p, 1] == places[q, 1]:
        return True
    along_x = (places[q, 0] - places[p, 0]) * (places[r, 0] - places[q, 0])
    along_y = (places[q, 1] - places[p, 1]) * (places[r, 1] - places[q, 1])
    return doubled_area_of(p, q, r, places) == 0.0 and along_x + along_y < 0.0


# ---- points of a grid


@inner_kernel
def box_of(places: FloatRows, first: int, last: int) -> tuple[float, float, float, float]:
    """Left, bottom, right and top of the loop first..last."""
    left = right = places[first, 0]
    bottom = top = places[first, 1]
    for k in range(first + 1, last):
        left, right = min(left, places[k, 0]), max(right, places[k, 0])
        bottom, top = min(bottom, places[k, 1]), max(top, places[k, 1])
    return left, bottom, right, top


@inner_kernel
def grid_part(places: FloatRows, first: int, last: int, spacing: float) -> GridPart:
    """The grid of whole multiples of a spacing [m] in the box of the loop first..last."""
    low_x, low_y, high_x, high_y = box_of(places, first, last)
    left = math.ceil(_between(low_x / spacing - BORDER, -GRID_END, GRID_END))
    bottom = math.ceil(_between(low_y / spacing - BORDER, -GRID_END, GRID_END))
    columns = math.floor(_between(high_x / spacing + BORDER, -GRID_END, GRID_END)) - left + 1
    rows = math.floor(_between(high_y / spacing + BORDER, -GRID_END, GRID_END)) - bottom + 1
    return GridPart(left, bottom, max(0, columns), max(0, rows))


@kernel
def grid_points(arena: Arena, corners: FloatRows, spacing: float, box: Slots, points: Flags) -> None:
    """Mark which points (rows * columns) of a grid lie in a simple polygon or on its border, where the arena has room.

    box: left, bottom, columns and rows. A row is inside between its first and second crossing of the border, its third
    and fourth, and so on. Each side also marks the points on it.
    """
    begin(arena)
    part = GridPart(box[0], box[1], box[2], box[3])
    mark_grid(corners, 0, corners.shape[0], spacing, part, points, arena)


@inner_kernel
def mark_grid(
    corners: FloatRows, first: int, last: int, spacing: float, part: GridPart, points: Flags, arena: Arena
) -> None:
    """`grid_points` of the loop first..last, for kernels."""
    bottom = mark(arena)
    start = new_float_rows(arena, last - first, 2)
    lists = new_tuple(_Crossings, arena, rows=part.rows, width=part.columns + 1)
    if is_full(arena):
        return
    for k in range(last - first):
        start[k, 0] = corners[first + k, 0] / spacing - float(part.left)
        start[k, 1] = corners[first + k, 1] / spacing - float(part.bottom)
    for k in range(start.shape[0]):
        _count_side(k, next_of(k, 0, start.shape[0]), start, part, lists)
    end_lists(part.rows, lists.start)
    crossed = new_floats(arena, lists.start[part.rows])
    if is_full(arena):
        return
    for k in range(start.shape[0]):
        _list_side(k, next_of(k, 0, start.shape[0]), start, part, lists, crossed)
    for row in range(part.rows):
        sort_ascending(crossed, lists.start[row], lists.start[row + 1])
        for k in range(lists.start[row], lists.start[row + 1] - 1, 2):
            _mark(row, crossed[k], crossed[k + 1], part, lists.edges)
        depth = 0
        for column in range(part.columns):
            depth += lists.edges[row * (part.columns + 1) + column]
            points[row * part.columns + column] = depth > 0
    give_back(arena, bottom)


@inner_kernel
def _rows_of(ay: float, by: float, part: GridPart) -> tuple[int, int]:
    # The first and the last row that a side comes to, whose lower end is at ay.
    end = float(part.rows)
    return math.ceil(_between(ay - BORDER, 0.0, end)), math.floor(_between(by + BORDER, -1.0, end - 1.0))


@inner_kernel
def _upward(a: int, b: int, start: FloatRows) -> tuple[float, float, float, float]:
    # A side from its lower end to its upper one.
    if start[a, 1] > start[b, 1]:
        return start[b, 0], start[b, 1], start[a, 0], start[a, 1]
    return start[a, 0], start[a, 1], start[b, 0], start[b, 1]


@inner_kernel
def _crosses(row: int, ay: float, by: float) -> bool:
    # Half-open, so that a corner between two sides counts once and every row is crossed an even number of times.
    return float(row) >= ay and float(row) < by


@inner_kernel
def _x_at(row: int, ax: float, ay: float, bx: float, by: float) -> float:
    if not by > ay:
        return ax
    return ax + (bx - ax) * (min(max(float(row), ay), by) - ay) / (by - ay)


@inner_kernel
def _count_side(a: int, b: int, start: FloatRows, part: GridPart, lists: _Crossings) -> None:
    # Mark the points on a side, and count the rows that it crosses.
    ax, ay, bx, by = _upward(a, b, start)
    first, last = _rows_of(ay, by, part)
    is_level = by - ay <= BORDER
    for row in range(first, last + 1):
        x = _x_at(row, ax, ay, bx, by)
        _mark(row, min(ax, bx) if is_level else x, max(ax, bx) if is_level else x, part, lists.edges)
        if _crosses(row, ay, by):
            lists.start[row] += 1


@inner_kernel
def _list_side(a: int, b: int, start: FloatRows, part: GridPart, lists: _Crossings, crossed: Floats) -> None:
    ax, ay, bx, by = _upward(a, b, start)
    first, last = _rows_of(ay, by, part)
    for row in range(first, last + 1):
        if _crosses(row, ay, by):
            lists.start[row] -= 1
            crossed[lists.start[row]] = _x_at(row, ax, ay, bx, by)


@inner_kernel
def _mark(row: int, start: float, end: float, part: GridPart, edges: Slots) -> None:
    columns = float(part.columns)
    first = math.ceil(_between(start - BORDER, 0.0, columns))
    beyond = math.floor(_between(end + BORDER, -1.0, columns - 1.0)) + 1
    if beyond > first:
        edges[row * (part.columns + 1) + first] += 1
        edges[row * (part.columns + 1) + beyond] -= 1


# ---- drawn by hand


@kernel
def trace(arena: Arena, stroke: FloatRows, tolerance: float, overshoot: float) -> int:
    """Simplify a closed line drawn by hand; how many corners that leaves, which are the first rows of `stroke` then.

    overshoot: the largest part of the corners that is left out at the end, where a hand ran over what it began with; as
    few as make the line simple, and none if nothing does. The arena is scratch: where it is full, nothing was changed.
    """
    begin(arena)
    count = simplify(stroke, tolerance, arena)
    return count if is_full(arena) else without_overshoot(stroke, count, overshoot)


@inner_kernel
def without_overshoot(corners: FloatRows, count: int, overshoot: float) -> int:
    """How many of the first `count` corners make a simple line, if no more than a part of them is left out; or all."""
    for left_out in range(math.floor(overshoot * float(count)) + 1):
        if is_simple_part(corners, 0, count - left_out):
            return count - left_out
    return count


@inner_kernel
def simplify(stroke: FloatRows, tolerance: float, arena: Arena) -> int:
    """Drop corners of a closed line that change it by at most a tolerance [m]; how many rows (n, 2) are left.

    Two far corners stay. Each way between them becomes a chord, or is split at the corner farthest from the chord
    (Ramer 1972; Douglas and Peucker 1973). Repeated corners go first.
    """
    given = stroke.shape[0]
    bottom = mark(arena)
    points = new_float_rows(arena, given + 1, 2)
    kept = new_slots(arena, given + 1)
    if is_full(arena):
        return 0
    count = 0
    for k in range(given):
        before = k - 1 if k > 0 else given - 1
        if stroke[k, 0] != stroke[before, 0] or stroke[k, 1] != stroke[before, 1]:
            points[count, 0] = stroke[k, 0]
            points[count, 1] = stroke[k, 1]
            count += 1
    far = 0
    farthest = 0.0
    for k in range(1, count):
        dx, dy = points[k, 0] - points[0, 0], points[k, 1] - points[0, 1]
        if dx * dx + dy * dy > farthest:
            farthest = dx * dx + dy * dy
            far = k
    points[count, 0] = points[0, 0]
    points[count, 1] = points[0, 1]
    kept[0] = kept[far] = 1
    kept[count] = 1
    _split_ways(points, count, tolerance, kept)
    left = 0
    for k in range(count):
        if kept[k] == 1 or count < 3:
            stroke[left, 0] = points[k, 0]
            stroke[left, 1] = points[k, 1]
            left += 1
    give_back(arena, bottom)
    return left


@inner_kernel
def _split_ways(points: FloatRows, count: int, tolerance: float, kept: Slots) -> None:
    first = 0
    while first < count:
        last = first + 1
        while kept[last] == 0:
            last += 1
        x, y, dx, dy = segment_of(first, last, points)
        worst = first
        most = tolerance
        for k in range(first + 1, last):
            share = nearest_share(points[k, 0] - x, points[k, 1] - y, dx, dy)
            away_x, away_y = points[k, 0] - x - share * dx, points[k, 1] - y - share * dy
            away = math.sqrt(away_x * away_x + away_y * away_y)
            if away > most:
                most = away
                worst = k
        if worst == first:
            first = last
        else:
            kept[worst] = 1


@inlined_kernel
def rounded(value: float) -> float:
    """The nearest whole number."""
    return (value + ROUNDING) - ROUNDING


# ---- on the outline


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
        back_x, back_y = way.corner[k, 0] - x, way.corner[k, 1] - y
        x, y = place_at(way.start[k] + window, way)
        ahead_x, ahead_y = x - way.corner[k, 0], y - way.corner[k, 1]
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
    start_x, start_y = border[a, 0] / spacing, border[a, 1] / spacing
    side_x, side_y = border[b, 0] / spacing - start_x, border[b, 1] / spacing - start_y
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
