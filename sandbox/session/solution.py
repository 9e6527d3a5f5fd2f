"""Solutions: the recording beside a level's file that wins it; whether it still does, or where it parts."""

import contextlib
from collections import deque
from collections.abc import Generator, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from sandbox.level.document.model import Level
from sandbox.level.format.level_error import one_line
from sandbox.level.format.writing import unfinished
from sandbox.level.plan.run_rules import run_rules
from sandbox.level.reading.files import read_level
from sandbox.physics.snapshot import state_hash
from sandbox.session.commands import CommandError
from sandbox.session.commands.records import ScriptLine
from sandbox.session.compare.distance import SameParticles, metres
from sandbox.session.level_edits import runs_alike
from sandbox.session.outcome import Outcome, outcome, outcome_text
from sandbox.session.replay.link import run_of
from sandbox.session.replay.reader import read_in_slices, read_replay
from sandbox.session.replay.recording import Replay, ReplayError
from sandbox.session.session import Session

SUFFIX = ".solution.replay.gz"
# Two runs part where one particle of both is so far from itself [m]: a hand's breadth, which a picture shows.
APART = 0.1
# A solution has that long after its end [s]: after an edit it may win a little later.
AFTER = 5.0
# Ticks of a run that is recorded again, from one pause to the next.
SLICE_TICKS = 4


@dataclass(frozen=True)
class Verdict:
    """What came of a solution on a level: whether it passed, in words, and the outcome; None: neither won nor lost."""

    passed: bool
    text: str
    outcome: Outcome | None = None


def solution_of(path: Path) -> Path:
    """Where the solution of a level's file is kept."""
    return path.with_name(f"{path.name.removesuffix('.json')}{SUFFIX}")


def solved_text(found: Outcome, rate: int) -> str:
    """The win of a solution in words; rate: ticks in a second."""
    return f"Solved in {found.tick / rate:.1f} s with {found.stars} star{'s' * (found.stars > 1)}, by its author."


def recorded_win(level: Level, replay: Replay) -> Outcome | None:
    """The win that a recording's own end shows, where its level runs as this one does; None: it has to be run."""
    if not replay.is_of_this_physics or not runs_alike(level, replay.level):
        return None
    try:
        found = outcome(level, replay.state(replay.ticks))
    except ReplayError:
        return None
    return found if found is not None and found.is_won else None


def known_solution(level: Level, path: Path) -> Generator[None, None, tuple[Replay, str] | None]:
    """The solution beside a level's file and its win in words, read a slice at a time; None: none, or it has to be run.

    What is damaged is none: that is told where levels are checked.
    """
    with contextlib.suppress(ReplayError):
        if level.has_goal and solution_of(path).is_file():
            replay = yield from read_in_slices(solution_of(path))
            found = recorded_win(level, replay)
            if found is not None:
                return replace(replay, level=level), solved_text(found, level.settings.tick_rate)
    return None


class Proof:
    """A solution's commands on a level, run a slice at a time: `work` goes on, `done` is the part that is done, 0..1.

    verdict: None until it is known. run: once it has won, what it did, as a recording that knows its end alone.
    """

    def __init__(self, level: Level, replay: Replay) -> None:
        self.level, self.replay = replay.on(level), replay
        self.done = 0.0
        self.verdict: Verdict | None = None
        self.run: Replay | None = None
        self.work = self._work()

    def whole(self) -> Verdict:
        """The verdict, all at once."""
        deque(self.work, 0)
        assert self.verdict is not None
        return self.verdict

    def _work(self) -> Iterator[None]:
        level, replay = self.level, self.replay
        session, rate, name = Session(level, script=replay.script), level.settings.tick_rate, Path(replay.source).name
        fault, found = "", None
        last = replay.ticks + round(AFTER * rate)
        while not fault and found is None and session.tick < last:
            fault = _advanced(session)
            found = outcome(level, session.world)
            self.done = session.tick / last
            yield None
        if found is not None and found.is_won:
            script = tuple(line for line in replay.script if line.tick <= session.tick)
            self.run = run_of(replay.source, level, script, session.tick, state_hash(session.world))
            self.verdict = Verdict(True, f"{outcome_text(found, rate)}, by {name}", found)
            return
        said = outcome_text(found, rate) if found else f"not won in the {replay.ticks / rate:.2f} s"
        where = f"at {session.tick / rate:.2f} s: {fault}" if fault else (yield from self._parting(session))
        self.verdict = Verdict(False, f"{said} of {name}; {f'it parts {where}' if where else SAME_RUN}", found)

    def _parting(self, ended: Session) -> Generator[None, None, str]:
        """Where the run first differs from the recording's own by what a person sees; "": nowhere."""
        own, now = (Session(each, script=self.replay.script) for each in (self.replay.level, self.level))
        same, rate, names = (
            SameParticles(),
            self.replay.level.settings.tick_rate,
            [rule.id for rule in run_rules(own.level)],
        )
        first = dict(zip((rule.id for rule in run_rules(self.level)), ended.world.rule_first.tolist(), strict=True))
        while True:
            far, (_, slot) = same.farthest(own.world, now.world)
            at = f"at {own.tick / rate:.2f} s"
            if far > APART:
                return f"{at}: {now.world.particle_names[slot]} is {metres(far)} from where it was"
            for rule in np.flatnonzero(own.world.rule_first == own.tick).tolist():
                if first.get(names[rule], -1) < 0:
                    return f"{at}: the rule {names[rule]} fired there, and does not now"
            if own.tick >= self.replay.ticks or now.tick >= ended.tick or _advanced(own) or _advanced(now):
                return ""
            yield None


# Said where all goes as it was recorded until the run ends.
SAME_RUN = "it goes as it went, and yet is not won"


def _advanced(session: Session) -> str:
    """Make a tick; why its script cannot be followed, or ""."""
    try:
        with np.errstate(over="ignore", invalid="ignore"):
            session.advance()
    except CommandError as error:
        # Which line of the recording it was is nothing to a person.
        return one_line(error.faults[0].partition(": ")[2])
    return ""


def try_goal(level: Level, path: Path) -> Verdict | None:
    """Run a level by the solution beside its file, until it is won or lost; None for a level without a goal."""
    if not level.has_goal:
        return None
    solution = solution_of(path)
    if not solution.exists():
        return Verdict(True, f"not tried: there is no {solution.name}")
    try:
        found = Proof(level, read_replay(solution)).whole()
    except ReplayError as error:
        return Verdict(False, f"FAILS: {solution.name}: {error.faults[0]}")
    return found if found.passed else Verdict(False, f"FAILS: {found.text}", found.outcome)


def recorded(level: Level, script: Sequence[ScriptLine], ticks: int, path: Path) -> Generator[float, None, Session]:
    """Record commands on a level until a tick, a slice at a time: the part that is done, 0..1; then the run.

    What does not get to its end leaves no file. Raises CommandError, and OSError where the file cannot be written.
    """
    session = Session(level, script=script)
    try:
        session.record_to(path)
        while session.tick < ticks:
            session.advance()
            if session.tick % SLICE_TICKS == 0:
                yield session.tick / ticks
        session.apply_pending()
        if session.stop_recording() is None:
            raise OSError(session.refusals[-1])
    except BaseException:
        session.abandon_recording()
        with contextlib.suppress(OSError):
            path.unlink(missing_ok=True)
        raise
    return session


def keep_solution(path: Path, script: Sequence[ScriptLine], ticks: int) -> Generator[float, None, Verdict]:
    """Record commands as the solution of a level's file, a slice at a time; one that does not win keeps none.

    Raises LevelError, CommandError and OSError.
    """
    level, target = read_level(path), solution_of(path)
    partial = unfinished(target, ".replay.gz")
    session = yield from recorded(level, script, ticks, partial)
    found = outcome(level, session.world)
    if found is None or not found.is_won:
        partial.unlink()
        return Verdict(False, f"it does not win {path.name}, so it is not kept as its solution", found)
    partial.replace(target)
    return Verdict(True, f"{outcome_text(found, level.settings.tick_rate)}, by {target.name}", found)
