"""OutOfView: whether what moves in a run has left what is seen of it at first, so that it can be begun again."""

import numpy as np
from numpy.typing import NDArray

from sandbox.app.draw.camera import Box
from sandbox.app.run.playback import Playback
from sandbox.physics.analysis.query import shown_particles
from sandbox.physics.arrays import Slots
from sandbox.physics.components import body_of
from sandbox.physics.world import World
from sandbox.session.commands import MoveBody

Mask = NDArray[np.bool_]

NOTICE = "Everything fell out of sight. R restarts; Ctrl+Z undoes."
# A run is over once this part of the mass that moves has left; stubs may stay where something broke.
GONE = 0.75
# So far around what is seen at first something still counts as near, as a part of its width and height.
MARGIN = 0.25
# Ticks between two looks; after each step back in time there is one.
EVERY = 20

# What is brought back is put so far below the top of what is seen at first, as a part of its height.
FROM_TOP = 0.2


class OutOfView:
    """Looks at a world after its ticks; is_over: whether nearly nothing that moves is near any more.

    has_lost: whether something that moves is out of sight.
    """

    def __init__(self) -> None:
        self.is_over = self.has_lost = False
        self._tick = -EVERY

    def update(self, world: World, box: Box) -> None:
        """Look at a world; box [m]: what is seen at first."""
        if 0 <= world.tick - self._tick < EVERY:
            return
        self._tick = world.tick
        moving, is_gone = _gone(world, box)
        mass = world.mass[moving]
        self.has_lost = bool(is_gone.any())
        self.is_over = bool(mass[is_gone[moving]].sum() > GONE * mass.sum())


def put_back(playback: Playback, box: Box) -> bool:
    """Put all that is out of sight back into a box [m], in one gesture; whether there is anything."""
    found, gesture = _ways_back(playback.session.world, box), playback.session.new_gesture()
    for command in found:
        playback.submit(command, gesture)
    return bool(found)


def _ways_back(world: World, box: Box) -> list[MoveBody]:
    # Side by side near the top of the box, at rest.
    _, is_gone = _gone(world, box)
    bodies: list[Slots] = []
    left_over = set(np.flatnonzero(is_gone).tolist())
    while left_over:
        body = body_of(world, min(left_over))
        # What hangs on something that is in sight, such as the end of a torn rope, stays.
        if is_gone[body].all() and np.isfinite(world.position[body]).all():
            bodies.append(body)
        left_over -= set(body.tolist()) or {min(left_over)}
    left, bottom, right, top = box
    found = []
    for number, body in enumerate(bodies):
        wanted = left + (right - left) * (number + 1) / (len(bodies) + 1), top - FROM_TOP * (top - bottom)
        x, y = world.position[body].mean(axis=0).tolist()
        found.append(MoveBody(int(body[0]), (wanted[0] - x, wanted[1] - y), at_rest=True))
    return found


def _gone(world: World, box: Box) -> tuple[Mask, Mask]:
    """What moves (n,), and what of it is out of sight (n,)."""
    moving = shown_particles(world) & (world.inverse_mass > 0.0)
    left, bottom, right, top = box
    wide, tall = MARGIN * (right - left), MARGIN * (top - bottom)
    low, high = np.array([left - wide, bottom - tall]), np.array([right + wide, top + tall])
    return moving, moving & ~((world.position >= low) & (world.position <= high)).all(axis=1)
