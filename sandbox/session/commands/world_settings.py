"""Settings of a running world are changed: its gravity, its air, its solver."""

from dataclasses import asdict, dataclass, replace
from typing import Annotated

from pydantic import Field

from sandbox.level.format.quantities import Drag, Gravity, Share, Velocity
from sandbox.physics.changing.ramping import firm_up
from sandbox.physics.settings import Substeps
from sandbox.physics.world import World
from sandbox.session.commands.command import Command, CommandError
from sandbox.session.commands.ramping import Duration


@dataclass(frozen=True)
class SetGravity(Command):
    """Set gravity [m/s^2], in `duration` ticks."""

    type = "set_gravity"
    gravity: Gravity
    duration: Duration = 0

    def carry_out(self, world: World) -> None:
        world.set_gravity(self.gravity, self.duration)


@dataclass(frozen=True)
class SetAir(Command):
    """Set the wind [m/s], the drag [1/s] or both (None = leave), in `duration` ticks."""

    type = "set_air"
    wind: Velocity | None = None
    drag: Drag | None = None
    duration: Duration = 0

    def carry_out(self, world: World) -> None:
        world.set_air(self.wind, self.drag, self.duration)


@dataclass(frozen=True)
class SetSolver(Command):
    """Set the solver or any of its settings (None = leave); substeps is a power of two or "auto".

    duration [ticks]: with another solver everything is soft at first, and has its Cs and Cd back after so many.
    """

    type = "set_solver"
    solver: str | None = None
    iterations: Annotated[int, Field(ge=1, le=1000)] | None = None
    substeps: Substeps | None = None
    warm_start: Share | None = None
    duration: Duration = 0

    def carry_out(self, world: World) -> None:
        before = world.settings
        given = {name: value for name, value in asdict(self).items() if value is not None and name != "duration"}
        try:
            world.settings = replace(before, **given)
        except ValueError as error:
            raise CommandError(str(error)) from None
        if self.duration and world.settings.solver != before.solver:
            firm_up(world, self.duration)
