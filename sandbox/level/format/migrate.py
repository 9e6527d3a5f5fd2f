"""Older versions of the level format, brought to this one in memory by a chain of pure functions."""

from collections.abc import Callable, Mapping
from typing import Any

from sandbox.level.format.limits import VERSION

Migration = Callable[[dict[str, Any]], dict[str, Any]]

# From a version to the next: the plain JSON of a level, not yet looked at, in; another object out, whose version is
# set here. A file keeps its version until it is saved. Taking a step out makes every file of its version unreadable.
MIGRATIONS: dict[int, Migration] = {}


def migrated(
    raw: dict[str, Any], migrations: Mapping[int, Migration] = MIGRATIONS, version: int = VERSION
) -> dict[str, Any]:
    """A level's JSON in this version of the format; as it is where it is of this version or of none that is known.

    Raises ValueError where it is not what its own version allows.
    """
    while type(raw.get("version")) is int and raw["version"] < version and raw["version"] in migrations:
        before = raw["version"]
        try:
            raw = {**migrations[before](raw), "version": before + 1}
        except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError):
            raise ValueError(f"is no valid level of version {before}, so it cannot be brought to {version}") from None
    return raw
