"""Settings of a running world are changed: its gravity, its air, its solver."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias

from pydantic import BeforeValidator

from sandbox.level.format.quantities import Drag, Gravity, Iterations, Share, Velocity
from sandbox.physics.settings import SUBSTEPS, SolverName, SubstepChoice, Substeps
from sandbox.session.commands.command import Command
from sandbox.session.commands.ramping import Duration

if TYPE_CHECKING:
    # Whatever their words say, names and numbers are checked when a command is carried out.
    SolverChoice: TypeAlias = str
    SubstepsChoice: TypeAlias = Substeps
else:
    SolverChoice, SubstepsChoice = SolverName, Annotated[SubstepChoice, BeforeValidator(lambda value: _plain(value))]


def _plain(value: Any) -> Any:
    """A choice as it is; nothing that is one of where it is true, or a number that only a text can hold."""
    return value if isinstance(value, str) or (type(value) is int and abs(value) <= SUBSTEPS[-1]) else ""


@dataclass(frozen=True)
class SetGravity(Command):
    """Set gravity [m/s^2], in `duration` ticks."""

    type = "set_gravity"
    gravity: Gravity
    duration: Duration = 0


@dataclass(frozen=True)
class SetAir(Command):
    """Set the wind [m/s], the drag [1/s] or both (None = leave), in `duration` ticks."""

    type = "set_air"
    wind: Velocity | None = None
    drag: Drag | None = None
    duration: Duration = 0


@dataclass(frozen=True)
class SetSolver(Command):
    """Set the solver or any of its settings (None = leave); substeps is a power of two or "auto".

    duration [ticks]: with another solver everything is soft at first, and has its Cs and Cd back after so many.
    """

    type = "set_solver"
    solver: SolverChoice | None = None
    iterations: Iterations | None = None
    substeps: SubstepsChoice | None = None
    warm_start: Share | None = None
    duration: Duration = 0
