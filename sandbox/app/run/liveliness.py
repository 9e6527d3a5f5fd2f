"""Liveliness: how much moved at each tick of a run, so that the liveliest part of it can be found again."""

import numpy as np

from sandbox.physics.analysis.query import shown_particles
from sandbox.physics.snapshot import Snapshot

# Faster than this [m/s] is no livelier: what flies away is not what one wants to see.
FASTEST = 20.0


class Liveliness:
    """The mean speed of what moves, by tick, of the ticks that were shown."""

    def __init__(self) -> None:
        self._speeds: dict[int, float] = {}

    def note(self, shown: Snapshot) -> None:
        """Look at a state that is shown; an earlier tick again replaces what was known of it."""
        if shown.tick in self._speeds:
            return
        moving = shown_particles(shown) & (shown.inverse_mass > 0.0)
        velocity = shown.velocity[moving]
        speed = np.minimum(np.sqrt(np.sum(velocity * velocity, axis=1)), FASTEST)
        self._speeds[shown.tick] = float(np.nan_to_num(speed).mean()) if len(speed) else 0.0

    def liveliest(self, first: int, last: int, ticks: int) -> int:
        """The tick from which on this many ticks within first..last move the most; those not shown count as still."""
        speeds = np.array([self._speeds.get(tick, 0.0) for tick in range(first, last + 1)])
        if len(speeds) <= ticks:
            return first
        sums = np.concatenate([[0.0], np.cumsum(speeds)])
        return first + int(np.argmax(sums[ticks:] - sums[:-ticks]))
