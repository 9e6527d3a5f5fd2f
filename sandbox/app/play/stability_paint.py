"""How near the springs of a run are to the limit of what is proven stable, worked out anew where that may change."""

import numpy as np
from numpy.typing import NDArray

from sandbox.app.play.playback import Playback
from sandbox.physics.stability import stability_shares

# Ticks between two looks at what changes by itself, such as springs that break.
LOOK_EVERY = 15


class StabilityPaint:
    """Keeps the shares of a run's springs (m,), see stability_shares."""

    def __init__(self) -> None:
        self._key: tuple[object, ...] = ()
        self._shares: NDArray[np.float64] = np.zeros(0)

    def shares(self, playback: Playback) -> NDArray[np.float64]:
        """The shares of its springs as they are now."""
        world = playback.session.world
        key = world, playback.revision, world.tick // LOOK_EVERY, world.spring_count, world.settings.solver
        if key != self._key:
            self._key, self._shares = key, stability_shares(world)
        return self._shares
