"""Tools that do something to the particle that is clicked: pin it, take it out, or freeze all of its body."""

from typing import ClassVar

import numpy as np

from sandbox.physics.analysis.query import nearest_particle, shown_particles
from sandbox.physics.snapshot import Snapshot
from sandbox.session.commands import Command, Pin, Remove, Unpin
from sandbox.tools.tool import NOTHING, PlayTool, PointerEvent, Response, Tool

# The middle of a coarse body has no particle that is nearer.
REACH = 2.5


class ClickTool(Tool):
    """A tool whose clicks are a gesture each; reach: how many pick radii away a particle is hit."""

    reach: ClassVar[float] = 1.0
    is_held = False

    def commands(self, particle: int, snapshot: Snapshot) -> list[Command]:
        """The commands of a click on a particle."""
        raise NotImplementedError

    def handle(self, event: PointerEvent, snapshot: Snapshot) -> Response:
        """Submit the tool's commands for a press."""
        if event.kind != "down" or event.button != 1:
            return NOTHING
        particle = nearest_particle(snapshot, event.position, self.reach * event.pick_radius)
        if particle is None:
            return NOTHING
        return self._in_one_gesture(self.commands(particle, snapshot))


class PinTool(ClickTool):
    """Toggle the pin of the particle that is clicked."""

    def commands(self, particle: int, snapshot: Snapshot) -> list[Command]:
        """Pin or unpin the particle."""
        return [Pin(particle) if snapshot.inverse_mass[particle] > 0.0 else Unpin(particle)]


class DeleteTool(ClickTool):
    """Deletes the clicked particle, with all that hangs on it."""

    reach = REACH

    def commands(self, particle: int, snapshot: Snapshot) -> list[Command]:
        """Remove the particle."""
        return [Remove(particle=particle)]


class FreezeTool(ClickTool):
    """Pin every particle of the body that is clicked, or let a body go of which every one is pinned."""

    reach = REACH

    def commands(self, particle: int, snapshot: Snapshot) -> list[Command]:
        """Freeze or thaw all of the particle's body."""
        return freezing(particle, snapshot)


def freezing(particle: int, snapshot: Snapshot) -> list[Command]:
    """The commands that pin what is free of the body of a particle, or let it go where nothing of it is."""
    body = np.flatnonzero(shown_particles(snapshot) & (snapshot.owner == snapshot.owner[particle]))
    free = body[snapshot.inverse_mass[body] > 0.0].tolist()
    return [Pin(slot) for slot in free] or [Unpin(slot) for slot in body.tolist()]


PIN = PlayTool("pin", ("P", "2"), "Pin tool: pin or unpin a particle", "Tools", PinTool, "pin")

DELETE = PlayTool("delete", ("X",), "Erase a thing, with what hangs on it", "Parts", DeleteTool, "remove")

FREEZE = PlayTool("freeze", ("I",), "Freeze or thaw a body", "Parts", FreezeTool, "pin")
