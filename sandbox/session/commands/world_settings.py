"""Settings of a running world are changed: its gravity, its air, its solver."""

from dataclasses import asdict, dataclass, replace
from typing import Annotated

from pydantic import Field

from sandbox.level.format.quantities import Drag, Gravity, Share, Velocity
from sandbox.physics.settings import Substeps
from sandbox.physics.world import World
from sandbox.session.commands.command import Command, CommandError


@dataclass(frozen=True)
class SettingsCommand(Command):
    """A command whose fields are settings of the world, by their names there (None = leave)."""

    def carry_out(self, world: World) -> None:
        given = {name: value for name, value in asdict(self).items() if value is not None}
        try:
            world.settings = replace(world.settings, **given)
        except ValueError as error:
            raise CommandError(str(error)) from None


@dataclass(frozen=True)
class SetGravity(SettingsCommand):
    """Set gravity [m/s^2]."""

    type = "set_gravity"
    gravity: Gravity


@dataclass(frozen=True)
class SetAir(SettingsCommand):
    """Set the wind [m/s], the drag [1/s] or both (None = leave)."""

    type = "set_air"
    wind: Velocity | None = None
    drag: Drag | None = None


@dataclass(frozen=True)
class SetSolver(SettingsCommand):
    """Set the solver or any of its settings (None = leave); substeps is a power of two or "auto"."""

    type = "set_solver"
    solver: str | None = None
    iterations: Annotated[int, Field(ge=1, le=1000)] | None = None
    substeps: Substeps | None = None
    warm_start: Share | None = None
