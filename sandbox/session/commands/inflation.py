"""Bodies are inflated."""

from dataclasses import dataclass

from sandbox.level.format.quantities import Inflation
from sandbox.session.commands.command import Command
from sandbox.session.commands.named import BodySlot
from sandbox.session.commands.ramping import Duration


@dataclass(frozen=True)
class SetInflation(Command):
    """Let a body's areas, the one of a ring or those of a jelly, want this multiple of their own.

    They come to it in `duration` ticks.
    """

    type = "set_inflation"
    body: BodySlot
    value: Inflation
    duration: Duration = 0
