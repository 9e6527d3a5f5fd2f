"""Rest: whether nothing has moved for so long that the toy may sleep."""

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.query import shown_particles
from sandbox.physics.snapshot import Snapshot

# What moves by no more than this [pixels] in so long [s] stands.
UNSEEN, LOOK = 0.6, 0.5
# It sleeps after so long [s] at rest, with the pointer over it after so long without a deed.
DROWSY, WATCHED = 2.0, 12.0
# Faster than this [pixels/s] half the frames would be seen to be missing.
FAST = 40.0


class Rest:
    """Follows snapshots; is_over: the toy may sleep; moves_fast: something is fast enough for every frame to count."""

    def __init__(self) -> None:
        self.moves_fast = True
        self._still = 0.0
        self._calm = 0.0
        self._since = 0.0
        self._hovered = False
        self._places: NDArray[np.float64] | None = None

    @property
    def is_over(self) -> bool:
        """Whether nothing moves, and nobody has done anything for a while."""
        return self._still >= DROWSY and self._calm >= (WATCHED if self._hovered else DROWSY)

    def disturb(self) -> None:
        """Somebody does something."""
        self._calm = 0.0

    def follow(self, now: Snapshot, zoom: float, seconds: float, hovered: bool) -> None:
        """Take in the state after a frame of `seconds`, a metre being `zoom` pixels."""
        self._hovered = hovered
        self._calm += seconds
        self._since += seconds
        free = shown_particles(now) & (now.inverse_mass > 0.0)
        with np.errstate(over="ignore", invalid="ignore"):
            fastest = np.abs(now.velocity[free]).max(initial=0.0)
        self.moves_fast = bool(fastest * zoom > FAST)
        if self._since < LOOK and self._places is not None:
            return
        places, before = now.position.copy(), self._places
        with np.errstate(over="ignore", invalid="ignore"):
            is_still = (
                before is not None
                and len(before) == len(places)
                and bool((np.abs(places - before)[free] * zoom <= UNSEEN).all())
            )
        self._still = self._still + self._since if is_still else 0.0
        self._since, self._places = 0.0, places
