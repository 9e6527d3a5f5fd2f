"""SoundEvents: collects what is to be heard of a run: blows, splashes, breaks, jerks of strings, rubbing and motors.

It reads and never writes. What each body sounds like: its stuff from its look, its pitch from size, mass and stiffness.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sandbox.app.draw.looks import GRAINS, STRANDS, Look, ball_look, body_looks
from sandbox.app.draw.things.level_slots import level_slots_of
from sandbox.app.sound.waves import STUFFS, Note, note
from sandbox.level.assembly.build_world import LevelWorld
from sandbox.level.document.model import Level
from sandbox.physics.analysis.query import shown_particles
from sandbox.physics.arrays import Floats, Slots
from sandbox.physics.marks import DISC, GRAB_COUNT, KINDS, TERRAIN, TIP
from sandbox.physics.substeps import substep_time
from sandbox.physics.world import World

# A blow is heard from this change of velocity on [m/s], and is as loud as any at the other.
SOFTEST, HARDEST = 0.35, 9.0
# A ball that no contact tells of was struck where its velocity changed by this much [m/s] and more.
LEAP = 1.0
# What goes on for longer than about this [s] is no event any more: a heap that settles, a wheel that rolls.
MEMORY = 0.25
# A blow is one where there is this many times more of it than there was of late.
NEWS = 1.5
# From what friction does to a body in a tick [m^2/s^2 a kg] a squeak is heard, and where it is loudest.
RUB, HARD_RUB = 0.12, 1.2
# From what jerk of a string [m/s] it sounds, and where it is loudest.
JERK, HARD_JERK = 1.0, 8.0
# Strings of the size of a level would be too low to hear: this many times higher, up to this many Hz.
TUNED, HIGHEST_STRING = 24.0, 700.0
# Pitches [Hz] of a break of a spring of 0.3 m, and of a motor that stands and one of 1 rad/s.
SNAP_PITCH, MOTOR_PITCH, MOTOR_RISE = 420.0, 70.0, 9.0
# A splash is heard from this speed [m/s] through the surface on, and is as loud as any at the other; its pitch [Hz],
# where what falls in sounds at 200 Hz when it is struck.
SOFT_SPLASH, HARD_SPLASH, SPLASH_PITCH = 0.7, 7.0, 260.0
# Of one tick at most this many of each kind: the loudest.
MOST = 4


class Sounding(NamedTuple):
    """Something to be heard: what, how loud 0..1, where [m], and whose, so that one thing does not repeat itself."""

    note: Note
    loudness: float
    place: tuple[float, float]
    source: int


class _Touching(NamedTuple):
    """What touches, k of them: its particle, the other disc or -1, push and rub = impulses [N s], is it the ground."""

    particle: Slots
    other: Slots
    push: Floats
    rub: Floats
    is_ground: NDArray[np.bool_]


@dataclass(eq=False)
class _Before:
    """The state that the next tick is compared with."""

    tick: int
    velocity: Floats
    spring_active: NDArray[np.bool_]
    topology: int
    held: list[tuple[int, float]]


class _Onsets:
    """Tells for which bodies a measure has just risen well above its usual value."""

    def __init__(self, count: int) -> None:
        self._usual = np.full(count, np.inf)

    def new(self, now: Floats, least: float, keep: float) -> Slots:
        """Timbres of which there is much more now than of late; keep: what share of the past still counts."""
        found = np.flatnonzero(now > NEWS * self._usual + least)
        # At first what is there already is nothing new.
        self._usual = np.where(np.isinf(self._usual), now, np.maximum(self._usual * keep, now))
        return found


class SoundEvents:
    """Told of every tick by `hear`, after it; what it heard waits in `heard`."""

    def __init__(self) -> None:
        self.heard: list[Sounding] = []
        # Whether bodies have come that `likely_notes` has not told of.
        self.has_new_bodies = False
        self._before: _Before | None = None
        self._bodies: Timbres | None = None
        self._key: tuple[object, ...] = ()
        self._owners: tuple[int, bytes] | None = None

    def forget(self) -> None:
        """Compare the next tick with nothing, as time has jumped."""
        self._before = None
        self.heard.clear()

    def likely_notes(self) -> list[Note]:
        """What the bodies that there are sound like when they are struck, what is heaviest last."""
        self.has_new_bodies = False
        bodies = self._bodies
        if bodies is None:
            return []
        order = np.argsort(bodies.mass, kind="stable").tolist()
        notes = [note("thud", float(bodies.pitch[b]), bodies.stuff[b]) for b in order]
        return list(dict.fromkeys(reversed(notes)))[::-1]

    def hear(self, world: LevelWorld) -> None:
        """Take in a tick of the world."""
        key = (world.particle_count, world.joined, self._owners_of(world))
        if self._bodies is None or self._key != key:
            # Pieces go on as the whole was, and the cut is heard.
            self._before = self._before if self._key[:2] == key[:2] else None
            self._bodies, self._key = timbres_of(world), key
            count, self.has_new_bodies = len(self._bodies.mass), True
            self._blows, self._rubs, self._jerks, self._splashes = (_Onsets(count) for _ in range(4))
        before = self._before
        if before is not None and before.tick == world.tick - 1:
            keep = float(np.exp(-1.0 / (MEMORY * world.settings.tick_rate)))
            with np.errstate(all="ignore"):
                self._hear_contacts(world, before, keep)
                self._hear_splashes(world, keep)
                self._hear_breaks(world, before)
                self._hear_strings(world, before, keep)
        held = _held(world)
        if before is None or before.topology != world.topology_version:
            active = world.spring_active.copy()
        else:
            active = before.spring_active
        self._before = _Before(world.tick, world.velocity.copy(), active, world.topology_version, held)

    def _owners_of(self, world: World) -> bytes:
        # Looked at only where something was cut, or may be whole again.
        if self._owners is None or self._owners[0] != world.topology_version:
            self._owners = world.topology_version, world.owner.tobytes()
        return self._owners[1]

    def _add(self, kind: str, pitch: float, stuff: str, loudness: float, place: Floats, body: int) -> None:
        assert self._bodies is not None
        if np.isfinite(loudness) and np.isfinite(pitch) and np.isfinite(place).all():
            at = (float(place[0]), float(place[1]))
            self.heard.append(
                Sounding(note(kind, pitch, stuff), min(float(loudness), 1.0), at, int(self._bodies.owner[body]))
            )

    # Blows and rubbing.

    def _hear_contacts(self, world: World, before: _Before, keep: float) -> None:
        bodies = self._bodies
        assert bodies is not None
        count = len(bodies.mass)
        felt, rub = np.zeros(count), np.zeros(count)
        touch = _touching(world, self._leaping(world, before))
        if len(touch.particle):
            particle, body = touch.particle, bodies.body[touch.particle]
            fall = np.array(world.settings.gravity) / world.settings.tick_rate
            velocity = world.velocity[particle]
            change = velocity - before.velocity[particle] - fall * world.gravity_scale[particle, None]
            jump = np.where(world.inverse_mass[particle] > 0.0, np.hypot(change[:, 0], change[:, 1]), 0.0)
            blow = np.maximum(jump * world.mass[particle], touch.push)
            speed = np.zeros(count)
            np.maximum.at(speed, body, jump)
            # What a whole body feels of it, and its hardest hit part: the geometric mean.
            felt = np.sqrt(speed * np.bincount(body, blow, count) / bodies.mass)
            power = np.where(touch.is_ground, touch.rub * np.hypot(velocity[:, 0], velocity[:, 1]), 0.0)
            rub = np.where(bodies.squeaks, np.bincount(body, power, count) / bodies.mass, 0.0)
        for b in _loudest(self._blows.new(felt, SOFTEST, keep), felt):
            hardest = int(np.argmax(np.where(body == b, blow, -1.0)))
            other = int(touch.other[hardest])
            # A bumper rings rather than what strikes it.
            sounding = b if other < 0 or world.inverse_mass[other] > 0.0 else int(bodies.body[other])
            loudness = (felt[b] / HARDEST) ** 0.75 * bodies.weight[b]
            place = world.position[particle[hardest]]
            self._add("thud", bodies.pitch[sounding], bodies.stuff[sounding], loudness, place, b)
        for b in _loudest(self._rubs.new(rub, RUB, keep), rub):
            place = world.position[particle[np.argmax(np.where(body == b, power, -1.0))]]
            self._add("squeak", 2.5 * bodies.pitch[b], "", (rub[b] / HARD_RUB) ** 0.7 * bodies.weight[b], place, b)

    def _leaping(self, world: World, before: _Before) -> Slots:
        """Balls that were struck in a tick: some are apart again at its end, and no contact tells of it."""
        assert self._bodies is not None
        balls = self._bodies.balls
        change = world.velocity[balls] - before.velocity[balls]
        fast = (change[:, 0] * change[:, 0] + change[:, 1] * change[:, 1] > LEAP * LEAP) & world.particle_active[balls]
        held = [particle for particle, _ in before.held]
        return balls[fast & ~np.isin(balls, held)] if fast.any() else balls[:0]

    # Splashes.

    def _hear_splashes(self, world: World, keep: float) -> None:
        bodies = self._bodies
        assert bodies is not None
        if not len(world.water):
            return
        x, y = world.position.T
        sinking = world.velocity[:, 1] / world.settings.tick_rate
        passing = np.zeros(len(x), dtype=np.bool_)
        for left, _, right, top, *_ in world.water.tolist():
            passing |= ((y > top) != (y - sinking > top)) & (x > left) & (x < right)
        passing &= world.particle_active & (world.inverse_mass > 0.0)
        found, count = np.flatnonzero(passing), len(bodies.mass)
        body, speed = bodies.body[found], np.zeros(count)
        np.maximum.at(speed, body, np.abs(world.velocity[found, 1]))
        for b in _loudest(self._splashes.new(speed, SOFT_SPLASH, keep), speed):
            place = world.position[found[np.argmax(np.where(body == b, np.abs(world.velocity[found, 1]), -1.0))]]
            loudness = (speed[b] / HARD_SPLASH) ** 0.8 * bodies.weight[b]
            self._add("splash", SPLASH_PITCH * float(bodies.pitch[b] / 200.0) ** 0.5, "", loudness, place, b)

    # Breaks.

    def _hear_breaks(self, world: World, before: _Before) -> None:
        if before.topology == world.topology_version or len(before.spring_active) > world.spring_count:
            return
        active = world.spring_active
        gone = np.flatnonzero(before.spring_active & ~active[: len(before.spring_active)])
        ends = world.particle_active[world.particle_a[gone]] & world.particle_active[world.particle_b[gone]]
        # Not those of hands, nor of what was taken out whole.
        gone = gone[ends & (world.material[gone] >= 0)]
        assert self._bodies is not None
        body = self._bodies.body[world.particle_a[gone]]
        for b in np.unique(body)[:MOST]:
            springs = gone[body == b]
            length = float(np.median(world.rest_length[springs]))
            stiff = float(np.median(world.stiffness[springs]))
            pitch = SNAP_PITCH * (0.3 / max(length, 1e-3)) ** 0.5 * (0.6 + stiff)
            loudness = min(1.0, 0.55 + 0.12 * np.log2(len(springs))) * self._bodies.weight[b]
            self._add("snap", pitch, "", loudness, world.position[world.particle_a[springs[0]]], int(b))

    # Strings.

    def _hear_strings(self, world: World, before: _Before, keep: float) -> None:
        bodies = self._bodies
        assert bodies is not None
        for grab, (particle, pull) in enumerate(before.held):
            if particle >= 0 and not world.is_held(grab) and particle < len(bodies.body):
                b = int(bodies.body[particle])
                if bodies.strand[b] or bodies.stuff[b] in ("metal", "wood"):
                    loudness = 0.8 * (pull / (100.0 * bodies.mass[b])) ** 0.5
                    self._add("pluck", self._string_pitch(world, b), "", loudness, world.position[particle], b)
        if not len(bodies.strings):
            return
        mine = bodies.strings[world.spring_active[bodies.strings]]
        body, most = bodies.body[world.particle_a[mine]], np.zeros(len(bodies.mass))
        np.maximum.at(most, body, world.tension[mine])
        jerk = most / bodies.mass
        for b in _loudest(self._jerks.new(jerk, JERK, keep), jerk):
            place = world.position[world.particle_a[mine[np.argmax(body == b)]]]
            self._add("pluck", self._string_pitch(world, b), "", 0.8 * (jerk[b] / HARD_JERK) ** 0.8, place, b)

    def _string_pitch(self, world: World, body: int) -> float:
        """Pitch [Hz] of a string: f = sqrt(T L / m) / (2 L), many times higher, so that it can be heard."""
        bodies = self._bodies
        assert bodies is not None
        springs = (bodies.body[world.particle_a] == body) & world.spring_active & (world.material >= 0)
        length = max(float(world.rest_length[springs].sum()), 1e-3)
        weight = float(bodies.mass[body]) * float(np.hypot(*world.settings.gravity) or 1.0)
        pull = max(float(np.max(world.tension[springs], initial=0.0)) / substep_time(world.settings), 0.3 * weight)
        return min(TUNED * float(np.sqrt(pull * length / bodies.mass[body])) / (2.0 * length), HIGHEST_STRING)

    # Motors.

    def motors(self, world: World) -> list[Sounding]:
        """What motors and hydraulics are doing now; source: the number of the part."""
        found = []
        motors, hydraulics = world.actuators.motors, world.actuators.hydraulics
        for k in np.flatnonzero(world.actuator_value[motors.part]):
            hub, rim = int(motors.hub[k]), motors.rim[motors.rim_start[k] : motors.rim_start[k + 1]]
            arm, way = world.position[rim] - world.position[hub], world.velocity[rim] - world.velocity[hub]
            with np.errstate(all="ignore"):
                turning = np.abs(np.mean((arm[:, 0] * way[:, 1] - arm[:, 1] * way[:, 0]) / np.sum(arm * arm, axis=1)))
                load = abs(world.actuator_impulse[motors.part[k]]) / substep_time(world.settings) / motors.torque[k]
                fraction = min(turning / (abs(motors.speed[k]) or 1.0), 1.0)
                effort = (0.2 + 0.8 * fraction) * (0.6 + 0.4 * min(load, 1.0))
            if np.isfinite(turning) and np.isfinite(effort) and np.isfinite(world.position[hub]).all():
                x, y = world.position[hub].tolist()
                pitch = MOTOR_PITCH + MOTOR_RISE * float(turning)
                found.append(Sounding(note("motor", pitch), float(effort), (x, y), int(motors.part[k])))
        for k in np.flatnonzero(world.actuator_value[hydraulics.part]):
            spring, value = int(hydraulics.spring[k]), world.actuator_value[hydraulics.part[k]]
            length = world.rest_length[spring]
            moves = length < hydraulics.longest[k] if value > 0 else length > hydraulics.shortest[k]
            place = world.position[world.particle_a[spring]]
            if moves and world.spring_active[spring] and np.isfinite(place).all():
                at = (float(place[0]), float(place[1]))
                found.append(Sounding(note("motor", 1.6 * MOTOR_PITCH), 0.6, at, int(hydraulics.part[k])))
        return found


def _touching(world: World, others: Slots) -> _Touching:
    """Contacts of the last step and impacts of the tick, of two discs for each of them; and others that were struck."""
    own = (world.contact_particle >= 0) & (world.contact_particle < world.particle_count)
    particle, feature = world.contact_particle[own].astype(np.int64), world.contact_feature[own]
    kind, number, impulse = feature % KINDS, feature // KINDS, np.abs(world.contact_impulse[own])
    push, rub = impulse[:, 0] + np.abs(world.contact_impact[own]), impulse[:, 1]
    discs = (kind == DISC) & (number < world.particle_count)
    other = np.where(discs, number, -1)
    others = others[~np.isin(others, np.concatenate([particle, number[discs]]))] if len(others) else others
    none = np.zeros(len(others))
    return _Touching(
        np.concatenate([particle, number[discs], others]),
        np.concatenate([other, particle[discs], others - others - 1]),
        np.concatenate([push, push[discs], none]),
        np.concatenate([rub, rub[discs], none]),
        np.concatenate([np.isin(kind, (TERRAIN, TIP)), np.zeros(discs.sum() + len(others), dtype=np.bool_)]),
    )


def _held(world: World) -> list[tuple[int, float]]:
    """The particle that each hand holds, -1: none, and its force [N]."""
    if world.grab_spring < 0 or not len(world.hand_strength):
        return []
    return [
        (int(world.particle_b[world.grab_spring + grab]), float(np.hypot(*world.hand_force[grab])))
        if world.is_held(grab)
        else (-1, 0.0)
        for grab in range(GRAB_COUNT)
    ]


def _loudest(found: Slots, loudness: Floats) -> list[int]:
    """The MOST loudest of the sounds that were found."""
    order = np.argsort(-loudness[found], kind="stable")[:MOST]
    return [int(each) for each in found[order]]


# What the stuff of a skin, a line or a ball sounds like.
_SKINS = {
    "jelly": "jelly", "plain": "jelly", "rubber": "rubber", "balloon": "rubber", "tyre": "rubber", "cloth": "cloth",
    "wood": "wood", "stone": "stone", "brick": "stone", "steel wheel": "metal",
}  # fmt: skip
_LINES = {
    "steel": "metal", "paint": "metal", "brass": "metal", "chain": "metal", "piston": "metal", "deck": "wood",
    "wood": "wood", "bone": "wood", "muscle": "jelly", "rubber": "rubber", "coil": "metal", "hidden": "rubber",
}  # fmt: skip
_BALLS = {
    "marble": "glass", "stripe": "rubber", "steel": "metal", "sand": "stone", "bumper": "metal", "plain": "wood",
}  # fmt: skip
# What rubs with a squeak.
SQUEAKING = ("jelly", "rubber")
# How fast pitch falls with size [m] and with mass [kg], and rises with Cs over that of a usual jelly.
BY_SIZE, BY_MASS, BY_STIFFNESS, USUAL_STIFFNESS = 0.6, 0.08, 0.15, 0.02
# Small things are quieter than one of 0.6 m, by this power of their size, to no less than this.
LOUD_SIZE, QUIETER, LEAST = 0.6, 0.5, 0.3


@dataclass(frozen=True, eq=False)
class Timbres:
    """The bodies of a world by number, b of them.

    body (n,): of every particle. By number (b,): owner, as the world calls them; mass [kg]; size [m]; pitch [Hz] when
    struck; weight 0..1, how loud they are beside others; strand: whether they are strings; squeaks: whether they do
    where they rub; stuff, of STUFFS. strings: slots of the springs of strings; balls: those that are a body each.
    """

    body: Slots
    owner: Slots
    mass: Floats
    size: Floats
    pitch: Floats
    weight: Floats
    strand: NDArray[np.bool_]
    squeaks: NDArray[np.bool_]
    strings: Slots
    balls: Slots
    stuff: list[str]


def timbres_of(world: LevelWorld) -> Timbres:
    """Timbres of the world's bodies."""
    owners, body = np.unique(world.owner, return_inverse=True)
    body = body.reshape(-1)
    count = len(owners)
    mass = np.bincount(body, world.mass, count).astype(np.float64)
    counts = np.bincount(body, minlength=count)
    spread = np.zeros(count)
    for axis in range(2):
        mean = np.bincount(body, world.origin[:, axis], count) / counts
        spread += np.bincount(body, (world.origin[:, axis] - mean[body]) ** 2, count) / counts
    size = 2.0 * np.sqrt(spread) + 2.0 * np.bincount(body, world.radius, count) / counts
    first = body[np.minimum(world.particle_a, len(body) - 1)]
    held = np.bincount(first, minlength=count)
    stiffness = np.where(
        held > 0, np.bincount(first, world.stiffness, count) / np.maximum(held, 1), USUAL_STIFFNESS
    )  # fmt: skip
    kinds = dict(_kinds(world))
    # The number of a piece that was cut off says its first particle alone.
    is_cut = bool(np.any(world.owner[shown_particles(world)] < 0))
    wholes = np.where(owners < 0, _wholes(world)[-1 - np.minimum(owners, -1)], owners) if is_cut else owners
    found = [kinds.get(int(owner), ("rubber", False)) for owner in wholes]
    stuff = [kind for kind, _ in found]
    pitch = np.array([STUFFS[kind].pitch for kind in stuff])
    with np.errstate(all="ignore"):
        pitch = pitch * np.maximum(size, 1e-3) ** -BY_SIZE * np.maximum(mass, 1e-6) ** -BY_MASS
        pitch *= np.clip(stiffness / USUAL_STIFFNESS, 0.01, 100.0) ** BY_STIFFNESS
        weight = np.clip((size / LOUD_SIZE) ** QUIETER, LEAST, 1.0)
    strand = np.array([is_strand for _, is_strand in found], dtype=np.bool_)
    squeaks = np.array([kind in SQUEAKING for kind in stuff], dtype=np.bool_)
    strings = np.flatnonzero(strand[first] & (world.material >= 0))
    balls = np.flatnonzero((counts[body] == 1) & (world.owner >= 0))
    return Timbres(body, owners.astype(np.int64), mass, size, pitch, weight, strand, squeaks, strings, balls, stuff)


def _kinds(world: LevelWorld) -> Iterator[tuple[int, tuple[str, bool]]]:
    """Owner, stuff and whether it is a string, of every body of the level and of what joined it."""
    yield from enumerate(_of_level(world.level))
    for joined in world.joined:
        if joined.first_particle < len(world.owner):
            yield from enumerate(_of_level(joined.level), int(world.owner[joined.first_particle]))


def _wholes(world: LevelWorld) -> Slots:
    """The numbers (n,) that the bodies of particles had before anything was cut; -1: it is of no body of a level."""
    found = np.full(len(world.owner), -1, dtype=np.int64)
    parts = [(0, 0, world.level)]
    parts += [(each.first_particle, int(world.owner[each.first_particle]), each.level) for each in world.joined]
    for first, owner, level in parts:
        for number, actor in enumerate(level_slots_of(level).actors):
            found[first + actor.slots] = owner + number
    return found


def _of_level(level: Level) -> Iterator[tuple[str, bool]]:
    for look in body_looks(level):
        yield _of_look(look)
    many = sum(not particle.pinned for particle in level.particles) > GRAINS
    for index, particle in enumerate(level.particles):
        yield _BALLS[ball_look(level, particle, index, many)[0]], False


def _of_look(look: Look) -> tuple[str, bool]:
    if look.skin in _SKINS:
        return _SKINS[look.skin], False
    if look.line in STRANDS and look.line not in ("deck", "chain"):
        return "cloth", True
    return _LINES[look.line], look.line == "chain"
