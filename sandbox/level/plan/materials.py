"""What materials make of bodies: coefficients and limits of springs, areas and bends, and firmness."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sandbox.level.document.model import HookeMaterial, Level, Material, NissenMaterial
from sandbox.level.kinds.expansion import NO_POLYGONS, Expansion
from sandbox.level.plan.plan import Layout
from sandbox.physics.arrays import Slots
from sandbox.physics.breaking import NEVER, StrainLimits
from sandbox.physics.constraints import AREA, BEND, TRIANGLE
from sandbox.physics.keeping.equipment import FirmBody, Firmness
from sandbox.physics.marks import LAW_HOOKE, LAW_NISSEN, OWN_MATERIAL
from sandbox.physics.softness.firmness import give_firmness, lowest_mode_of
from sandbox.physics.world import World


def coefficients(material: NDArray[np.int64], materials: dict[str, Material]) -> dict[str, NDArray[np.generic]]:
    """Law and coefficients of every spring (m,), as arguments of World.add_springs."""
    rows = [_row(chosen) for chosen in materials.values()]
    law, stiffness, damping, k, c = (np.array(column)[material] for column in zip(*rows, strict=True))
    return {"law": law, "stiffness": stiffness, "damping": damping, "hooke_stiffness": k, "hooke_damping": c}


def strain_limits(materials: dict[str, Material]) -> StrainLimits:
    """The strains at which springs of each material break and yield."""

    def column(name: str) -> NDArray[np.float64]:
        values = [getattr(material, name) for material in materials.values()]
        return np.array([NEVER if value is None else value for value in values], dtype=np.float64)

    yielding = column("yield_strain")
    return StrainLimits(
        tension=column("tension_limit"),
        compression=column("compression_limit"),
        yielding=yielding,
        yield_share=np.where(np.isfinite(yielding), column("yield_limit"), 0.0),
    )


def _row(material: Material) -> tuple[int, float, float, float, float]:
    if isinstance(material, HookeMaterial):
        return LAW_HOOKE, 0.0, 0.0, material.k + 0.0, material.c + 0.0
    return LAW_NISSEN, material.stiffness + 0.0, material.damping + 0.0, 0.0, 0.0


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


def add_forms(
    world: World, level: Level, bodies: Sequence[Expansion[Any]], materials: dict[str, Material],
    first_constraint: list[int],
) -> None:  # fmt: skip
    """Give the world the forms of bodies that may be stiff without pins, and set their firmness.

    bodies: expansions of the level's bodies; first_constraint: where the constraints of each body begin, and where the
    last ones end.
    """
    first_spring = 0
    forms: list[FirmBody] = []
    asked: dict[int, Firmness] = {}
    for number, (body, made) in enumerate(zip(level.bodies, bodies, strict=True)):
        springs = first_spring + np.arange(len(made.pairs))
        first_spring += len(made.pairs)
        constraints = np.arange(first_constraint[number], first_constraint[number + 1])
        narrow = constraints[world.constraint_corners[constraints] == TRIANGLE]
        if isinstance(materials[body.material], HookeMaterial):
            continue
        if body.firmness is None and not made.may_be_stiff:
            continue
        if body.firmness is not None:
            asked[len(forms)] = body.firmness.asked
        forms.append(FirmBody(body.id, made.stiff_form, springs, narrow))
    world.forms += tuple(forms)
    for number, firmness in asked.items():
        world.form_table.know(number, lowest_mode_of(forms[number].shape))
        give_firmness(world, number, firmness, level.settings.gravity)
