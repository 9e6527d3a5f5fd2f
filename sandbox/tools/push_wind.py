"""PushTool and WindTool: a click bursts what is near apart, an arrow pushes it; a drag holds the wind."""

import math
from collections.abc import Callable

from sandbox.physics.analysis.query import shown_particles
from sandbox.physics.snapshot import Snapshot
from sandbox.session.commands import Push, SetAir
from sandbox.tools.dropping import ROUND
from sandbox.tools.tool import (
    CLICK_SHARE,
    NOTHING,
    Loop,
    PlacedTool,
    PlayTool,
    Point,
    PointerEvent,
    Response,
    Sized,
    Submission,
)

# Speed [m/s] that a click gives what is near, on the average, and a push for each radius that its arrow is long.
BURST_SPEED, ARROW_SPEED = 4.0, 4.0
# Wind speed [m/s] of a drag over the whole height of the view.
WIND_SPEED = 40.0
# The least drag [1/s] of an air that moves things.
LEAST_DRAG = 0.8
# The head of an arrow: its length as a share of the arrow's, and its half angle [rad].
HEAD, SPREAD = 0.25, 0.45


def arrow(start: Point, end: Point) -> list[Loop]:
    """Lines of an arrow."""
    dx, dy = start[0] - end[0], start[1] - end[1]
    tips = []
    for turn in (SPREAD, -SPREAD):
        c, s = math.cos(turn) * HEAD, math.sin(turn) * HEAD
        tips.append((end[0] + c * dx - s * dy, end[1] + s * dx + c * dy))
    return [[start, end], [tips[0], end, tips[1]]]


class PushTool(Sized, PlacedTool):
    """Push what is within the ring; size [m] is its radius. Each push is a gesture.

    A click drives all that is near away from the place; a drag pushes along its arrow, the harder the longer it is.
    """

    def __init__(self, new_gesture: Callable[[], int]) -> None:
        super().__init__(new_gesture)
        self._pressed_at: Point | None = None

    def handle(self, event: PointerEvent, snapshot: Snapshot) -> Response:
        """Follow the pointer; push on the release."""
        self.place = event.position
        if event.kind == "down" and event.button == 1:
            self._pressed_at = event.position
        if self._pressed_at is None or event.kind != "up" or event.button != 1:
            return NOTHING
        at, self._pressed_at = self._pressed_at, None
        away = snapshot.position - at
        near = shown_particles(snapshot) & (snapshot.inverse_mass > 0.0)
        near &= away[:, 0] * away[:, 0] + away[:, 1] * away[:, 1] < self.size * self.size
        mass = float(snapshot.mass[near].sum())
        if mass == 0.0:
            return Response(message="There is nothing to push within the ring.")
        dx, dy = event.position[0] - at[0], event.position[1] - at[1]
        if math.hypot(dx, dy) <= CLICK_SHARE * event.pick_radius:
            command = Push(at, self.size, outward=BURST_SPEED * mass)
        else:
            speed = ARROW_SPEED / self.size
            command = Push(at, self.size, (speed * dx * mass, speed * dy * mass))
        return Response((Submission(command, self._new_gesture()),))

    @property
    def ghost(self) -> list[Loop]:
        """The ring [m], and the arrow while it is drawn."""
        if self.place is None:
            return []
        x, y = self._pressed_at or self.place
        turns = [2.0 * math.pi * k / ROUND for k in range(ROUND + 1)]
        ring = [(x + self.size * math.cos(turn), y + self.size * math.sin(turn)) for turn in turns]
        return [ring, *(arrow((x, y), self.place) if self._pressed_at not in (None, self.place) else [])]

    def cancel(self) -> Response:
        """Push nothing."""
        self._pressed_at = self.place = None
        return NOTHING


class WindTool(PlacedTool):
    """Blows wind along a drag while it is held; strength [1/s]: its speed for each metre of the drag."""

    def __init__(self, new_gesture: Callable[[], int]) -> None:
        super().__init__(new_gesture)
        self.strength = 4.0
        self._gesture: int | None = None
        self._pressed_at: Point = (0.0, 0.0)
        self._place: Point = (0.0, 0.0)
        self._before = SetAir((0.0, 0.0), 0.0)

    def handle(self, event: PointerEvent, snapshot: Snapshot) -> Response:
        """Begin, turn or end the wind."""
        if event.kind == "down" and event.button == 1:
            settings = snapshot.settings
            self._gesture, self._pressed_at = self._new_gesture(), event.position
            self._before = SetAir(settings.wind, settings.drag)
        self._place = event.position
        if self._gesture is None:
            return NOTHING
        if event.kind == "up" and event.button == 1:
            return self.cancel()
        wind = tuple(self.strength * (event.position[axis] - self._pressed_at[axis]) for axis in range(2))
        drag = max(self._before.drag or 0.0, LEAST_DRAG)
        return Response((Submission(SetAir((wind[0], wind[1]), drag), self._gesture),))

    def take_up(self, size: float, height: float) -> None:
        """A drag over all of the view makes the strongest wind."""
        self.strength = WIND_SPEED / height

    @property
    def ghost(self) -> list[Loop]:
        """An arrow [m] along the wind."""
        return [] if self._gesture is None or self._place == self._pressed_at else arrow(self._pressed_at, self._place)

    def cancel(self) -> Response:
        """Switch the wind off again."""
        gesture, self._gesture = self._gesture, None
        return NOTHING if gesture is None else Response((Submission(self._before, gesture),))


PUSH = PlayTool("push", ("0",), "Push: click bursts, drag pushes", "Parts", PushTool, "push")
WIND = PlayTool("wind", ("V",), "Wind: it blows along a drag", "Parts", WindTool, "air")
