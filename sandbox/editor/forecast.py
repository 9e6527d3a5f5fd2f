"""Runs of a level beside the sheet, a slice of time at a time: forecast of rest, firing of rules, trail of things.

A forecast is a damped run. Kinetic damping (Cundall 1976; Barnes 1999): each part moves freely until its kinetic energy
has passed a peak, where it is near an equilibrium of most of its motion, and is stopped there. The level's own solver
and settings make the run, so that where it ends is where playing would end.
"""

from collections import deque
from collections.abc import Generator, Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from sandbox.editor.edits.grouping import groups_of
from sandbox.editor.items import Item, Selection
from sandbox.editor.lint.finding import called, falling_particles
from sandbox.editor.scene import Scene, driven_items, make_scene
from sandbox.level.assembly.build_world import build_world
from sandbox.level.document.model import Level
from sandbox.level.format.slices import work_for
from sandbox.level.plan.run_rules import run_rules
from sandbox.physics.step import step
from sandbox.physics.world import World
from sandbox.session.check_run import HeldKeys
from sandbox.session.commands import Command
from sandbox.session.session import Session

Floats = NDArray[np.float64]
Slots = NDArray[np.int64]

# What was done in a run: the tick, the gesture and the command of each, in order.
TimedCommands = list[tuple[int, int, Command]]

# At rest is what moves by less than this part of the level's size within a window of this many seconds. Larger: a heavy
# weight on a long rope stops above its place; smaller: a soft jelly takes minutes.
STILL = 5e-5
# Places are shaken by this part of the level's size first, so that nothing balances on its head for want of a push.
NUDGE = 2e-4
WINDOW = 0.5  # [s]
# What has not come to rest after so long [s of the run] is said not to.
LONGEST = 60.0
# A part is stopped where its kinetic energy has fallen below this share of its last peak. Nearer to 1: the flutter of
# single springs stops it too, and it creeps.
PAST_PEAK = 0.9
# Particles that move, at most: one tick of more takes so long that drawing waits for it.
LARGEST = 4_000


# No more of a run is stepped again [s].
LONGEST_RUN = 60.0


# How far ahead it looks [s], and how often it notes the places in a second.
SECONDS = 5.0
NOTES = 30


class Forecast:
    """A run in work, a slice at a time; it touches nothing but its own world, so a thread of its own may run it.

    position [m] (n, 2) by the particles of the level's Scene: where they are at rest, None until that is known or where
    they do not come to rest; what falls away stays as drawn. falling: items with particles that nothing holds.
    at_rest: whether all else came to rest; None until known.
    """

    def __init__(self, level: Level) -> None:
        self.position: Floats | None = None
        self.at_rest: bool | None = None
        self.falling: Selection = frozenset()
        self._trouble, self._level = "", level
        self._work = self._run(level)

    @property
    def text(self) -> str:
        """The forecast as a line for the person."""
        if self.at_rest is None:
            return "Calculating the forecast"
        if not self.at_rest:
            return self._trouble
        if len(self.falling) == 1:
            subject = called(self._level, *self.falling)
            return f"This is where it comes to rest; {subject} falls away, because nothing holds it"
        if self.falling:
            return f"This is where it comes to rest; {len(self.falling)} items fall away, because nothing holds them"
        return "This is where it comes to rest"

    def advance(self, seconds: float) -> bool:
        """Work for about that long, at least one step; whether it is done. Building and one tick are not divided."""
        return work_for(self._work, seconds)

    def _run(self, level: Level) -> Iterator[None]:
        scene = make_scene(level)
        yield None
        part, is_falling = yield from falling_particles(level, scene)
        owners: list[int] = np.unique(scene.particle_item[is_falling]).tolist()
        self.falling = frozenset(scene.items[index] for index in owners)
        moving = int(np.count_nonzero(~(is_falling | scene.pinned)))
        if not moving:
            self.position, self.at_rest = scene.position, True
            return
        driven = next(driven_items(scene), None)
        if driven is not None:
            self._trouble = f"{called(level, driven)} is driven, and never comes to rest; play it to see"
            self.at_rest = False
            return
        if moving > LARGEST:
            self._trouble = f"{moving:,} particles move, too many for a forecast ({LARGEST:,}); play it to see"
            self.at_rest = False
            return
        world = build_world(level)
        yield None
        # Slots of the world by the particles of the scene: of welded ones the first alone.
        is_first = scene.first_of_weld == np.arange(len(part))
        slots = (np.cumsum(is_first) - 1)[scene.first_of_weld]
        for slot in np.unique(slots[is_falling]).tolist():
            world.pin(slot)
        part = np.unique(part[is_first], return_inverse=True)[1]
        self._trouble = yield from _settle(world, part)
        if not self._trouble:
            self.position = world.position[slots]
            self.position[is_falling] = scene.position[is_falling]
        self.at_rest = not self._trouble


def _settle(world: World, part: Slots) -> Generator[None, None, str]:
    """Run until nothing moves, or for too long: the trouble, empty at rest. part (k,): labels of the first slots."""
    count = len(part)
    free = world.inverse_mass[:count] > 0.0
    mass = np.where(free, world.mass[:count], 0.0)
    tick_rate = world.settings.tick_rate
    window = max(1, round(WINDOW * tick_rate))
    size = float(np.max(np.ptp(world.position[:count], axis=0)))
    shaken = np.random.default_rng(1).uniform(-NUDGE * size, NUDGE * size, (count, 2))
    world.position[:count] += np.where(free[:, None], shaken, 0.0)
    _stop(world, np.ones(count, dtype=np.bool_))
    peak = np.zeros(count)
    before = world.position[:count].copy()
    for tick in range(1, round(LONGEST * tick_rate) + 1):
        step(world)
        if world.contained:
            return "It blows up before it comes to rest; Findings may say which springs are too hard"
        speed = world.velocity[:count]
        energy = np.bincount(part, mass * (speed[:, 0] ** 2 + speed[:, 1] ** 2), count)
        past = energy < PAST_PEAK * peak
        peak = np.where(past, 0.0, np.maximum(peak, energy))
        if past.any():
            _stop(world, past[part])
        if tick % window == 0:
            now = world.position[:count]
            if float(np.max(np.abs(now - before))) <= STILL * size:
                return ""
            before = now.copy()
        yield None
    return f"It does not come to rest within {LONGEST:g} s"


def _stop(world: World, chosen: NDArray[np.bool_]) -> None:
    """Take all speed from particles, of the first slots."""
    slots = np.flatnonzero(chosen)
    world.velocity[slots] = 0.0
    world.slow_velocity[slots] = 0.0


class Firing:
    """A run in work, a slice at a time; times: when each rule fired [s], by its id; fault: why it went no further.

    span: what of the run is looked at, in words: "the last run", or as much of a long one as there is time for.
    """

    def __init__(self, level: Level, commands: TimedCommands, last_tick: int) -> None:
        self.level = level
        ticks = round(LONGEST_RUN * level.settings.tick_rate)
        self.span = "the last run" if last_tick <= ticks else f"the first {LONGEST_RUN:g} s of the last run"
        self.times: dict[str, list[float]] = {rule.id: [] for rule in level.rules}
        self.is_done = False
        self.fault = ""
        self._work = self._run(deque(commands), last_tick)

    def advance(self, seconds: float) -> bool:
        """Work for about that long, at least one tick; whether it is done."""
        self.is_done = work_for(self._work, seconds)
        return self.is_done

    def _run(self, commands: deque[tuple[int, int, Command]], last_tick: int) -> Iterator[None]:
        session = Session(self.level)
        rate, world = session.world.settings.tick_rate, session.world
        if len(world.position) > LARGEST:
            self.fault = "the level is too large to step the run again"
            return
        for _ in range(min(last_tick, round(LONGEST_RUN * rate))):
            while commands and commands[0][0] <= session.tick:
                _, gesture, command = commands.popleft()
                session.submit(command, gesture)
            session.advance()
            for rule in np.flatnonzero(session.world.rule_last == session.tick).tolist():
                self.times[run_rules(self.level)[rule].id.partition(":")[0]].append(session.tick / rate)
            yield None


def timed_commands(run: Session) -> tuple[TimedCommands, int]:
    """The commands that count in a run, and its last tick."""
    entries = [entry for entry in run.history.timeline if entry.in_effect and not entry.implied]
    return [(entry.tick, entry.gesture, entry.command) for entry in entries], run.last_tick


class Trail:
    """A run in work, a slice at a time; it changes nothing but its own session.

    places: of each note the mean place [m] (k, 2) of each item that has particles, NaN of others; per_second: notes in
    a second. fault: why there is none; "" = there is.
    """

    def __init__(self, level: Level, run: Session | None = None) -> None:
        self.level = level
        self.scene: Scene = make_scene(level)
        self.places: list[Floats] = []
        self.per_second = 0.0
        self.is_done = False
        self.fault = ""
        self._work = self._run(run)
        self._found: tuple[object, list[Floats]] = (None, [])

    def advance(self, seconds: float) -> bool:
        """Work for about that long, at least one tick; whether it is done."""
        self.is_done = work_for(self._work, seconds)
        return self.is_done

    def _run(self, run: Session | None) -> Iterator[None]:
        scene = self.scene
        if len(scene.position) > LARGEST:
            self.fault = f"{len(scene.position):,} particles are too many for a trail ({LARGEST:,})"
            return
        # Of welded particles the world has the first alone.
        is_first = scene.first_of_weld == np.arange(len(scene.position))
        slots = (np.cumsum(is_first) - 1)[scene.first_of_weld]
        count = np.bincount(scene.particle_item, minlength=len(scene.items))
        session = run if run is not None else Session(self.level)
        rate = session.world.settings.tick_rate
        every = max(1, rate // NOTES)
        self.per_second = rate / every
        # A level that waits for keys says in its checks which ones to hold.
        held = HeldKeys(self.level, next((check.hold for check in self.level.checks if check.hold), ()))
        last = round(SECONDS * rate) if run is None else min(round(SECONDS * rate), session.last_tick)
        for tick in range(last + 1):
            if tick % every == 0:
                self.places.append(_means(session.world.position[slots], scene.particle_item, count))
            if tick < last:
                if run is None:
                    held.press(session)
                session.advance()
            yield None

    def lines(self, selection: Selection, most: int) -> list[Floats]:
        """The ways [m] (notes, 2) of what is selected, a group's as one, of no more than `most` things.

        They are kept until more is known or something else is asked for: each frame draws them.
        """
        asked = (selection, most, len(self.places))
        if self._found[0] != asked:
            self._found = asked, self._lines(selection)[:most] if self.places else []
        return self._found[1]

    def _lines(self, selection: Selection) -> list[Floats]:
        index = {item: number for number, item in enumerate(self.scene.items)}
        groups = groups_of(self.level)
        units: dict[object, list[Item]] = {}
        for item in sorted(selection.intersection(index), key=index.__getitem__):
            units.setdefault(groups.get(item, item), []).append(item)
        places = np.stack(self.places)
        found = [_middle(places, [index[item] for item in items]) for items in units.values()]
        return [line for line in found if line is not None]


def _means(position: Floats, owner: NDArray[np.int64], count: NDArray[np.int64]) -> Floats:
    with np.errstate(invalid="ignore", divide="ignore"):
        sums = [np.bincount(owner, position[:, axis], len(count)) / count for axis in (0, 1)]
    return np.stack(sums, axis=1)


def _middle(places: Floats, items: Sequence[int]) -> Floats | None:
    chosen = places[:, items]
    known = chosen[:, ~np.isnan(chosen[0, :, 0])]
    return known.mean(axis=1) if known.shape[1] else None
