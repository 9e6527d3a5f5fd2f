"""Things are pushed."""

from dataclasses import dataclass
from typing import Annotated

from pydantic import Field

from sandbox.level.format.limits import FORCE_LIMIT
from sandbox.level.format.quantities import Point, Size, unit
from sandbox.session.commands.command import Command

# The hardest push [N s]: more than anything bears.
HARDEST_PUSH = FORCE_LIMIT
Impulse = Annotated[float, Field(ge=-HARDEST_PUSH, le=HARDEST_PUSH, json_schema_extra=unit("N s"))]


@dataclass(frozen=True)
class Push(Command):
    """Push the free particles within radius [m] of position [m].

    Together they get the momentum `impulse` [N s]. Each is also driven straight away from the position, by `outward`
    [N s] in sum. The nearer a particle is, the more its velocity changes.
    """

    type = "push"
    position: Point
    radius: Size
    impulse: tuple[Impulse, Impulse] = (0.0, 0.0)
    outward: Impulse = 0.0
