"""What tools share: pointer events in, commands out. No window, no pixels."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar, Literal, NamedTuple

from sandbox.level.document.model import Level
from sandbox.physics.analysis.query import nearest_particle
from sandbox.physics.snapshot import Snapshot
from sandbox.session.commands import Command

Point = tuple[float, float]
Loop = list[Point]

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


@dataclass(frozen=True)
class DropPicture:
    """A pale picture of what a click would add: a part by its name, or a level of the catalogue.

    size: of a part by name [m], of a level how many times as large as it was kept. colour: of a part by name.
    replaces_ghost: the ghost is drawn only where there is no picture.
    """

    part: str | Level
    size: float
    colour: str = ""
    replaces_ghost: bool = False


class Tool(ABC):
    """Turns pointer events over a snapshot into commands. Methods that are not abstract may stay as they are here.

    adds: it adds bodies to the world; touches: whether these touch other things. is_held: it goes on until it is
    released; others act at a press alone. place [m]: where the pointer is before a press; None: nowhere, or unknown.
    """

    adds: ClassVar[bool] = False
    is_held: ClassVar[bool] = True
    touches: bool = False
    place: Point | None = None

    @abstractmethod
    def handle(self, event: PointerEvent, snapshot: Snapshot) -> Response:
        """Answer one pointer event; the snapshot is of the present tick."""

    @abstractmethod
    def cancel(self) -> Response:
        """Give up what is being done, as Escape asks, and let go of everything."""

    def reconcile(self, snapshot: Snapshot) -> None:  # noqa: B027
        """Forget what the world no longer has; called when all commands handed out so far have been applied."""

    def take_up(self, size: float, height: float) -> None:  # noqa: B027
        """Begin to be in use. size [m]: a usual size for the view; height [m]: of the view."""

    @property
    def size_to_share(self) -> float | None:
        """The size [m] that the next tool with a size takes over; None: it has no such size."""
        return None

    def resize(self, steps: float) -> bool:
        """Make larger what the tool works with, by steps of the wheel; False: it has no size."""
        return False

    def hover(self, place: Point | None) -> None:
        """Know where the pointer is [m] before a press; None: it is over no world."""
        self.place = place

    def target(self, place: Point, within: float, snapshot: Snapshot) -> int | None:
        """The particle that a press at a place [m] would act on, within a distance [m], to mark it."""
        return nearest_particle(snapshot, place, within)

    @property
    def ghost(self) -> list[Loop]:
        """Lines [m] that show what a press would do; closed ones end where they begin."""
        return []

    @property
    def landing(self) -> Point | None:
        """Where [m] a click would put what it adds; None: nowhere."""
        return self.place

    @property
    def fits(self) -> bool:
        """Whether what it adds has room there."""
        return True

    @property
    def hint(self) -> str:
        """What is said beside the pointer, in a sentence; nothing as a rule."""
        return ""

    @property
    def preview(self) -> DropPicture | None:
        """A picture of what a click would add at `place`."""
        return None

    @property
    def trail(self) -> list[Point]:
        """The last points [m] of a stroke."""
        return []


class PlacedTool(Tool):
    """A tool that acts on a place: no particle is marked under the pointer."""

    def target(self, place: Point, within: float, snapshot: Snapshot) -> int | None:
        """None."""
        return None
