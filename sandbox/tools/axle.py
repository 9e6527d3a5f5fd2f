"""AxleTool: a click puts an axle through what is there: two bodies turn about it, or one about a place of the world.

An axle is a small wheel, which may have a motor: its rim holds one body, and its hub holds the others, or the air.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np

from sandbox.level.assembly.build_world import JoinedLevel
from sandbox.level.kinds.wheel import WheelDef
from sandbox.physics.analysis.query import bodies_around, particle_at, shown_particles
from sandbox.physics.arrays import FloatRows, Slots
from sandbox.physics.geometry.segment import lengths
from sandbox.physics.snapshot import Snapshot
from sandbox.session.commands import AddBody, AddSpring, Command, CutSprings, Remove
from sandbox.tools.dropping import in_pace
from sandbox.tools.tool import NOTHING, Loop, PlayTool, Point, PointerEvent, Response, Tool

# The body of an axle, by its id, and what it is of.
AXLE_ID, STUFF = "axle", "drawn axle"
# Its spokes, springs from each to what it turns, springs from its hub to each other body, and the shortest one [m].
SPOKES, RIM_TIES, TIES, LEAST = 6, 2, 3, 1e-4
# Its radius, as a share of the mean distance to the nearest particles that it holds; that of its particles, of its own.
RADIUS, SKIN = 0.5, 0.3
# Cs and Cd of what keeps its length.
FIRM = {"stiffness": 1.0, "damping": 1.0}
# A thing is round whose rim is nowhere so much nearer to its middle than elsewhere, in so many directions; an axle
# snaps to the middle from within this share of its radius. What is so many times as long as wide is a plank.
ROUND, DIRECTIONS, SNAP, LONG = 0.25, 8, 0.6, 2.5
# A motor's speed at the rim of what it turns [m/s], its fastest [rad/s], and what it can push for each kg [N/kg].
RIM_SPEED, FASTEST, PUSH = 3.0, 15.0, 8.0
# Its keys: ahead, which is to the right on the ground, and back.
KEYS = ("d", "a")
# Corners of the ring that shows an axle, and places of a wheel at which what it lies over is looked for, or a few more.
CORNERS, SAMPLES = 24, 16
DIGITS, DECIMALS = 6, 4
NOTHING_THERE = "Click on a thing: the axle goes through it."
TOO_FEW = "This is too small for an axle. Hold it with the pin tool (P)."
AIR, RUBS = "the air", ". They rub: draw one over the other, and they pass"


class Thing(NamedTuple):
    """A body that an axle goes through: its owner, its particles, its middle [m], and its radius [m] if it is round."""

    owner: int
    slots: Slots
    middle: Point
    radius: float | None
    word: str


class Hinge(NamedTuple):
    """Where an axle goes [m], the things that turn about it, the one that a motor turns first, and whether it stays."""

    place: Point
    things: Sequence[Thing]
    is_pinned: bool

    def words(self, snapshot: Snapshot) -> str:
        """What it joins, and whether that cannot turn freely."""
        first, *others = self.things
        rubs = any(_touch(snapshot, first.slots[0], other.slots[0]) for other in others)
        return f"{first.word} to {' and '.join(other.word for other in others) or AIR}{RUBS if rubs else ''}"


class Axle(NamedTuple):
    """An axle of a run: its particles, the springs that tie it, and whom they hold, the one that is turned first."""

    slots: Slots
    ties: Slots
    owners: list[int]
    has_motor: bool
    is_pinned: bool


class AxleTool(Tool):
    """Join the bodies under a click by a hinge there, or one body to the world; on an axle: a motor, or none.

    Each is a gesture.
    """

    is_held = False

    def __init__(self, new_gesture: Callable[[], int]) -> None:
        super().__init__(new_gesture)
        self._says, self._ring = "", list[Point]()

    def handle(self, event: PointerEvent, snapshot: Snapshot) -> Response:
        """Put an axle at the place of a press."""
        if event.kind != "down" or event.button != 1:
            return NOTHING
        axle = axle_at(snapshot, event.position, event.pick_radius)
        if axle is not None:
            commands = refitted(snapshot, axle, not axle.has_motor)
        else:
            hinge = hinge_at(snapshot, event.position, event.pick_radius)
            self._refusal = hinge if isinstance(hinge, str) else ""
            if isinstance(hinge, str):
                return NOTHING
            commands = _added(snapshot, hinge, has_motor=False)
        return self._in_one_gesture(commands)

    def target(self, place: Point, within: float, snapshot: Snapshot) -> int | None:
        """A particle of the body that an axle would go through."""
        self._says, self._ring = "", []
        axle = axle_at(snapshot, place, within)
        if axle is not None:
            self._refusal = ""
            self._says = "Click: loose" if axle.has_motor else f"Click: a motor ({KEYS[1].upper()}, {KEYS[0].upper()})"
            return int(axle.slots[0])
        hinge = hinge_at(snapshot, place, within)
        if isinstance(hinge, str):
            return None
        self._says, (x, y), self._refusal = hinge.words(snapshot), hinge.place, ""
        turns = [math.tau * k / CORNERS for k in range(CORNERS + 1)]
        self._ring = [(x + 0.5 * within * math.cos(turn), y + 0.5 * within * math.sin(turn)) for turn in turns]
        return None

    @property
    def ghost(self) -> list[Loop]:
        """A ring where the axle goes [m]."""
        return [self._ring] if self._ring else []

    @property
    def hint(self) -> str:
        """What a click would join, or why the last press did nothing."""
        return self._refusal or self._says


def hinge_at(snapshot: Snapshot, place: Point, within: float) -> Hinge | str:
    """What an axle at a place [m] joins; or why there is none. It snaps to the middle of a round thing."""
    front = particle_at(snapshot, place, within)
    if front is None:
        return NOTHING_THERE
    axles = {int(snapshot.owner[slots[0]]) for slots, _ in _axles(snapshot)}
    owners = {int(snapshot.owner[front]), *bodies_around(snapshot, place).tolist()} - axles
    # What was made later lies before what was there.
    here = [thing for owner in sorted(owners, reverse=True) if (thing := _thing(snapshot, owner)) is not None]
    if not here:
        return TOO_FEW
    # Of two wheels the smaller one turns on the larger.
    wheels = [each for each in here if each.radius and math.dist(each.middle, place) < SNAP * each.radius]
    turned = min(wheels, key=lambda each: each.radius or 0.0, default=here[0])
    if wheels or math.dist(turned.middle, place) < within:
        place = turned.middle
    others = [each for each in here if each is not turned] or (_below(snapshot, turned, axles) if wheels else [])
    return Hinge(_rounded_place(place), [turned, *others], not others)


def axle_at(snapshot: Snapshot, place: Point, within: float) -> Axle | None:
    """The axle at a place [m]."""
    for slots, body in _axles(snapshot):
        if math.dist(snapshot.position[slots[0]].tolist(), place) < within:
            a, b = (np.isin(ends, slots) for ends in (snapshot.particle_a, snapshot.particle_b))
            ties = np.flatnonzero(snapshot.spring_active & (a != b) & (snapshot.material >= 0))
            held = np.where(a[ties], snapshot.particle_b[ties], snapshot.particle_a[ties])
            owners, hub = list(dict.fromkeys(snapshot.owner[held].tolist())), int(slots[0])
            return Axle(slots, ties, owners, body.motor is not None, bool(snapshot.inverse_mass[hub] == 0.0))
    return None


def _axles(snapshot: Snapshot) -> Iterator[tuple[Slots, WheelDef]]:
    """The axles that are there, by their particles, with what they are."""
    for joined in snapshot.equipment.joined:
        body = joined.level.bodies[0] if isinstance(joined, JoinedLevel) and joined.level.bodies else None
        slots = np.arange(joined.first_particle, joined.first_particle + len(joined.particle_names))
        if isinstance(body, WheelDef) and body.id == AXLE_ID and snapshot.particle_active[slots].all():
            yield slots, body


def taken_out(axle: Axle) -> list[Command]:
    """The commands that take an axle out."""
    cut = [CutSprings(tuple(axle.ties.tolist()))] if len(axle.ties) else []
    return [*cut, Remove(particle=int(axle.slots[0]))]


def refitted(snapshot: Snapshot, axle: Axle, has_motor: bool) -> list[Command]:
    """The commands that put an axle with a motor, or without one, in the place of an axle."""
    things = [thing for owner in axle.owners if (thing := _thing(snapshot, owner)) is not None]
    if not things:
        return []
    hinge = Hinge(_rounded_place(tuple(snapshot.position[axle.slots[0]].tolist())), things, axle.is_pinned)
    return [*taken_out(axle), *_added(snapshot, hinge, has_motor)]


def _added(snapshot: Snapshot, hinge: Hinge, has_motor: bool) -> list[Command]:
    """The commands that add an axle: its rim holds the first thing, its hub the others."""
    turned, *mounts = (thing.slots for thing in hinge.things)
    near = np.concatenate([_nearest(snapshot, slots, hinge.place, TIES) for slots in (turned, *mounts)])
    radius = RADIUS * float(lengths(snapshot.position[near] - np.array(hinge.place)).mean())
    mass, first, (x, y) = float(snapshot.mass[near].mean()), len(snapshot.mass), hinge.place
    turns = [math.tau * k / SPOKES for k in range(SPOKES)]
    ends = [
        (first + 1 + SPOKES + k, slot)
        for k, turn in enumerate(turns)
        for slot in _nearest(snapshot, turned, (x + radius * math.cos(turn), y + radius * math.sin(turn)), RIM_TIES)
    ]
    ends += [(first, slot) for slots in mounts for slot in _nearest(snapshot, slots, hinge.place, TIES)]
    wheel = {
        "type": "wheel", "id": AXLE_ID, "position": [x, y], "radius": _rounded(radius), "segments": SPOKES,
        "thickness": _rounded(radius / 2.0), "particle_mass": _rounded(mass / SPOKES), "hub_mass": _rounded(mass),
        "pin": ["hub"] if hinge.is_pinned else [], "particle_radius": _rounded(SKIN * radius), "material": STUFF,
        # It lies inside of what it holds.
        "collides": [],
        **({"motor": _motor(snapshot, hinge)} if has_motor else {}),
    }  # fmt: skip
    body = AddBody(wheel, materials={STUFF: FIRM})
    ties = (AddSpring(own, int(slot), **FIRM) for own, slot in ends)
    return [in_pace(body, snapshot.settings.tick_rate), *ties]


def _motor(snapshot: Snapshot, hinge: Hinge) -> dict[str, Any]:
    """A motor that turns the first of the things of a hinge, on the ground as fast as a child runs."""
    reach = float(lengths(snapshot.position[hinge.things[0].slots] - np.array(hinge.place)).max())
    weight = sum(float(snapshot.mass[thing.slots].sum()) for thing in hinge.things)
    ahead, back = KEYS
    speed, torque = -min(RIM_SPEED / reach, FASTEST), PUSH * weight * reach
    return {"key": ahead, "reverse_key": back, "speed": _rounded(speed), "torque": _rounded(torque)}


def _nearest(snapshot: Snapshot, slots: Slots, place: Point, count: int) -> Slots:
    """The particles that are nearest to a place [m], and not at it."""
    distance = lengths(snapshot.position[slots] - np.array(place))
    off = np.flatnonzero(distance > LEAST)
    return np.asarray(slots[off[np.argsort(distance[off], kind="stable")[:count]]])


def _thing(snapshot: Snapshot, owner: int) -> Thing | None:
    """The body of an owner; None where it has too few particles for an axle."""
    slots = np.flatnonzero(shown_particles(snapshot) & (snapshot.owner == owner))
    if len(slots) <= TIES:
        return None
    places = snapshot.position[slots]
    middle, radius = _round_form(places)
    spread = np.sqrt(np.linalg.eigvalsh(np.cov(places.T)))
    is_long = spread[1] > LONG * spread[0]
    return Thing(owner, slots, middle, radius, "wheel" if radius else "plank" if is_long else "thing")


def _round_form(places: FloatRows) -> tuple[Point, float | None]:
    """The middle [m] of particles, and their radius [m] if their rim is round."""
    middle = (places.min(axis=0) + places.max(axis=0)) / 2.0
    turns, off = np.arange(DIRECTIONS) * (math.tau / DIRECTIONS), places - middle
    along, far = off @ np.array([np.cos(turns), np.sin(turns)]), lengths(off)
    # How far it reaches each way, and how far out its rim is there: a square and a cross are not round.
    reach = along.max(axis=0)
    rim = np.where(along >= math.cos(math.pi / DIRECTIONS) * far[:, None], far[:, None], 0.0).max(axis=0)
    x, y = middle.tolist()
    is_round = min(reach.min(), rim.min()) > (1.0 - ROUND) * reach.max()
    return (x, y), float(reach.max()) if is_round else None


def _below(snapshot: Snapshot, wheel: Thing, axles: set[int]) -> list[Thing]:
    """The thing that a wheel lies over, rather one that it passes, and rather one that it covers most."""
    some = wheel.slots[:: max(1, len(wheel.slots) // SAMPLES)]
    around = [bodies_around(snapshot, (x, y)) for x, y in snapshot.position[some].tolist()]
    owners, counts = np.unique(np.concatenate(around), return_counts=True)
    ranked = owners[np.argsort(-counts, kind="stable")].tolist()
    there = [
        each for owner in ranked if owner not in {wheel.owner, *axles} and (each := _thing(snapshot, owner)) is not None
    ]
    return sorted(there, key=lambda each: _touch(snapshot, wheel.slots[0], each.slots[0]))[:1]


def _touch(snapshot: Snapshot, p: int, q: int) -> bool:
    """Whether the bodies of two particles touch each other."""
    group, collides = snapshot.group, snapshot.collides
    return bool(collides[p] & group[q]) and bool(collides[q] & group[p])


def _rounded_place(place: Point) -> Point:
    return round(place[0], DECIMALS), round(place[1], DECIMALS)


def _rounded(value: float) -> float:
    return float(f"{value:.{DIGITS}g}")


AXLE = PlayTool("axle", ("Shift+7",), "Axle: click where two things turn, or one", "Parts", AxleTool, "add")
