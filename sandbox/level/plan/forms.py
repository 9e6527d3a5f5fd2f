"""Gives a world the forms of bodies whose firmness can be set, and sets the firmness of the level."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from sandbox.level.document.model import HookeMaterial, Level, Material
from sandbox.level.kinds.expansion import Expansion
from sandbox.physics.constraints import TRIANGLE
from sandbox.physics.keeping.equipment import FirmBody, Firmness
from sandbox.physics.softness.firmness import give_firmness, lowest_mode_of
from sandbox.physics.world import World


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
