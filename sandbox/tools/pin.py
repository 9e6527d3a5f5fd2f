"""PinTool: a click pins a particle where it is, another lets it move."""

from sandbox.physics.snapshot import Snapshot
from sandbox.session.commands import Command, Pin, Unpin
from sandbox.tools.click import ClickTool
from sandbox.tools.play_tool import PlayTool


class PinTool(ClickTool):
    """Toggle the pin of the particle that is clicked."""

    def commands(self, particle: int, snapshot: Snapshot) -> list[Command]:
        """Pin or unpin it."""
        return [Pin(particle) if snapshot.inverse_mass[particle] > 0.0 else Unpin(particle)]


PIN = PlayTool("pin", ("P", "2"), "Pin tool: pin or unpin a particle", "Tools", PinTool, "pin")
