"""Cells of a layer of tiles: as numbers, or packed as Tiled packs them."""

import base64
import binascii
import gzip
import io
import zlib
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sandbox.bring.sketch import LeftOut, Unreadable
from sandbox.bring.values import Object, objects, text, whole

CELL_LIMIT = 1_000_000

Cells = NDArray[np.int64]


def layer_cells(layer: Object, left_out: LeftOut) -> Iterator[tuple[Cells, tuple[int, int]]]:
    """Numbers of tiles (rows, columns), and the column and row of the first, of each part of a layer.

    Raises Unreadable for what is damaged.
    """
    parts = objects(layer, "chunks") if "chunks" in layer else [layer]
    packing = text(layer, "compression")
    if packing not in ("", "zlib", "gzip"):
        left_out.add(f"tile layer packed as {packing[:20]}")
        return
    total = 0
    for part in parts:
        width, height = whole(part, "width"), whole(part, "height")
        total += max(0, width) * max(0, height)
        if width < 0 or height < 0 or total > CELL_LIMIT:
            raise Unreadable(f"has a layer of tiles of no size, or of more than {CELL_LIMIT:,}")
        cells = _cells(part.get("data"), width * height, packing)
        yield cells.reshape(height, width), (whole(part, "x"), whole(part, "y"))


def _cells(data: Any, count: int, packing: str) -> Cells:
    if data is None:
        return np.zeros(count, dtype=np.int64)
    if isinstance(data, str):
        return _unpacked(data, count, packing)
    if not isinstance(data, list) or len(data) != count:
        raise Unreadable("has a layer of tiles whose data is no list as long as its size")
    if not all(type(cell) is int and 0 <= cell < 2**32 for cell in data):
        raise Unreadable("has a layer of tiles whose data holds more than numbers of tiles")
    return np.array(data, dtype=np.int64)


def _unpacked(data: str, count: int, packing: str) -> Cells:
    try:
        packed = base64.b64decode(data.strip(), validate=False)
        if packing == "zlib":
            packed = zlib.decompressobj().decompress(packed, 4 * count + 1)
        elif packing == "gzip":
            with gzip.GzipFile(fileobj=io.BytesIO(packed)) as file:
                packed = file.read(4 * count + 1)
    except (binascii.Error, zlib.error, OSError, EOFError, ValueError):
        raise Unreadable("has a layer of tiles whose packed data is damaged") from None
    if len(packed) != 4 * count:
        raise Unreadable("has a layer of tiles whose data is not as long as its size")
    return np.frombuffer(packed, dtype="<u4").astype(np.int64)
