"""Room: slots of a world for what is added in the course of a recording; a page has them from the start, unused.

Slots are append-only, and nothing is derived from those that are not active: the others come to the same bits.
"""

from typing import Any

from sandbox.physics.state import FAMILIES, Family
from sandbox.physics.world import World

Counts = dict[str, int]
# Families of rows by their names in pages; contacts are of a step.
GROWING = {family.name.lower(): family for family in Family if family is not Family.CONTACT}
# What slots hold that are not in use, where it is not what they will hold.
_UNUSED: dict[str, Any] = {
    "particle_active": False, "inverse_mass": 0.0, "velocity": 0.0, "slow_velocity": 0.0, "spin": 0.0, "collides": 0,
    "energy_bank": 0.0, "unmoved": False, "spring_active": False, "material": -1, "impulse": 0.0, "tension": 0.0,
    "constraint_active": False, "constraint_material": -1, "actuator_value": 0.0, "actuator_impulse": 0.0,
    "ramp_ticks": 0, "constraint_ramp_ticks": 0, "constraint_area_ticks": 0,
}  # fmt: skip


def row_counts(world: World) -> Counts:
    """How many rows the arrays of each family have, and how many materials there are."""
    rows = {name: len(getattr(world, FAMILIES[family][0].name)) for name, family in GROWING.items()}
    return rows | {"material": len(world.material_names)}


def make_room(world: World, last: World) -> None:
    """Give a world at its start the slots that it has at its end, where they were made, and its names and equipment."""
    here, there = row_counts(world), row_counts(last)
    for name, family in GROWING.items():
        if there[name] > here[name]:
            rows = {column.name: getattr(last, column.name)[here[name] :] for column in FAMILIES[family]}
            places = {"position": rows["origin"]} if family is Family.PARTICLE else {}
            world.append(family, there[name] - here[name], **rows | places)
    world.name_slots(last.particle_names[here["particle"] :], last.spring_names[here["spring"] :])
    world.equipment = last.equipment


def leave_unused(world: World, counts: Counts) -> None:
    """Take the slots beyond these out of use."""
    for name, family in GROWING.items():
        for column in FAMILIES[family]:
            if column.name in _UNUSED and len(getattr(world, column.name)) > counts[name]:
                world.change(column.name, _UNUSED[column.name], slice(counts[name], None))
