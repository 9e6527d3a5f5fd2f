"""Trials: plays of one level are run until a failure shows, each from the last state that it shares with one before."""

from collections import deque
from dataclasses import dataclass
from typing import Any

import numpy as np

from sandbox.level.document.model import Level
from sandbox.physics.snapshot import Snapshot
from sandbox.session.commands import CommandError
from sandbox.session.commands.records import ScriptLine, from_record
from sandbox.session.session import Session
from sandbox.session.shrink.failure import Failure, FailureError, FailureSeen, FailureWatch
from sandbox.session.shrink.play import Play

# Plays whose states are kept, and states of each: more save ticks, and take memory, some 100 KB each in a large level.
PLAYS_KEPT, STATES_KEPT = 12, 48
# Fewer ticks than these between two states save less than it takes to begin from one.
LEAST_SPACING = 20


@dataclass(frozen=True)
class TriedPlay:
    """What came of a play: what failed, None: not what was looked for; play: what of it was done until then."""

    seen: FailureSeen | None
    play: Play


@dataclass(frozen=True)
class _Mark:
    """A state of a play at a tick, before the commands of that; done: which were carried out until then."""

    state: Snapshot
    watched: Any
    done: tuple[ScriptLine, ...]


class Trials:
    """Runs plays of a level and looks for one failure in each."""

    def __init__(self, level: Level, failure: Failure) -> None:
        self._level, self._failure = level, failure
        self._marks: deque[tuple[Play, list[_Mark]]] = deque(maxlen=PLAYS_KEPT)

    def run(self, play: Play) -> TriedPlay:
        """Run a play until the failure shows, or to its end. A command that cannot be carried out is left out.

        Raises FailureError where the level has nothing of the kind of failure.
        """
        marks = self._shared(play)
        mark = marks[-1] if marks else None
        session = Session(self._level, start=mark.state if mark else None)
        done = list(mark.done) if mark else []
        with np.errstate(over="ignore", invalid="ignore"):
            try:
                watch = self._failure.watch(session, mark.watched if mark else None)
                seen = self._follow(play, session, watch, marks, done)
            except (FailureError, OSError, MemoryError):
                raise
            except Exception as error:
                seen = self._failure.raised(error)
                if seen is None:
                    return TriedPlay(None, play)
                # Shown in the tick after the last one.
                return TriedPlay(seen, Play(tuple(done), session.tick + 1))
        self._marks.append((play, marks))
        return TriedPlay(seen, Play(tuple(done), session.tick))

    def _follow(
        self, play: Play, session: Session, watch: FailureWatch, marks: list[_Mark], done: list[ScriptLine]
    ) -> FailureSeen | None:
        """Run to the end, or until the failure shows; marks, done: what is added to."""
        lines = deque(line for line in play.lines if line.tick >= session.tick)
        spacing = max(LEAST_SPACING, play.ticks // STATES_KEPT)
        last = marks[-1].state.tick if marks else 0
        while session.tick < play.ticks and not watch.is_over:
            while lines and lines[0].tick == session.tick:
                line = lines.popleft()
                if carried_out(session, line):
                    done.append(line)
            watch.before()
            session.advance()
            session.take_messages()
            seen = watch.after()
            if seen is not None:
                return seen
            if session.tick - last >= spacing:
                last = session.tick
                marks.append(_Mark(session.snapshot(), watch.keep(), tuple(done)))
        return None

    def _shared(self, play: Play) -> list[_Mark]:
        """The states that a play shares with the one before with which it shares most. An undo needs all of the run."""
        if play.is_about_commands:
            return []
        best: list[_Mark] = []
        for other, marks in self._marks:
            if other.is_about_commands or not marks:
                continue
            parting = play.parting(other)
            last = play.ticks if parting is None else min(parting, play.ticks)
            shared = [mark for mark in marks if mark.state.tick <= last]
            if shared and (not best or shared[-1].state.tick > best[-1].state.tick):
                best = shared
        return best


def carried_out(session: Session, line: ScriptLine) -> bool:
    """Carry a command out before the next tick; whether that was possible."""
    told = len(session.refusals)
    try:
        command = from_record(line.record, session.world)
    except CommandError:
        return False
    session.submit(command, line.gesture)
    session.apply_pending()
    return len(session.refusals) == told
