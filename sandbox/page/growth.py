"""Growth: which arrays of a block have a row for each particle, spring, constraint, corner, driven part or material.

A page gives them more rows when something is added to its world. Looked up by trying: the block of the same world with
a few rows more.
"""

import math
from dataclasses import astuple
from typing import Any

import numpy as np

from sandbox.page.image import arrays_of
from sandbox.physics.actuators import StrainLimits, unlimited
from sandbox.physics.pipeline.block_owner import block_of
from sandbox.physics.snapshot import restore, take
from sandbox.physics.state import Family
from sandbox.physics.world import World

# By family, so many rows as no other has: where an array has so many more, it is of that family.
_MORE = {Family.PARTICLE: 11, Family.SPRING: 23, Family.CONSTRAINT: 41, Family.CORNER: 79, Family.ACTUATOR: 131}
_MATERIALS = 5
_NAMES = {count: family.name.lower() for family, count in _MORE.items()} | {_MATERIALS: "material"}

# By the path of an array: the name of its family, and what numbers of a new row are, as JavaScript reads them.
Growth = dict[str, tuple[str, float | str]]


def growth_of(world: World) -> Growth:
    """What grows of a world's block."""
    before, equipment = take(world), world.equipment
    present = dict(arrays_of(block_of(world).given))
    for family, count in _MORE.items():
        world.append(family, count)
    limits = zip(astuple(world.limits), astuple(unlimited(_MATERIALS)), strict=True)
    world.equipment = equipment._replace(limits=StrainLimits(*map(np.concatenate, limits)))
    grown = dict(arrays_of(block_of(world).given))
    restore(world, before)
    world.equipment = equipment
    found = {path: _row(array, present[path]) for path, array in grown.items()}
    return {path: row for path, row in found.items() if row is not None}


def _row(grown: Any, present: Any) -> tuple[str, float | str] | None:
    family = _NAMES.get(len(grown) - len(present))
    if family is None:
        return None
    fill = float(grown[len(present) :].flat[0])
    return family, fill if math.isfinite(fill) else "Infinity"
