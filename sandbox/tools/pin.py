"""PinTool: a click pins a particle where it is, another lets it move."""

from collections.abc import Callable

from sandbox.physics.query import nearest_particle
from sandbox.physics.snapshot import Snapshot
from sandbox.session.commands import Pin, Unpin
from sandbox.tools.tool import NOTHING, PointerEvent, Response, Submission


class PinTool:
    """Toggle the pin of the particle that is clicked; each click is a gesture."""

    def __init__(self, new_gesture: Callable[[], int]) -> None:
        self._new_gesture = new_gesture

    def handle(self, event: PointerEvent, snapshot: Snapshot) -> Response:
        """Pin or unpin on a press."""
        if event.kind != "down" or event.button != 1:
            return NOTHING
        particle = nearest_particle(snapshot, event.position, event.pick_radius)
        if particle is None:
            return NOTHING
        command = Pin(particle) if snapshot.inverse_mass[particle] > 0.0 else Unpin(particle)
        return Response((Submission(command, self._new_gesture()),))

    def cancel(self) -> Response:
        """Nothing is ever under way."""
        return NOTHING

    def reconcile(self, snapshot: Snapshot) -> None:
        """Nothing is remembered."""
