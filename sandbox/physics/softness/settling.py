"""SettleRun: how far a body sags, measured by a run of its own: alone, as it is held in its world, until it rests.

It is held (SupportedBody) by its pins, by what hangs on pins, or by a floor; then it stands, on the side of it on which
it does so without tipping over.
"""

import math
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np

from sandbox.physics.arrays import Flags, Floats, Slots
from sandbox.physics.components import label_bodies
from sandbox.physics.constraints import AREA, BEND
from sandbox.physics.keeping.equipment import FirmBody, design_gravity
from sandbox.physics.marks import BANK_UNOPENED, TERRAIN_GROUP
from sandbox.physics.settings import WorldSettings
from sandbox.physics.softness.standing import lies_on_ends, stood_up, upright
from sandbox.physics.step import step
from sandbox.physics.terrain import Chain, make_terrain
from sandbox.physics.world import World

# At its foot or at its head is this share of a body's height, and held from end to end is what is held over this share
# of its length.
EDGE, SPAN = 0.12, 0.6
# A body at one point hangs on it as a wheel does, where its centre lies within this share of its size from it.
BALANCED = 0.05
# What is no farther from terrain than this share of the body's shortest spring lies on it.
TOUCHING = 0.3
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


class Support(Enum):
    """The support of a body, and so what one sees of it under its weight."""

    FLOOR = "floor"  # it stands: its height becomes less
    ENDS = "ends"  # it lies on its ends: its middle drops
    HANGING = "hanging"  # held at its head: it becomes longer
    SPANNED = "spanned"  # held from end to end: what is between drops
    ARM = "arm"  # held at one end: the other drops
    HUB = "hub"  # held at its middle, where it may turn: its rim drops


@dataclass(frozen=True, eq=False)
class SupportedBody:
    """A body alone, as it is held, upright: gravity goes down.

    points [m] (n, 2); mass [kg], gravity_scale, radius [m], friction (n,); pairs (m, 2) with rest lengths [m] (m,);
    areas, bends (t, 3); held (n,): what does not move; rests (n,): what lies on something, for ENDS; length [m]: of
    what a sag is a share.
    """

    points: Floats
    mass: Floats
    gravity_scale: Floats
    radius: Floats
    friction: Floats
    pairs: Slots
    rest: Floats
    areas: Slots
    bends: Slots
    held: Flags
    rests: Flags
    support: Support
    length: float


class SettleRun:
    """A run of a body alone, from rest; sag, of its length: None until it is known, NaN where it does not come to rest.

    pair: Cs and Cd per tick, and the lowest mode, of its springs; moved [m] (n, 2): how far off its form it begins.
    """

    def __init__(
        self, body: SupportedBody, settings: WorldSettings, pair: tuple[float, float, float],
        moved: Floats | float = 0.0,
    ) -> None:  # fmt: skip
        self.body = body
        self.sag: float | None = None
        strength = design_gravity(*settings.gravity)
        gravity = (LEAN * strength if _may_buckle(body) else 0.0, -strength)
        self.world = world = World(replace(settings, gravity=gravity, wind=(0.0, 0.0)))
        lowest = float((body.points[:, 1] - body.radius).min())
        self._places = points = body.points - (body.points[:, 0].mean(), lowest - CLEAR * body.length)
        touches = TERRAIN_GROUP if body.support in (Support.FLOOR, Support.ENDS) else 0
        world.add_particles(
            [str(k) for k in range(len(points))], points, mass=body.mass, radius=body.radius, pinned=body.held,
            gravity_scale=body.gravity_scale, owner=0, group=TERRAIN_GROUP, collides=touches, friction=body.friction,
        )  # fmt: skip
        world.add_springs([f"s{k}" for k in range(len(body.pairs))], *body.pairs.T, rest_length=body.rest)
        for kind, corners in ((AREA, body.areas), (BEND, body.bends)):
            if len(corners):
                world.add_constraints(kind, corners)
        if touches:
            world.terrain = make_terrain(self._ground())
        for name, value in zip(("stiffness", "damping", "lowest_mode"), pair, strict=True):
            world.change(name, value)
            world.change(f"constraint_{name}", value)
        world.change("position", points + moved)
        self._energy, self._still, self._settled = 0.0, 0, 0
        self._before, self._sag_before = world.position.copy(), math.inf

    def _ground(self) -> list[Chain]:
        points = self._places
        far = 20.0 * (float(np.ptp(points)) + 1.0)
        if self.body.support is Support.FLOOR:
            return [Chain([[-far, 0.0], [far, 0.0]], friction=FRICTION)]
        x = np.sort(points[self.body.rests, 0])
        gap = int(np.argmax(np.diff(x)))
        reach = 0.01 * self.body.length
        ends = ((-far, float(x[gap]) + reach), (float(x[gap + 1]) - reach, far))
        return [Chain([[start, 0.0], [end, 0.0]], friction=FRICTION) for start, end in ends]

    @property
    def moved(self) -> Floats:
        """How far its particles (n, 2) are from their places in its form [m]."""
        return self.world.position - self._places

    def advance(self) -> bool:
        """Step a tick; True: the sag is known, at rest or at the end."""
        step(self.world)
        if self.body.support is Support.HUB:
            self._turn_back()
        # Where it lies on its ends it has to swing, or friction keeps them where they are.
        if self.body.support is not Support.ENDS:
            self._calm()
        if self.world.tick % LOOK_EVERY == 0:
            self._look()
        return self.sag is not None

    def _turn_back(self) -> None:
        """Take back the rotation of a wheel about its hub."""
        world, hub = self.world, self._places[self.body.held][0]
        first, now = self._places - hub, world.position - hub
        across = float(world.mass @ (first[:, 0] * now[:, 1] - first[:, 1] * now[:, 0]))
        along = float(world.mass @ np.sum(first * now, axis=1))
        size = math.hypot(along, across)
        if size > 0.0:
            cos, sin = along / size, across / size
            turn = np.array([[cos, -sin], [sin, cos]])
            world.change("position", hub + now @ turn)
            world.change("velocity", world.velocity @ turn)

    def _calm(self) -> None:
        """Stop where the body has its greatest speed, at the middle of its swing: it stays near where it will rest."""
        world = self.world
        energy = float(world.mass @ np.sum(world.velocity * world.velocity, axis=1))
        # What creeps slows down as well, by little from tick to tick.
        if energy < 0.98 * self._energy:
            world.change("velocity", 0.0)
            world.slow_velocity[:] = 0.0
            world.energy_bank[:] = BANK_UNOPENED
            energy = 0.0
        self._energy = energy

    def _look(self) -> None:
        position, now, length = self.world.position, self._drop(), self.body.length
        moved, changed = float(np.abs(position - self._before).max()), abs(now - self._sag_before)
        if not math.isfinite(moved) or abs(now) > LOST:
            self.sag = math.nan
            return
        self._still = self._still + 1 if moved < AT_REST * length else 0
        self._settled = self._settled + 1 if changed < SETTLED * now else 0
        if self._still == 2 or self._settled == 3:
            self.sag = max(now, 0.0)
        elif self.world.tick >= LONGEST:
            is_about_at_rest = moved < CALM * length and changed <= NEAR * abs(now)
            self.sag = max(now, 0.0) if is_about_at_rest else math.nan
        self._before, self._sag_before = position.copy(), now

    def _drop(self) -> float:
        """The sag by now, as a fraction of the body's length."""
        y, body = self.world.position[:, 1], self.body
        down = self._places[:, 1] - y
        if body.support is Support.FLOOR:
            drop = float(np.ptp(self._places[:, 1]) - np.ptp(y))
        elif body.support is Support.ENDS:
            drop = float(down.max() - down[body.rests].mean())
        else:
            drop = float(down.max())
        return drop / body.length if body.length > 0.0 else 0.0


def _may_buckle(body: SupportedBody) -> bool:
    wide, tall = np.ptp(body.points, axis=0)
    return body.support in (Support.FLOOR, Support.ARM) and bool(tall > COLUMN * wide)


def supported_body(world: World, body: FirmBody) -> SupportedBody:
    """A body with the supports it has in its world."""
    slots = slots_of(world, body)
    pairs = body.shape.pairs
    points = upright(body.shape.points, world.settings.gravity)
    rest = world.natural_length[body.springs]
    held = _is_held(world, body, slots)
    rests = np.zeros(len(points), np.bool_)
    weight = body.shape.mass * world.gravity_scale[slots]
    support = Support.FLOOR
    if held.any():
        held, support = _support_of(points, weight, held, pairs)
    if not held.any():
        points = stood_up(points, weight)
        if lies_on_ends(body.shape, points):
            support = Support.ENDS
            rests = _resting(world, slots, float(rest.min()), points)
    wide, tall = (float(size) for size in np.ptp(points, axis=0))
    is_upright = support in (Support.FLOOR, Support.HANGING, Support.HUB)
    length = tall if is_upright and tall > 0.0 else max(wide, tall)
    return SupportedBody(
        points, body.shape.mass, world.gravity_scale[slots], world.radius[slots], world.friction[slots], pairs, rest,
        body.shape.areas, body.shape.bends, held, rests, support, length,
    )  # fmt: skip


def slots_of(world: World, body: FirmBody) -> Slots:
    """The particles (n,) of a world that a body's form is made of."""
    slots = np.zeros(len(body.shape.mass), np.int64)
    slots[body.shape.pairs[:, 0]] = world.particle_a[body.springs]
    slots[body.shape.pairs[:, 1]] = world.particle_b[body.springs]
    return slots


def _is_held(world: World, body: FirmBody, slots: Slots) -> Flags:
    """Which of its particles (n,) are pinned, or hang on pins by springs that are not its own."""
    pinned = (world.inverse_mass == 0.0) & world.particle_active
    foreign = world.spring_active & (world.material >= 0)
    foreign[body.springs] = False
    a, b = world.particle_a[foreign], world.particle_b[foreign]
    own = np.zeros(world.particle_count, np.bool_)
    own[slots] = True
    # What other springs join, without going through the body.
    beyond = ~own[a] & ~own[b]
    label = np.arange(world.particle_count)
    label_bodies(a[beyond].astype(np.int64), b[beyond].astype(np.int64), label)
    leads_to_pin = np.zeros(world.particle_count, np.bool_)
    leads_to_pin[label[pinned & ~own]] = True
    held = pinned.copy()
    for one, other in ((a, b), (b, a)):
        tied = own[one] & ~own[other] & leads_to_pin[label[other]]
        held[one[tied]] = True
    return held[slots]


def _support_of(points: Floats, weight: Floats, held: Flags, pairs: Slots) -> tuple[Flags, Support]:
    """Which particles of a held body do not move, and how it is supported."""
    low, high = points.min(axis=0), points.max(axis=0)
    wide, tall = high - low
    if np.ptp(points[held], axis=0).max() == 0.0:
        centre = weight @ points / weight.sum() - points[held][0]
        reach = BALANCED * max(wide, tall)
        if abs(centre[0]) <= reach and centre[1] > reach:
            # A cord from below carries nothing.
            return np.zeros_like(held), Support.FLOOR
        if abs(centre[0]) <= reach:
            return held, Support.HUB if abs(centre[1]) <= reach else Support.HANGING
        # It may turn there; what holds it up elsewhere is not its own.
        beside = held.copy()
        for one, other in ((0, 1), (1, 0)):
            beside[pairs[held[pairs[:, one]], other]] = True
        return beside, Support.ARM
    if points[held, 1].min() >= high[1] - EDGE * tall and tall >= 0.5 * wide:
        return held, Support.HANGING
    if np.ptp(points[held], axis=0).max() >= SPAN * max(wide, tall):
        return held, Support.SPANNED
    return held, Support.ARM


def _resting(world: World, slots: Slots, shortest: float, points: Floats) -> Flags:
    """Which particles (n,) of a beam lie on the level's terrain; where none do, its two ends."""
    reach = world.radius[slots] + TOUCHING * shortest
    places, terrain = world.origin[slots], world.terrain
    distance = np.full(len(points), np.inf)
    for a, b in zip(terrain.vertex[terrain.edge_a], terrain.vertex[terrain.edge_b], strict=True):
        along = b - a
        square = float(along @ along)
        share = np.clip((places - a) @ along / square, 0.0, 1.0) if square > 0.0 else np.zeros(len(places))
        distance = np.minimum(distance, np.hypot(*(places - a - share[:, None] * along).T))
    rests = distance <= reach
    low = points[:, 1] <= points[:, 1].min() + 1e-6 * float(np.ptp(points))
    x = points[:, 0]
    if rests.any() and np.ptp(x[rests]) >= SPAN * np.ptp(x):
        return rests
    return low & ((x <= x[low].min() + 1e-9) | (x >= x[low].max() - 1e-9))
