"""Commands: everything that a person or a script can do to a running world, as data in metres and slots.

A command is a frozen value. `apply` is the one dispatcher; `to_record` and `from_record` turn a command into the JSON
object of a replay file, where particles, springs and materials go by name, and back.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, fields
from typing import Any

from sandbox.physics.solvers import SOLVERS
from sandbox.physics.world import HAND_COUNT, World

# Limits of what a command may ask for; those of the level format.
COORDINATE_LIMIT = 1e6  # [m]
GRAVITY_LIMIT = 1e6  # [m/s^2]
MASS_RANGE = (1e-9, 1e9)  # [kg]
PARTICLE_LIMIT = 100_000
SPRING_LIMIT = 400_000

Point = tuple[float, float]


class CommandError(ValueError):
    """A command that cannot be carried out in this world; its text is one line for a person."""


@dataclass(frozen=True)
class Grab:
    """Hold a particle with hand number `grab` (0..9) at target [m]."""

    grab: int
    particle: int
    target: Point


@dataclass(frozen=True)
class MoveGrab:
    """Move a hand that holds something to target [m]."""

    grab: int
    target: Point


@dataclass(frozen=True)
class Release:
    """Let go of what a hand holds."""

    grab: int


@dataclass(frozen=True)
class Pin:
    """Hold a particle where it is."""

    particle: int


@dataclass(frozen=True)
class Unpin:
    """Let a pinned particle move."""

    particle: int


@dataclass(frozen=True)
class CutSprings:
    """Take springs out of the world."""

    springs: tuple[int, ...]


@dataclass(frozen=True)
class AddParticle:
    """Add a particle at position [m], of mass [kg] and radius [m]; it is named +.0, +.1, ... in order of adding."""

    position: Point
    mass: float = 1.0
    radius: float = 0.05
    pinned: bool = False


@dataclass(frozen=True)
class AddSpring:
    """Add a spring between two particles; rest_length [m], None = as placed; it is named +:0, +:1, ..."""

    particle_a: int
    particle_b: int
    rest_length: float | None = None
    stiffness: float = 0.5
    damping: float = 0.9


@dataclass(frozen=True)
class SetCoefficients:
    """Set Cs, Cd or both (None = leave), of one material by index or of all (None)."""

    stiffness: float | None = None
    damping: float | None = None
    material: int | None = None


@dataclass(frozen=True)
class SetGravity:
    """Set gravity [m/s^2]."""

    gravity: Point


@dataclass(frozen=True)
class SetSolver:
    """Set the solver or any of its settings (None = leave)."""

    solver: str | None = None
    iterations: int | None = None
    substeps: int | None = None
    warm_start: float | None = None


@dataclass(frozen=True)
class Undo:
    """Take the last gesture back, as if it had never been made; carried out by the session."""


@dataclass(frozen=True)
class Redo:
    """Make the gesture again that was undone last; carried out by the session."""
