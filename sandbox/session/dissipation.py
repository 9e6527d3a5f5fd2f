"""Dissipation: what the ticks of a run have taken out of the world's energy."""

from sandbox.physics.energy import total_energy
from sandbox.physics.world import World


class Dissipation:
    """Energy [J] lost in ticks: `before` each, then `after` it; energy that a tick gained counts against it.

    What commands change between ticks is not counted, nor is a tick in which a hand holds something: the hand works.
    Wind, muscles, hydraulics and motors work too: what they put in counts as gained, what they take out as lost.
    """

    def __init__(self) -> None:
        self.energy = 0.0
        self._before: float | None = None

    def before(self, world: World) -> None:
        """Look at a world that is about to make a tick."""
        self._before = None if world.hands_in_use() else total_energy(world)

    def after(self, world: World) -> None:
        """Look at it again after the tick."""
        if self._before is not None:
            self.energy += self._before - total_energy(world)
