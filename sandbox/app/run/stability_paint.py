"""How near the springs of a run are to the limit of what is proven stable, worked out again where that may change."""

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.analysis.stability import stability_shares
from sandbox.physics.world import World

# Ticks between two looks at what changes by itself, such as springs that break.
LOOK_EVERY = 15


class StabilityPaint:
    """Keeps the shares of a run's springs (m,), see stability_shares."""

    def __init__(self) -> None:
        self._key: tuple[object, ...] = ()
        self._shares: NDArray[np.float64] = np.zeros(0)

    def shares(self, world: World, revision: int = 0) -> NDArray[np.float64]:
        """The shares of its springs as they are now; revision: another number where a command may have changed them."""
        key = world, revision, world.tick // LOOK_EVERY, world.spring_count, world.settings.solver
        if key != self._key:
            self._key, self._shares = key, stability_shares(world)
        return self._shares
