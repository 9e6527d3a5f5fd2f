"""What has come to lie in something else and does not come out by itself: found, marked, and freed on request."""

import numpy as np
import pygame

from sandbox.app.draw.camera import Camera
from sandbox.app.draw.colours import WARNING
from sandbox.app.run.playback import Playback
from sandbox.app.widgets.ui import Ui
from sandbox.physics.analysis.applied_forces import overlapping
from sandbox.physics.components import body_of
from sandbox.physics.snapshot import Snapshot
from sandbox.physics.world import World
from sandbox.session.commands import Free

# What overlaps for so long is stuck [s]; what parts takes less than two. For so long it may be apart in between.
STUCK_SECONDS = 4.0
APART_SECONDS = 0.5
NOTICE = "Something is stuck inside another. J frees it; Ctrl+Z undoes that."
# Sizes of a mark in layout units: how far from the body, and how thick.
ROUND, THICK = 10.0, 2.0


class StuckBodies:
    """The pairs of bodies of a run that have overlapped for long, by a particle of each."""

    def __init__(self) -> None:
        self._since: dict[tuple[int, int], tuple[int, int]] = {}
        self._tick, self._count = -1, 0
        self.particles: list[int] = []

    def update(self, world: World) -> None:
        """Look at a world after its ticks; one that went back in time, or has lost particles, is looked at afresh."""
        if world.tick < self._tick or world.particle_count < self._count:
            self._since.clear()
            self.particles = []
        self._count = world.particle_count
        if world.tick == self._tick:
            return
        self._tick, rate = world.tick, world.settings.tick_rate
        found = overlapping(world)
        for pair in found:
            self._since[pair] = (self._since.get(pair, (world.tick, 0))[0], world.tick)
        self._since = {
            pair: (first, last)
            for pair, (first, last) in self._since.items()
            if world.tick - last <= APART_SECONDS * rate
        }
        stuck = [pair for pair, (first, last) in self._since.items() if last - first >= STUCK_SECONDS * rate]
        chosen = [_to_be_moved(world, pair) for pair in stuck]
        self.particles = sorted({particle for particle in chosen if particle >= 0})

    def free(self, playback: Playback) -> bool:
        """Free what is stuck, all in one gesture; whether anything was."""
        gesture, found = playback.session.new_gesture(), self.particles
        for particle in found:
            playback.submit(Free(particle), gesture)
        self._since.clear()
        self.particles = []
        return bool(found)

    def draw(self, surface: pygame.Surface, ui: Ui, camera: Camera, current: Snapshot) -> None:
        """Draw a ring round each body that is stuck."""
        for particle in self.particles:
            if particle >= len(current.mass):
                continue
            body = current.position[current.owner == current.owner[particle]]
            middle = body.mean(axis=0)
            if not np.isfinite(body).all():
                continue
            radius = float(np.sqrt(np.max(np.sum((body - middle) ** 2, axis=1)))) * camera.zoom + ui.px(ROUND)
            at = camera.to_pixels((float(middle[0]), float(middle[1])))
            pygame.draw.aacircle(surface, WARNING, at, round(radius), max(1, ui.px(THICK)))


def _to_be_moved(world: World, pair: tuple[int, int]) -> int:
    """The particle of a pair whose body is to be moved, the lighter one; -1: both are pinned."""
    bodies = [body_of(world, particle) for particle in pair]
    masses = [float(world.mass[body].sum()) if (world.inverse_mass[body] > 0.0).all() else np.inf for body in bodies]
    return -1 if min(masses) == np.inf else pair[masses.index(min(masses))]
