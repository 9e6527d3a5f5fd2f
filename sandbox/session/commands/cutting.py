"""Springs are cut."""

from dataclasses import dataclass
from typing import Annotated

from pydantic import Field

from sandbox.session.commands.command import Command
from sandbox.session.commands.named import SpringSlot

ShareOfSpring = Annotated[float, Field(ge=0.0, le=1.0)]


@dataclass(frozen=True)
class CutSprings(Command):
    """Take springs out of the world.

    at: where each is cut, as a share of it from its first end. Bodies of triangles are parted along the line through
    these places. Without it they lose every triangle that a spring is a side of.
    """

    type = "cut_springs"
    springs: tuple[SpringSlot, ...]
    at: tuple[ShareOfSpring, ...] = ()
