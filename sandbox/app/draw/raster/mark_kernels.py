"""Marks of a layer, drawn in one call: strokes, strips, hairs, discs, glows and balls; and textured triangles."""

import math
from typing import NamedTuple

from sandbox.app.draw.raster.pixels import FAR, Pixels, Sheets, SlotTables, laid_over
from sandbox.physics.arrays import FloatRows, Floats, Slots
from sandbox.physics.jit import inner_kernel, kernel

STROKE, STRIP, HAIR, DISC, GLOW, STRIPED, MARBLED, STUDDED, PLAIN = range(9)
# Texels of the tile of a strip, across and along; both powers of two.
ACROSS, ALONG = 16, 32
# Strips of less than this half width [pixels] have one colour: their tile would not be seen.
THIN = 1.0


class MarkArrays(NamedTuple):
    """MarkList to draw, one row each.

    ends (m, 4) [pixels]: both ends of a stroke, strip or hair; of the others centre, and a ball's turn, as cosine and
    sine. half (m,): half width or radius [pixels]. colour (m,) 0xRRGGBB: of a strip, what tints it. alpha (m,) 0..1:
    of a strip, by how much. along (m, 2): of a strip, texture periods at the ends. extra (m,): tile of a strip,
    colour of a ball's mark. kind (m,).
    """

    ends: FloatRows
    half: Floats
    colour: Slots
    alpha: Floats
    along: FloatRows
    extra: Slots
    kind: Slots


@inner_kernel
def row_of_capsule(py: float, ax: float, bx: float, ux: float, uy: float, reach: float) -> tuple[float, float]:
    # From where to where a row of pixels, py below the first end, is in reach of a segment in direction u.
    low, high = min(ax, bx) - reach, max(ax, bx) + reach
    if abs(uy) > 1e-9:
        first, last = ax + (py * ux - reach) / uy, ax + (py * ux + reach) / uy
        low, high = max(low, min(first, last)), min(high, max(first, last))
    return low, high


@inner_kernel
def from_segment(along: float, across: float, length: float) -> float:
    # The distance of a place from a segment that begins at the origin.
    beyond = max(-along, along - length)
    return math.sqrt(beyond * beyond + across * across) if beyond > 0.0 else abs(across)


@inner_kernel
def paint_segment(
    pixels: Pixels, ax: float, ay: float, bx: float, by: float, half: float, colour: int, alpha: float, clip: Slots
) -> None:
    """Draw a capsule: a pixel centre at distance d from the segment is covered by clamp(half + 1/2 - d, 0, 1)."""
    reach = half + 0.5
    dx, dy = bx - ax, by - ay
    length = math.sqrt(dx * dx + dy * dy)
    ux, uy = (dx / length, dy / length) if length > 1e-9 else (1.0, 0.0)
    for y in range(max(clip[1], int(max(min(ay, by) - reach, -1.0))), min(clip[3], int(max(ay, by) + reach) + 2)):
        py = y + 0.5 - ay
        low, high = row_of_capsule(py, ax, bx, ux, uy, reach)
        for x in range(max(clip[0], int(max(low, 0.0))), min(clip[2], int(max(high, -1.0)) + 2)):
            px = x + 0.5 - ax
            along = px * ux + py * uy
            across = py * ux - px * uy
            cover = reach - from_segment(along, across, length)
            if cover > 0.0:
                pixels[y, x] = laid_over(int(pixels[y, x]), colour, int(min(cover, 1.0) * alpha * 256.0))


@inner_kernel
def _paint_strip(pixels: Pixels, marks: MarkArrays, m: int, tiles: Sheets, clip: Slots) -> None:
    # Light falls on the same side of all: what is above, or left.
    ax, ay, bx, by = marks.ends[m, 0], marks.ends[m, 1], marks.ends[m, 2], marks.ends[m, 3]
    half, tile = marks.half[m], marks.extra[m]
    dx, dy = bx - ax, by - ay
    length = math.sqrt(dx * dx + dy * dy)
    if length < 1e-6:
        return
    reach = half + 0.5
    ux, uy = dx / length, dy / length
    side = (-1.0 if (ux < 0.0 or (ux == 0.0 and uy > 0.0)) else 1.0) / (half + 0.25)
    start, rate = marks.along[m, 0], (marks.along[m, 1] - marks.along[m, 0]) / length
    tint, share = marks.colour[m], int(marks.alpha[m] * 256.0)
    for y in range(max(clip[1], int(max(min(ay, by) - reach, -1.0))), min(clip[3], int(max(ay, by) + reach) + 2)):
        py = y + 0.5 - ay
        low, high = row_of_capsule(py, ax, bx, ux, uy, reach)
        for x in range(max(clip[0], int(max(low, 0.0))), min(clip[2], int(max(high, -1.0)) + 2)):
            px = x + 0.5 - ax
            along = px * ux + py * uy
            across = py * ux - px * uy
            cover = reach - from_segment(along, across, length)
            if cover <= 0.0:
                continue
            row = min(max(int((across * side + 1.0) * 8.0), 0), ACROSS - 1)
            place = start + along * rate
            column = int((place - math.floor(place)) * ALONG) & (ALONG - 1)
            texel = int(tiles[tile, row, column])
            shown = int((texel >> 24) * min(cover, 1.0) * 1.004)
            if shown <= 0:
                continue
            if share > 0:
                texel = laid_over(texel, tint, share)
            pixels[y, x] = laid_over(int(pixels[y, x]), texel, shown)


@inner_kernel
def _paint_hair(pixels: Pixels, ax: float, ay: float, bx: float, by: float, colour: int, clip: Slots) -> None:
    """Draw a line one pixel wide, a pixel for each step along its longer side."""
    if max(ax, bx) < clip[0] or min(ax, bx) >= clip[2] or max(ay, by) < clip[1] or min(ay, by) >= clip[3]:
        return
    steps = int(max(abs(bx - ax), abs(by - ay))) + 1
    for i in range(steps + 1):
        x, y = math.floor(ax + (bx - ax) * i / steps), math.floor(ay + (by - ay) * i / steps)
        if clip[0] <= x < clip[2] and clip[1] <= y < clip[3]:
            pixels[y, x] = 0xFF000000 | colour


@inner_kernel
def _paint_disc(pixels: Pixels, marks: MarkArrays, m: int, clip: Slots) -> None:
    cx, cy, radius = marks.ends[m, 0], marks.ends[m, 1], marks.half[m]
    colour, alpha, is_glow = marks.colour[m], marks.alpha[m], marks.kind[m] == GLOW
    for y in range(max(clip[1], int(max(cy - radius - 1.0, 0.0))), min(clip[3], int(max(cy + radius, -2.0)) + 2)):
        dy = y + 0.5 - cy
        for x in range(max(clip[0], int(max(cx - radius - 1.0, 0.0))), min(clip[2], int(max(cx + radius, -2.0)) + 2)):
            dx = x + 0.5 - cx
            distance = math.sqrt(dx * dx + dy * dy)
            if is_glow:
                fall = max(0.0, 1.0 - distance / radius)
                cover = fall * fall * (3.0 - 2.0 * fall)
            else:
                cover = min(radius + 0.5 - distance, 1.0)
            shown = int(cover * alpha * 256.0)
            if shown > 0:
                pixels[y, x] = laid_over(int(pixels[y, x]), colour, shown)


@inner_kernel
def _mark_share(style: int, u: float, v: float, edge: float) -> float:
    """How much of a pixel of a ball is its mark, at (u, v) in the turned ball of radius 1."""
    if style == STRIPED:
        return min(max((0.26 - abs(v)) / edge + 0.5, 0.0), 1.0)
    if style == MARBLED:
        wave = 1.6 * u
        bent = v + 0.35 * wave * (1.5 - 0.5 * wave * wave)
        return 0.9 * min(max((0.20 - abs(bent)) / edge + 0.5, 0.0), 1.0)
    if style == STUDDED:
        out = math.sqrt(u * u + v * v)
        ring = 0.5 * min(max((0.05 - abs(out - 0.62)) / edge + 0.5, 0.0), 1.0)
        stud = math.sqrt((u - 0.62) * (u - 0.62) + v * v)
        return max(ring, min(max((0.13 - stud) / edge + 0.5, 0.0), 1.0))
    return 0.0


@inner_kernel
def _paint_ball(pixels: Pixels, marks: MarkArrays, m: int, clip: Slots) -> None:
    cx, cy, radius, style = marks.ends[m, 0], marks.ends[m, 1], marks.half[m], marks.kind[m]
    cosine, sine = marks.ends[m, 2], marks.ends[m, 3]
    own, mark = marks.colour[m], marks.extra[m]
    inverse = 1.0 / max(radius, 0.5)
    edge = 1.5 * inverse
    for y in range(max(clip[1], int(max(cy - radius - 1.0, 0.0))), min(clip[3], int(max(cy + radius, -2.0)) + 2)):
        ny = (y + 0.5 - cy) * inverse
        for x in range(max(clip[0], int(max(cx - radius - 1.0, 0.0))), min(clip[2], int(max(cx + radius, -2.0)) + 2)):
            nx = (x + 0.5 - cx) * inverse
            out = nx * nx + ny * ny
            cover = radius + 0.5 - math.sqrt(out) * radius
            if cover <= 0.0:
                continue
            out = min(out, 1.0)
            nz = math.sqrt(1.0 - out)
            share = _mark_share(style, cosine * nx + sine * ny, cosine * ny - sine * nx, edge)
            lit = 0.66 * nz - 0.42 * nx - 0.62 * ny
            # Light from above, some that comes back from below, and a rim.
            light = 0.50 + 0.64 * max(lit, 0.0) + 0.16 * max(0.0, 0.5 * nx + 0.7 * ny) * (1.0 - nz)
            light *= 1.0 - 0.3 * min(max((out - 0.80) * 5.0, 0.0), 1.0)
            gleam = min(max(0.0, lit - 0.90) * 10.0, 1.0)
            gleam = 0.8 * gleam * gleam
            colour = 0
            for shift in range(0, 24, 8):
                channel = float((own >> shift) & 255)
                channel += (((mark >> shift) & 255) - channel) * share
                channel = min(channel * light, 255.0)
                colour |= int(channel + (255.0 - channel) * gleam) << shift
            alpha = marks.alpha[m]
            pixels[y, x] = laid_over(int(pixels[y, x]), colour, int(min(cover, 1.0) * alpha * 256.0))


@kernel
def paint_marks(pixels: Pixels, marks: MarkArrays, tiles: Sheets, clip: Slots) -> None:
    """Draw marks into pixels (h, w), strips with tiles (t, ACROSS, ALONG) 0xAARRGGBB, inside clip (4,)."""
    for m in range(marks.kind.shape[0]):
        ax, ay, bx, by = marks.ends[m, 0], marks.ends[m, 1], marks.ends[m, 2], marks.ends[m, 3]
        if not (abs(ax) < FAR and abs(ay) < FAR and abs(bx) < FAR and abs(by) < FAR and marks.half[m] < FAR):
            continue
        kind = marks.kind[m]
        if kind == STROKE:
            paint_segment(pixels, ax, ay, bx, by, marks.half[m], marks.colour[m], marks.alpha[m], clip)
        elif kind == STRIP and marks.half[m] >= THIN:
            _paint_strip(pixels, marks, m, tiles, clip)
        elif kind == STRIP:
            colour = int(tiles[marks.extra[m], ACROSS // 2 - 1, 0])
            colour = laid_over(colour, marks.colour[m], int(marks.alpha[m] * 256.0))
            paint_segment(pixels, ax, ay, bx, by, marks.half[m], colour, 1.0, clip)
        elif kind == HAIR:
            _paint_hair(pixels, ax, ay, bx, by, marks.colour[m], clip)
        elif kind <= GLOW:
            _paint_disc(pixels, marks, m, clip)
        else:
            _paint_ball(pixels, marks, m, clip)


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
