"""Converts older versions of the level format in memory, by a chain of pure functions."""

from collections.abc import Callable, Mapping
from typing import Any

from sandbox.level.format.limits import DEFAULT_MATERIAL, DEFAULT_SOLVER, VERSION
from sandbox.physics.equation import HIGHEST_COEFFICIENT, half_step, whole_of_parts

Migration = Callable[[dict[str, Any]], dict[str, Any]]


def migrated(
    raw: dict[str, Any], migrations: Mapping[int, Migration] | None = None, version: int = VERSION
) -> dict[str, Any]:
    """The JSON of a level converted to this version of the format; unchanged if its version is this one or unknown.

    Raises ValueError if it is not valid in its own version.
    """
    migrations = MIGRATIONS if migrations is None else migrations
    while type(raw.get("version")) is int and raw["version"] < version and raw["version"] in migrations:
        before = raw["version"]
        try:
            raw = {**migrations[before](raw), "version": before + 1}
        except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError):
            raise ValueError(f"is no valid level of version {before}, so it cannot be brought to {version}") from None
    return raw


def _springs_keep_their_constant(raw: dict[str, Any]) -> dict[str, Any]:
    """Version 1 to 2: substeps of the direct solver keep k and c of springs; before, they kept the motion of each.

    Changes Cs and Cd of a tick so that those of a substep stay the same. Materials at 1, and bodies with a firmness,
    stay as they are.
    """
    settings = raw.get("settings") or {}
    parts = settings.get("substeps", 1)
    if settings.get("solver", DEFAULT_SOLVER) != "direct" or type(parts) is not int or parts < 2:
        return raw
    materials = dict(raw.get("materials") or {})
    sprung = [*(raw.get("bodies") or []), *(raw.get("springs") or [])]
    if any(part.get("material", DEFAULT_MATERIAL) == DEFAULT_MATERIAL for part in sprung):
        materials.setdefault(DEFAULT_MATERIAL, {})
    return {
        **raw,
        "materials": {
            name: material if "law" in material else _same_in_parts(material, parts)
            for name, material in materials.items()
        },
        "bodies": [
            {**body, "bending": _same_in_parts(body["bending"], parts)} if body.get("bending") is not None else body
            for body in raw.get("bodies") or []
        ],
    }


def _same_in_parts(springs: dict[str, Any], parts: int) -> dict[str, Any]:
    stiffness, damping = springs.get("stiffness", 0.5), springs.get("damping", 0.9)
    if not (0.0 <= stiffness <= 1.0 and 0.0 <= damping <= HIGHEST_COEFFICIENT):
        return springs
    halved = 1
    while halved < parts:
        stiffness, damping = half_step(stiffness, damping)
        halved *= 2
    stiffness, damping = whole_of_parts(stiffness, damping, parts)
    return {**springs, "stiffness": stiffness, "damping": damping}


# From a version to the next: the plain JSON of a level, not yet looked at, in; another object out, whose version is
# set here. What version 2 says, version 3 says too. A file keeps its version until it is saved. Taking a step out makes
# every file of its version unreadable.
MIGRATIONS: dict[int, Migration] = {1: _springs_keep_their_constant, 2: dict}
