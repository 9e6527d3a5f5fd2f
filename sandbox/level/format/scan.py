"""Scans the bytes of a JSON text before any parser reads them: its depth, and how many lists and objects it has."""

import numpy as np

from sandbox.level.format.level_error import Fault
from sandbox.level.format.limits import CONTAINER_LIMIT, DEPTH_LIMIT


def scan(data: bytes) -> Fault | None:
    """The fault of a text that nests too deep or has too many lists and objects, or None. Takes linear time."""
    # Escapes go first, so that every quotation mark left opens or closes a string.
    if b"\\" in data:
        data = data.replace(b"\\\\", b"__").replace(b'\\"', b"__")
    text = np.frombuffer(data, dtype=np.uint8)
    outside = ~np.logical_xor.accumulate(text == ord('"'))
    opening = np.flatnonzero(((text == ord("[")) | (text == ord("{"))) & outside)
    closing = np.flatnonzero(((text == ord("]")) | (text == ord("}"))) & outside)
    if len(opening) > CONTAINER_LIMIT:
        return "", f"holds more than {CONTAINER_LIMIT:,} lists and objects; make it smaller"
    # Depth at each opening bracket: those opened up to it less those closed before it.
    depth = np.arange(1, len(opening) + 1) - np.searchsorted(closing, opening)
    too_deep = np.flatnonzero(depth > DEPTH_LIMIT)
    if not len(too_deep):
        return None
    line = data.count(b"\n", 0, int(opening[too_deep[0]])) + 1
    return f"line {line}", f"lists and objects are nested more than {DEPTH_LIMIT} deep; make it flatter"
