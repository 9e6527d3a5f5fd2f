"""ClickTool: what the tools share that do something to the particle that is clicked."""

from collections.abc import Callable
from typing import ClassVar

from sandbox.physics.analysis.query import nearest_particle
from sandbox.physics.snapshot import Snapshot
from sandbox.session.commands import Command
from sandbox.tools.tool import NOTHING, PointerEvent, Response, Submission, Tool


class ClickTool(Tool):
    """A tool whose clicks are a gesture each; reach: how many pick radii away a particle is hit."""

    reach: ClassVar[float] = 1.0
    is_held = False

    def __init__(self, new_gesture: Callable[[], int]) -> None:
        self._new_gesture = new_gesture

    def commands(self, particle: int, snapshot: Snapshot) -> list[Command]:
        """What a click on a particle does."""
        raise NotImplementedError

    def handle(self, event: PointerEvent, snapshot: Snapshot) -> Response:
        """Do it on a press."""
        if event.kind != "down" or event.button != 1:
            return NOTHING
        particle = nearest_particle(snapshot, event.position, self.reach * event.pick_radius)
        if particle is None:
            return NOTHING
        gesture = self._new_gesture()
        return Response(tuple(Submission(command, gesture) for command in self.commands(particle, snapshot)))

    def cancel(self) -> Response:
        """Nothing is ever under way."""
        return NOTHING
