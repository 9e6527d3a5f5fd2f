"""Adds the area and bending constraints of a level's bodies to its world."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sandbox.level.document.model import Level, Material, NissenMaterial
from sandbox.level.kinds.expansion import NO_POLYGONS, Expansion
from sandbox.level.plan.layout import Layout
from sandbox.level.plan.welds import Slots
from sandbox.physics.constraints import AREA, BEND
from sandbox.physics.marks import OWN_MATERIAL
from sandbox.physics.world import World


def add_constraints(
    world: World,
    layout: Layout,
    level: Level,
    bodies: Sequence[Expansion[Any]],
    slots: Slots,
    materials: dict[str, Material],
) -> list[int]:
    """Add the area and bending constraints, body by body, with the areas and angles of the bodies' forms.

    Returns where the constraints of each body begin, and where the last ones end.
    """
    index = {name: number for number, name in enumerate(materials)}
    firsts = []
    for body, made in zip(level.bodies, bodies, strict=True):
        material, bending = materials[body.material], made.bending
        firsts.append(world.constraint_count)
        # Their error is that of the impulse-based spring; a Hooke material has none for areas.
        areas = made.area_constraints if isinstance(material, NissenMaterial) else NO_POLYGONS
        angles = made.bending_constraints
        if not len(areas) and not len(angles):
            continue
        particles, form = slots[layout.owners[body.id].first :], made.form
        # Welds may have made one particle of two corners: nothing is left to keep.
        areas, angles = (rows[_distinct(particles[rows])] for rows in (areas, angles))
        if isinstance(material, NissenMaterial):
            first = world.add_constraints(
                AREA, particles[areas], form=form[areas], inflation=made.inflation,
                stiffness=material.stiffness + 0.0, damping=material.damping + 0.0, material=index[body.material],
            )  # fmt: skip
            if len(areas):
                world.name_areas(body.id, range(first, first + len(areas)))
        if bending is not None:
            world.add_constraints(
                BEND, particles[angles], form=form[angles], stiffness=bending.stiffness + 0.0,
                damping=bending.damping + 0.0, material=OWN_MATERIAL,
            )  # fmt: skip
    return [*firsts, world.constraint_count]


def _distinct(corners: Slots) -> NDArray[np.bool_]:
    return np.asarray((np.diff(np.sort(corners, axis=1), axis=1) != 0).all(axis=1))
