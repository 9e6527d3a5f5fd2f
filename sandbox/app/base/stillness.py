"""Stillness: for how long nothing in a run has been seen to move."""

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.analysis.query import shown_particles
from sandbox.physics.snapshot import Snapshot

# What moves by no more than this [pixels] in so long [s] stands.
UNSEEN, LOOK = 0.6, 0.5


class Stillness:
    """Follows snapshots; lasted [s]: how long everything has stood."""

    def __init__(self) -> None:
        self.lasted = 0.0
        self._since = 0.0
        # Places [m] (n, 2) and turns [rad] (n,) that are compared with.
        self._seen: tuple[NDArray[np.float64], NDArray[np.float64]] | None = None

    def follow(self, now: Snapshot, zoom: float, seconds: float) -> None:
        """Take in the state after a frame of `seconds`, a metre being `zoom` pixels."""
        self._since += seconds
        stands = self._stands(now, zoom)
        self.lasted = self.lasted + seconds if stands else 0.0
        if not stands or self._since >= LOOK:
            self._since, self._seen = 0.0, (now.position.copy(), now.angle.copy())

    def _stands(self, now: Snapshot, zoom: float) -> bool:
        if self._seen is None or len(self._seen[0]) != len(now.position):
            return False
        free = shown_particles(now) & (now.inverse_mass > 0.0)
        places, turns = self._seen
        with np.errstate(over="ignore", invalid="ignore"):
            moved = np.abs(now.position - places)[free].max(initial=0.0)
            turned = (np.abs(now.angle - turns) * now.radius)[free].max(initial=0.0)
            return bool(max(moved, turned) * zoom <= UNSEEN)
