"""CutTool: a stroke cuts every spring that it crosses, a click cuts the spring under it."""

from collections.abc import Callable

from sandbox.physics.analysis.query import nearest_spring, springs_crossing
from sandbox.physics.snapshot import Snapshot
from sandbox.session.commands import CutSprings
from sandbox.tools.tool import NOTHING, PlacedTool, PlayTool, Point, PointerEvent, Response, Submission

# Points of the stroke kept for drawing it.
TRAIL_LENGTH = 24


class CutTool(PlacedTool):
    """Cut springs; a whole stroke is one gesture."""

    def __init__(self, new_gesture: Callable[[], int]) -> None:
        super().__init__(new_gesture)
        self._trail: list[Point] = []
        self._gesture: int | None = None
        self._cut: set[int] = set()

    def handle(self, event: PointerEvent, snapshot: Snapshot) -> Response:
        """Begin, continue or end a stroke."""
        if event.kind == "down" and event.button == 1:
            self._gesture, self._cut, self._trail = self._new_gesture(), set(), [event.position]
            return self._cut_springs([nearest_spring(snapshot, event.position, event.pick_radius / 2)])
        if self._gesture is None:
            return NOTHING
        if event.kind == "move":
            crossed = springs_crossing(snapshot, self._trail[-1], event.position)
            self._trail = [*self._trail[-TRAIL_LENGTH + 1 :], event.position]
            return self._cut_springs([int(slot) for slot in crossed])
        if event.kind == "up" and event.button == 1:
            self.cancel()
        return NOTHING

    def cancel(self) -> Response:
        """End the stroke; cut springs stay cut."""
        self._gesture, self._trail = None, []
        return NOTHING

    @property
    def trail(self) -> list[Point]:
        """The last points [m] of the stroke, for drawing."""
        return self._trail

    def _cut_springs(self, found: list[int | None]) -> Response:
        fresh = tuple(slot for slot in found if slot is not None and slot not in self._cut)
        if not fresh or self._gesture is None:
            return NOTHING
        self._cut.update(fresh)
        return Response((Submission(CutSprings(fresh), self._gesture),))


CUT = PlayTool("cut", ("C", "3"), "Cut tool: a stroke cuts what it crosses", "Tools", CutTool, "cut")
