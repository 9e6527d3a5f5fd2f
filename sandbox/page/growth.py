"""Growth: which arrays of a block have a row for each particle, spring or other thing in it, and what new rows hold.

A page gives them more rows when a kit joins its world.
"""

import math

from sandbox.physics.actuators import Actuators
from sandbox.physics.driving import Drives
from sandbox.physics.joints.motors import DrivenWheels
from sandbox.physics.state import FAMILIES, Column, Family
from sandbox.physics.world import World

# By the path of an array: its family, what numbers of a new row are, as JavaScript reads them, and how many rows more
# than of the family it has.
Growth = dict[str, tuple[str, float | str, int]]
Counts = dict[str, int]
# The families that kits add rows to, in arrays of the state; and the hands of a level that begins with nothing.
_GROWING = (Family.PARTICLE, Family.SPRING, Family.CONSTRAINT, Family.CORNER, Family.ACTUATOR, Family.HAND)
_HYDRAULIC = ("hydraulic", "shortest", "longest", "rate", "part", "hydraulic_force", "returns")
# Rows of forms by what they count, in the order of their columns in `first`; and arrays of them by their paths.
FORM_ROWS = ("formPoint", "formSpring", "formConstraint", "formArea", "formBend")
_OF_FORMS = {
    "forms.first": "form", "forms.shapes.points": "formPoint", "forms.shapes.mass": "formPoint",
    "forms.shapes.pairs": "formSpring", "forms.shapes.areas": "formArea", "forms.shapes.bends": "formBend",
    "forms.spring": "formSpring", "forms.constraint": "formConstraint", "modes.body": "form",
    "modes.piece": "formPoint", "modes.point": "formPoint", "modes.spring": "formSpring",
    "modes.constraint": "formConstraint",
}  # fmt: skip
_LIMITS: dict[str, float | str] = {
    "tension": "Infinity",
    "compression": "Infinity",
    "yielding": "Infinity",
    "yield_share": 0.0,
}


def row_counts(world: World) -> Counts:
    """How many rows there are of each family, of materials and of what is driven.

    limit: materials, where any has limits, else none; breakable: springs, where there are such limits.
    """
    rows = {
        family.name.lower(): len(getattr(world, FAMILIES[family][0].name))
        for family in Family
        if family is not Family.CONTACT
    }
    driven: Actuators = world.actuators
    return rows | {
        "material": len(world.material_names),
        "muscle": len(driven.muscles.spring),
        "hydraulic": len(driven.hydraulics.spring),
        "motor": len(driven.motors.hub),
        "rim": len(driven.motors.rim),
        "hull": len(world.hulls),
        "area": len(world.area_names),
        "form": len(world.forms),
        **dict(zip(FORM_ROWS, world.form_table.forms.first[-1].tolist(), strict=True)),
        "limit": len(world.material_names) if world.limits.exist else 0,
        "breakable": world.spring_count if world.limits.exist else 0,
    }


def growth_of() -> Growth:
    """What grows of a world's block."""
    found: Growth = {}
    for family in _GROWING:
        for column in FAMILIES[family]:
            found |= _of_column(column, family.name.lower())
    for name in Drives._fields:
        found[f"drives.{name}"] = "hydraulic" if name in _HYDRAULIC else "muscle", 0.0, 0
    for name in DrivenWheels._fields:
        family_name = "rim" if name == "rim" else "motor"
        found[f"wheels.{name}"] = family_name, 0.0, int(name == "rim_start")
    found |= {f"limits.{name}": ("limit", fill, 0) for name, fill in _LIMITS.items()}
    found |= {f"limits.{name}": ("breakable", 0.0, 0) for name in ("driven", "broken")}
    for path, family_name in _OF_FORMS.items():
        found[path] = family_name, 0.0, int(path == "forms.first")
    return found | {"water.hull": ("hull", 0.0, 0), "areas": ("area", 0.0, 0)}


def _of_column(column: Column, family: str) -> Growth:
    usual = float(column.usual)
    assert math.isfinite(usual)
    paths = [f"state.{column.name}", *([f"good.{column.name}"] if column.guarded else [])]
    return {path: (family, usual, 0) for path in paths}
