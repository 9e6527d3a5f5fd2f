"""Water of a level: its pools, and the hulls of bodies that displace it without triangles."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from sandbox.level.document.model import Level, Material, NissenMaterial
from sandbox.level.kinds.expansion import NO_HULL, Expansion
from sandbox.physics.arrays import FloatRows, SlotRows
from sandbox.physics.constraints import TRIANGLE
from sandbox.physics.water.displacers import NO_HULLS, NO_POOLS, Pool, pools_of


def water_of(level: Level) -> FloatRows:
    """The pools of a level, in the order of its zones."""
    pools = [
        Pool(zone.box, zone.water.density, zone.water.fast_drag, zone.water.slow_drag, zone.water.flow)
        for zone in level.zones
        if zone.water is not None and zone.box is not None
    ]
    return pools_of(pools) if pools else NO_POOLS


def hulls_of(level: Level, bodies: Sequence[Expansion[Any]], materials: Mapping[str, Material]) -> SlotRows:
    """The hulls of a level's bodies, in file order, of those alone that have no triangles. Bodies may join later."""
    rows, first = [NO_HULLS], 0
    for number, (body, made) in enumerate(zip(level.bodies, bodies, strict=True)):
        hull = made.hull() if _needs_hull(made, materials[body.material]) else NO_HULL
        if np.isin(hull[:, 0], made.numbers).all():
            springs = first + np.searchsorted(made.numbers, hull[:, 0])
            rows.append(np.column_stack([np.full(len(hull), number), springs, hull[:, 1]]))
        first += len(made.pairs)
    return np.concatenate(rows)


def _needs_hull(made: Expansion[Any], material: Material) -> bool:
    """Whether a body displaces water by its outline: it has no triangles, and is no ring that keeps no area."""
    areas = made.area_constraints
    if not len(areas):
        return True
    keeps_areas = isinstance(material, NissenMaterial)
    return keeps_areas != (areas.shape[1] == TRIANGLE)
