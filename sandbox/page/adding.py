"""Adding: what a page must know to let kits join its world, and to make some of what is drawn on it."""

import math
from typing import Any

from sandbox.level.assembly.level_world import LevelWorld
from sandbox.level.document.model import ContactsDef
from sandbox.level.format.limits import (
    LIMITED_LIMIT,
    LIMITED_WORK_LIMIT,
    MATERIAL_LIMIT,
    MOTOR_LIMIT,
    PARTICLE_LIMIT,
    SPRING_LIMIT,
)
from sandbox.level.plan.surfaces import DEFAULT_GROUP, TERRAIN_NAME, group_bits
from sandbox.physics.arena import NO_ARENA
from sandbox.physics.collision.filter import ALL_GROUPS, LINE, NO_EDGE, SOLID_LEFT, SOLID_RIGHT
from sandbox.physics.keeping.arguments import FARTHEST
from sandbox.physics.kits import joining, kit, removing
from sandbox.physics.state import Range
from sandbox.session.commands.adding import SAME_ENDS
from sandbox.session.commands.removing import ONE_OF_TWO

# The rows of a world, by parts of kits.
FAMILIES = {
    "particles": "particle", "springs": "spring", "constraints": "constraint", "corners": "corner", "parts": "actuator",
    "muscles": "muscle", "hydraulics": "hydraulic", "motors": "motor", "rims": "rim", "materials": "material",
    "hulls": "hull",
}  # fmt: skip
_CODES = ("NO_ROWS", "NO_LIMIT_ROWS", "TOO_MANY", "BAD_PLACE", "HEADER")
WORDS = {
    "notATable": joining.NOT_A_TABLE,
    "notRows": joining.NOT_ROWS,
    "notWhole": joining.NOT_WHOLE,
    "notANumber": joining.NOT_A_NUMBER,
    "unknown": joining.UNKNOWN,
    "missing": joining.MISSING,
    "outOfRange": joining.OUT_OF_RANGE,
    "doesNotFit": joining.DOES_NOT_FIT,
    "noParticle": joining.NO_PARTICLE,
    "tooMuch": joining.TOO_MUCH,
    "tooManyWheels": joining.TOO_MANY_WHEELS,
    "sameEnds": SAME_ENDS,
    "oneOfTwo": ONE_OF_TWO,
    "notThere": "it is not there any more",
}


def kit_table(world: LevelWorld) -> dict[str, Any]:
    """The tables of a kit's columns, limits, answers of kernels and words; 64-bit numbers as text."""
    return {
        "parts": kit.PART_NAMES,
        "families": FAMILIES,
        "slots": [[c.part, c.name, c.usual, _range(c)] for c in kit.SLOT_TABLE],
        "numbers": [[c.part, c.name, _number(c.usual), _range(c)] for c in kit.NUMBER_TABLE],
        "table": [str(value) for value in kit.TABLE.tolist()],
        "ranges": [_number(value) for value in kit.RANGES.tolist()],
        "codes": {name: getattr(kit, name) for name in _CODES} | {"NO_ARENA": NO_ARENA, "BAD_SLOT": removing.BAD_SLOT},
        "ways": {name: getattr(removing, name) for name in ("BODY", "HANGING")},
        "most": {
            "particles": PARTICLE_LIMIT, "springs": SPRING_LIMIT, "motors": MOTOR_LIMIT,
            "materials": MATERIAL_LIMIT + 1, "muscles": LIMITED_LIMIT,
        },
        "limitedWork": LIMITED_WORK_LIMIT,
        "far": str(FARTHEST),
        "groupBits": str(max(group_bits(world.level).values())),
        "nouns": joining.NOUNS,
        "words": WORDS,
    }  # fmt: skip


def _number(value: float | None) -> float | str | None:
    return value if value is None or math.isfinite(value) else "NaN" if math.isnan(value) else "Infinity"


def _range(column: kit.SlotColumn | kit.NumberColumn) -> list[Any] | None:
    """Least, most and words of a range; None: of what counts rows."""
    if isinstance(column, kit.SlotColumn):
        within = Range(column.low, column.high)
        return None if column.of else [str(column.low), str(column.high), str(within)]
    return [_number(column.within.lowest), _number(column.within.high), str(column.within)]


def adding(world: LevelWorld) -> dict[str, Any]:
    """Surfaces, groups and kinds of edge, for who makes kits, as JSON takes them; 64-bit numbers as text."""
    level = world.level
    usual, surface, bits = level.contacts or ContactsDef(), vars(world.surface), group_bits(level)
    return {
        "surface": {name: str(value) if isinstance(value, int) else value for name, value in surface.items()},
        "body": {
            "friction": usual.friction, "restitution": usual.restitution, "group": str(bits[DEFAULT_GROUP]),
            "collides": str(ALL_GROUPS if level.has_contacts else 0),
        },
        "terrain": str(bits[TERRAIN_NAME] if level.has_contacts else 0),
        "touches": level.has_contacts,
        "edges": {"none": NO_EDGE, "line": LINE, "left": SOLID_LEFT, "right": SOLID_RIGHT},
    }  # fmt: skip
