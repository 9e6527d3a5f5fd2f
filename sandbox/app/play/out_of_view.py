"""OutOfView: which bodies of a run have left the picture, and how they are brought back into it."""

import numpy as np

from sandbox.app.draw.camera import Box
from sandbox.app.run.playback import Playback
from sandbox.physics.analysis.query import shown_particles
from sandbox.physics.arrays import Slots
from sandbox.physics.components import label_bodies
from sandbox.physics.world import World
from sandbox.session.commands import Free, MoveBody

NOTICE = "Nearly everything has left the picture. Shift+J brings it back; R restarts."
# A run is over once this part of the mass that moves has left; stubs may stay where something broke.
GONE = 0.75
# Ticks between two looks; after each step back in time there is one.
EVERY = 20
# A body has left once it has been out for so long [s]: one above the picture, where it falls back from, for longer.
AWAY, ABOVE = 1.0, 5.0
# What is brought back is put so far below the top of its box, as a part of that height.
FROM_TOP = 0.2


class OutOfView:
    """Looks at a world after its ticks.

    lost_count: how many bodies have left the picture. is_over: whether they are nearly all that moves.
    """

    def __init__(self) -> None:
        self.lost_count, self.is_over = 0, False
        self._tick = -EVERY
        # Since which tick a body is out of the picture, by its first particle.
        self._since: dict[int, int] = {}

    def update(self, world: World, pictures: list[Box]) -> None:
        """Look at a world; pictures [m]: what is seen at first, and what is seen now."""
        if 0 <= world.tick - self._tick < EVERY:
            return
        if world.tick < self._tick:
            self._since.clear()
        self._tick, rate = world.tick, world.settings.tick_rate
        bodies = {int(body[0]): body for body in bodies_beyond(world, pictures)}
        self._since = {first: self._since.get(first, world.tick) for first in bodies}
        gone = [
            body for first, body in bodies.items()
            if world.tick - self._since[first] >= rate * (ABOVE if _falls_back(world, body, pictures[0]) else AWAY)
        ]  # fmt: skip
        self.lost_count = len(gone)
        moving = float(world.mass[shown_particles(world) & (world.inverse_mass > 0.0)].sum())
        self.is_over = sum(float(world.mass[body].sum()) for body in gone) > GONE * moving


def put_back(playback: Playback, box: Box, pictures: list[Box]) -> int:
    """Put every body that is beyond the pictures [m] into a box [m], in one gesture; how many there are."""
    world, gesture = playback.session.world, playback.session.new_gesture()
    bodies = bodies_beyond(world, pictures)
    left, bottom, right, top = box
    for number, body in enumerate(bodies):
        # Side by side near the top, at rest.
        wanted = left + (right - left) * (number + 1) / (len(bodies) + 1), top - FROM_TOP * (top - bottom)
        x, y = world.position[body].mean(axis=0).tolist()
        playback.submit(MoveBody(int(body[0]), (wanted[0] - x, wanted[1] - y), at_rest=True), gesture)
    if world.has_contacts:
        # Where another body or the ground is, they are put beside it.
        for body in bodies:
            playback.submit(Free(int(body[0])), gesture)
    return len(bodies)


def bodies_beyond(world: World, pictures: list[Box]) -> list[Slots]:
    """The bodies, by their particles, that move freely and whose middle is in none of the pictures [m].

    What hangs on something that is pinned, such as the end of a torn rope, stays where it is.
    """
    moving = shown_particles(world) & (world.inverse_mass > 0.0)
    if not _is_beyond(world.position[moving], pictures).any():
        return []
    joined = np.flatnonzero(world.spring_active & (world.material >= 0))
    label = np.arange(len(world.particle_active))
    label_bodies(world.particle_a[joined].astype(np.int64), world.particle_b[joined].astype(np.int64), label)
    shown = np.flatnonzero(shown_particles(world))
    order = shown[np.argsort(label[shown], kind="stable")]
    bodies = np.split(order, np.flatnonzero(np.diff(label[order])) + 1)
    free = [body for body in bodies if moving[body].all() and np.isfinite(world.position[body]).all()]
    return [body for body in free if _is_beyond(world.position[body].mean(axis=0)[None], pictures)[0]]


def _is_beyond(points: np.ndarray, pictures: list[Box]) -> np.ndarray:
    """Which points [m] (n, 2) are in none of the pictures (n,)."""
    inside = [((points >= box[:2]) & (points <= box[2:])).all(axis=1) for box in pictures]
    return ~np.logical_or.reduce(inside)


def _falls_back(world: World, body: Slots, picture: Box) -> bool:
    """Whether gravity pulls a body back into a picture [m]: it is on the side that gravity comes from, and no other."""
    gravity, at = np.array(world.settings.gravity), world.position[body].mean(axis=0)
    along = int(np.argmax(np.abs(gravity)))
    low, high = np.array(picture[:2]), np.array(picture[2:])
    across = 1 - along
    is_before = at[along] > high[along] if gravity[along] < 0.0 else at[along] < low[along]
    return bool(gravity[along] != 0.0 and is_before and low[across] <= at[across] <= high[across])
