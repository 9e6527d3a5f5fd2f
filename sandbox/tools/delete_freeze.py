"""DeleteTool and FreezeTool: a click takes out what hangs together under it, or holds all of a body where it is."""

import numpy as np

from sandbox.physics.analysis.query import shown_particles
from sandbox.physics.snapshot import Snapshot
from sandbox.session.commands import Command, Pin, Remove, Unpin
from sandbox.tools.click import ClickTool
from sandbox.tools.play_tool import PlayTool

# The middle of a coarse body has no particle that is nearer.
REACH = 2.5


class DeleteTool(ClickTool):
    """Take out what is clicked, with all that hangs on it."""

    reach = REACH

    def commands(self, particle: int, snapshot: Snapshot) -> list[Command]:
        """Remove it."""
        return [Remove(particle=particle)]


class FreezeTool(ClickTool):
    """Pin every particle of the body that is clicked, or let a body go of which every one is pinned."""

    reach = REACH

    def commands(self, particle: int, snapshot: Snapshot) -> list[Command]:
        """Freeze or thaw all of its body."""
        return freezing(particle, snapshot)


def freezing(particle: int, snapshot: Snapshot) -> list[Command]:
    """The commands that pin what is free of the body of a particle, or let it go where nothing of it is."""
    body = np.flatnonzero(shown_particles(snapshot) & (snapshot.owner == snapshot.owner[particle]))
    free = body[snapshot.inverse_mass[body] > 0.0].tolist()
    return [Pin(slot) for slot in free] or [Unpin(slot) for slot in body.tolist()]


DELETE = PlayTool("delete", ("X",), "Erase a thing, with what hangs on it", "Parts", DeleteTool, "remove")
FREEZE = PlayTool("freeze", ("I",), "Freeze or thaw a body", "Parts", FreezeTool, "pin")
