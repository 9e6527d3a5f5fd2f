"""Reads the outline of a picture with transparency: what is opaque is inside; and cuts out what a body of it wears."""

import io
import math
import warnings
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sandbox.bring.sketch import FilledShape, Pixels, Ring, Sketch, Unreadable, area_of
from sandbox.level.format.picture import PICTURE_LIMIT, SIDE_LIMIT

Layer = list[NDArray[np.float32]]

PIXEL_LIMIT = 16 * 1024 * 1024
# Outlines are looked for in a picture made smaller to this many pixels a side: finer ones no mesh would show.
LOOKED_AT = 512
# Least opacity (0..1) of what is inside.
OPAQUE = 0.5
PIECE_LIMIT = 300
# Fewer pixels than these are dust of a scan.
SMALLEST = 12
# A picture whose file would be too large is made smaller by this at least, again and again.
SMALLER = 0.95


def read_picture(data: bytes) -> Sketch:
    """The opaque regions of a PNG, in pixels of the picture looked at. Raises Unreadable."""
    whole, (colours, alpha) = _pixels(data)
    if alpha.min() >= OPAQUE:
        raise Unreadable("has no transparent pixels, so no outline; make its background transparent")
    if alpha.max() < OPAQUE:
        raise Unreadable("is transparent all over; there is nothing to bring in")
    size = len(alpha) / len(whole)
    drawing = Sketch("jelly", tolerance=0.6, picture=Pixels(whole, (0.0, 0.0), size))
    pieces = sorted(_regions(alpha), key=lambda rings: -area_of(rings[0]))
    kept = [rings for rings in pieces if area_of(rings[0]) >= SMALLEST][:PIECE_LIMIT]
    if len(kept) < len(pieces):
        drawing.left_out.add("speck", len(pieces) - len(kept))
    for outer, *holes in kept or pieces[:1]:
        rings = [outer, *(hole for hole in holes if area_of(hole) >= SMALLEST)]
        mean = _mean_colour(colours, alpha, rings)
        # Rows of a picture go down.
        upright = tuple(np.stack([ring[:, 0], len(alpha) - ring[:, 1]], axis=1) for ring in rings)
        drawing.outlines.append(FilledShape(upright, "evenodd", mean))
    return drawing


def cut_out(picture: Pixels, box: tuple[float, float, float, float]) -> bytes:
    """The part of a picture in a box, as a PNG that a body can wear; colours go on where it is transparent."""
    from PIL import Image

    high, wide = picture.pixels.shape[:2]
    left, bottom, right, top = box
    x, y = picture.corner
    edges = np.array([left - x, right - x, bottom - y, top - y]) / picture.size
    first, last = np.clip(edges[:2], 0, wide)
    upper, lower = np.clip(high - edges[:1:-1], 0, high)
    across, down = max(last - first, 1e-3), max(lower - upper, 1e-3)
    whole, share = Image.fromarray(picture.pixels), min(1.0, SIDE_LIMIT / max(across, down))
    while True:
        size = max(1, round(across * share)), max(1, round(down * share))
        part = whole.resize(size, Image.Resampling.BICUBIC, box=(first, upper, first + across, upper + down))
        Image.fromarray(_opaque(np.asarray(part))).save(file := io.BytesIO(), "PNG", optimize=True)
        if file.tell() <= PICTURE_LIMIT:
            return file.getvalue()
        share *= min(SMALLER, math.sqrt(PICTURE_LIMIT / file.tell()))


def _opaque(pixels: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """The colours (h, w, 3) of pixels; where these are transparent, those around, the nearer the more."""
    from PIL import Image

    def resized(planes: Layer, size: tuple[int, int], how: Image.Resampling) -> Layer:
        return [np.asarray(Image.fromarray(plane).resize(size, how)) for plane in planes]

    alpha = np.asarray(pixels[:, :, 3] / 255.0, dtype=np.float32)
    # Each layer half as large as the one before, the colours weighted by how opaque they are.
    weighted = [np.asarray(pixels[:, :, k] * alpha, dtype=np.float32) for k in range(3)]
    layers: list[Layer] = [[*weighted, alpha]]
    while max(layers[-1][3].shape) > 1:
        high, wide = layers[-1][3].shape
        layers.append(resized(layers[-1], ((wide + 1) // 2, (high + 1) // 2), Image.Resampling.BOX))
    found = layers.pop()
    for layer in reversed(layers):
        around = resized(found, layer[3].shape[::-1], Image.Resampling.BILINEAR)
        found = [own + far * (1.0 - layer[3]) for own, far in zip(layer, around, strict=True)]
    colours = np.stack(found[:3], axis=2) / np.maximum(found[3], 1e-6)[:, :, None]
    return np.asarray(np.clip(np.round(colours), 0, 255), dtype=np.uint8)


def _pixels(data: bytes) -> tuple[NDArray[np.uint8], tuple[NDArray[np.float64], NDArray[np.float64]]]:
    """Pixels (h, w, 4); and colours (h, w, 3) and opacities (h, w), 0..1 each, of the picture made smaller.

    Raises Unreadable.
    """
    from PIL import Image

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            with Image.open(io.BytesIO(data), formats=["PNG"]) as opened:
                width, height = opened.size
                if width * height > PIXEL_LIMIT:
                    raise Unreadable(
                        f"has {width} x {height} pixels; at most {PIXEL_LIMIT // 1024 // 1024} Mi are read"
                    )
                rgba = opened.convert("RGBA")
        except Unreadable:
            raise
        except (OSError, SyntaxError, ValueError, EOFError, Image.DecompressionBombError):
            raise Unreadable("is a damaged PNG picture: its pixels cannot be read") from None
        whole = np.asarray(rgba)
        ratio = max(rgba.size) / LOOKED_AT
        if ratio > 1.0:
            size = max(1, round(rgba.size[0] / ratio)), max(1, round(rgba.size[1] / ratio))
            rgba = rgba.resize(size, Image.Resampling.BOX)
    pixels = np.asarray(rgba, dtype=np.float64) / 255.0
    return whole, (pixels[:, :, :3], pixels[:, :, 3])


def _regions(alpha: NDArray[np.float64]) -> list[list[Ring]]:
    """Rings of each region, its outer border first, x to the right and y down."""
    from contourpy import FillType, contour_generator

    # A frame of nothing closes what the picture's border cuts.
    field = np.pad(alpha, 1)
    if not alpha.size:
        return []
    filled: Any = contour_generator(z=field, fill_type=FillType.OuterOffset).filled(OPAQUE, np.inf)
    points, offsets = filled
    return [
        [ring[:-1] - 0.5 for ring in np.split(place, offset[1:-1])]
        for place, offset in zip(points, offsets, strict=True)
    ]


def _mean_colour(colours: NDArray[np.float64], alpha: NDArray[np.float64], rings: list[Ring]) -> str:
    """The mean colour of the opaque pixels inside the outer border."""
    from PIL import Image, ImageDraw

    low = np.maximum(np.floor(rings[0].min(axis=0)).astype(int) - 1, 0)
    high = np.ceil(rings[0].max(axis=0)).astype(int) + 1
    part = slice(low[1], high[1]), slice(low[0], high[0])
    weight = alpha[part]
    mask = Image.new("L", (weight.shape[1], weight.shape[0]))
    ImageDraw.Draw(mask).polygon([(x - low[0] - 0.5, y - low[1] - 0.5) for x, y in rings[0].tolist()], 1, 1)
    weight = weight * np.asarray(mask)
    if weight.sum() <= 0.0:
        weight = np.ones(weight.shape)
    mean = np.tensordot(weight, colours[part], axes=2) / weight.sum()
    return "#" + "".join(f"{round(255 * float(value)):02X}" for value in mean)
