"""AxleTool: a click puts an axle through what is there: two bodies turn about it, or one about a place of the world."""

import numpy as np

from sandbox.physics.analysis.query import bodies_around, particle_at, shown_particles
from sandbox.physics.arrays import Slots
from sandbox.physics.geometry.segment import lengths
from sandbox.physics.snapshot import Snapshot
from sandbox.session.commands import AddBody, AddSpring
from sandbox.tools.tool import NOTHING, PlayTool, Point, PointerEvent, Response, Submission, Tool

# Spokes from the axle to each body, and the shortest one as a share of the pick radius.
SPOKES, SHORTEST = 3, 0.2
# The axle's radius, as a share of its shortest spoke.
RADIUS = 0.3
DIGITS, DECIMALS = 6, 4
NOTHING_THERE = "Click on a thing: the axle goes through it."
TOO_FEW = "This is too small for an axle. Hold it with the pin tool (P)."


class AxleTool(Tool):
    """Join the two bodies under a click by a hinge there, or one body to the world. Each axle is a gesture."""

    def handle(self, event: PointerEvent, snapshot: Snapshot) -> Response:
        """Put an axle at the place of a press."""
        if event.kind != "down" or event.button != 1:
            return NOTHING
        front = particle_at(snapshot, event.position, event.pick_radius)
        if front is None:
            self._refusal = NOTHING_THERE
            return NOTHING
        owners = dict.fromkeys([int(snapshot.owner[front]), *bodies_around(snapshot, event.position).tolist()])
        found = [_spokes(snapshot, owner, event) for owner in owners][:2]
        self._refusal = TOO_FEW if min(map(len, found)) < 2 else ""
        if self._refusal:
            return NOTHING
        tied = np.concatenate(found)
        x, y = (round(value, DECIMALS) for value in event.position)
        reach = float(lengths(snapshot.position[tied] - np.array([x, y])).min())
        hub = {
            "type": "mesh",
            "id": "axle",
            "particles": [[x, y]],
            "masses": [_rounded(float(snapshot.mass[tied].mean()))],
            "pinned": [0] if len(found) == 1 else [],
            # It lies inside of what it holds.
            "collides": [],
            "particle_radius": _rounded(RADIUS * reach),
        }
        first, gesture = len(snapshot.mass), self._new_gesture()
        commands = [AddBody(hub), *(AddSpring(first, slot, stiffness=1.0, damping=1.0) for slot in tied.tolist())]
        return Response(tuple(Submission(command, gesture) for command in commands))

    def target(self, place: Point, within: float, snapshot: Snapshot) -> int | None:
        """A particle of the body that an axle would go through."""
        return particle_at(snapshot, place, within)


def _spokes(snapshot: Snapshot, owner: int, event: PointerEvent) -> Slots:
    """The particles of a body that are nearest to a press, and yet not at it."""
    own = np.flatnonzero(shown_particles(snapshot) & (snapshot.owner == owner))
    distance = lengths(snapshot.position[own] - np.array(event.position))
    own, distance = own[distance > (least := SHORTEST * event.pick_radius)], distance[distance > least]
    return np.asarray(own[np.argsort(distance, kind="stable")[:SPOKES]])


def _rounded(value: float) -> float:
    return float(f"{value:.{DIGITS}g}")


AXLE = PlayTool("axle", ("Shift+7",), "Axle: click where two things turn, or one", "Parts", AxleTool, "add")
