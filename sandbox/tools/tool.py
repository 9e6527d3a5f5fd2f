"""What tools share: pointer events in, commands out. No window, no pixels. PlayTool: what the window knows of one."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable
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
# A step of the wheel makes it this many times larger; sizes [m] that it may have.
SIZE_STEP, SMALLEST, LARGEST = 1.1, 0.02, 100.0
# The part of the view's height that it is at first.
SIZE_SHARE = 0.12
# Where the page of all shortcuts has a tool; those of "Parts" are buttons of the strip at the left, too.
Group = Literal["Tools", "Parts"]


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
    """A tool's answer to an event: commands in order, and a line for the person where something cannot be done."""

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

    new_gesture: gives the number of a new gesture.
    adds: it adds bodies to the world; touches: whether these touch other things. is_held: it goes on until it is
    released; others act at a press alone. place [m]: where the pointer is before a press; None: nowhere, or unknown.
    """

    adds: ClassVar[bool] = False
    is_held: ClassVar[bool] = True
    touches: bool = False
    place: Point | None = None
    _refusal: str = ""

    def __init__(self, new_gesture: Callable[[], int]) -> None:
        self._new_gesture = new_gesture

    @abstractmethod
    def handle(self, event: PointerEvent, snapshot: Snapshot) -> Response:
        """Answer one pointer event; the snapshot is of the present tick."""

    def _in_one_gesture(self, commands: Iterable[Command]) -> Response:
        """Commands that make up a gesture of their own."""
        gesture = self._new_gesture()
        return Response(tuple(Submission(command, gesture) for command in commands))

    def cancel(self) -> Response:
        """Give up what is being done, as Escape asks, and let go of everything."""
        self._refusal = ""
        return NOTHING

    def reconcile(self, snapshot: Snapshot) -> None:  # noqa: B027
        """Forget what the world no longer has; called when all commands handed out so far have been applied."""

    def take_up(self, size: float, height: float) -> None:  # noqa: B027
        """Prepare for use. size [m]: a usual size for the view; height [m]: of the view."""

    @property
    def size_to_share(self) -> float | None:
        """The size [m] that the next tool with a size takes over; None: it has no such size."""
        return None

    def resize(self, steps: float) -> bool:
        """Make larger what the tool works with, by steps of the wheel; False: it has no size."""
        return False

    def hover(self, place: Point | None) -> None:
        """Note the place of the pointer [m] before a press; None: it is over no world."""
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
        """Where [m] a click would put the new part; None: nowhere."""
        return self.place

    @property
    def fits(self) -> bool:
        """Whether the new part has room there."""
        return True

    @property
    def hint(self) -> str:
        """A sentence beside the pointer: why the last press did nothing, or what one would do."""
        return self._refusal

    @property
    def is_refused(self) -> bool:
        """Whether the last press did nothing."""
        return bool(self._refusal)

    @property
    def preview(self) -> DropPicture | None:
        """A picture of the new part at `place`."""
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


class Sized:
    """A tool that works at a size [m], which it hands on to the next such tool."""

    size: float = 1.0

    def take_up(self, size: float, height: float) -> None:
        """Begin at a size that the view has room for."""
        self.size = size

    @property
    def size_to_share(self) -> float | None:
        """The size [m]."""
        return self.size

    def resize(self, steps: float) -> bool:
        """Make the new part larger, by steps of the wheel."""
        self.size = resized(self.size, steps)
        return True


def resized(size: float, steps: float) -> float:
    """A size made larger by this many steps of the wheel."""
    return min(max(size * SIZE_STEP**steps, SMALLEST), LARGEST)


def usual_size(height: float) -> float:
    """How large [m] things are at first in a view of a height [m]."""
    return float(f"{SIZE_SHARE * height:.2g}")


@dataclass(frozen=True)
class PlayTool:
    """A tool in play: its name, the keys that take it up, its line on the help page and in its tip, and its group.

    make: the tool, for a function that gives the number of a new gesture. Its icon is the file of its name in
    assets/icons, unless the strip has a picture of its own for it.
    deed: what hands do with it, which a level may keep away.
    """

    name: str
    keys: tuple[str, ...]
    label: str
    group: Group
    make: Callable[[Callable[[], int]], Tool]
    deed: str = ""

    @property
    def action(self) -> str:
        """The action that takes the tool up."""
        return f"tool_{self.name}"
