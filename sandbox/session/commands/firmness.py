"""Bodies are made softer or firmer as a whole while they move."""

from dataclasses import dataclass

from sandbox.level.format.quantities import DampingRatio, Frequency, Sag
from sandbox.session.commands.command import Command
from sandbox.session.commands.named import FormSlot
from sandbox.session.commands.ramping import Duration


@dataclass(frozen=True)
class SetFirmness(Command):
    """Set how soft a body is as a whole, whatever its grid, size and mass: by its sag, or by hz and ratio.

    For bodies whose form is stiff without pins. sag: part of its height by which a square as high, and of the same
    slowest wobble, sags where it stands, 0 = rigid; FirmnessRange says what wobble makes a body itself sag so far.
    hz, ratio: frequency [Hz] and damping ratio of its slowest wobble, ratio null = 0.15 or the least possible.
    It becomes so in `duration` ticks.
    """

    type = "set_firmness"
    body: FormSlot
    sag: Sag | None = None
    hz: Frequency | None = None
    ratio: DampingRatio | None = None
    duration: Duration = 0
