"""Bodies are inflated."""

from dataclasses import dataclass

from sandbox.level.format.quantities import Inflation
from sandbox.physics.world import World
from sandbox.session.commands.command import Command
from sandbox.session.commands.named import BodySlot


@dataclass(frozen=True)
class SetInflation(Command):
    """Let a body's areas, the one of a ring or those of a jelly, want this multiple of their own."""

    type = "set_inflation"
    body: BodySlot
    value: Inflation

    def carry_out(self, world: World) -> None:
        world.inflate(self.body, self.value)
