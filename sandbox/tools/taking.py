"""DeleteTool and FreezeTool: a click takes out what hangs together under it, or holds all of a body where it is."""

from collections.abc import Callable

import numpy as np

from sandbox.physics.query import nearest_particle, shown_particles
from sandbox.physics.snapshot import Snapshot
from sandbox.session.commands import Command, Pin, Remove, Unpin
from sandbox.tools.tool import NOTHING, PointerEvent, Response, Submission

# A click hits a particle so many pick radii away: the middle of a coarse body has none that is nearer.
REACH = 2.5


class DeleteTool:
    """Take out what is clicked, with all that hangs on it; each click is a gesture."""

    def __init__(self, new_gesture: Callable[[], int]) -> None:
        self._new_gesture = new_gesture

    def handle(self, event: PointerEvent, snapshot: Snapshot) -> Response:
        """Remove on a press."""
        if event.kind != "down" or event.button != 1:
            return NOTHING
        particle = nearest_particle(snapshot, event.position, REACH * event.pick_radius)
        if particle is None:
            return NOTHING
        return Response((Submission(Remove(particle=particle), self._new_gesture()),))

    def cancel(self) -> Response:
        """Nothing is ever under way."""
        return NOTHING

    def reconcile(self, snapshot: Snapshot) -> None:
        """Nothing is remembered."""


class FreezeTool:
    """Pin every particle of the body that is clicked, or let a body go of which every one is pinned."""

    def __init__(self, new_gesture: Callable[[], int]) -> None:
        self._new_gesture = new_gesture

    def handle(self, event: PointerEvent, snapshot: Snapshot) -> Response:
        """Freeze or thaw on a press, as one gesture."""
        if event.kind != "down" or event.button != 1:
            return NOTHING
        particle = nearest_particle(snapshot, event.position, REACH * event.pick_radius)
        if particle is None:
            return NOTHING
        body = np.flatnonzero(shown_particles(snapshot) & (snapshot.owner == snapshot.owner[particle]))
        free = body[snapshot.inverse_mass[body] > 0.0].tolist()
        gesture = self._new_gesture()
        commands: list[Command] = [Pin(slot) for slot in free] or [Unpin(slot) for slot in body.tolist()]
        return Response(tuple(Submission(command, gesture) for command in commands))

    def cancel(self) -> Response:
        """Nothing is ever under way."""
        return NOTHING

    def reconcile(self, snapshot: Snapshot) -> None:
        """Nothing is remembered."""
