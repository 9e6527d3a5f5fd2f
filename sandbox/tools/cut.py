"""CutTool: a stroke cuts every spring that it crosses, a click cuts the spring under it."""

from collections.abc import Callable

from sandbox.physics.analysis.query import nearest_spring, springs_crossing
from sandbox.physics.snapshot import Snapshot
from sandbox.session.commands import CutSprings
from sandbox.tools.tool import NOTHING, Point, PointerEvent, Response, Submission

# Points of the stroke kept for drawing it.
TRAIL_LENGTH = 24


class CutTool:
    """Cut springs; a whole stroke is one gesture. trail: the stroke's last points [m], for drawing."""

    def __init__(self, new_gesture: Callable[[], int]) -> None:
        self.trail: list[Point] = []
        self._new_gesture = new_gesture
        self._gesture: int | None = None
        self._cut: set[int] = set()

    def handle(self, event: PointerEvent, snapshot: Snapshot) -> Response:
        """Begin, continue or end a stroke."""
        if event.kind == "down" and event.button == 1:
            self._gesture, self._cut, self.trail = self._new_gesture(), set(), [event.position]
            return self._cut_springs([nearest_spring(snapshot, event.position, event.pick_radius / 2)])
        if self._gesture is None:
            return NOTHING
        if event.kind == "move":
            crossed = springs_crossing(snapshot, self.trail[-1], event.position)
            self.trail = [*self.trail[-TRAIL_LENGTH + 1 :], event.position]
            return self._cut_springs([int(slot) for slot in crossed])
        if event.kind == "up" and event.button == 1:
            self.cancel()
        return NOTHING

    def cancel(self) -> Response:
        """End the stroke; what is cut stays cut."""
        self._gesture, self.trail = None, []
        return NOTHING

    def reconcile(self, snapshot: Snapshot) -> None:
        """Nothing in a stroke can vanish: cut springs are only remembered so as not to be cut twice."""

    def _cut_springs(self, found: list[int | None]) -> Response:
        fresh = tuple(slot for slot in found if slot is not None and slot not in self._cut)
        if not fresh or self._gesture is None:
            return NOTHING
        self._cut.update(fresh)
        return Response((Submission(CutSprings(fresh), self._gesture),))
