"""Limits of extras: finite numbers, short texts."""

import math
from collections.abc import Iterator
from typing import Any

from sandbox.level.document.model import Level
from sandbox.level.format.level_error import Fault, json_path, shown
from sandbox.level.format.limits import TEXT_LIMIT


def extras_faults(level: Level) -> Iterator[Fault]:
    """Faults of the extras of a level and of everything in it."""
    yield from _kept(["extras"], level.extras)
    for name in ("terrain", "zones", "bodies", "particles", "springs"):
        for index, item in enumerate(getattr(level, name)):
            if item.extras:
                yield from _kept([name, index, "extras"], item.extras)


def _is_finite(value: Any) -> bool:
    if isinstance(value, float):
        return math.isfinite(value)
    return not isinstance(value, int) or value.bit_length() <= 1024


def _kept(path: list[Any], value: Any) -> Iterator[Fault]:
    if isinstance(value, dict):
        for key, item in value.items():
            yield from _kept([*path, key], key)
            yield from _kept([*path, key], item)
    elif isinstance(value, list | tuple):
        for index, item in enumerate(value):
            yield from _kept([*path, index], item)
    elif isinstance(value, str):
        if len(value) > TEXT_LIMIT:
            yield json_path(path), f"has {len(value)} characters; at most {TEXT_LIMIT} are allowed"
    elif not _is_finite(value):
        yield json_path(path), f"{shown(value)} is not a finite number"
