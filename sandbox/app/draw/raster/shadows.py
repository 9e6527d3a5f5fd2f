"""Shadows: everything that moves, thrown on the stage behind it, blurred at a quarter of the size."""

import math
from typing import NamedTuple

from sandbox.app.draw.raster.bodies import Outlines
from sandbox.app.draw.raster.pixels import FAR, Pixels, Singles, add_outline, blur, clear, find_box, laid_over
from sandbox.physics.arrays import FloatRows, Floats, Int32s, Slots
from sandbox.physics.jit import inner_kernel, kernel

# Pixels of the screen to one of the shadow, each way.
FACTOR = 4
# How shadows are blurred: cells each way, how often; and how many cells beyond what throws it a shadow ends.
REACH, PASSES = 2, 2
MARGIN = REACH * PASSES + 1


class ShadowScratch(NamedTuple):
    """Cells of the shadow: mask, cover, spare: as many as it has; sums, dark: of one row, of its pixels; box (4,)."""

    mask: Singles
    cover: Singles
    spare: Singles
    sums: Singles
    dark: Int32s
    box: Floats


class Thrown(NamedTuple):
    """Shapes that throw shadows: lines (m, 5) = both ends and half width; discs (k, 3) = centre and radius [pixels]."""

    lines: FloatRows
    discs: FloatRows


@inner_kernel
def _add_outline(
    scratch: ShadowScratch, outlines: Outlines, loop: int, wide: int, tall: int, x0: float, y0: float
) -> None:
    first, last = outlines.start[loop], outlines.start[loop + 1]
    if not find_box(outlines.point, first, last, scratch.box):
        return
    scale = 1.0 / FACTOR
    left, top = max(0, int((scratch.box[0] - x0) * scale)), max(0, int((scratch.box[1] - y0) * scale))
    width = min(wide, int((scratch.box[2] - x0) * scale) + 2) - left
    height = min(tall, int((scratch.box[3] - y0) * scale) + 2) - top
    if width <= 0 or height <= 0:
        return
    clear(scratch.cover, (width + 2) * height)
    add_outline(scratch.cover, width, height, outlines.point, first, last, x0 + left * FACTOR, y0 + top * FACTOR, scale)
    for row in range(height):
        total = 0.0
        for column in range(width):
            total += scratch.cover[row * (width + 2) + column]
            at = (top + row) * wide + left + column
            scratch.mask[at] = max(scratch.mask[at], min(abs(total), 1.0))


@inner_kernel
def _add_lines(mask: Singles, lines: FloatRows, wide: int, tall: int, x0: float, y0: float) -> None:
    scale = 1.0 / FACTOR
    for m in range(lines.shape[0]):
        ax, ay = (lines[m, 0] - x0) * scale, (lines[m, 1] - y0) * scale
        bx, by = (lines[m, 2] - x0) * scale, (lines[m, 3] - y0) * scale
        if not (abs(ax) < FAR and abs(ay) < FAR and abs(bx) < FAR and abs(by) < FAR):
            continue
        if max(ax, bx) < 0.0 or min(ax, bx) >= wide or max(ay, by) < 0.0 or min(ay, by) >= tall:
            continue
        dark = min(0.9, 2.0 * lines[m, 4] * scale)
        steps = min(int((abs(bx - ax) + abs(by - ay)) * 1.2) + 1, 4096)
        for k in range(steps + 1):
            x, y = int(ax + (bx - ax) * k / steps), int(ay + (by - ay) * k / steps)
            if 0 <= x < wide and 0 <= y < tall:
                mask[y * wide + x] = max(mask[y * wide + x], dark)


@inner_kernel
def _add_discs(mask: Singles, discs: FloatRows, wide: int, tall: int, x0: float, y0: float) -> None:
    scale = 1.0 / FACTOR
    for k in range(discs.shape[0]):
        cx, cy, radius = (discs[k, 0] - x0) * scale, (discs[k, 1] - y0) * scale, discs[k, 2] * scale
        if not (abs(cx) < FAR and abs(cy) < FAR and radius < FAR):
            continue
        for y in range(max(0, int(max(cy - radius - 1.0, 0.0))), min(tall, int(max(cy + radius, -2.0)) + 2)):
            dy = y + 0.5 - cy
            for x in range(max(0, int(max(cx - radius - 1.0, 0.0))), min(wide, int(max(cx + radius, -2.0)) + 2)):
                dx = x + 0.5 - cx
                cover = min(radius + 0.5 - math.sqrt(dx * dx + dy * dy), 1.0)
                if cover > 0.0:
                    mask[y * wide + x] = max(mask[y * wide + x], cover)


@inner_kernel
def _widen(box: Floats, x: float, y: float, by: float) -> None:
    if abs(x) < FAR and abs(y) < FAR and by < FAR:
        box[0], box[2] = min(box[0], x - by), max(box[2], x + by)
        box[1], box[3] = min(box[1], y - by), max(box[3], y + by)


@inner_kernel
def _find_reach(outlines: Outlines, thrown: Thrown, box: Floats) -> None:
    """Write the box (4,) [pixels] around all that throws shadows."""
    box[0], box[1], box[2], box[3] = FAR, FAR, -FAR, -FAR
    for k in range(outlines.point.shape[0]):
        _widen(box, outlines.point[k, 0], outlines.point[k, 1], 0.0)
    for m in range(thrown.lines.shape[0]):
        _widen(box, thrown.lines[m, 0], thrown.lines[m, 1], 0.0)
        _widen(box, thrown.lines[m, 2], thrown.lines[m, 3], 0.0)
    for k in range(thrown.discs.shape[0]):
        _widen(box, thrown.discs[k, 0], thrown.discs[k, 1], thrown.discs[k, 2])


@inner_kernel
def _lay_row(
    pixels: Pixels,
    y: int,
    scratch: ShadowScratch,
    wide: int,
    at: int,
    down: float,
    left: int,
    colour: int,
    full: float,
    clip: Slots,
) -> None:
    """Darken a row of pixels between two rows of cells, `down` (0..1) below the one that begins at `at`."""
    mask, sums, dark = scratch.mask, scratch.sums, scratch.dark
    above, below, count = at, at + wide, wide
    most = 0.0
    for k in range(count):
        sums[k] = (mask[above + k] + (mask[below + k] - mask[above + k]) * down) * full
        most = max(most, sums[k])
    if most < 1.0:
        return
    for k in range(count - 1):
        step, first = (sums[k + 1] - sums[k]) / FACTOR, FACTOR * k
        for x in range(FACTOR):
            dark[first + x] = int(sums[k] + step * (x + 0.5))
    first, last = max(clip[0], left), min(clip[2], left + FACTOR * (wide - 1))
    while first < last and dark[first - left] == 0:
        first += 1
    while first < last and dark[last - left - 1] == 0:
        last -= 1
    if first >= last:
        return
    row, begin, shift = y, first, first - left
    for x in range(last - first):
        under, share = pixels[row, begin + x], dark[shift + x]
        pixels[row, begin + x] = laid_over(int(under), colour, int(share))


@kernel
def paint_shadows(
    pixels: Pixels,
    outlines: Outlines,
    thrown: Thrown,
    scratch: ShadowScratch,
    offset: Floats,
    colour: int,
    strength: float,
    clip: Slots,
) -> None:
    """Lay shadows over pixels (h, w), offset (2,) [pixels] from what throws them, inside clip (4,)."""
    mask, box = scratch.mask, scratch.box
    # Cells of the view begin one before it; of them only those count that a shadow reaches.
    x0, y0 = clip[0] - FACTOR - offset[0], clip[1] - FACTOR - offset[1]
    _find_reach(outlines, thrown, box)
    if box[0] > box[2]:
        return
    first = max(0, int(max(box[0] - x0, 0.0) / FACTOR) - MARGIN)
    top = max(0, int(max(box[1] - y0, 0.0) / FACTOR) - MARGIN)
    wide = min((clip[2] - clip[0]) // FACTOR + 3, int(max(box[2] - x0, 0.0) / FACTOR) + MARGIN + 2) - first
    tall = min((clip[3] - clip[1]) // FACTOR + 3, int(max(box[3] - y0, 0.0) / FACTOR) + MARGIN + 2) - top
    if wide < 2 or tall < 2:
        return
    x0, y0 = x0 + first * FACTOR, y0 + top * FACTOR
    clear(mask, wide * tall)
    for loop in range(outlines.start.shape[0] - 1):
        _add_outline(scratch, outlines, loop, wide, tall, x0, y0)
    _add_lines(mask, thrown.lines, wide, tall, x0, y0)
    _add_discs(mask, thrown.discs, wide, tall, x0, y0)
    blur(mask, scratch.spare, scratch.sums, wide, tall, REACH, PASSES)
    # Between the middles of cells.
    left = clip[0] + (first - 1) * FACTOR + FACTOR // 2
    for row in range(tall - 1):
        above = clip[1] + (top + row - 1) * FACTOR + FACTOR // 2
        for y in range(max(clip[1], above), min(clip[3], above + FACTOR)):
            down = (y - above + 0.5) / FACTOR
            _lay_row(pixels, y, scratch, wide, row * wide, down, left, colour, strength * 256.0, clip)
