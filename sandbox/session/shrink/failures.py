"""Failure: something that goes wrong in a run, told tick by tick, so that smaller runs can be tried for the same."""

import traceback
from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from sandbox.level.checks import CheckResult
from sandbox.level.document.model import Level
from sandbox.level.plan.run_rules import run_rules
from sandbox.level.rules.player_limits import thing_of
from sandbox.physics.analysis.energy import Dissipation
from sandbox.physics.analysis.query import shown_particles
from sandbox.physics.snapshot import Snapshot, hash_by_array
from sandbox.physics.state import BY_STORED
from sandbox.session.check_run import CheckWatch
from sandbox.session.commands.records import to_record
from sandbox.session.compare.distance import SameParticles
from sandbox.session.compare.divergence import first_difference
from sandbox.session.outcome import outcome, outcome_text
from sandbox.session.session import Session


class FailureError(ValueError):
    """A failure that cannot be looked for in a level; one line."""


@dataclass(frozen=True, repr=False)
class FailureSeen:
    """A failure that was seen. failure: this very one, which smaller runs must have; text: what is wrong, a line."""

    failure: "Failure"
    text: str

    def __repr__(self) -> str:
        return self.text


class FailureWatch:
    """Looks for a failure in one run. is_over: whether it cannot come any more, so that the run may end."""

    is_over = False

    def before(self) -> None:
        """Look at the state that the next tick begins with; its commands are carried out."""

    def after(self) -> FailureSeen | None:
        """Look at the state that a tick has ended with; what has failed in it."""
        return None

    def keep(self) -> Any:
        """What the watch knows of the run until now, for one of another run that goes on from the same state."""
        return None


class Failure(ABC):
    """A failure to look for; other processes can be given it. Its text says it in a few words.

    beyond: ticks after the end of a recording in which it may show.
    """

    beyond = 0

    @abstractmethod
    def watch(self, session: Session, kept: Any = None) -> FailureWatch:
        """FailureWatch a run from its beginning, or from a state at which another watch gave what it kept.

        Raises FailureError where the level has nothing of the kind.
        """

    def raised(self, error: Exception) -> FailureSeen | None:
        """The failure where a tick raises an exception; None: that is another failure than this one."""
        return None


Box = tuple[float, float, float, float]


@dataclass(frozen=True)
class CheckFails(Failure):
    """A check of the level, by its name, does not hold in a run. Keys that the check would hold are not pressed."""

    name: str

    def __str__(self) -> str:
        return f'the check "{self.name}" fails'

    def watch(self, session: Session, kept: Any = None) -> FailureWatch:
        return _CheckWatch(self, session, kept)


class _CheckWatch(FailureWatch):
    def __init__(self, failure: CheckFails, session: Session, kept: Any) -> None:
        self._failure = failure
        names = [check.name for check in session.level.checks]
        if failure.name not in names:
            known = ", ".join(f'"{name}"' for name in names) or "none"
            raise FailureError(f'{session.level.name}: there is no check "{failure.name}"; it has {known}')
        number = names.index(failure.name)
        self._watch = CheckWatch(session.level, session.world, [number], at_once=True)
        if kept is None:
            self._judge(self._watch.look())
        else:
            self._watch.go_on(kept)

    def _judge(self, decided: list[tuple[int, CheckResult]]) -> FailureSeen | None:
        for _, result in decided:
            self.is_over = True
            if not result.passed:
                return FailureSeen(self._failure, result.text)
        return None

    def after(self) -> FailureSeen | None:
        return self._judge(self._watch.look())

    def keep(self) -> Any:
        return self._watch.keep()


@dataclass(frozen=True)
class Crashes(Failure):
    """A tick raises an exception: of this kind, out of this function; "": whichever comes."""

    where: str = ""
    # What has crashed is not recorded.
    beyond = 1

    def __str__(self) -> str:
        return f"it crashes: {self.where}" if self.where else "it crashes"

    def watch(self, session: Session, kept: Any = None) -> FailureWatch:
        return FailureWatch()

    def raised(self, error: Exception) -> FailureSeen | None:
        last = traceback.extract_tb(error.__traceback__)[-1]
        where = f"{type(error).__name__} in {last.name}"
        if self.where not in ("", where):
            return None
        return FailureSeen(Crashes(where), f"{where}, line {last.lineno} of {last.filename}: {str(error)[:200]}")


@dataclass(frozen=True)
class Freezes(Failure):
    """Particles get values that no physics can give, and are frozen where they were.

    array: in which; thing: the body or loose particle; "": any.
    """

    array: str = ""
    thing: str = ""

    def __str__(self) -> str:
        of = f" of {self.thing}" if self.thing else ""
        return f"particles{of} freeze, by their {self.array}" if self.array else f"particles{of} freeze"

    def watch(self, session: Session, kept: Any = None) -> FailureWatch:
        return _FrozenWatch(self, session)


class _FrozenWatch(FailureWatch):
    def __init__(self, failure: Freezes, session: Session) -> None:
        self._failure, self._session = failure, session

    def after(self) -> FailureSeen | None:
        for hit in self._session.world.contained:
            thing = thing_of(hit.name)
            if hit.frozen and self._failure.array in ("", hit.array) and self._failure.thing in ("", thing):
                return FailureSeen(Freezes(hit.array, thing), str(hit))
        return None


@dataclass(frozen=True)
class Leaves(Failure):
    """A particle is outside a box [m]: left, bottom, right, top; None: outside the level's view.

    thing: the body or loose particle that leaves it; side: by which it does, as left; "": any.
    """

    box: Box | None = None
    thing: str = ""
    side: str = ""

    def __str__(self) -> str:
        box = "the level's view" if self.box is None else f"the box {list(self.box)}"
        return f"{self.thing or 'something'} leaves {box}{f' on the {self.side}' if self.side else ''}"

    def watch(self, session: Session, kept: Any = None) -> FailureWatch:
        box = session.level.view if self.box is None else self.box
        if box is None:
            raise FailureError(f"{session.level.name}: the level has no view that could be left; give a box")
        return _BoxWatch(self, session, box)


class _BoxWatch(FailureWatch):
    def __init__(self, failure: Leaves, session: Session, box: Box) -> None:
        self._failure, self._world, self._box = failure, session.world, box

    def after(self) -> FailureSeen | None:
        world, (left, bottom, right, top) = self._world, self._box
        inside = np.all((world.position >= (left, bottom)) & (world.position <= (right, top)), axis=1)
        outside = np.flatnonzero(~inside & shown_particles(world))
        failure = self._failure
        for slot in outside.tolist():
            x, y = world.position[slot].tolist()
            sides = {"left": x < left, "right": x > right, "bottom": y < bottom, "top": y > top}
            # What is nowhere is beyond no side.
            side = next((name for name, beyond in sides.items() if beyond), "")
            name = world.particle_names[slot]
            if failure.thing in ("", thing_of(name)) and failure.side in ("", side):
                found = Leaves(failure.box, thing_of(name), side)
                return FailureSeen(found, f"tick {world.tick}: {name} is at ({x:.2f}, {y:.2f}) m")
        return None


@dataclass(frozen=True)
class IsLost(Failure):
    """The goal of the level is lost; rule: by which one, its id, "": any."""

    rule: str = ""

    def __str__(self) -> str:
        return f'the goal is lost by rule "{self.rule}"' if self.rule else "the goal is lost"

    def watch(self, session: Session, kept: Any = None) -> FailureWatch:
        if not any(action.fail is not None for rule in session.level.rules for action in rule.then):
            raise FailureError(f"{session.level.name}: no rule of the level loses it")
        return _GoalWatch(self, session)


class _GoalWatch(FailureWatch):
    def __init__(self, failure: IsLost, session: Session) -> None:
        self._failure, self._session = failure, session

    def after(self) -> FailureSeen | None:
        found = outcome(self._session.level, self._session.world)
        if found is None:
            return None
        self.is_over = True
        level = self._session.level
        rule, rate = run_rules(level)[found.rule].id, level.settings.tick_rate
        if found.is_won or self._failure.rule not in ("", rule):
            return None
        return FailureSeen(IsLost(rule), f"{outcome_text(found, rate)}: {found.text}")


@dataclass(frozen=True)
class EnergyGrows(Failure):
    """The energy of everything grows by more than a bound [J] while nothing works on it.

    What commands change, and ticks in which a hand, a motor, the wind or a flow works, do not count, see Dissipation.
    """

    bound: float

    def __str__(self) -> str:
        return f"the energy grows by more than {self.bound:g} J by itself"

    def watch(self, session: Session, kept: Any = None) -> FailureWatch:
        return _EnergyWatch(self, session, kept)


class _EnergyWatch(FailureWatch):
    def __init__(self, failure: EnergyGrows, session: Session, kept: float | None) -> None:
        self._failure, self._world = failure, session.world
        self._ticks = Dissipation()
        # Since it was least.
        self._grown = kept or 0.0

    def before(self) -> None:
        self._ticks.energy = 0.0
        self._ticks.before(self._world)

    def after(self) -> FailureSeen | None:
        self._ticks.after(self._world)
        self._grown = max(0.0, self._grown - self._ticks.energy)
        # What is not a number is no proof of anything.
        if not self._grown > self._failure.bound:
            return None
        return FailureSeen(self._failure, f"the energy has grown by {self._grown:.6g} J by itself")

    def keep(self) -> float:
        return self._grown


@dataclass(frozen=True)
class Diverges(Failure):
    """A run differs from the one with the same commands on another level.

    array: the first that differs, "": any; those in which the two differ from the beginning do not count. apart: it is
    no difference of bits, but a particle is further than so [m] from where it is on the other level.
    """

    level: Level = field(repr=False)
    array: str = ""
    apart: float | None = None

    def __str__(self) -> str:
        if self.apart is not None:
            return f"a particle comes more than {self.apart:g} m away from where it is on the other level"
        return f"the runs on both levels differ, first in {self.array or 'any array'}"

    def watch(self, session: Session, kept: Any = None) -> FailureWatch:
        return _PairWatch(self, session, kept)


class _PairWatch(FailureWatch):
    def __init__(self, failure: Diverges, session: Session, kept: tuple[Snapshot, frozenset[str]] | None) -> None:
        self._failure, self._session = failure, session
        self._other = Session(failure.level, start=kept[0] if kept else None)
        self._same = SameParticles()
        # How much of the log the other has carried out.
        self._done = len(session.history.log)
        self._aside = kept[1] if kept else frozenset(self._differing())

    def _differing(self) -> list[str]:
        ours, theirs = hash_by_array(self._session.world), hash_by_array(self._other.world)
        return [name for name in BY_STORED if ours.get(name) != theirs.get(name)]

    def before(self) -> None:
        log = self._session.history.log
        for entry in log[self._done :]:
            if not entry.implied:
                record = to_record(entry.command, self._session.world)
                self._other.attempt(record, entry.gesture)
        self._done = len(log)
        self._other.advance()
        self._other.take_messages()

    def after(self) -> FailureSeen | None:
        if self._failure.apart is not None:
            return self._far_apart(self._failure.apart)
        found = next((name for name in self._differing() if name not in self._aside), None)
        if found is None:
            return None
        self.is_over = True
        if self._failure.array not in ("", found):
            return None
        session, column = self._session, BY_STORED[found]
        difference = first_difference(session.tick, found, getattr(session.world, column.name), self._other.world)
        return FailureSeen(Diverges(self._failure.level, found), f"diverged at {difference}")

    def _far_apart(self, bound: float) -> FailureSeen | None:
        ours, theirs = self._session.world, self._other.world
        distance, slots = self._same.farthest(ours, theirs)
        if distance <= bound:
            return None
        text = f"{ours.particle_names[slots[0]]} is {distance:.3g} m from where it is on the other level"
        return FailureSeen(self._failure, f"tick {ours.tick}: {text}")

    def keep(self) -> tuple[Snapshot, frozenset[str]]:
        return self._other.snapshot(), self._aside


def usual_failures(level: Level) -> tuple[Failure, ...]:
    """The failures to look for where none is named: a crash, a check that fails, frozen particles."""
    return (Crashes(), *(CheckFails(name) for name in dict.fromkeys(check.name for check in level.checks)), Freezes())


@dataclass(frozen=True)
class AnyOf(Failure):
    """Whichever of several failures comes first."""

    failures: tuple[Failure, ...]

    @property
    def beyond(self) -> int:  # type: ignore[override]
        return max(each.beyond for each in self.failures)

    def __str__(self) -> str:
        return "; ".join(map(str, self.failures))

    def watch(self, session: Session, kept: Any = None) -> FailureWatch:
        states = kept or [None] * len(self.failures)
        return _Watches([each.watch(session, one) for each, one in zip(self.failures, states, strict=True)])

    def raised(self, error: Exception) -> FailureSeen | None:
        return next((seen for each in self.failures if (seen := each.raised(error)) is not None), None)


class _Watches(FailureWatch):
    def __init__(self, watches: list[FailureWatch]) -> None:
        self._watches = watches

    def before(self) -> None:
        for each in self._watches:
            each.before()

    def after(self) -> FailureSeen | None:
        found = [each.after() for each in self._watches if not each.is_over]
        return next((seen for seen in found if seen is not None), None)

    def keep(self) -> Any:
        return [each.keep() for each in self._watches]
