"""Loops: whether closed lines are simple, and touch; which points of a grid they hold; what a hand meant to draw.

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
    new_float_rows,
    new_floats,
    new_slots,
    new_tuple,
)
from sandbox.physics.arrays import Flags, FloatRows, Floats, Slots
from sandbox.physics.geometry.segment import doubled_area_of, nearest_share, segment_of
from sandbox.physics.jit import inlined_kernel, inner_kernel, kernel

# Grid points this close to the border, in units of the spacing, count as on it: beyond rounding, below what is seen.
BORDER = 1e-9
# No grid has points farther out, in units of its spacing: floats are whole numbers there.
GRID_END = 2.0**52


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
    """Whether a side of a loop touches one of another."""
    return loops_touch_each_other(places, start)


@inner_kernel
def loops_touch_each_other(places: FloatRows, start: Slots) -> bool:
    """The same, for kernels."""
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


@inner_kernel
def grid_part(places: FloatRows, first: int, last: int, spacing: float) -> GridPart:
    """The grid of whole multiples of a spacing [m] in the box of the loop first..last."""
    low_x = places[first, 0]
    high_x = low_x
    low_y = places[first, 1]
    high_y = low_y
    for k in range(first + 1, last):
        low_x = min(low_x, places[k, 0])
        high_x = max(high_x, places[k, 0])
        low_y = min(low_y, places[k, 1])
        high_y = max(high_y, places[k, 1])
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
    """The same of the loop first..last, for kernels."""
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
    total = 0
    for row in range(part.rows + 1):
        total += lists.start[row]
        lists.start[row] = total
    crossed = new_floats(arena, total)
    if is_full(arena):
        return
    for k in range(start.shape[0]):
        _list_side(k, next_of(k, 0, start.shape[0]), start, part, lists, crossed)
    for row in range(part.rows):
        _sort(crossed, lists.start[row], lists.start[row + 1])
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


@inner_kernel
def _sort(values: Floats, first: int, last: int) -> None:
    # A row has few crossings.
    for at in range(first + 1, last):
        value = values[at]
        to = at
        while to > first and values[to - 1] > value:
            values[to] = values[to - 1]
            to -= 1
        values[to] = value


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
        dx = points[k, 0] - points[0, 0]
        dy = points[k, 1] - points[0, 1]
        if dx * dx + dy * dy > farthest:
            farthest = dx * dx + dy * dy
            far = k
    points[count, 0] = points[0, 0]
    points[count, 1] = points[0, 1]
    kept[0] = 1
    kept[far] = 1
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
            away_x = points[k, 0] - x - share * dx
            away_y = points[k, 1] - y - share * dy
            away = math.sqrt(away_x * away_x + away_y * away_y)
            if away > most:
                most = away
                worst = k
        if worst == first:
            first = last
        else:
            kept[worst] = 1
