"""Bodies are made softer or firmer as a whole while they move."""

from dataclasses import dataclass
from typing import Annotated

from pydantic import Field

from sandbox.level.format.limits import FREQUENCY_RANGE, RATIO_LIMIT, SAG_LIMIT
from sandbox.session.commands.command import Command
from sandbox.session.commands.named import FormSlot
from sandbox.session.commands.ramping import Duration


@dataclass(frozen=True)
class SetFirmness(Command):
    """Set how soft a body is as a whole, whatever its grid, size and mass: by its sag, or by hz and ratio.

    For bodies whose form is stiff without pins. sag: part of its height by which it sags where it stands, 0 = rigid;
    hz, ratio: frequency [Hz] and damping ratio of its slowest wobble, ratio null = 0.15 or the least possible.
    It becomes so in `duration` ticks.
    """

    type = "set_firmness"
    body: FormSlot
    sag: Annotated[float, Field(ge=0.0, le=SAG_LIMIT)] | None = None
    hz: Annotated[float, Field(ge=FREQUENCY_RANGE[0], le=FREQUENCY_RANGE[1])] | None = None
    ratio: Annotated[float, Field(ge=0.0, le=RATIO_LIMIT)] | None = None
    duration: Duration = 0
