"""Pixels 0xAARRGGBB, and what covers them: outlines traced around particles, coverage, blur.

Each edge of an outline adds its signed area to the cells it crosses; a row's running sum is coverage. After R. Levien's
font-rs and S. Barrett's stb_truetype 2: exact at the edges, for any winding, with holes.
"""

import math
from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.arrays import ArrayKind, FloatRows, Floats, Slots
from sandbox.physics.jit import inner_kernel, kernel, scalar_kernel

# Pixels of a picture, of a row of one, and of several pictures of one size.
Pixels = Annotated[NDArray[np.uint32], ArrayKind(np.uint32, 2)]
PixelRow = Annotated[NDArray[np.uint32], ArrayKind(np.uint32)]
Sheets = Annotated[NDArray[np.uint32], ArrayKind(np.uint32, 3)]
Singles = Annotated[NDArray[np.float32], ArrayKind(np.float32)]
SlotTables = Annotated[NDArray[np.int64], ArrayKind(np.int64, 3)]

# Coordinates beyond this [pixels] are not drawn: no screen is that large.
FAR = 1e6


class Clip(NamedTuple):
    """Left, top, right, bottom (4,) of what may be drawn on, right and bottom exclusive."""

    edges: Slots


@scalar_kernel
def laid_over(under: int, over: int, share: int) -> int:
    """A pixel with share / 256 of another colour over it; red and blue in one multiplication."""
    keep = 256 - share
    both = (((over & 0xFF00FF) * share + (under & 0xFF00FF) * keep) >> 8) & 0xFF00FF
    green = (((over & 0x00FF00) * share + (under & 0x00FF00) * keep) >> 8) & 0x00FF00
    return 0xFF000000 | both | green


@inner_kernel
def find_box(point: FloatRows, first: int, last: int, box: Floats) -> bool:
    """Write the box around points into box (4,); whether all of them can be drawn."""
    left, top, right, bottom = FAR, FAR, -FAR, -FAR
    for k in range(first, last):
        x, y = point[k, 0], point[k, 1]
        if not (abs(x) < FAR and abs(y) < FAR):
            return False
        left, right = min(left, x), max(right, x)
        top, bottom = min(top, y), max(bottom, y)
    box[0], box[1], box[2], box[3] = left, top, right, bottom
    return first < last


@inner_kernel
def clear(cells: Singles, count: int) -> None:
    """Set the first cells to 0."""
    for k in range(count):
        cells[k] = 0.0


@inner_kernel
def add_outline(
    cells: Singles, width: int, height: int, point: FloatRows, first: int, last: int, x0: float, y0: float, scale: float
) -> None:
    """Add a closed outline to cells of rows of width + 2; (x0, y0): where the cells begin, scale: cells a pixel."""
    stride = width + 2
    for i in range(first, last):
        j = i + 1 if i + 1 < last else first
        ax, ay = (point[i, 0] - x0) * scale, (point[i, 1] - y0) * scale
        bx, by = (point[j, 0] - x0) * scale, (point[j, 1] - y0) * scale
        if ay == by:
            continue
        way = 1.0
        if ay > by:
            ax, ay, bx, by = bx, by, ax, ay
            way = -1.0
        slope = (bx - ax) / (by - ay)
        x = ax
        if ay < 0.0:
            x -= ay * slope
            ay = 0.0
        for row in range(int(ay), min(height, math.ceil(by))):
            down = min(row + 1.0, by) - max(row * 1.0, ay)
            next_x = x + slope * down
            area = down * way
            low, high = min(x, next_x), max(x, next_x)
            x = next_x
            low, high = min(max(low, 0.0), width * 1.0), min(max(high, 0.0), width * 1.0)
            at = row * stride + int(low)
            column, end = int(low), math.ceil(high)
            if end <= column + 1:
                middle = 0.5 * (low + high) - column
                cells[at] += area - area * middle
                cells[at + 1] += area * middle
                continue
            step = 1.0 / (high - low)
            inside, beyond = low - column, high - end + 1.0
            begin = 0.5 * step * (1.0 - inside) * (1.0 - inside)
            finish = 0.5 * step * beyond * beyond
            cells[at] += area * begin
            last_cell = at + end - column
            if end == column + 2:
                cells[at + 1] += area * (1.0 - begin - finish)
            else:
                second = step * (1.5 - inside)
                cells[at + 1] += area * (second - begin)
                for k in range(at + 2, last_cell - 1):
                    cells[k] += area * step
                cells[last_cell - 1] += area * (1.0 - second - (end - column - 3) * step - finish)
            cells[last_cell] += area * finish


@inner_kernel
def blur(cells: Singles, spare: Singles, sums: Singles, width: int, height: int, reach: int, passes: int) -> None:
    """Blur cells (height, width) by boxes of 2 reach + 1, this many times; what lies outside counts as 0."""
    share = 1.0 / (2 * reach + 1)
    ahead, wide = reach, width
    for _ in range(passes):
        for y in range(height):
            begin = y * wide
            total = 0.0
            for x in range(min(ahead, wide)):
                total += cells[begin + x]
            for x in range(wide):
                enters = cells[begin + x + ahead] if x + ahead < wide else 0.0
                leaves = cells[begin + x - ahead - 1] if x > ahead else 0.0
                total += enters - leaves
                spare[begin + x] = total * share
        # Down the columns a whole row at a time, as memory lies.
        for x in range(wide):
            sums[x] = 0.0
        for y in range(min(reach, height)):
            for x in range(wide):
                sums[x] += spare[y * wide + x]
        for y in range(height):
            if y + ahead < height:
                for x in range(wide):
                    sums[x] += spare[(y + ahead) * wide + x]
            for x in range(wide):
                cells[y * wide + x] = sums[x] * share
            if y >= ahead:
                for x in range(wide):
                    sums[x] -= spare[(y - ahead) * wide + x]


class Loops(NamedTuple):
    """Closed loops of particles: slot (k,), start (c + 1,); rounds (c,): how often corners are cut (Chaikin).

    keep (c,): which part of a side a cut takes at each end. Each round doubles the points of an outline; point_start
    (c + 1,): where they begin.
    """

    slot: Slots
    start: Slots
    rounds: Slots
    keep: Floats
    point_start: Slots


@inner_kernel
def _grow(pixels: FloatRows, loops: Loops, c: int, grow: float, point: FloatRows) -> None:
    """Move the corners of a loop outwards along their normals."""
    first, last, out = loops.start[c], loops.start[c + 1], loops.point_start[c]
    area = 0.0
    for k in range(first, last):
        a, b = loops.slot[k], loops.slot[k + 1 if k + 1 < last else first]
        area += pixels[a, 0] * pixels[b, 1] - pixels[b, 0] * pixels[a, 1]
    by = grow if area > 0.0 else -grow
    for k in range(first, last):
        p = loops.slot[k - 1 if k > first else last - 1]
        q = loops.slot[k]
        r = loops.slot[k + 1 if k + 1 < last else first]
        dx, dy = pixels[r, 0] - pixels[p, 0], pixels[r, 1] - pixels[p, 1]
        length = math.sqrt(dx * dx + dy * dy) + 1e-12
        point[out + k - first, 0] = pixels[q, 0] + dy / length * by
        point[out + k - first, 1] = pixels[q, 1] - dx / length * by


@inner_kernel
def _cut_corners(point: FloatRows, first: int, count: int, keep: float, spare: FloatRows) -> None:
    """Two points in place of each of `count` from `first` on."""
    for k in range(count):
        spare[k, 0], spare[k, 1] = point[first + k, 0], point[first + k, 1]
    for k in range(count):
        j = k + 1 if k + 1 < count else 0
        for axis in range(2):
            a, b = spare[k, axis], spare[j, axis]
            point[first + 2 * k, axis] = a + (b - a) * keep
            point[first + 2 * k + 1, axis] = b + (a - b) * keep


@kernel
def trace_outlines(pixels: FloatRows, loops: Loops, grow: Floats, point: FloatRows, spare: FloatRows) -> None:
    """Write the outlines of loops of particles at pixels (n, 2), grown by grow (c,) [pixels], into point (k, 2)."""
    for c in range(loops.rounds.shape[0]):
        _grow(pixels, loops, c, grow[c], point)
        count = loops.start[c + 1] - loops.start[c]
        for _ in range(loops.rounds[c]):
            _cut_corners(point, loops.point_start[c], count, loops.keep[c], spare)
            count *= 2
