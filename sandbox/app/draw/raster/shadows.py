"""Shadows: everything that moves, thrown on the stage behind it, blurred at a quarter of the size."""

import math
from typing import NamedTuple

from sandbox.app.draw.raster.coverage import add_outline, blur, clear, find_box
from sandbox.app.draw.raster.pixels import FAR, Floats, Singles, laid_over
from sandbox.physics.jit import inner_kernel, kernel

# Pixels of the screen to one of the shadow, each way.
FACTOR = 4


class ShadowScratch(NamedTuple):
    """Cells of the shadow: mask, cover, spare as many as it has, sums as many as a row; box (4,)."""

    mask: Singles
    cover: Singles
    spare: Singles
    sums: Singles
    box: Floats


class Thrown(NamedTuple):
    """What throws it: lines (m, 5) = both ends and half width; discs (k, 3) = centre and radius, all [pixels]."""

    lines: Floats
    discs: Floats


@inner_kernel
def _add_outline(scratch, outlines, loop, wide, tall, x0, y0):  # type: ignore[no-untyped-def]
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
def _add_lines(mask, lines, wide, tall, x0, y0):  # type: ignore[no-untyped-def]
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
def _add_discs(mask, discs, wide, tall, x0, y0):  # type: ignore[no-untyped-def]
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


@kernel
def paint_shadows(pixels, outlines, thrown, scratch, offset, colour, strength, clip):  # type: ignore[no-untyped-def]
    """Lay shadows over pixels (h, w), offset (2,) [pixels] from what throws them, inside clip (4,)."""
    wide = (clip[2] - clip[0]) // FACTOR + 3
    tall = (clip[3] - clip[1]) // FACTOR + 3
    mask = scratch.mask
    clear(mask, wide * tall)
    # The mask begins a cell before the view.
    x0, y0 = clip[0] - FACTOR - offset[0], clip[1] - FACTOR - offset[1]
    for loop in range(outlines.start.shape[0] - 1):
        _add_outline(scratch, outlines, loop, wide, tall, x0, y0)
    _add_lines(mask, thrown.lines, wide, tall, x0, y0)
    _add_discs(mask, thrown.discs, wide, tall, x0, y0)
    blur(mask, scratch.spare, scratch.sums, wide, tall, 2, 2)
    for row in range(tall - 1):
        for column in range(wide - 1):
            k = row * wide + column
            a, b, c, d = mask[k], mask[k + 1], mask[k + wide], mask[k + wide + 1]
            if a + b + c + d < 0.02:
                continue
            left, top = clip[0] + (column - 1) * FACTOR + FACTOR // 2, clip[1] + (row - 1) * FACTOR + FACTOR // 2
            for y in range(max(clip[1], top), min(clip[3], top + FACTOR)):
                down = (y - top + 0.5) / FACTOR
                start, stop = a + (c - a) * down, b + (d - b) * down
                for x in range(max(clip[0], left), min(clip[2], left + FACTOR)):
                    dark = start + (stop - start) * (x - left + 0.5) / FACTOR
                    pixels[y, x] = laid_over(int(pixels[y, x]), colour, int(dark * strength * 256.0))
