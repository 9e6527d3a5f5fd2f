"""SidePanel: what a screen asks of the panel at its right, whatever that is for."""

from collections.abc import Set
from typing import Protocol

from sandbox.app.panel.coefficient_pad import CoefficientPad
from sandbox.app.run.playback import Playback

# Narrower windows begin without a panel at their side [layout units].
ROOM_FOR_PANEL = 800.0


class SidePanel(Protocol):
    """A panel beside a run."""

    playback: Playback
    material: int | None
    pad: CoefficientPad | None

    def refresh(self) -> None:
        """Show what the world has now."""
        ...

    def show_choices(self, strength: str, views: Set[str]) -> None:
        """Show the strength of the hand, and which overlays are seen."""
        ...

    def choose_material(self, material: int | None) -> None:
        """Show and change the springs of a material (index); None = all."""
        ...

    def attach(self, playback: Playback) -> None:
        """Show and change another run of the same level."""
        ...
