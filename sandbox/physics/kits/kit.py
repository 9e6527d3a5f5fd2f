"""Kits: the tables of their columns, by which they are packed and looked at.

A kit is bodies as rows and nothing else. It is packed into whole numbers and numbers, column after column in the order
of SLOT_TABLE and NUMBER_TABLE: docs/kits.md has them all.
"""

import math
from typing import NamedTuple

import numpy as np

from sandbox.physics.arrays import Floats, Slots
from sandbox.physics.collision.filter import ALL_GROUPS, SOLID_RIGHT
from sandbox.physics.constraints import AREA, BEND
from sandbox.physics.marks import LAW_HOOKE
from sandbox.physics.state import BY_NAME, FINITE, NOT_NEGATIVE, ROLLING_RESISTANCE, SHARE, Range

# The parts of a kit. `bodies` has no columns, but a name each; `free_wheels`: wheels that pass through their mounts.
PART_NAMES = (
    "bodies", "particles", "springs", "constraints", "corners", "parts", "muscles", "hydraulics", "motors", "rims",
    "materials", "hulls", "free_wheels",
)  # fmt: skip
BODIES, PARTICLES, SPRINGS, CONSTRAINTS, CORNERS, PARTS, MUSCLES, HYDRAULICS, MOTORS, RIMS, MATERIALS, HULLS, FREE = (
    range(len(PART_NAMES))
)
COUNTED = len(PART_NAMES)
# What comes first of a packed kit's whole numbers: how many rows each part has; how many of its kind are in use in the
# world, for bodies the first free owner; how many a world holds at most, of muscles and hydraulics together those of
# limited force; the tick; the first particle of hands; the largest bit of the level's groups; then the columns.
MOST = 2 * COUNTED
TICK, FIRST_CURSOR, LEVEL_GROUPS, HEADER = range(3 * COUNTED, 3 * COUNTED + 4)
# Answers of `join` but for 0: there are too few rows for it, and limits of materials need rows as well; the world would
# have too many of the k-th part, TOO_MANY - k; the k-th of whole numbers and numbers, counted through, is out of its
# range, BAD_PLACE - k. Nothing was changed.
NO_ROWS, NO_LIMIT_ROWS, TOO_MANY, BAD_PLACE = -2, -3, -10, -100
FAR = 2**53


class SlotColumn(NamedTuple):
    """A column of whole numbers: its part and name, the least and the most, or the part whose rows it counts.

    usual: of a row that says nothing; None: each row says it.
    """

    part: str
    name: str
    low: int
    high: int
    of: str = ""
    usual: int | None = None


class NumberColumn(NamedTuple):
    """A column of numbers: its part and name, its range, its unit, and what a row has that says nothing.

    usual: NaN = as placed, or as the world has it; None: each row says it.
    """

    part: str
    name: str
    within: Range
    unit: str
    usual: float | None = None


def _state(part: str, name: str, column: str, usual: float | None = None) -> NumberColumn:
    """A column with the range and the unit of one of the table of state."""
    found = BY_NAME[column]
    return NumberColumn(part, name, found.within or FINITE, found.unit, usual)


SLOT_TABLE = (
    SlotColumn("particles", "body", -FAR, FAR),
    SlotColumn("particles", "group", 0, ALL_GROUPS),
    SlotColumn("particles", "collides", 0, ALL_GROUPS),
    SlotColumn("particles", "pinned", 0, 1, usual=0),
    SlotColumn("particles", "rolls", 0, 1, usual=1),
    SlotColumn("springs", "a", -FAR, FAR),
    SlotColumn("springs", "b", -FAR, FAR),
    SlotColumn("springs", "law", 0, LAW_HOOKE, usual=0),
    SlotColumn("springs", "material", 0, 0, "materials", usual=0),
    SlotColumn("springs", "edge", 0, SOLID_RIGHT, usual=0),
    SlotColumn("constraints", "kind", AREA, BEND, usual=AREA),
    SlotColumn("constraints", "corners", 3, FAR, usual=3),
    SlotColumn("constraints", "material", -1, 0, "materials", usual=0),
    SlotColumn("corners", "particle", 0, 0, "particles"),
    SlotColumn("muscles", "spring", 0, 0, "springs"),
    SlotColumn("muscles", "period", 2, 1_000_000),
    SlotColumn("hydraulics", "spring", 0, 0, "springs"),
    SlotColumn("hydraulics", "part", 0, 0, "parts"),
    SlotColumn("hydraulics", "returns", 0, 1, usual=0),
    SlotColumn("motors", "hub", 0, 0, "particles"),
    SlotColumn("motors", "part", 0, 0, "parts"),
    SlotColumn("motors", "rim", 0, FAR),
    SlotColumn("rims", "particle", 0, 0, "particles"),
    SlotColumn("materials", "slot", 0, FAR),
    SlotColumn("hulls", "body", 0, 0, "bodies"),
    SlotColumn("hulls", "spring", 0, 0, "springs"),
    SlotColumn("hulls", "turned", 0, 1, usual=0),
    SlotColumn("free_wheels", "wheel", 0, 0, "bodies"),
    SlotColumn("free_wheels", "mount", 0, 0, "bodies"),
)
(
    BODY, GROUP, COLLIDES, PINNED, ROLLS, END_A, END_B, LAW, MATERIAL, EDGE, KIND, SIZE, OF_MATERIAL, CORNER, MUSCLE,
    PERIOD, HYDRAULIC, MOVED_PART, RETURNS, HUB, TURNED_PART, RIM_SIZE, RIM, MATERIAL_SLOT, HULL_BODY, HULL_SPRING,
    HULL_TURNED, WHEEL, MOUNT, SLOT_COLUMNS,
) = range(len(SLOT_TABLE) + 1)  # fmt: skip
_LENGTH, _STRAIN, _FORCE = Range(0.0, 1e18), Range(0.0, math.inf), Range(0.0, math.inf, is_above=True)
NUMBER_TABLE = (
    _state("particles", "x", "position"),
    _state("particles", "y", "position"),
    _state("particles", "vx", "velocity", 0.0),
    _state("particles", "vy", "velocity", 0.0),
    _state("particles", "mass", "mass", 1.0),
    _state("particles", "radius", "radius", 0.05),
    _state("particles", "friction", "friction", 0.0),
    _state("particles", "restitution", "restitution", 0.0),
    _state("particles", "gravity_scale", "gravity_scale", 1.0),
    _state("particles", "rolling", "rolling", ROLLING_RESISTANCE),
    _state("particles", "angle", "angle", 0.0),
    _state("particles", "spin", "spin", 0.0),
    _state("springs", "rest_length", "rest_length", math.nan),
    _state("springs", "stiffness", "stiffness", 0.5),
    _state("springs", "damping", "damping", 0.9),
    _state("springs", "hooke_stiffness", "hooke_stiffness", 0.0),
    _state("springs", "hooke_damping", "hooke_damping", 0.0),
    _state("springs", "lowest_mode", "lowest_mode", 0.0),
    NumberColumn("springs", "belt", FINITE, "m/s", 0.0),
    NumberColumn("constraints", "area", FINITE, "m^2", math.nan),
    _state("constraints", "stiffness", "constraint_stiffness", 0.5),
    _state("constraints", "damping", "constraint_damping", 0.9),
    _state("constraints", "lowest_mode", "constraint_lowest_mode", 0.0),
    _state("corners", "x", "corner_form", math.nan),
    _state("corners", "y", "corner_form", math.nan),
    NumberColumn("parts", "value", Range(-1.0, 1.0), "1", 0.0),
    NumberColumn("muscles", "amplitude", Range(0.0, 0.9), "1"),
    NumberColumn("muscles", "phase", Range(0.0, 1.0), "1", 0.0),
    NumberColumn("muscles", "force", _FORCE, "N", math.inf),
    NumberColumn("hydraulics", "shortest", NOT_NEGATIVE, "m"),
    NumberColumn("hydraulics", "longest", NOT_NEGATIVE, "m"),
    NumberColumn("hydraulics", "rate", NOT_NEGATIVE, "m/s"),
    NumberColumn("hydraulics", "force", _FORCE, "N", math.inf),
    NumberColumn("motors", "speed", FINITE, "rad/s"),
    NumberColumn("motors", "torque", NOT_NEGATIVE, "N m"),
    NumberColumn("materials", "tension", _STRAIN, "1", math.nan),
    NumberColumn("materials", "compression", _STRAIN, "1", math.nan),
    NumberColumn("materials", "yielding", _STRAIN, "1", math.nan),
    NumberColumn("materials", "yield_share", SHARE, "1", math.nan),
)
(
    X, Y, VX, VY, MASS, RADIUS, FRICTION, RESTITUTION, GRAVITY_SCALE, ROLLING, ANGLE, SPIN, REST, STIFFNESS, DAMPING,
    HOOKE_STIFFNESS, HOOKE_DAMPING, LOWEST_MODE, BELT, KEPT_AREA, OF_STIFFNESS, OF_DAMPING, OF_MODE, FORM_X, FORM_Y,
    VALUE, AMPLITUDE, PHASE, MUSCLE_FORCE, SHORTEST, LONGEST, RATE, FORCE, SPEED, TORQUE, TENSION, COMPRESSION,
    YIELDING, YIELD_SHARE, NUMBER_COLUMNS,
) = range(SLOT_COLUMNS, SLOT_COLUMNS + len(NUMBER_TABLE) + 1)  # fmt: skip
# The tables as kernels take them: of a column of slots its part, the least, the most and the part that it counts, -1:
# none; of one of numbers its part; of numbers the lowest, the highest, and whether NaN may be.
SLOT_BOUNDS = np.array(
    [[PART_NAMES.index(c.part), c.low, c.high, PART_NAMES.index(c.of) if c.of else -1] for c in SLOT_TABLE], np.int64
)
TABLE: Slots = np.append(SLOT_BOUNDS.reshape(-1), [PART_NAMES.index(c.part) for c in NUMBER_TABLE]).astype(np.int64)
RANGES: Floats = np.array(
    [[c.within.lowest, c.within.high, c.usual is not None and math.isnan(c.usual)] for c in NUMBER_TABLE], np.float64
).reshape(-1)
