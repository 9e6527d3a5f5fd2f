"""Commands: everything that a person or a script can do to a running world, as data in metres and slots.

A command is one class in one file of this folder, see command.py; every file here is found by itself. Names of commands
and of their fields are part of the replay format and are never reused.
"""

import importlib
import pkgutil

from sandbox.session.commands.adding import AddParticle, AddSpring
from sandbox.session.commands.command import COMMAND_TYPES, Command, CommandError, apply
from sandbox.session.commands.cutting import CutSprings
from sandbox.session.commands.driving import SetDrive
from sandbox.session.commands.firmness import SetFirmness
from sandbox.session.commands.freeing import Free
from sandbox.session.commands.grabbing import Grab, MoveGrab, Release
from sandbox.session.commands.history import Redo, Undo
from sandbox.session.commands.inflation import SetInflation
from sandbox.session.commands.joining import AddBody
from sandbox.session.commands.keys import HoldKey
from sandbox.session.commands.materials import ScaleMass, SetCoefficients
from sandbox.session.commands.moving import MoveBody
from sandbox.session.commands.painting import SetColour
from sandbox.session.commands.pinning import Pin, Unpin
from sandbox.session.commands.pushing import Push
from sandbox.session.commands.removing import Remove
from sandbox.session.commands.shaking import Shake
from sandbox.session.commands.world_settings import SetAir, SetGravity, SetSolver

__all__ = [
    "COMMAND_TYPES",
    "AddBody",
    "AddParticle",
    "AddSpring",
    "Command",
    "CommandError",
    "CutSprings",
    "Free",
    "Grab",
    "HoldKey",
    "MoveBody",
    "MoveGrab",
    "Pin",
    "Push",
    "Redo",
    "Release",
    "Remove",
    "ScaleMass",
    "SetAir",
    "SetCoefficients",
    "SetColour",
    "SetDrive",
    "SetFirmness",
    "SetGravity",
    "SetInflation",
    "SetSolver",
    "Shake",
    "Undo",
    "Unpin",
    "apply",
]

for _module in pkgutil.iter_modules(__path__):
    importlib.import_module(f"{__name__}.{_module.name}")
