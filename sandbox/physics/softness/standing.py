"""StandingForm: how far a body of a form sags where it stands, found when the body is made.

The form stands alone on the side on which it does so without tipping over, its foot held. Gravity grows load by load,
and at each the direct solver takes a few ticks of springs so tough that a tick is a step towards rest. What sinks to
the floor is held there as well: a disc stands on more, the farther it sags. By + - * / and square roots alone, like
all that a run follows from.
"""

import bisect
import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from sandbox.physics.arrays import Floats, Slots
from sandbox.physics.constraints import AREA, BEND
from sandbox.physics.equation import HIGHEST_COEFFICIENT, TURN
from sandbox.physics.keeping.equipment import StiffForm, design_gravity
from sandbox.physics.marks import BANK_UNOPENED
from sandbox.physics.settings import WorldSettings
from sandbox.physics.softness.kernels.reach import STANDING
from sandbox.physics.step import step
from sandbox.physics.world import World

# A frame at least so many times as long as high lies on its two ends.
SLENDER = 4.0
# Standing, its centre of mass lies above its foot by this share of its own height, so that it does not tip over.
STEADY = 0.1
# Cs and Cd of the form's springs: the nearer to 1, the sooner it rests, and the more what holds it gives way with it.
TOUGH = 1.0 - 1e-4
# About the first sag, and what is above which it does not stand; how much greater each load is, with its ticks at most,
# which end once one changes the sag by no more than this share of itself; and the sag after which there are no more.
FIRST, MOST_AT_FIRST = 5e-4, 5e-3
HEAVIER, TICKS, AT_REST, LAST = 1.5, 6, 1e-3, 0.45
# Forms of more particles, whose ticks take long, go on in fewer loads.
LARGE, MUCH_HEAVIER = 2_000, 4.0
# What is this near to the floor is on it, and how far away what holds it there is fixed, as shares of its length.
ON_FLOOR, FAR = 1e-6, 10.0
BOTH, UP = np.array([[1.0, 0.0], [0.0, 1.0]]), np.array([[0.0, 1.0]])


class StandingForm:
    """The sags of a form, of whose height, or of whose length on two ends, `length` [m], they are a share.

    length: 0 of a form that has none. gravity [m/s^2]: its direction. lowest_mode: of the form. Loads are
    g / (F^2 length), F^2 = k / m of the slowest wobble as in reach.py.
    """

    def __init__(self, shape: StiffForm, gravity: tuple[float, float], lowest_mode: float) -> None:
        points = stood_up(upright(shape.points, gravity), shape.mass)
        low, high = points.min(axis=0), points.max(axis=0)
        self._shape, self._form = shape, points - np.array([0.5 * (low[0] + high[0]), low[1]])
        self._on_ends = lies_on_ends(shape, points)
        # A link alone has nothing that sags.
        self.length = float((high - low)[0 if self._on_ends else 1]) if len(points) > 2 else 0.0
        self._settings = WorldSettings(gravity=(0.0, -1.0), solver="direct")
        rate = self._settings.tick_rate / TURN
        # F^2 of the wobble of the run [1/s^2].
        self._square = lowest_mode * TOUGH / (1.0 - TOUGH) * rate * rate
        # What is known, load by load: both ascend.
        self._sags: list[float] = []
        self._loads: list[float] = []
        self._held = np.zeros(len(points), np.bool_)
        # The run; None before it begins, and once it has ended.
        self._world: World | None = None
        self._is_new = True

    def constant(self, sag: float) -> float:
        """F^2 length sag / g of a body that sags so far: STANDING of a square that sags little."""
        self._find(lambda: self._sags[-1] >= sag)
        if not self._sags:
            return STANDING
        constants = [one / load for one, load in zip(self._sags, self._loads, strict=True)]
        k = bisect.bisect_left(self._sags, sag)
        if k in (0, len(constants)):
            return constants[min(k, len(constants) - 1)]
        share = (sag - self._sags[k - 1]) / (self._sags[k] - self._sags[k - 1])
        return constants[k - 1] + share * (constants[k] - constants[k - 1])

    def sags(self, loads: Floats) -> Floats:
        """The sags (k,) under loads (k,); inf where one is infinite."""
        heaviest = float(np.max(loads, initial=0.0, where=np.isfinite(loads)))
        self._find(lambda: self._loads[-1] >= heaviest)
        if not self._sags:
            return STANDING * loads
        sag, load = np.array(self._sags), np.array(self._loads)
        constant = sag / load
        # Between two the constant rises evenly with the sag: s = load (c + slope (s - s_k)).
        slope = np.append(np.diff(constant) / np.diff(sag), 0.0)
        at = np.clip(np.searchsorted(load, loads, side="right") - 1, 0, len(sag) - 1)
        rise = np.where(loads < load[0], 0.0, slope[at])
        with np.errstate(invalid="ignore"):
            found = loads * (constant[at] - rise * sag[at]) / (1.0 - loads * rise)
        return np.asarray(np.where(np.isfinite(loads), found, np.inf))

    def _find(self, is_known: Callable[[], bool]) -> None:
        """Go on with the run until that is so, or its end."""
        if self._is_new and self.length > 0.0 and self._square > 0.0:
            self._begin()
        self._is_new = False
        heavier = HEAVIER if len(self._form) <= LARGE else MUCH_HEAVIER
        while self._world is not None and not is_known():
            self._rest(heavier * self._loads[-1] * self._square * self.length)

    def _begin(self) -> None:
        """Find the first load; a form that tips over or falls apart has none."""
        world, shape, points = World(self._settings), self._shape, self._form
        self._world = world
        world.add_particles([str(k) for k in range(len(points))], points, mass=shape.mass, owner=0)
        names = [f"s{k}" for k in range(len(shape.pairs))]
        world.add_springs(names, *shape.pairs.T, stiffness=TOUGH, damping=TOUGH)
        for kind, corners in ((AREA, shape.areas), (BEND, shape.bends)):
            if len(corners):
                world.add_constraints(kind, corners, stiffness=TOUGH, damping=TOUGH)
        foot = np.flatnonzero(points[:, 1] <= ON_FLOOR * self.length)
        if self._on_ends:
            x = points[foot, 0]
            self._hold(world, foot[[np.argmin(x)]], BOTH)
            self._hold(world, foot[[np.argmax(x)]], UP)
        else:
            self._hold(world, foot, BOTH)
        # What it weighs so that it sags by FIRST, from one tick.
        strength = FIRST * self._square * self.length / STANDING
        sag = self._tick(strength)
        self._rest(strength * FIRST / sag if sag > 0.0 else strength)
        if not self._sags or self._sags[0] > MOST_AT_FIRST:
            self._sags, self._loads, self._world = [], [], None

    def _hold(self, world: World, slots: Slots, ways: Floats) -> None:
        """Hold particles (k,) on the floor by a spring along each way: a pin would make their own springs firmer."""
        self._held[slots] = True
        far = FAR * self.length
        on_floor = np.stack([world.position[slots, 0], np.zeros(len(slots))], axis=1)
        for way in ways:
            first = world.particle_count
            names = [f"{first + k}" for k in range(len(slots))]
            world.add_particles(names, on_floor - far * way, pinned=True, owner=0)
            world.add_springs(
                names, np.arange(first, first + len(slots)), slots, rest_length=far,
                stiffness=HIGHEST_COEFFICIENT, damping=HIGHEST_COEFFICIENT,
            )  # fmt: skip

    def _rest(self, strength: float) -> None:
        """Find the sag under gravity of that strength [m/s^2]; the run ends where the form gives way, or lies flat."""
        assert self._world is not None
        sag = self._sags[-1] if self._sags else 0.0
        for _ in range(TICKS):
            before, sag = sag, self._tick(strength)
            sunk = ~self._held & (self._world.position[: len(self._held), 1] < -ON_FLOOR * self.length)
            if not self._on_ends and sunk.any():
                self._hold(self._world, np.flatnonzero(sunk), BOTH)
            elif abs(sag - before) <= AT_REST * sag:
                break
        if sag > (self._sags[-1] if self._sags else 0.0):
            self._sags.append(sag)
            self._loads.append(strength / (self._square * self.length))
        if not self._sags or self._sags[-1] != sag or sag > LAST:
            self._world = None

    def _tick(self, strength: float) -> float:
        """The sag after a tick under gravity of that strength [m/s^2], from which nothing goes on moving."""
        world = self._world
        assert world is not None
        world.settings = replace(self._settings, gravity=(0.0, -strength))
        step(world)
        world.change("velocity", 0.0)
        world.slow_velocity[:] = 0.0
        world.energy_bank[:] = BANK_UNOPENED
        y, was = world.position[: len(self._held), 1], self._form[:, 1]
        drop = (was - y).max() if self._on_ends else was.max() - y.max()
        return float(drop) / self.length


def upright(points: Floats, gravity: tuple[float, float]) -> Floats:
    """Points (n, 2) turned so that gravity [m/s^2] goes down."""
    strength = design_gravity(*gravity)
    x, y = (gravity[0] / strength, gravity[1] / strength) if any(gravity) else (0.0, -1.0)
    return _turned(points, -y, x)


def _turned(points: Floats, along: float, across: float) -> Floats:
    # No product of matrices: a library chooses the order of its sums.
    x, y = points[:, 0], points[:, 1]
    return np.stack([along * x + across * y, along * y - across * x], axis=1)


def lies_on_ends(shape: StiffForm, points: Floats) -> bool:
    """Whether a form that is turned so that it stands lies on its two ends, as a frame does that is long."""
    wide, tall = np.ptp(points, axis=0)
    return not len(shape.areas) and bool(wide >= SLENDER * tall)


def stood_up(points: Floats, weight: Floats) -> Floats:
    """Points turned by the least angle that lets them stand on a side of their hull without tipping over."""
    hull = _hull(points)
    if len(hull) < 3:
        return points
    # Sums one after another.
    centre = np.add.accumulate(weight[:, None] * points)[-1] / np.add.accumulate(weight)[-1]
    best, least = points, math.inf
    for start, end in zip(hull, np.roll(hull, -1, axis=0), strict=True):
        (x, y), (to_x, to_y) = (end - start).tolist(), (centre - start).tolist()
        size = math.sqrt(x * x + y * y)
        x, y = x / size, y / size
        at, height = to_x * x + to_y * y, to_y * x - to_x * y
        margin = min(at, size - at) / max(height, 1e-12)
        # 1 - cos of the angle; one that would tip over comes after all that would not.
        order = 1.0 - x if margin >= STEADY else 10.0 - margin
        if order < least:
            least, best = order, _turned(points, x, y)
    return best


def _hull(points: Floats) -> Floats:
    """The convex hull of points, counter-clockwise, without what lies on its sides."""
    rows = points[np.lexsort((points[:, 1], points[:, 0]))]
    slack = 1e-9 * float(np.ptp(points)) ** 2
    halves: list[Floats] = []
    for order in (rows, rows[::-1]):
        chain: list[Floats] = []
        for point in order:
            while len(chain) > 1:
                (ax, ay), (bx, by) = chain[-1] - chain[-2], point - chain[-2]
                if ax * by - ay * bx > slack:
                    break
                chain.pop()
            chain.append(point)
        halves += chain[:-1]
    return np.array(halves)
