"""StandingRun: how far a body sags, measured by a run of its own: alone, as it is held, until it rests."""

import math
from dataclasses import replace

import numpy as np

from sandbox.physics.analysis.stance import Stance, Support
from sandbox.physics.arrays import Floats
from sandbox.physics.collision.filter import TERRAIN_GROUP
from sandbox.physics.constraints import AREA, BEND
from sandbox.physics.keeping.forms import design_gravity
from sandbox.physics.marks import BANK_UNOPENED
from sandbox.physics.settings import WorldSettings
from sandbox.physics.step import step
from sandbox.physics.terrain import Chain, make_terrain
from sandbox.physics.world import World

# Friction of a floor, and of what a beam's ends lie on.
FRICTION = 0.5
# How far above a floor it begins, as a share of its length.
CLEAR = 1e-5
# It is looked at every so many ticks, and rests where no particle has moved by more than this share of its length,
# twice in a row, or where its sag has changed by less than this share of itself, three times; longer is not waited.
LOOK_EVERY, AT_REST, SETTLED, LONGEST = 15, 2e-5, 5e-4, 1_500
# A column leans by this much of gravity, so that it buckles where it would in a world that is not even; what is so many
# times as high as wide is one.
LEAN, COLUMN = 0.005, 1.5
# What has dropped by so many of its lengths flies. What still moves at the end by less than this share of its length,
# its sag by less than this share of itself, is about at rest.
LOST, CALM, NEAR = 20.0, 2e-3, 0.02


class StandingRun:
    """A run of a body, alone, in a stance; sag: None until it is known, NaN where it does not come to rest."""

    def __init__(self, stance: Stance, settings: WorldSettings) -> None:
        self.stance = stance
        self.sag: float | None = None
        strength = design_gravity(*settings.gravity)
        gravity = (LEAN * strength if _may_buckle(stance) else 0.0, -strength)
        self.world = world = World(replace(settings, gravity=gravity, wind=(0.0, 0.0)))
        lowest = float((stance.points[:, 1] - stance.radius).min())
        points = stance.points - (stance.points[:, 0].mean(), lowest - CLEAR * stance.length)
        touches = TERRAIN_GROUP if stance.support in (Support.FLOOR, Support.ENDS) else 0
        world.add_particles(
            [str(k) for k in range(len(points))], points, mass=stance.mass, radius=stance.radius, pinned=stance.held,
            gravity_scale=stance.gravity_scale, owner=0, group=TERRAIN_GROUP, collides=touches,
            friction=stance.friction,
        )  # fmt: skip
        names = [f"s{k}" for k in range(len(stance.pairs))]
        world.add_springs(names, *stance.pairs.T, rest_length=stance.rest)
        for kind, corners in ((AREA, stance.areas), (BEND, stance.bends)):
            if len(corners):
                world.add_constraints(kind, corners)
        if touches:
            world.terrain = make_terrain(self._ground(points))
        self._places = points
        self._begin()

    def _ground(self, points: Floats) -> list[Chain]:
        far = 20.0 * (float(np.ptp(points)) + 1.0)
        if self.stance.support is Support.FLOOR:
            return [Chain([[-far, 0.0], [far, 0.0]], friction=FRICTION)]
        x = np.sort(points[self.stance.rests, 0])
        gap = int(np.argmax(np.diff(x)))
        reach = 0.01 * self.stance.length
        ends = ((-far, float(x[gap]) + reach), (float(x[gap + 1]) - reach, far))
        return [Chain([[start, 0.0], [end, 0.0]], friction=FRICTION) for start, end in ends]

    def _begin(self) -> None:
        self.sag, self._from, self._energy = None, self.world.tick, 0.0
        self._still = self._settled = 0
        self._before, self._sag_before = self.world.position.copy(), math.inf

    @property
    def moved(self) -> Floats:
        """How far its particles (n, 2) are from where they began [m]."""
        return self.world.position - self._places

    def take(self, stiffness: float, damping: float, lowest_mode: float, moved: Floats | None = None) -> None:
        """Measure with these Cs and Cd per tick; moved [m] (n, 2): how far off its form it begins, None: not at all."""
        for family in ("", "constraint_"):
            for name, value in (("stiffness", stiffness), ("damping", damping), ("lowest_mode", lowest_mode)):
                self.world.change(f"{family}{name}", value)
        self.world.change("position", self._places if moved is None else self._places + moved)
        self._stop()
        self._begin()

    def _stop(self) -> None:
        self.world.change("velocity", 0.0)
        self.world.slow_velocity[:] = 0.0
        self.world.energy_bank[:] = BANK_UNOPENED

    def advance(self, ticks: int) -> bool:
        """Step a number of ticks; True: the sag is known, at rest or at the end."""
        for _ in range(ticks):
            if self.sag is not None:
                break
            step(self.world)
            if self.stance.support is Support.HUB:
                self._turn_back()
            # Where it lies on its ends it has to swing, or friction keeps them where they are.
            if self.stance.support is not Support.ENDS:
                self._calm()
            if (self.world.tick - self._from) % LOOK_EVERY == 0:
                self._look()
        return self.sag is not None

    def _calm(self) -> None:
        """Stop where the body has its greatest speed, at the middle of its swing: it stays near where it will rest."""
        velocity = self.world.velocity
        energy = float(self.world.mass @ np.sum(velocity * velocity, axis=1))
        # What creeps slows down as well, by little from tick to tick.
        if energy < 0.98 * self._energy:
            self._stop()
            energy = 0.0
        self._energy = energy

    def _turn_back(self) -> None:
        """Take back what a wheel has turned about its hub."""
        world, hub = self.world, self._places[self.stance.held][0]
        first, now = self._places - hub, world.position - hub
        across = float(world.mass @ (first[:, 0] * now[:, 1] - first[:, 1] * now[:, 0]))
        along = float(world.mass @ np.sum(first * now, axis=1))
        size = math.hypot(along, across)
        if size > 0.0:
            cos, sin = along / size, across / size
            turn = np.array([[cos, -sin], [sin, cos]])
            world.change("position", hub + now @ turn)
            world.change("velocity", world.velocity @ turn)

    def _drop(self) -> float:
        """How far it has sagged by now."""
        position, stance = self.world.position, self.stance
        down = self._places[:, 1] - position[:, 1]
        if stance.support is Support.FLOOR:
            drop = float(np.ptp(self._places[:, 1]) - np.ptp(position[:, 1]))
        elif stance.support is Support.ENDS:
            drop = float(down.max() - down[stance.rests].mean())
        else:
            drop = float(down.max())
        return drop / stance.length if stance.length > 0.0 else 0.0

    def _look(self) -> None:
        position, now = self.world.position, self._drop()
        moved, changed = float(np.abs(position - self._before).max()), abs(now - self._sag_before)
        if not math.isfinite(moved) or abs(now) > LOST:
            self.sag = math.nan
            return
        self._still = self._still + 1 if moved < AT_REST * self.stance.length else 0
        self._settled = self._settled + 1 if changed < SETTLED * now else 0
        if self._still == 2 or self._settled == 3:
            self.sag = max(now, 0.0)
        elif self.world.tick - self._from >= LONGEST:
            about = moved < CALM * self.stance.length and changed <= NEAR * abs(now)
            self.sag = max(now, 0.0) if about else math.nan
        self._before, self._sag_before = position.copy(), now


def _may_buckle(stance: Stance) -> bool:
    wide, tall = np.ptp(stance.points, axis=0)
    return stance.support in (Support.FLOOR, Support.ARM) and bool(tall > COLUMN * wide)
