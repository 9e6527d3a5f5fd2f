"""Bodies: what a level is made of, to make one in Python, and `write_level` to keep it.

Each class is one JSON object of a level file, with the same fields, defaults and limits: see `docs/level-format.md`.
Values are validated where they are made: tuples for lists, and ValidationError (a ValueError) for what is wrong.
"""

from sandbox.level.checks import CheckDef
from sandbox.level.document.model import (
    ContactsDef,
    HookeMaterial,
    Level,
    NissenMaterial,
    ParticleDef,
    Settings,
    SpringDef,
    TerrainDef,
    WallsDef,
)
from sandbox.level.format.actuator_defs import HydraulicDef, MotorDef, MuscleDef
from sandbox.level.format.level_error import LevelError
from sandbox.level.format.limits import FORMAT, VERSION
from sandbox.level.kinds.body_def import BendingDef
from sandbox.level.kinds.bridge import BridgeDef
from sandbox.level.kinds.girder import GirderDef
from sandbox.level.kinds.jelly import BoxShape, CircleShape, JellyDef, PolygonShape
from sandbox.level.kinds.mesh import MeshDef
from sandbox.level.kinds.ring import RingDef
from sandbox.level.kinds.rope import RopeDef
from sandbox.level.kinds.web import WebDef
from sandbox.level.kinds.wheel import WheelDef
from sandbox.level.reading.files import parse_level, write_level

__all__ = [
    "FORMAT",
    "VERSION",
    "BendingDef",
    "BoxShape",
    "BridgeDef",
    "CheckDef",
    "CircleShape",
    "ContactsDef",
    "GirderDef",
    "HookeMaterial",
    "HydraulicDef",
    "JellyDef",
    "Level",
    "LevelError",
    "MeshDef",
    "MotorDef",
    "MuscleDef",
    "NissenMaterial",
    "ParticleDef",
    "PolygonShape",
    "RingDef",
    "RopeDef",
    "Settings",
    "SpringDef",
    "TerrainDef",
    "WallsDef",
    "WebDef",
    "WheelDef",
    "parse_level",
    "write_level",
]
