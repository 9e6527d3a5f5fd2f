"""Following: the camera goes along with a body, smoothly."""

import math

import numpy as np

from sandbox.app.draw.camera import Camera
from sandbox.physics.arrays import Slots
from sandbox.physics.components import body_of
from sandbox.physics.snapshot import Snapshot
from sandbox.physics.world import World

# The camera makes up all but a third of what it is behind in so long [s].
LAG = 0.25


def driven_particle(world: World) -> int | None:
    """A particle of the first thing that a motor, a hydraulic or a muscle drives; None: nothing is driven."""
    actuators = world.actuators
    if len(actuators.motors.hub):
        return int(actuators.motors.hub[0])
    for springs in (actuators.hydraulics.spring, actuators.muscles.spring):
        if len(springs):
            return int(world.particle_a[springs[0]])
    return None


class Following:
    """What a camera goes along with: the body of a particle (None: nothing)."""

    def __init__(self) -> None:
        self.particle: int | None = None
        self._body: Slots | None = None
        self._of: object = None

    def begin(self, particle: int | None) -> None:
        """Go along with the body of a particle from now on; None: with nothing."""
        self.particle, self._of = particle, None

    def update(self, camera: Camera, world: World, shown: Snapshot, frame_time: float) -> None:
        """Move a camera on by a frame; what is gone or nowhere is not followed."""
        if self.particle is None:
            return
        if self.particle >= len(shown.position) or not shown.particle_active[self.particle]:
            self.begin(None)
            return
        key = (world, world.topology_version)
        if key != self._of:
            self._of, self._body = key, body_of(world, self.particle)
        assert self._body is not None
        body = self._body[self._body < len(shown.position)]
        free = body[shown.inverse_mass[body] > 0.0]
        places = shown.position[free if len(free) else body]
        middle = places[np.isfinite(places).all(axis=1)]
        if not len(middle):
            return
        x, y = middle.mean(axis=0).tolist()
        share = 1.0 - math.exp(-frame_time / LAG)
        across, up = camera.centre
        camera.centre = across + share * (x - across), up + share * (y - up)
