"""Cells: textured triangles, of cloth and of planks."""

import math
from typing import NamedTuple

from sandbox.app.draw.raster.pixels import FAR, Pixels, SlotTables, laid_over
from sandbox.physics.arrays import FloatRows, Floats, Slots
from sandbox.physics.jit import inner_kernel, kernel

# Texels of a sheet, a power of two.
SHEET = 64
# Texels and shades are counted in parts of this size.
BITS = 20
ONE = float(1 << BITS)


class CellArrays(NamedTuple):
    """Triangles: corner (t, 6) = x, y of each [pixels], texel (t, 6), shade (t, 3) -1..1, sheet (t,)."""

    corner: FloatRows
    texel: FloatRows
    shade: FloatRows
    sheet: Slots


@inner_kernel
def _find_slopes(cells: CellArrays, t: int, slopes: Floats) -> bool:
    """Write values at the origin and their slopes across and down, of texel and shade, in parts of ONE; whether any."""
    x0, y0, x1, y1 = cells.corner[t, 0], cells.corner[t, 1], cells.corner[t, 2], cells.corner[t, 3]
    x2, y2 = cells.corner[t, 4], cells.corner[t, 5]
    area = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0)
    if not (abs(x0) < FAR and abs(x1) < FAR and abs(x2) < FAR and abs(area) > 1e-6):
        return False
    if not (min(y0, y1, y2) > -FAR and max(y0, y1, y2) < FAR):
        return False
    for k in range(3):
        if k < 2:
            a, b, c = cells.texel[t, k], cells.texel[t, k + 2], cells.texel[t, k + 4]
        else:
            a, b, c = cells.shade[t, 0], cells.shade[t, 1], cells.shade[t, 2]
        across = ((b - a) * (y2 - y0) - (c - a) * (y1 - y0)) / area
        down = ((c - a) * (x1 - x0) - (b - a) * (x2 - x0)) / area
        slopes[3 * k] = (a - across * x0 - down * y0) * ONE
        slopes[3 * k + 1], slopes[3 * k + 2] = across * ONE, down * ONE
    return True


@inner_kernel
def _paint_span(pixels: Pixels, y: int, first: int, last: int, slopes: Floats, picture: SlotTables, sheet: int) -> None:
    """Some pixels of a row of a triangle."""
    px, py = first + 0.5, y + 0.5
    # In whole numbers, which wrap around as texels do.
    u = int(slopes[0] + slopes[1] * px + slopes[2] * py)
    v = int(slopes[3] + slopes[4] * px + slopes[5] * py)
    shade = int(slopes[6] + slopes[7] * px + slopes[8] * py)
    du, dv, by = int(slopes[1]), int(slopes[4]), int(slopes[7])
    for x in range(first, last):
        colour = int(picture[sheet, (v >> BITS) & (SHEET - 1), (u >> BITS) & (SHEET - 1)])
        share = min(max(shade >> (BITS - 8), -256), 256)
        over = 0xFFFFFF if share > 0 else 0
        pixels[y, x] = laid_over(colour, over, abs(share))
        u, v, shade = u + du, v + dv, shade + by


@kernel
def paint_cells(pixels: Pixels, cells: CellArrays, sheets: SlotTables, slopes: Floats, clip: Slots) -> None:
    """Draw triangles into pixels (h, w) with sheets (s, SHEET, SHEET) 0xRRGGBB; neighbours share no pixel.

    slopes (9,): scratch of a triangle.
    """
    for t in range(cells.sheet.shape[0]):
        if not _find_slopes(cells, t, slopes):
            continue
        corner = cells.corner
        low, high = min(corner[t, 1], corner[t, 3], corner[t, 5]), max(corner[t, 1], corner[t, 3], corner[t, 5])
        for y in range(max(clip[1], math.ceil(low - 0.5)), min(clip[3], math.ceil(high - 0.5))):
            py = y + 0.5
            first, last = FAR, -FAR
            for k in range(3):
                j = (k + 1) % 3
                ay, by = corner[t, 2 * k + 1], corner[t, 2 * j + 1]
                if (ay <= py) != (by <= py):
                    ax, bx = corner[t, 2 * k], corner[t, 2 * j]
                    x = ax + (py - ay) * (bx - ax) / (by - ay)
                    first, last = min(first, x), max(last, x)
            begin, end = max(clip[0], math.ceil(first - 0.5)), min(clip[2], math.ceil(last - 0.5))
            if begin < end:
                _paint_span(pixels, y, begin, end, slopes, sheets, cells.sheet[t])
