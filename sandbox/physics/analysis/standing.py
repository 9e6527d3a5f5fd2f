"""StandingRun: how far a body sags, measured by a run of its own: it stands on a floor, alone, until it rests."""

from dataclasses import replace

import numpy as np

from sandbox.physics.collision.filter import TERRAIN_GROUP
from sandbox.physics.constraints import AREA, BEND
from sandbox.physics.keeping.forms import StiffForm
from sandbox.physics.settings import WorldSettings
from sandbox.physics.step import step
from sandbox.physics.terrain import Chain, make_terrain
from sandbox.physics.world import World

FRICTION = 0.5
# Radius of its particles as a share of its shortest spring, and at most so many [m].
RADIUS_SHARE, LARGEST_RADIUS = 0.4, 0.05
# It rests once its height changes by less than this share of it in so many ticks; longer than so many is not waited.
AT_REST, LOOK_EVERY, LONGEST = 2e-5, 30, 2_400


class StandingRun:
    """A run of a form whose springs, areas and bends all have these Cs and Cd per tick; sag: None until it is known."""

    def __init__(self, shape: StiffForm, settings: WorldSettings, stiffness: float, damping: float) -> None:
        self.sag: float | None = None
        points = shape.points @ _upright(settings.gravity)
        links = points[shape.pairs[:, 1]] - points[shape.pairs[:, 0]]
        radius = min(LARGEST_RADIUS, RADIUS_SHARE * float(np.sqrt(np.sum(links**2, axis=1)).min()))
        points = points - (points[:, 0].mean(), points[:, 1].min() - 1.001 * radius)
        strength = float(np.hypot(*settings.gravity)) or 9.81
        self.world = world = World(replace(settings, gravity=(0.0, -strength), wind=(0.0, 0.0)))
        names = [str(k) for k in range(len(points))]
        world.add_particles(
            names, points, mass=shape.mass, radius=radius, friction=FRICTION, owner=0, group=TERRAIN_GROUP,
            collides=TERRAIN_GROUP,
        )  # fmt: skip
        pair = {"stiffness": stiffness, "damping": damping}
        world.add_springs([f"s{k}" for k in range(len(links))], *shape.pairs.T, **pair)
        for kind, corners in ((AREA, shape.areas), (BEND, shape.bends)):
            if len(corners):
                world.add_constraints(kind, corners, **pair)
        far = 20.0 * (float(np.ptp(points)) + 1.0)
        world.terrain = make_terrain([Chain([[-far, 0.0], [far, 0.0]], friction=FRICTION)])
        self._height = self._before = self._tall()

    def _tall(self) -> float:
        y = self.world.position[:, 1]
        return float(y.max() - y.min())

    def advance(self, ticks: int) -> bool:
        """Step a number of ticks; True: the sag is known, at rest or at the end."""
        for _ in range(ticks):
            if self.sag is not None:
                break
            step(self.world)
            if self.world.tick % LOOK_EVERY:
                continue
            now = self._tall()
            if abs(now - self._before) < AT_REST * self._height or self.world.tick >= LONGEST:
                self.sag = 1.0 - now / self._height
            self._before = now
        return self.sag is not None


def _upright(gravity: tuple[float, float]) -> np.ndarray:
    # Turns points (n, 2), from the right, so that gravity goes down.
    strength = float(np.hypot(*gravity))
    x, y = (0.0, -1.0) if strength == 0.0 else (gravity[0] / strength, gravity[1] / strength)
    return np.array([[-y, -x], [x, -y]])
