"""Dissipation: what the ticks of a run have taken out of the world's energy."""

import numpy as np

from sandbox.physics.energy import total_energy
from sandbox.physics.world import World


class Dissipation:
    """Energy [J] lost in ticks: `before` each, then `after` it; energy that a tick gained counts against it.

    What commands change between ticks is not counted, nor is a tick in which something works on the world: a hand that
    holds a particle, a muscle, a hydraulic or motor that is driven, the wind.
    """

    def __init__(self) -> None:
        self.energy = 0.0
        self._before: float | None = None
        self._after: float | None = None

    def before(self, world: World, changed: bool = True) -> None:
        """Look at a world that is about to make a tick; changed: whether it may differ from the last look `after`."""
        if _is_worked_on(world):
            self._before = None
        else:
            self._before = total_energy(world) if changed or self._after is None else self._after

    def after(self, world: World) -> None:
        """Look at it again after the tick."""
        self._after = None
        if self._before is not None:
            self._after = total_energy(world)
            self.energy += self._before - self._after


def _is_worked_on(world: World) -> bool:
    settings = world.settings
    blows = settings.drag > 0.0 and any(settings.wind)
    return world.hands_in_use() or bool(len(world.driven.muscles.spring)) or bool(np.any(world.part_value)) or blows
