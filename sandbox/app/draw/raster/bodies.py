"""Lit bodies: an outline is filled, and light falls on the slope of a skin that bulges inside it.

Coverage of the outline, blurred at half the size, is how high the skin stands; its gradient says how it is lit. A table
of how far inside and how lit gives the colour. All bodies of a layer are drawn in one call, each with its line.
"""

import math
from typing import NamedTuple

from sandbox.app.draw.raster.mark_kernels import from_segment, row_of_capsule
from sandbox.app.draw.raster.pixels import (
    PixelRow,
    Pixels,
    Sheets,
    Singles,
    SlotTables,
    add_outline,
    blur,
    clear,
    find_box,
    laid_over,
)
from sandbox.physics.arrays import FloatRows, Floats, Int32s, SlotRows, Slots
from sandbox.physics.jit import inner_kernel, kernel

# Rows and columns of a table of colours: how far inside, how lit.
INSIDE, LIT = 64, 256
# Texels of a grain, a power of two.
GRAIN = 256
# Pixels of a cell of the flush, and how fully it covers at most, of 256.
FLUSH_CELL = 8
FLUSH_FULL = 190.0
# Coverage that is not seen.
FAINT = 0.004
# Widest that a skin is rounded [pixels].
WIDEST = 80.0
# Of that, how far the skin is blurred, a box's reach in cells of two pixels.
SOFTNESS = 0.85


class Outlines(NamedTuple):
    """Closed outlines: point (k, 2) [pixels], start (c + 1,): where each begins."""

    point: FloatRows
    start: Slots


class BodyRows(NamedTuple):
    """One row a body.

    loops (b, 2): first outline and one past the last. look (b, 3): table, grain or -1, colour of the line. size (b, 3):
    rounding and half width of the line [pixels], its alpha. flush (b, 2): first splat and one past the last.
    """

    loops: SlotRows
    look: SlotRows
    size: FloatRows
    flush: SlotRows


class Flush(NamedTuple):
    """Splats of strain: at (k, 4) = x, y, reach [pixels], amount -1..1; colours (2,) 0xRRGGBB squeezed, stretched."""

    at: FloatRows
    colours: Slots


class Skins(NamedTuple):
    """Tables (t, INSIDE, LIT) 0xAARRGGBB, grains (g, GRAIN, GRAIN), what is added to each channel."""

    tables: Sheets
    grains: SlotTables


class BodyScratch(NamedTuple):
    """Cells for one body at a time, as many as the largest needs; middle .. tone: of one row of it; box (4,)."""

    cover: Singles
    high: Singles
    spare: Singles
    sums: Singles
    field: Singles
    weight: Singles
    middle: Singles
    fall: Singles
    texel: Int32s
    amount: Int32s
    tone: PixelRow
    box: Floats


@inner_kernel
def _raise_skin(scratch: BodyScratch, width: int, height: int, wide: int, tall: int, edge: int) -> None:
    """Coverage from areas, and from it a quarter as many cells of the skin, inside an empty edge of this many cells."""
    cover, high = scratch.cover, scratch.high
    stride = width + 2
    for y in range(height):
        total = 0.0
        for k in range(y * stride, y * stride + width):
            total += cover[k]
            cover[k] = min(abs(total), 1.0)
    across = wide + 2 * edge
    clear(high, across * (tall + 2 * edge))
    for y in range(height // 2):
        for x in range(width // 2):
            k = 2 * y * stride + 2 * x
            high[(y + edge) * across + edge + x] = 0.25 * (
                cover[k] + cover[k + 1] + cover[k + stride] + cover[k + stride + 1]
            )


@inner_kernel
def _splat(
    flush: Flush, first: int, last: int, scratch: BodyScratch, wide: int, tall: int, x0: float, y0: float
) -> None:
    """Find the flush of one body in cells of FLUSH_CELL pixels, -FLUSH_FULL..FLUSH_FULL."""
    field, weight = scratch.field, scratch.weight
    for k in range(wide * tall):
        field[k], weight[k] = 0.0, 0.25
    for s in range(first, last):
        x, y = (flush.at[s, 0] - x0) / FLUSH_CELL, (flush.at[s, 1] - y0) / FLUSH_CELL
        reach = max(1.0, flush.at[s, 2] / FLUSH_CELL)
        if not (-reach < x < wide + reach and -reach < y < tall + reach):
            continue
        for row in range(max(0, int(y - 2.0 * reach)), min(tall, int(y + 2.0 * reach) + 2)):
            for column in range(max(0, int(x - 2.0 * reach)), min(wide, int(x + 2.0 * reach) + 2)):
                dx, dy = column - x, row - y
                out = (dx * dx + dy * dy) / (reach * reach)
                if out < 4.0:
                    fall = 1.0 - 0.25 * out
                    field[row * wide + column] += fall * fall * flush.at[s, 3]
                    weight[row * wide + column] += fall * fall
    for k in range(wide * tall):
        field[k] = min(max(field[k] / weight[k], -1.0), 1.0) * FLUSH_FULL


@inner_kernel
def _grainy(colour: int, amount: int) -> int:
    red = min(max(((colour >> 16) & 255) + amount, 0), 255)
    green = min(max(((colour >> 8) & 255) + amount, 0), 255)
    blue = min(max((colour & 255) + amount, 0), 255)
    return (colour & 0xFF000000) | (red << 16) | (green << 8) | blue


@inner_kernel
def _find_texels(row: int, first: int, last: int, scratch: BodyScratch, place: Slots) -> None:
    """Find the place in the table of the colour of each pixel of a run; place: see _light_row."""
    high, middle, fall, texel = scratch.high, scratch.middle, scratch.fall, scratch.texel
    tall, reach, edge = place[4], place[5], place[9]
    gain = 1.3 * reach * 256.0 / 3.0
    across, down = 0.42 * gain, 0.9 * gain
    half_y = 0.5 * row + 0.25
    iy = min(max(int(half_y - 0.5), 0), tall - 2)
    fy = min(max(half_y - 0.5 - iy, 0.0), 1.0)
    stride = place[3] + 2 * edge
    above = (iy + edge) * stride + edge
    below = above + stride
    begin, end = max(first - 1, 0) // 2, min(last // 2 + 1, place[3] - 1)
    for k in range(begin, end + 1):
        fall[k] = high[below + k] - high[above + k]
        middle[k] = high[above + k] + fall[k] * fy
    # Two pixels lie between the middles of two cells.
    for k in range(begin, end):
        slope, bend = middle[k + 1] - middle[k], fall[k + 1] - fall[k]
        light, inside = slope * across + fall[k] * down + 128.0, (middle[k] - 0.45) * 120.0
        for half in range(2):
            part = 0.25 + 0.5 * half
            lit = min(max(int(light + bend * part * down), 0), LIT - 1)
            texel[2 * k + 1 + half] = min(max(int(inside + slope * part * 120.0), 0), INSIDE - 1) * LIT + lit
    if first == 0:
        texel[0] = texel[1]


@inner_kernel
def _find_amounts(row: int, scratch: BodyScratch, place: Slots) -> None:
    """Find the flush's opacity over each pixel of a row, of 256; below 0 where the body is squeezed."""
    field, amount, wide = scratch.field, scratch.amount, place[6]
    jy = min(row // FLUSH_CELL, place[7] - 2)
    part = row / FLUSH_CELL - jy
    above, below = jy * wide, (jy + 1) * wide
    for j in range(min(place[2] // FLUSH_CELL + 1, wide - 1)):
        begin = field[above + j] + (field[below + j] - field[above + j]) * part
        end = field[above + j + 1] + (field[below + j + 1] - field[above + j + 1]) * part
        step = (end - begin) / FLUSH_CELL
        for x in range(FLUSH_CELL):
            amount[j * FLUSH_CELL + x] = int(begin + step * x)


@inner_kernel
def _lay_flush(tone: PixelRow, amount: Int32s, first: int, last: int, squeezed: int, stretched: int) -> None:
    for x in range(first, last):
        share, colour = int(amount[x]), int(tone[x])
        over = stretched if share > 0 else squeezed
        by = abs(share) if abs(share) > 2 else 0
        tone[x] = (laid_over(colour, over, by) & 0xFFFFFF) | (colour & 0xFF000000)


@inner_kernel
def _light_run(
    pixels: Pixels,
    y: int,
    first: int,
    last: int,
    rows: BodyRows,
    b: int,
    skins: Skins,
    flush: Flush,
    scratch: BodyScratch,
    place: Slots,
) -> None:
    """Pixels of a row of a body that lie side by side."""
    cover, tone, texel = scratch.cover, scratch.tone, scratch.texel
    table, grain, left = rows.look[b, 0], rows.look[b, 1], place[0]
    _find_texels(y - place[1], first, last, scratch, place)
    for x in range(first, last):
        k = texel[x]
        tone[x] = skins.tables[table, k // LIT, k % LIT]
    if place[8] != 0:
        _lay_flush(tone, scratch.amount, first, last, flush.colours[0], flush.colours[1])
    if grain >= 0:
        for x in range(first, last):
            tone[x] = _grainy(int(tone[x]), skins.grains[grain, y & (GRAIN - 1), (left + x) & (GRAIN - 1)])
    row, start, at = y, left + first, (y - place[1]) * (place[2] + 2) + first
    for x in range(last - first):
        colour = int(tone[first + x])
        share = int(cover[at + x] * (colour >> 24) * 1.004)
        pixels[row, start + x] = laid_over(int(pixels[row, start + x]), colour, share)


@inner_kernel
def _light_row(
    pixels: Pixels,
    y: int,
    rows: BodyRows,
    b: int,
    skins: Skins,
    flush: Flush,
    scratch: BodyScratch,
    place: Slots,
    clip: Slots,
) -> None:
    """One row of pixels of a body. place: left, top, width, wide, tall, reach, wide and tall of the flush, 0, edge."""
    cover, left, width = scratch.cover, place[0], place[2]
    begin = (y - place[1]) * (width + 2)
    x, last = max(clip[0], left) - left, min(clip[2], left + width) - left
    if place[8] != 0 and x < last:
        _find_amounts(y - place[1], scratch, place)
    while x < last:
        while x < last and cover[begin + x] <= FAINT:
            x += 1
        first = x
        while x < last and cover[begin + x] > FAINT:
            x += 1
        if first < x:
            _light_run(pixels, y, first, x, rows, b, skins, flush, scratch, place)


@inner_kernel
def _paint_side(
    pixels: Pixels,
    ox: float,
    oy: float,
    ax: float,
    ay: float,
    bx: float,
    by: float,
    half: float,
    colour: int,
    alpha: float,
    clip: Slots,
) -> None:
    """Draw a side of a closed line from a to b, the one before it from o to a; no pixel is covered by both.

    What lies beyond b is the next side's, what lies beside the one before is that one's, and what lies between both,
    round the corner a, is this one's: sides laid over each other would look like beads.
    """
    reach = half + 0.5
    dx, dy, ex, ey = bx - ax, by - ay, ax - ox, ay - oy
    length, back = math.sqrt(dx * dx + dy * dy), math.sqrt(ex * ex + ey * ey)
    ux, uy = (dx / length, dy / length) if length > 1e-9 else (1.0, 0.0)
    vx, vy = (ex / back, ey / back) if back > 1e-9 else (ux, uy)
    for y in range(max(clip[1], int(max(min(ay, by) - reach, -1.0))), min(clip[3], int(max(ay, by) + reach) + 2)):
        py = y + 0.5 - ay
        low, high = row_of_capsule(py, ax, bx, ux, uy, reach)
        for x in range(max(clip[0], int(max(low, 0.0))), min(clip[2], int(max(high, -1.0)) + 2)):
            px = x + 0.5 - ax
            along, behind = px * ux + py * uy, -(px * vx + py * vy)
            if along >= length or (behind > 0.0 and (along < 0.0 or behind < back)):
                continue
            cover = reach - from_segment(along, py * ux - px * uy, length)
            if cover > 0.0:
                pixels[y, x] = laid_over(int(pixels[y, x]), colour, int(min(cover, 1.0) * alpha * 256.0))


@inner_kernel
def _paint_lines(pixels: Pixels, outlines: Outlines, rows: BodyRows, b: int, clip: Slots) -> None:
    point = outlines.point
    for loop in range(rows.loops[b, 0], rows.loops[b, 1]):
        first, last = outlines.start[loop], outlines.start[loop + 1]
        for i in range(first, last):
            j, o = i + 1 if i + 1 < last else first, i - 1 if i > first else last - 1
            _paint_side(
                pixels, point[o, 0], point[o, 1], point[i, 0], point[i, 1], point[j, 0], point[j, 1],
                rows.size[b, 1], rows.look[b, 2], rows.size[b, 2], clip,
            )  # fmt: skip


@kernel
def paint_bodies(
    pixels: Pixels,
    outlines: Outlines,
    rows: BodyRows,
    skins: Skins,
    flush: Flush,
    scratch: BodyScratch,
    place: Slots,
    clip: Slots,
) -> None:
    """Draw bodies into pixels (h, w), one after the other, inside clip (4,); place (10,): scratch of a row."""
    for b in range(rows.loops.shape[0]):
        first, last = rows.loops[b, 0], rows.loops[b, 1]
        box = scratch.box
        if not find_box(outlines.point, outlines.start[first], outlines.start[last], box):
            continue
        rounding = min(rows.size[b, 0], WIDEST)
        # What lies outside the view by less than the skin is rounded counts for the light inside.
        pad = int(rounding) + 4
        left, top = max(int(box[0]) - 2, clip[0] - pad), max(int(box[1]) - 2, clip[1] - pad)
        width = min(int(box[2]) + 3, clip[2] + pad) - left
        height = min(int(box[3]) + 3, clip[3] + pad) - top
        if width <= 2 or height <= 2:
            continue
        clear(scratch.cover, (width + 2) * height)
        for loop in range(first, last):
            add_outline(
                scratch.cover, width, height, outlines.point,
                outlines.start[loop], outlines.start[loop + 1], left * 1.0, top * 1.0, 1.0,
            )  # fmt: skip
        wide, tall = (width + 1) // 2 + 2, (height + 1) // 2 + 2
        reach = max(1, int(rounding * 0.5))
        # Blurred once, the skin reaches so far beyond its box: the second time must find it, or the light has a step.
        edge = max(1, int(reach * SOFTNESS))
        _raise_skin(scratch, width, height, wide, tall, edge)
        blur(scratch.high, scratch.spare, scratch.sums, wide + 2 * edge, tall + 2 * edge, edge, 3)
        place[9] = edge
        place[0], place[1], place[2], place[3], place[4], place[5] = left, top, width, wide, tall, reach
        place[6], place[7], place[8] = width // FLUSH_CELL + 3, height // FLUSH_CELL + 3, 0
        if rows.flush[b, 0] < rows.flush[b, 1]:
            place[8] = 1
            _splat(flush, rows.flush[b, 0], rows.flush[b, 1], scratch, place[6], place[7], left * 1.0, top * 1.0)
        for y in range(max(clip[1], top), min(clip[3], top + height)):
            _light_row(pixels, y, rows, b, skins, flush, scratch, place, clip)
        if rows.size[b, 2] > 0.0:
            _paint_lines(pixels, outlines, rows, b, clip)
