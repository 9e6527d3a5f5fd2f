"""Commands: all that a person or a script can do to a running world, as values and as the JSON objects of files.

`Session.submit(command)` queues one; `docs/commands.md` lists them as files have them.
"""

from sandbox.session.commands import (
    COMMAND_TYPES,
    AddParticle,
    AddSpring,
    Command,
    CommandError,
    CutSprings,
    Free,
    Grab,
    MoveGrab,
    Pin,
    Redo,
    Release,
    SetAir,
    SetCoefficients,
    SetDrive,
    SetFirmness,
    SetGravity,
    SetInflation,
    SetSolver,
    Undo,
    Unpin,
    apply,
)
from sandbox.session.commands.records import ScriptLine, from_record, to_record
from sandbox.session.replay.script import read_script

__all__ = [
    "COMMAND_TYPES",
    "AddParticle",
    "AddSpring",
    "Command",
    "CommandError",
    "CutSprings",
    "Free",
    "Grab",
    "MoveGrab",
    "Pin",
    "Redo",
    "Release",
    "ScriptLine",
    "SetAir",
    "SetCoefficients",
    "SetDrive",
    "SetFirmness",
    "SetGravity",
    "SetInflation",
    "SetSolver",
    "Undo",
    "Unpin",
    "apply",
    "from_record",
    "read_script",
    "to_record",
]
