"""Reads the outline of a picture with transparency: what is opaque is inside."""

import io
import warnings
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sandbox.bring.sketch import FilledShape, Ring, Sketch, Unreadable, area_of

PIXEL_LIMIT = 16 * 1024 * 1024
# Outlines are looked for in a picture made smaller to this many pixels a side: finer ones no mesh would show.
LOOKED_AT = 512
# Least opacity (0..1) of what is inside.
OPAQUE = 0.5
PIECE_LIMIT = 300
# Fewer pixels than these are dust of a scan.
SMALLEST = 12


def read_picture(data: bytes) -> Sketch:
    """The opaque regions of a PNG, in pixels of the picture looked at. Raises Unreadable."""
    colours, alpha = _pixels(data)
    if alpha.min() >= OPAQUE:
        raise Unreadable("has no transparent pixels, so no outline; make its background transparent")
    if alpha.max() < OPAQUE:
        raise Unreadable("is transparent all over; there is nothing to bring in")
    drawing = Sketch("jelly", tolerance=0.6)
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
    drawing.left_out.add("picture inside the outline (its mean colour came in)")
    return drawing


def _pixels(data: bytes) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Colours (h, w, 3) and opacities (h, w), 0..1 each, of the picture made smaller. Raises Unreadable."""
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
        ratio = max(rgba.size) / LOOKED_AT
        if ratio > 1.0:
            size = max(1, round(rgba.size[0] / ratio)), max(1, round(rgba.size[1] / ratio))
            rgba = rgba.resize(size, Image.Resampling.BOX)
    pixels = np.asarray(rgba, dtype=np.float64) / 255.0
    return pixels[:, :, :3], pixels[:, :, 3]


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
