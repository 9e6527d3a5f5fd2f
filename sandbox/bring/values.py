"""Values of a file of another program, each of the type that is needed or a line that says it is not."""

import math
from collections.abc import Mapping
from typing import Any

from sandbox.bring.sketch import Unreadable
from sandbox.level.format.level_error import shown

Object = Mapping[str, Any]


def number(holder: Object, key: str, default: float = 0.0) -> float:
    """A finite number; default where there is none. Raises Unreadable."""
    value = holder.get(key, default)
    if isinstance(value, bool) or not isinstance(value, int | float) or not _is_finite(value):
        raise Unreadable(f"{key}: {shown(value)} is no number")
    return float(value)


def whole(holder: Object, key: str, default: int = 0) -> int:
    """A whole number; default where there is none. Raises Unreadable."""
    value = number(holder, key, default)
    if value != math.floor(value) or abs(value) > 2**53:
        raise Unreadable(f"{key}: {shown(holder.get(key))} is no whole number")
    return int(value)


def text(holder: Object, key: str, default: str = "") -> str:
    """A text; default where there is none. Raises Unreadable."""
    value = holder.get(key, default)
    if not isinstance(value, str):
        raise Unreadable(f"{key}: {shown(value)} is no text")
    return value


def objects(holder: Object, key: str) -> list[Object]:
    """A list of objects, empty where there is none. Raises Unreadable."""
    value = holder.get(key)
    if value is None:
        return []
    if not isinstance(value, list) or not all(isinstance(item, dict) for item in value):
        raise Unreadable(f"{key}: {shown(value)} is no list of objects")
    return value


def _is_finite(value: float) -> bool:
    try:
        return math.isfinite(value)
    except OverflowError:
        return False
