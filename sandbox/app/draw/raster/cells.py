"""Cells: textured triangles, of cloth and of planks."""

import math
from typing import NamedTuple

from sandbox.app.draw.raster.pixels import FAR, Floats, Slots
from sandbox.physics.jit import kernel

# Texels of a sheet, a power of two.
SHEET = 64


class CellArrays(NamedTuple):
    """Triangles: corner (t, 6) = x, y of each [pixels], texel (t, 6), shade (t, 3) -1..1, sheet (t,)."""

    corner: Floats
    texel: Floats
    shade: Floats
    sheet: Slots


@kernel
def paint_cells(pixels, cells, sheets, clip):  # type: ignore[no-untyped-def]
    """Draw triangles into pixels (h, w) with sheets (s, SHEET, SHEET) 0xRRGGBB; neighbours share no pixel."""
    for t in range(cells.sheet.shape[0]):
        x0, y0, x1, y1 = cells.corner[t, 0], cells.corner[t, 1], cells.corner[t, 2], cells.corner[t, 3]
        x2, y2 = cells.corner[t, 4], cells.corner[t, 5]
        area = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0)
        if not (abs(x0) < FAR and abs(x1) < FAR and abs(x2) < FAR and abs(area) > 1e-6):
            continue
        low, high = min(y0, y1, y2), max(y0, y1, y2)
        if not (low > -FAR and high < FAR):
            continue
        sheet = cells.sheet[t]
        for y in range(max(clip[1], math.ceil(low - 0.5)), min(clip[3], math.ceil(high - 0.5))):
            py = y + 0.5
            first, last = FAR, -FAR
            for k in range(3):
                j = (k + 1) % 3
                ay, by = cells.corner[t, 2 * k + 1], cells.corner[t, 2 * j + 1]
                if (ay <= py) != (by <= py):
                    ax, bx = cells.corner[t, 2 * k], cells.corner[t, 2 * j]
                    x = ax + (py - ay) * (bx - ax) / (by - ay)
                    first, last = min(first, x), max(last, x)
            for x in range(max(clip[0], math.ceil(first - 0.5)), min(clip[2], math.ceil(last - 0.5))):
                px = x + 0.5
                w1 = ((px - x0) * (y2 - y0) - (x2 - x0) * (py - y0)) / area
                w2 = ((x1 - x0) * (py - y0) - (px - x0) * (y1 - y0)) / area
                w0 = 1.0 - w1 - w2
                u = int(w0 * cells.texel[t, 0] + w1 * cells.texel[t, 2] + w2 * cells.texel[t, 4] + 65536.0)
                v = int(w0 * cells.texel[t, 1] + w1 * cells.texel[t, 3] + w2 * cells.texel[t, 5] + 65536.0)
                colour = int(sheets[sheet, v & (SHEET - 1), u & (SHEET - 1)])
                shade = w0 * cells.shade[t, 0] + w1 * cells.shade[t, 1] + w2 * cells.shade[t, 2]
                shaded = 0
                for shift in range(0, 24, 8):
                    channel = (colour >> shift) & 255
                    rest = 255 - channel if shade > 0.0 else channel
                    shaded |= min(max(int(channel + rest * shade), 0), 255) << shift
                pixels[y, x] = 0xFF000000 | shaded
