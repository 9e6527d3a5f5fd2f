"""CutTool: a stroke cuts every spring that it crosses, a click cuts the spring under it."""

from collections.abc import Callable

import numpy as np

from sandbox.physics.analysis.query import in_triangles, nearest_spring, shares_crossed, springs_crossing
from sandbox.physics.marks import SOLID_LEFT, SOLID_RIGHT
from sandbox.physics.snapshot import Snapshot
from sandbox.session.commands import CutSprings
from sandbox.tools.tool import NOTHING, PlacedTool, PlayTool, Point, PointerEvent, Response, Submission

# Points of the stroke kept for drawing it.
TRAIL_LENGTH = 24
# Digits of the shares at which springs are cut: more are not seen, and make links long.
DIGITS = 5


class CutTool(PlacedTool):
    """Cut springs; a whole stroke is one gesture.

    A body that keeps areas is cut once the stroke has left it, or ends, along the line through it.
    """

    def __init__(self, new_gesture: Callable[[], int]) -> None:
        super().__init__(new_gesture)
        self._trail: list[Point] = []
        self._gesture: int | None = None
        # Springs that were cut or are to be; by owner, those that are to be, and where; the one that was pressed.
        self._cut: set[int] = set()
        self._entered: dict[int, dict[int, float]] = {}
        self._pressed: int | None = None

    def handle(self, event: PointerEvent, snapshot: Snapshot) -> Response:
        """Begin, continue or end a stroke."""
        if event.kind == "down" and event.button == 1:
            self._gesture, self._cut, self._entered = self._new_gesture(), set(), {}
            self._trail = [event.position]
            found = nearest_spring(snapshot, event.position, event.pick_radius / 2)
            if found is not None and in_triangles(snapshot)[found]:
                # Perhaps a stroke begins here, which parts the body.
                self._pressed = found
                return NOTHING
            self._pressed = None
            return self._submit([] if found is None else [CutSprings((found,))])
        if self._gesture is None:
            return NOTHING
        if event.kind == "move":
            cuts = self._cross(snapshot, self._trail[-1], event.position)
            self._trail = [*self._trail[-TRAIL_LENGTH + 1 :], event.position]
            return self._submit(cuts + self._part(snapshot, self._left(snapshot)))
        if event.kind == "up" and event.button == 1:
            if not self._cut and self._pressed is not None and snapshot.spring_active[self._pressed]:
                response = self._submit([CutSprings((self._pressed,))])
            else:
                response = self._submit(self._part(snapshot, list(self._entered)))
            self.cancel()
            return response
        return NOTHING

    def cancel(self) -> Response:
        """End the stroke; cut springs stay cut."""
        self._gesture, self._trail = None, []
        return NOTHING

    @property
    def trail(self) -> list[Point]:
        """The last points [m] of the stroke, for drawing."""
        return self._trail

    def _submit(self, cuts: list[CutSprings]) -> Response:
        if self._gesture is None:
            return NOTHING
        self._cut.update(slot for cut in cuts for slot in cut.springs)
        return Response(tuple(Submission(cut, self._gesture) for cut in cuts)) if cuts else NOTHING

    def _cross(self, snapshot: Snapshot, start: Point, end: Point) -> list[CutSprings]:
        """Cut what is crossed and no part of a triangle, and note the rest."""
        crossed = np.setdiff1d(springs_crossing(snapshot, start, end), list(self._cut))
        is_noted = in_triangles(snapshot)[crossed]
        noted = crossed[is_noted]
        shares = shares_crossed(snapshot, noted, start, end)
        for slot, share in zip(noted.tolist(), shares.tolist(), strict=True):
            if share >= 0.0:
                owner = int(snapshot.owner[snapshot.particle_a[slot]])
                self._entered.setdefault(owner, {})[slot] = round(share, DIGITS)
                self._cut.add(slot)
        others = tuple(crossed[~is_noted].tolist())
        return [CutSprings(others)] if others else []

    def _left(self, snapshot: Snapshot) -> list[int]:
        """The bodies that the stroke has left: it has crossed their outlines an even number of times."""
        is_border = np.isin(snapshot.edge, (SOLID_LEFT, SOLID_RIGHT))
        crossings = {owner: int(np.count_nonzero(is_border[list(noted)])) for owner, noted in self._entered.items()}
        return [owner for owner, count in crossings.items() if count > 0 and count % 2 == 0]

    def _part(self, snapshot: Snapshot, owners: list[int]) -> list[CutSprings]:
        found = []
        for owner in owners:
            noted = {slot: share for slot, share in self._entered.pop(owner).items() if snapshot.spring_active[slot]}
            # One spring alone is no line.
            if noted:
                found.append(CutSprings(tuple(noted), tuple(noted.values()) if len(noted) > 1 else ()))
        return found


CUT = PlayTool("cut", ("C", "3"), "Cut tool: a stroke cuts what it crosses", "Tools", CutTool, "cut")
