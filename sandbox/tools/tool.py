"""What tools share: pointer events in, commands out. No window, no pixels."""

from dataclasses import dataclass
from typing import Literal, NamedTuple, Protocol

from sandbox.physics.snapshot import Snapshot
from sandbox.session.commands import Command

Point = tuple[float, float]

# A press that moves less than this share of the pick radius is a click.
CLICK_SHARE = 0.35


@dataclass(frozen=True)
class PointerEvent:
    """A pointer pressed, moved or released at position [m]; pick_radius [m]: how far off still counts as a hit.

    seconds: when, by any clock. paused: whether time stands.
    """

    kind: Literal["down", "move", "up"]
    position: Point
    pick_radius: float
    button: int = 1
    shift: bool = False
    ctrl: bool = False
    seconds: float = 0.0
    paused: bool = False


class Submission(NamedTuple):
    """A command and the gesture that it belongs to, for Session.submit."""

    command: Command
    gesture: int


@dataclass(frozen=True)
class Response:
    """What a tool makes of an event: commands in order, and a line for the person where something cannot be done."""

    submissions: tuple[Submission, ...] = ()
    message: str | None = None


NOTHING = Response()


class Tool(Protocol):
    """Turns pointer events over a snapshot into commands."""

    def handle(self, event: PointerEvent, snapshot: Snapshot) -> Response:
        """Answer one pointer event; the snapshot is of the present tick."""
        ...

    def cancel(self) -> Response:
        """Give up what is being done, as Escape asks, and let go of everything."""
        ...

    def reconcile(self, snapshot: Snapshot) -> None:
        """Forget what the world no longer has; called when all commands handed out so far have been applied."""
        ...
