"""Runs a level by itself and compares its checks with measurements."""

from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sandbox.level.checks import STILL, CheckDef, CheckResult, HoldDef, excess, judge, window_of
from sandbox.level.document.model import Level
from sandbox.level.plan.actuators import driving_keys
from sandbox.physics.analysis.energy import gravity_energy, kinetic_energy, spring_energy
from sandbox.physics.analysis.query import load_bearing, shown_particles, shown_springs, strain
from sandbox.physics.geometry.elementary import sum_in_order
from sandbox.physics.keeping.arguments import of_kind
from sandbox.physics.marks import GRAB_COUNT
from sandbox.physics.world import World
from sandbox.session.commands import SetDrive
from sandbox.session.session import Session
from sandbox.session.summary import STRAIN_WINDOW, particle_metric, strain_sample


def run_checks(level: Level) -> list[CheckResult]:
    """Run the level by itself as long as its checks ask for, and judge; in the order of the file."""
    results = dict(found for found in checks_as_they_end(of_kind("level", level, Level)) if found is not None)
    return [results[number] for number in sorted(results)]


def checks_as_they_end(level: Level) -> Iterator[tuple[int, CheckResult] | None]:
    """Run the level by itself and give each check's place and result as soon as it is known; None after every tick.

    Checks that hold the same keys share a run.
    """
    for run in check_runs(level):
        while True:
            with np.errstate(over="ignore", invalid="ignore"):
                yield from run.watch.look()
                if not run.watch.waiting:
                    break
                run.advance()
            yield None


class HeldKeys:
    """Presses and releases keys at their ticks; of several that drive one part, the one pressed last counts."""

    def __init__(self, level: Level, holds: Sequence[HoldDef]) -> None:
        rate, keys = level.settings.tick_rate, driving_keys(level) if holds else {}
        spans = [(round(hold.during[0] * rate), round(hold.during[1] * rate), hold.key) for hold in holds]
        self._values: dict[int, dict[int, float]] = {}
        held: dict[int, float] = {}
        for tick in sorted({edge for start, end, _ in spans for edge in (start, end)}):
            pressed = sorted(
                (start, number, key) for number, (start, end, key) in enumerate(spans) if start <= tick < end
            )
            now = {part: value for _, _, key in pressed for part, value in keys[key]}
            changed = {
                part: now.get(part, 0.0) for part in {**held, **now} if held.get(part, 0.0) != now.get(part, 0.0)
            }
            self._values[tick], held = changed, now

    def press(self, session: Session) -> None:
        """Press and release the keys that are due before a session's next tick."""
        for part, value in self._values.get(session.tick, {}).items():
            session.submit(SetDrive(part, value))


class CheckRun:
    """A run of a level with the keys that some of its checks hold, and these checks."""

    def __init__(self, level: Level, holds: tuple[HoldDef, ...], numbers: Sequence[int]) -> None:
        self.session = Session(level)
        self.watch = CheckWatch(level, self.session.world, numbers)
        self._keys = HeldKeys(level, holds)

    def advance(self) -> None:
        """Make one tick, with the keys that are held."""
        self._keys.press(self.session)
        self.session.advance()


def check_runs(level: Level) -> Iterator[CheckRun]:
    """A run for all checks of a level that hold no key, then one for each other choice of keys."""
    groups: dict[tuple[HoldDef, ...], list[int]] = {(): []}
    for number, check in enumerate(level.checks):
        groups.setdefault(check.hold, []).append(number)
    return (CheckRun(level, holds, numbers) for holds, numbers in groups.items())


class CheckWatch:
    """Holds some of a level's checks, by their places, against a run of it, from the first tick on.

    at_once: what must always hold is decided at the first tick at which it does not, and not by the worst of all.
    """

    def __init__(self, level: Level, world: World, numbers: Sequence[int], at_once: bool = False) -> None:
        self._world = world
        checks = [level.checks[number] for number in numbers]
        self._gauge = _Gauge(world, checks)
        rate = level.settings.tick_rate
        self._waiting = {number: _Waiting(level.checks[number], rate, at_once) for number in numbers}

    @property
    def waiting(self) -> int:
        """How many checks are not decided yet."""
        return len(self._waiting)

    def look(self) -> list[tuple[int, CheckResult]]:
        """Measure at this tick, once; the checks that are decided by it, by their places, with their results."""
        self._gauge.look(self._world)
        found = [(number, each.look(self._world.tick, self._gauge)) for number, each in self._waiting.items()]
        decided = [(number, result) for number, result in found if result is not None]
        for number, _ in decided:
            del self._waiting[number]
        return decided

    def keep(self) -> Any:
        """The measured values until now, for a watch of another run of the level that goes on from the same state."""
        return self._gauge.keep(), {number: each.found for number, each in self._waiting.items()}

    def go_on(self, kept: Any) -> None:
        """Go on from the values that another watch of the same checks has kept."""
        measured, waiting = kept
        self._gauge.go_on(measured)
        self._waiting = {number: each for number, each in self._waiting.items() if number in waiting}
        for number, found in waiting.items():
            self._waiting[number].found = found


class _Waiting:
    """A check that is not decided yet; found: the value that decides it as far as is known, and when that was [s]."""

    def __init__(self, check: CheckDef, rate: int, at_once: bool) -> None:
        self._check, self._rate, self._at_once = check, rate, at_once
        self._first, self._last = (round(at * rate) for at in window_of(check))
        self.found: tuple[float, float] | None = None

    def look(self, tick: int, gauge: "_Gauge") -> CheckResult | None:
        """Measure, if the check is due at this tick; its result once it is known."""
        check = self._check
        if tick < self._first:
            return None
        value, at = gauge.value(check), tick / self._rate
        beyond = excess(check, value)
        before = None if self.found is None else excess(check, self.found[0])
        if before is None or (beyond < before if check.eventually else beyond > before):
            self.found = value, at
        decided = beyond <= 0.0 if check.eventually else self._at_once and beyond > 0.0
        if not decided and tick < self._last:
            return None
        assert self.found is not None
        once = not (check.always or check.eventually)
        result = judge(check, value) if once else judge(check, *self.found)
        return result if result.passed else replace(result, text=result.text + gauge.reason(check))


class _Gauge:
    """Measures a running level; what depends on more than the present tick is followed from the first one on."""

    def __init__(self, world: World, checks: Sequence[CheckDef]) -> None:
        self._world = world
        metrics = {check.metric for check in checks}
        self._follows_strain = bool(metrics & {"max_strain", "rms_strain"})
        samples = max(1, round(STRAIN_WINDOW * world.settings.tick_rate))
        self._strains: deque[tuple[float, float, int]] = deque(maxlen=samples)
        # By body, as long as there are particles and springs: commands may add some.
        self._particles: dict[str | None, NDArray[np.bool_]] = {}
        self._springs: dict[str | None, NDArray[np.bool_]] = {}
        # For how many ticks each has been still.
        self._still = {check.body: -1 for check in checks if check.metric == "settled"}
        self._started = world.tick

    def keep(self) -> Any:
        """The gauge's state, to be taken up again."""
        return list(self._strains), dict(self._still), self._started

    def go_on(self, kept: Any) -> None:
        """Go on from the state that another gauge has kept."""
        strains, still, self._started = kept
        self._strains.extend(strains)
        self._still = dict(still)

    def look(self, world: World) -> None:
        """Measure the world after a tick."""
        if self._follows_strain and world.tick > self._started:
            self._strains.append(strain_sample(world))
        for body, ticks in self._still.items():
            speed = np.sqrt(np.sum(world.velocity[self._shown(body)] ** 2, axis=1))
            self._still[body] = ticks + 1 if bool(np.all(speed <= STILL)) else 0

    def value(self, check: CheckDef) -> float:
        """The value that a check measures now."""
        return float(_VALUES[check.metric](self, self._world, check))

    def reason(self, check: CheckDef) -> str:
        """Why a check fails now, where its value does not say it: what moves fastest of what should have settled."""
        moving = np.flatnonzero(self._shown(check.body)) if check.metric == "settled" else ()
        if not len(moving):
            return ""
        speed = np.sqrt(np.sum(self._world.velocity[moving] ** 2, axis=1))
        fastest = int(np.argmax(speed))
        if speed[fastest] <= STILL:
            return ""
        name = self._world.particle_names[moving[fastest]]
        return f"; {name} moves fastest, with {speed[fastest]:.3g} m/s of at most {STILL:g}"

    def _shown(self, body: str | None) -> NDArray[np.bool_]:
        return shown_particles(self._world) & _of_body(self._particles, self._world.particle_names, body, ".")

    def _springs_of(self, body: str | None) -> NDArray[np.bool_]:
        return _of_body(self._springs, self._world.spring_names, body, ":")

    def _max_strain(self, world: World, check: CheckDef) -> float:
        return float(np.max([largest for largest, _, _ in self._strains], initial=0.0))

    def _rms_strain(self, world: World, check: CheckDef) -> float:
        count = sum(count for _, _, count in self._strains)
        return float(np.sqrt(sum(squares for _, squares, _ in self._strains) / count)) if count else 0.0

    def _strain(self, world: World, check: CheckDef) -> float:
        return float(np.max(np.abs(strain(world))[load_bearing(world) & self._springs_of(check.body)], initial=0.0))

    def _energy(self, world: World, check: CheckDef) -> float:
        return kinetic_energy(world) + self._potential_energy(world, check)

    def _potential_energy(self, world: World, check: CheckDef) -> float:
        return spring_energy(world) + gravity_energy(world)

    def _max_speed(self, world: World, check: CheckDef) -> float:
        return float(np.max(np.sqrt(np.sum(world.velocity[self._shown(None)] ** 2, axis=1)), initial=0.0))

    def _non_finite(self, world: World, check: CheckDef) -> int:
        state = np.concatenate([world.position, world.velocity], axis=1)[shown_particles(world)]
        return int(np.count_nonzero(~np.isfinite(state).all(axis=1)))

    def _broken_springs(self, world: World, check: CheckDef) -> int:
        of_body = self._springs_of(check.body)
        hands = np.array([world.is_grab_spring(slot) for slot in range(world.spring_count)], dtype=np.bool_)
        return int(np.count_nonzero(of_body & ~hands) - np.count_nonzero(shown_springs(world) & of_body))

    def _of_owner(self, world: World, check: CheckDef) -> float:
        """The metric of a particle, or of a body's centre of mass."""
        if check.particle is not None:
            return particle_metric(world, check.particle, check.metric)
        shown = self._shown(check.body)
        mass = world.mass[shown]
        x, y = (sum_in_order(mass * world.position[shown, axis]) / sum_in_order(mass) for axis in (0, 1))
        if check.metric != "speed":
            return x if check.metric == "x" else y
        u, v = (sum_in_order(mass * world.velocity[shown, axis]) / sum_in_order(mass) for axis in (0, 1))
        return float(np.hypot(u, v))

    def _distance(self, world: World, check: CheckDef) -> float:
        ends = [world.position[world.particle_slot(str(name))] for name in (check.particle, check.other)]
        return float(np.sqrt(np.sum((ends[0] - ends[1]) ** 2)))

    def _inside(self, world: World, check: CheckDef) -> float:
        """How far inside the box the outermost is, below 0 where it is outside."""
        left, bottom, right, top = check.box or (0.0, 0.0, 0.0, 0.0)
        if check.particle is not None:
            position = world.position[world.particle_slot(check.particle)][None]
        else:
            position = world.position[self._shown(check.body)]
        return float(np.min(np.concatenate([position - (left, bottom), (right, top) - position]), initial=np.inf))

    def _settled(self, world: World, check: CheckDef) -> float:
        return self._still[check.body] / world.settings.tick_rate


def _of_body(
    known: dict[str | None, NDArray[np.bool_]], names: list[str], body: str | None, sign: str
) -> NDArray[np.bool_]:
    """Which of these slots are a body's; all of them where it is None. What is known of other times is looked up."""
    if body not in known or len(known[body]) != len(names):
        known[body] = np.array([body is None or name.startswith(f"{body}{sign}") for name in names], dtype=np.bool_)
    return known[body]


_VALUES: dict[str, Callable[[_Gauge, World, CheckDef], float]] = {
    "max_strain": _Gauge._max_strain,
    "rms_strain": _Gauge._rms_strain,
    "strain": _Gauge._strain,
    "kinetic_energy": lambda gauge, world, check: kinetic_energy(world),
    "potential_energy": _Gauge._potential_energy,
    "energy": _Gauge._energy,
    "max_speed": _Gauge._max_speed,
    "non_finite": _Gauge._non_finite,
    "broken_springs": _Gauge._broken_springs,
    "x": _Gauge._of_owner,
    "y": _Gauge._of_owner,
    "speed": _Gauge._of_owner,
    "distance": _Gauge._distance,
    "inside": _Gauge._inside,
    "settled": _Gauge._settled,
    "held": lambda gauge, world, check: sum(map(world.is_held, range(GRAB_COUNT))),
}
