"""Dropping: a click drops a part under the pointer, a drag throws it."""

from collections.abc import Callable
from functools import partial

from sandbox.level.document.model import Level
from sandbox.level.format.quantities import significant
from sandbox.physics.snapshot import Snapshot
from sandbox.session.commands import Command
from sandbox.tools.clearance import lift
from sandbox.tools.parts import COLOURS, PARTS, in_pace
from sandbox.tools.play_tool import PlayTool
from sandbox.tools.sizing import SMALLEST, Sized, resized
from sandbox.tools.tool import (
    CLICK_SHARE,
    NOTHING,
    DropPicture,
    Loop,
    PlacedTool,
    Point,
    PointerEvent,
    Response,
    Submission,
)

# What the pointer did in this last part of a drag decides how fast the part flies [s]; longer makes throws sluggish.
THROW_SECONDS = 0.08
# The fastest throw [m/s]: beyond it a part passes through walls of other parts.
FASTEST_THROW = 25.0
# What is said where a part has no room.
NO_ROOM = "There is no room for it here. Click where it is free, or make it smaller with the wheel."
# Significant digits of how many times as large a part of the catalogue is: turned back, the wheel comes to 1 again.
TIMES_DIGITS = 4


class ThrowTool(PlacedTool):
    """Drops or throws what subclasses make. Each drop is a gesture."""

    adds = True

    def __init__(self, new_gesture: Callable[[], int]) -> None:
        self._new_gesture = new_gesture
        self._snapshot: Snapshot | None = None
        self._landing: tuple[object, Point | None] = (None, None)
        self._pressed_at: Point | None = None
        self._trail: list[tuple[float, Point]] = []

    def made(self, place: Point, velocity: Point, snapshot: Snapshot) -> tuple[Command, ...]:
        """The commands that add it at a place [m], with a velocity [m/s]. Raises ValueError, with one line."""
        raise NotImplementedError

    def outline(self, place: Point) -> list[Loop]:
        """Lines [m] around what is dropped at a place [m]; closed ones end where they begin."""
        raise NotImplementedError

    def reconcile(self, snapshot: Snapshot) -> None:
        """Know what is in the way."""
        self._snapshot = snapshot

    @property
    def landing(self) -> Point | None:
        """Where a click drops: on what is below the pointer; None: there is no room, or no pointer."""
        return None if self.place is None else self._landing_at(self.place, self._snapshot)

    @property
    def fits(self) -> bool:
        """Whether a click drops something at the pointer."""
        return self.place is None or self.landing is not None

    def _landing_at(self, place: Point, snapshot: Snapshot | None) -> Point | None:
        if not self.touches or snapshot is None:
            return place
        outline = self.outline(place)
        key = outline, snapshot.tick, len(snapshot.mass)
        if self._landing[0] != key:
            by = lift(outline, snapshot)
            self._landing = key, None if by is None else (place[0], place[1] + by)
        return self._landing[1]

    @property
    def ghost(self) -> list[Loop]:
        """Lines [m] of what would be dropped; closed ones end where they begin."""
        place = self.landing or self.place
        return [] if place is None else self.outline(place)

    def handle(self, event: PointerEvent, snapshot: Snapshot) -> Response:
        """Follow the pointer; drop on the release."""
        self.place = event.position
        if event.kind == "down" and event.button == 1:
            self._pressed_at, self._trail = event.position, []
        if self._pressed_at is None:
            return NOTHING
        self._trail.append((event.seconds, event.position))
        if event.kind != "up" or event.button != 1:
            return NOTHING
        velocity = self._thrown(event)
        self._pressed_at = None
        landing = self._landing_at(event.position, snapshot)
        if landing is None:
            return Response(message=NO_ROOM)
        try:
            commands = self.made(landing, velocity, snapshot)
        except ValueError as error:
            return Response(message=f"{error}.")
        gesture = self._new_gesture()
        return Response(tuple(Submission(command, gesture) for command in commands))

    def _thrown(self, event: PointerEvent) -> Point:
        """The velocity [m/s] of the pointer in the last moment."""
        assert self._pressed_at is not None
        dx, dy = event.position[0] - self._pressed_at[0], event.position[1] - self._pressed_at[1]
        recent = [(when, at) for when, at in self._trail if when >= event.seconds - THROW_SECONDS]
        began, start = recent[0]
        if dx * dx + dy * dy <= (CLICK_SHARE * event.pick_radius) ** 2 or event.seconds <= began:
            return 0.0, 0.0
        vx, vy = ((event.position[axis] - start[axis]) / (event.seconds - began) for axis in range(2))
        share = min(1.0, FASTEST_THROW / max((vx * vx + vy * vy) ** 0.5, 1e-9))
        return share * vx, share * vy

    def cancel(self) -> Response:
        """Drop nothing."""
        self._pressed_at = self.place = None
        return NOTHING


class DropTool(Sized, ThrowTool):
    """Drop the part of that name; size [m]. Parts take the toys' colours in turn."""

    def __init__(self, new_gesture: Callable[[], int], part: str) -> None:
        super().__init__(new_gesture)
        self.part, self.size = PARTS[part], 1.0
        self.count = 0

    def made(self, place: Point, velocity: Point, snapshot: Snapshot) -> tuple[Command, ...]:
        """The part in its present size."""
        made = self.part.make(self.size, place, velocity, self.colour)
        self.count += 1
        return (in_pace(made, snapshot.settings.tick_rate),)

    @property
    def colour(self) -> str:
        """The colour of what is dropped next."""
        return COLOURS[self.count % len(COLOURS)]

    @property
    def preview(self) -> DropPicture | None:
        """The part in its present size and colour."""
        return DropPicture(self.part.name, self.size, self.colour)

    def outline(self, place: Point) -> list[Loop]:
        """Lines [m] of the part in its present size."""
        x, y = place
        loops = [[(x + self.size * px, y + self.size * py) for px, py in loop] for loop in self.part.ghost]
        return [[*loop, loop[0]] if self.part.solid else loop for loop in loops]


class CatalogueTool(ThrowTool):
    """Drop a part of the catalogue; make: see `made`, with how many times as large; box: width and height [m] as kept.

    times: how many times as large as it was kept the part is.
    """

    def __init__(
        self, new_gesture: Callable[[], int], part: Level,
        make: Callable[[Point, Point, float], tuple[Command, ...]], box: Point,
    ) -> None:  # fmt: skip
        super().__init__(new_gesture)
        self.part, self._make, self._box = part, make, box
        self._size = max(*box, SMALLEST)
        self.times = 1.0

    def made(self, place: Point, velocity: Point, snapshot: Snapshot) -> tuple[Command, ...]:
        """The part in its present size."""
        return self._make(place, velocity, self.times)

    def resize(self, steps: float) -> bool:
        """Make the part larger."""
        kept = max(*self._box, SMALLEST)
        self._size = resized(self._size, steps)
        self.times = significant(self._size / kept, TIMES_DIGITS)
        return True

    @property
    def preview(self) -> DropPicture | None:
        """The part in its present size."""
        return DropPicture(self.part, self.times, replaces_ghost=True)

    def outline(self, place: Point) -> list[Loop]:
        """The box [m] around the part in its present size."""
        (x, y), (width, height) = place, (self.times * side for side in self._box)
        corners = ((-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5), (-0.5, -0.5))
        return [[(x + dx * width, y + dy * height) for dx, dy in corners]]


# Keys and lines of the parts.
_LINES = {
    "ball": ("4", "Ball: click drops it, drag throws it"), "box": ("5", "Box"), "jelly": ("6", "Jelly"),
    "rope": ("7", "Rope"), "balloon": ("8", "Balloon"), "cart": ("9", "Cart: Q and W drive it"),
}  # fmt: skip
DROPS = tuple(
    PlayTool(part, (_LINES[part][0],), _LINES[part][1], "Parts", partial(DropTool, part=part), "add") for part in PARTS
)
