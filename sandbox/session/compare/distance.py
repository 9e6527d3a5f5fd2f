"""Trajectory distance: how far two runs come from each other, particle by particle, and whether that grows or heals."""

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np

from sandbox.level.assembly.build_world import build_world
from sandbox.physics.analysis.query import shown_particles
from sandbox.physics.arrays import Floats, Slots
from sandbox.physics.geometry.segment import lengths
from sandbox.physics.snapshot import Snapshot, restore
from sandbox.physics.state import BY_STORED
from sandbox.physics.world import World
from sandbox.session.check_run import CheckWatch
from sandbox.session.commands import CommandError
from sandbox.session.commands.adding import name_added
from sandbox.session.outcome import outcome, outcome_text
from sandbox.session.replay.format import decode_array
from sandbox.session.replay.recording import Replay
from sandbox.session.session import Session

# What is at least this part of the largest distance at the end is growing still.
STILL_GROWING = 0.5
# What a picture shows [m].
VISIBLE = 1e-3
# A course has so many ticks, from the first that differs to the last.
COURSE = 4

# Called with the ticks done and those in all.
Progress = Callable[[int, int], None]


@dataclass(frozen=True)
class TrajectoryDistance:
    """Distances [m] of the particles of two runs, of those that both have.

    first: the first tick at which one is elsewhere, None: none ever is; heals: the tick from which on none is any more.
    farthest, particle, slots, tick: the largest distance, whose it is, by name and by slot in both runs, and when.
    end: the largest distance at the last tick that was compared, last. series: the largest distance at each tick that
    was compared.
    alone: particles that one run alone has. stored: whether only the states that the recording stores were compared.
    stopped: why it ends early, or "". lines: what else there is to say of both runs, their checks and outcomes.
    """

    first: int | None
    heals: int | None
    farthest: float
    particle: str
    slots: tuple[int, int]
    tick: int
    end: float
    last: int
    series: tuple[tuple[int, float], ...]
    alone: int
    stored: bool
    stopped: str = ""
    lines: tuple[str, ...] = ()

    @property
    def is_visible(self) -> bool:
        """Whether a picture shows the largest distance."""
        return self.farthest >= VISIBLE

    def __str__(self) -> str:
        where = " at the stored states" if self.stored else ""
        if self.first is None:
            return f"no particle is elsewhere{where} until tick {self.last}"
        most = f"at most {metres(self.farthest)} apart{where}, {self.particle} at tick {self.tick}"
        if self.tick == self.last:
            return f"{most}, the last"
        return f"{most}; {metres(self.end)} at the end, tick {self.last}"

    def lines_of_all(self) -> list[str]:
        """All distances, a line each."""
        alone = f"{self.alone} particle{'s are' if self.alone > 1 else ' is'} in one of the runs alone"
        return [
            str(self), *([alone] if self.alone else []), *self.lines, *([self.stopped] if self.stopped else [])
        ]  # fmt: skip

    @property
    def course(self) -> list[tuple[int, float]]:
        """The largest distance at some ticks, from the first that differs to the last."""
        begun = [each for each in self.series if self.first is not None and each[0] >= self.first]
        places = sorted({round(part * (len(begun) - 1) / (COURSE - 1)) for part in range(COURSE)}) if begun else []
        return [begun[place] for place in places]

    def data(self) -> dict[str, Any]:
        """All of it but the series, for JSON."""
        known = {each.name: getattr(self, each.name) for each in fields(self) if each.name != "series"}
        return {**known, "course": self.course, "verdict": self.verdict()}

    def verdict(self) -> str:
        """Whether the distance shrinks or grows, with its value at some ticks on the way."""
        if self.first is None:
            return "no particle is elsewhere at any tick"
        way = ", ".join(f"{metres(distance)} at tick {tick}" for tick, distance in self.course)
        if self.heals is not None:
            return f"it heals: from tick {self.heals} on no particle is elsewhere ({way})"
        return f"it {'grows' if self.end >= STILL_GROWING * self.farthest else 'shrinks'}: {way}"


def metres(distance: float) -> str:
    """A distance [m] in words: "1.4 m", "2 cm", "3.1e-09 m"."""
    if not math.isfinite(distance):
        return "any distance"
    if distance >= 100.0:
        return f"{distance:.0f} m"
    if distance >= 0.1:
        return f"{distance:.2g} m"
    return f"{100 * distance:.2g} cm" if distance >= 1e-3 else f"{distance:.1e} m" if distance else "0 m"


def distance_in_step(
    expected: Session, actual: Session, ticks: int, progress: Progress | None = None
) -> TrajectoryDistance:
    """Step two runs that are at the same tick on to another, and measure.

    From the first tick on, what both levels check is measured in both.
    """
    watched = _WatchedRuns(expected, actual) if expected.tick == actual.tick == 0 else None
    stopped: list[str] = []

    def pairs() -> Iterator[tuple[World, World]]:
        while True:
            if watched is not None:
                watched.look()
            yield expected.world, actual.world
            if actual.tick >= ticks:
                return
            for session, which in ((expected, "recorded"), (actual, "new")):
                try:
                    session.advance()
                except CommandError as error:
                    stopped.append(f"the {which} run ends at tick {session.tick}: {error.faults[0]}")
                    return
            if progress is not None:
                progress(actual.tick, ticks)

    with np.errstate(over="ignore", invalid="ignore"):
        found = _measured(pairs(), False)
    said = (*(watched.lines() if watched else ()), *_outcomes(expected, actual))
    return replace(found, stopped="; ".join(stopped), lines=said)


def distance_from_stored(replay: Replay, actual: Session, progress: Progress | None = None) -> TrajectoryDistance:
    """Step a run on to the end of a recording, and measure at those of its ticks whose states the recording stores."""
    stopped: list[str] = []

    def pairs() -> Iterator[tuple[World, World]]:
        for tick in sorted(each for each in replay.states if each >= actual.tick):
            recorded = recorded_world(replay, tick)
            while actual.tick < tick:
                try:
                    actual.advance()
                except CommandError as error:
                    stopped.append(f"the new run ends at tick {actual.tick}: {error.faults[0]}")
                    return
                if progress is not None:
                    progress(actual.tick, replay.ticks)
            if recorded is not None:
                yield recorded, actual.world

    with np.errstate(over="ignore", invalid="ignore"):
        return replace(_measured(pairs(), True), stopped="; ".join(stopped))


def distance_as_stored(first: Replay, second: Replay) -> TrajectoryDistance:
    """Measure two recordings at the ticks whose states both store."""
    shared = sorted(first.states.keys() & second.states.keys())
    pairs = ((recorded_world(first, tick), recorded_world(second, tick)) for tick in shared)
    return _measured(((a, b) for a, b in pairs if a is not None and b is not None), True)


def recorded_world(replay: Replay, tick: int) -> World | None:
    """A world as a recording stores it at a tick, also one of another physics version, of which only the places count.

    None where nothing of it can be read.
    """
    stored = replay.states[tick]
    world = build_world(replay.level)
    try:
        restore(world, stored.of(replay.level, tick))
    except ValueError:
        # As built, with other places; what joined it stays out.
        try:
            position = decode_array(BY_STORED["position"], stored.arrays.get("position", ""))
        except ValueError:
            return None
        count = min(len(position), world.particle_count)
        world.position[:count] = position[:count]
        world.tick = tick
        return world
    name_added(world)
    return world


def distances(a: World | Snapshot, b: World | Snapshot, slots: tuple[Slots, Slots] | None = None) -> Floats:
    """Distances (n,) [m] of the particles that two states show, 0 of others; infinite where one is nowhere.

    slots: of the same particles in both, None: all, in the same order.
    """
    one, other = (a.position, b.position) if slots is None else (a.position[slots[0]], b.position[slots[1]])
    shown = shown_particles(a), shown_particles(b)
    both = shown[0] & shown[1] if slots is None else shown[0][slots[0]] & shown[1][slots[1]]
    with np.errstate(over="ignore", invalid="ignore"):
        far = np.where(both, lengths(one - other), 0.0)
    far[np.isnan(far)] = np.inf
    return far


class SameParticles:
    """Which particles of two worlds are the same by name, found anew when their topology changes. alone: how many one
    of the two shows alone.
    """

    def __init__(self) -> None:
        self._slots: tuple[Slots, Slots] | None = None
        self._key: tuple[Any, ...] = ()
        self.alone = 0

    def farthest(self, a: World, b: World) -> tuple[float, tuple[int, int]]:
        """The largest distance [m] of a particle that both have, and its slots in both."""
        key = (id(a), a.topology_version, a.hand_version, id(b), b.topology_version, b.hand_version)
        if key != self._key:
            self._key = key
            self._pair(a, b)
        far = distances(a, b, self._slots)
        if not len(far):
            return 0.0, (0, 0)
        place = int(np.argmax(far))
        slots = self._slots
        return float(far[place]), (place, place) if slots is None else (int(slots[0][place]), int(slots[1][place]))

    def _pair(self, a: World, b: World) -> None:
        names = a.particle_names
        if names == b.particle_names:
            self._slots = None
        else:
            known = {name: slot for slot, name in enumerate(b.particle_names)}
            ours = [slot for slot, name in enumerate(names) if name in known]
            theirs = [known[names[slot]] for slot in ours]
            self._slots = np.array(ours, dtype=np.int64), np.array(theirs, dtype=np.int64)
        shown = shown_particles(a), shown_particles(b)
        both = shown[0] & shown[1] if self._slots is None else shown[0][self._slots[0]] & shown[1][self._slots[1]]
        self.alone = int(sum(map(np.count_nonzero, shown)) - 2 * np.count_nonzero(both))


def _measured(pairs: Iterable[tuple[World, World]], stored: bool) -> TrajectoryDistance:
    same = SameParticles()
    ticks: list[int] = []
    series: list[float] = []
    most, particle, both, tick = 0.0, "", (0, 0), 0
    for a, b in pairs:
        far, slots = same.farthest(a, b)
        if far > most:
            most, particle, both, tick = far, b.particle_names[slots[1]], slots, b.tick
        ticks.append(b.tick)
        series.append(far)
    different = [number for number, distance in enumerate(series) if distance > 0.0]
    heals = different[-1] + 1 if different and different[-1] + 1 < len(series) else None
    return TrajectoryDistance(
        first=ticks[different[0]] if different else None,
        heals=None if heals is None else ticks[heals],
        farthest=most,
        particle=particle,
        slots=both,
        tick=tick,
        end=series[-1] if series else 0.0,
        last=ticks[-1] if ticks else 0,
        series=tuple(zip(ticks, series, strict=True)),
        alone=same.alone,
        stored=stored,
    )


class _WatchedRuns:
    """The checks that both of two runs' levels have by name, measured in both; those that hold keys are left out."""

    def __init__(self, expected: Session, actual: Session) -> None:
        levels = expected.level, actual.level
        known = [{each.name: k for k, each in enumerate(level.checks) if not each.hold} for level in levels]
        self._names = [name for name in known[1] if name in known[0]]
        self._found: list[dict[str, tuple[bool, str]]] = [{}, {}]
        self._watches = []
        for session, numbers in zip((expected, actual), known, strict=True):
            chosen = [numbers[name] for name in self._names]
            self._watches.append(CheckWatch(session.level, session.world, chosen))
        self._levels = levels

    def look(self) -> None:
        """Measure the distances at this tick."""
        for watch, level, found in zip(self._watches, self._levels, self._found, strict=True):
            if watch.waiting:
                for number, result in watch.look():
                    found[level.checks[number].name] = result.passed, result.text

    def lines(self) -> list[str]:
        """How many checks hold as before, and what became of the others."""
        before, now = self._found
        decided = [name for name in self._names if name in before and name in now]
        if not decided:
            return []
        still = [name for name in decided if now[name][0] and before[name][0]]
        other = [name for name in decided if now[name][0] != before[name][0]]
        both = len(decided) - len(still) - len(other)
        failing = f", {both} fail{'s' if both == 1 else ''} in both runs" if both else ""
        return [
            f"checks in this run: {len(still)} of {len(decided)} hold as before{failing}",
            *(f"{'held' if before[name][0] else 'failed'} before: {now[name][1]}" for name in other),
        ]  # fmt: skip


def _outcomes(expected: Session, actual: Session) -> list[str]:
    """Whether the runs are won or lost, where they differ in that."""
    found = [
        (outcome_text(ended, session.level.settings.tick_rate) if ended else "neither won nor lost")
        for session in (expected, actual)
        for ended in [outcome(session.level, session.world)]
    ]
    return [f"outcome: {found[0]} -> {found[1]}"] if found[0] != found[1] else []
