"""Things are moved to another place, as with a hand while time stands."""

from dataclasses import dataclass
from typing import Annotated

from pydantic import Field

from sandbox.level.format.limits import COORDINATE_LIMIT
from sandbox.level.format.quantities import unit
from sandbox.session.commands.command import Command
from sandbox.session.commands.named import ParticleSlot

Way = Annotated[float, Field(ge=-COORDINATE_LIMIT, le=COORDINATE_LIMIT, json_schema_extra=unit("m"))]


@dataclass(frozen=True)
class MoveBody(Command):
    """Move all that hangs together with a particle, its pins too, by a way [m], at once.

    at_rest: it stands still there; else its velocity stays.
    """

    type = "move_body"
    particle: ParticleSlot
    by: tuple[Way, Way]
    at_rest: bool = False
