"""OutOfView: whether what moves in a run has left what is seen of it at first, so that it can be begun again."""

import numpy as np

from sandbox.app.draw.camera import Box
from sandbox.physics.query import shown_particles
from sandbox.physics.world import World

NOTICE = "Everything fell out of sight. R restarts; Ctrl+Z undoes."
# A run is over once this part of the mass that moves has left; stubs may stay where something broke.
GONE = 0.75
# So far around what is seen at first something still counts as near, as a part of its width and height.
MARGIN = 0.25
# Ticks between two looks; after each step back in time there is one.
EVERY = 20


class OutOfView:
    """Looks at a world after its ticks; is_over: whether nearly nothing that moves is near any more."""

    def __init__(self) -> None:
        self.is_over = False
        self._tick = -EVERY

    def update(self, world: World, box: Box) -> None:
        """Look at a world; box [m]: what is seen at first."""
        if 0 <= world.tick - self._tick < EVERY:
            return
        self._tick = world.tick
        moving = shown_particles(world) & (world.inverse_mass > 0.0)
        left, bottom, right, top = box
        wide, tall = MARGIN * (right - left), MARGIN * (top - bottom)
        low, high = np.array([left - wide, bottom - tall]), np.array([right + wide, top + tall])
        at, mass = world.position[moving], world.mass[moving]
        is_gone = ((at < low) | (at > high)).any(axis=1)
        self.is_over = bool(mass[is_gone].sum() > GONE * mass.sum())
