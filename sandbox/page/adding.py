"""Adding: what a page must know to add particles, springs and bodies that say each of their rows to its world."""

from collections.abc import Mapping
from typing import Any

from sandbox.level.document.model import ContactsDef, Level, NissenMaterial
from sandbox.level.format.limits import DEFAULT_MATERIAL
from sandbox.level.plan.surfaces import DEFAULT_GROUP, group_bits
from sandbox.physics.collision.filter import ALL_GROUPS, LINE, NO_EDGE, SOLID_LEFT, SOLID_RIGHT
from sandbox.physics.marks import BANK_UNOPENED
from sandbox.physics.world import World

# What is said of a body that a page adds.
FIELDS = (
    "type", "id", "particles", "masses", "springs", "triangles", "pinned", "particle_radius", "friction", "restitution",
    "velocity", "collides", "material", "look",
)  # fmt: skip
# A page adds nothing of a material that has one of these.
_LIMITS = ("tension_limit", "compression_limit", "yield_strain")


def is_done_without_kernel(record: Mapping[str, Any]) -> bool:
    """Whether a page adds or removes what a command says, by itself."""
    if record["type"] == "remove":
        return record.get("particle") is not None
    if record["type"] in ("add_particle", "add_spring"):
        return True
    if record["type"] != "add_body" or record.keys() - {"type", "body", "materials"}:
        return False
    body, materials = record["body"], record.get("materials") or {}
    plain = all(material.keys() <= {"stiffness", "damping"} for material in materials.values())
    return (
        body["type"] == "mesh" and body.keys() <= set(FIELDS) and materials.keys() <= {body.get("material")} and plain
    )


def adding(world: World) -> dict[str, Any]:
    """Surfaces, groups, kinds of edge and materials, as JSON takes them; 64-bit numbers as text."""
    level = world.source
    assert isinstance(level, Level)
    usual, surface = level.contacts or ContactsDef(), vars(world.surface)
    bits = group_bits(level)
    materials = {DEFAULT_MATERIAL: NissenMaterial(), **level.materials}
    return {
        "fields": FIELDS,
        "surface": {name: str(value) if isinstance(value, int) else value for name, value in surface.items()},
        "usual": {"friction": usual.friction, "restitution": usual.restitution},
        "groups": {name: str(bit) for name, bit in bits.items()},
        "group": str(bits[DEFAULT_GROUP]),
        "allGroups": str(ALL_GROUPS),
        "touches": level.has_contacts,
        "hasWater": level.has_water,
        "edges": {"none": NO_EDGE, "line": LINE, "left": SOLID_LEFT, "right": SOLID_RIGHT},
        "unopened": BANK_UNOPENED,
        "materials": {
            name: {"stiffness": material.stiffness, "damping": material.damping}
            for name, material in materials.items()
            if isinstance(material, NissenMaterial) and not any(getattr(material, limit) for limit in _LIMITS)
        },
    }
