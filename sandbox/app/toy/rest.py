"""Rest: whether nothing has moved for so long that the toy may sleep."""

import numpy as np

from sandbox.physics.analysis.query import shown_particles
from sandbox.physics.snapshot import Snapshot

# It sleeps after so long [s] at rest, with the pointer over it after so long without a deed.
DROWSY, WATCHED = 2.0, 12.0
# Faster than this [pixels/s] half the frames would be seen to be missing.
FAST = 40.0


class Rest:
    """Follows snapshots; is_over: the toy may sleep; moves_fast: something is fast enough for every frame to count."""

    def __init__(self) -> None:
        self.moves_fast = True
        self._stood = self._calm = 0.0
        self._hovered = False

    @property
    def is_over(self) -> bool:
        """Whether nothing moves, and nobody has done anything for a while."""
        return self._stood >= DROWSY and self._calm >= (WATCHED if self._hovered else DROWSY)

    def disturb(self) -> None:
        """Somebody does something."""
        self._calm = 0.0

    def follow(self, now: Snapshot, zoom: float, seconds: float, hovered: bool, stood: float) -> None:
        """Take in the state after a frame of `seconds`, a metre being `zoom` pixels; all has stood for `stood` [s]."""
        self._hovered, self._stood = hovered, stood
        self._calm += seconds
        free = shown_particles(now) & (now.inverse_mass > 0.0)
        with np.errstate(over="ignore", invalid="ignore"):
            fastest = np.abs(now.velocity[free]).max(initial=0.0)
        self.moves_fast = bool(fastest * zoom > FAST)
