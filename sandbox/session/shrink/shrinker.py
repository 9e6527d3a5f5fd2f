"""Shrinker: makes a failing play as small as it gets, in this process or in several."""

import os
import pickle
import re
from collections import deque
from collections.abc import Generator, Iterable, Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from contextlib import ExitStack
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any

import numpy as np

from sandbox.level.document.model import Level
from sandbox.physics.snapshot import Snapshot
from sandbox.session.commands.records import ScriptLine
from sandbox.session.compare.distance import VISIBLE
from sandbox.session.replay.recording import Replay
from sandbox.session.session import Session
from sandbox.session.shrink.failures import Diverges, Failure, FailureError, FailureSeen, FailureWatch
from sandbox.session.shrink.passes import ROUNDER, SHORTER, Answer, Pass, Play, short_json
from sandbox.session.worker_pool import interrupts_ignored, worker_pool

# Plays whose states are kept, and states of each: more save ticks, and take memory, some 100 KB each in a large level.
PLAYS_KEPT, STATES_KEPT = 12, 48
# Fewer ticks than these between two states save less than it takes to begin from one.
LEAST_SPACING = 20
# Commands that are written in a test, at most; more are only in the recording.
MOST_SHOWN = 4


@dataclass(frozen=True)
class TriedPlay:
    """The result of a play: the failure, None: not the one looked for; play: the part of it done until then."""

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
                if session.attempt(line.record, line.gesture):
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


class Shrinker:
    """Makes a play that fails smaller. smallest: until now; seen: what it does; tries: how many plays were run; found:
    what the whole play did.

    What it finds is the same for any number of processes: of the candidates of a pass the first counts that fails.
    """

    def __init__(self, level: Level, play: Play, failure: Failure) -> None:
        """Run the play once; seen is None where it does not fail. Raises FailureError."""
        self.level, self.original = level, play
        self._trials = Trials(level, failure)
        first = self._trials.run(replace(play, ticks=play.ticks + failure.beyond))
        self.found = self.seen = first.seen
        self.smallest = first.play
        self.tries = 1
        self._known: set[str] = set()

    def steps(self, processes: int = 1) -> Generator[None, None, None]:
        """Make it smaller; stops after every play that was tried. Close it where that is enough.

        Raises OSError where a process is gone before it has answered.
        """
        if self.seen is None:
            return
        failure = self.seen.failure
        self._trials = Trials(self.level, failure)
        with ExitStack() as stack:
            workers = stack.enter_context(worker_pool(processes)) if processes > 1 else None
            work = pickle.dumps((self.level, failure))
            while True:
                before = self.smallest.size
                for passes in (SHORTER, ROUNDER):
                    yield from self._repeated(passes, workers, work, processes)
                if self.smallest.size == before:
                    return

    def _repeated(
        self, passes: Iterable[Pass], workers: ProcessPoolExecutor | None, work: bytes, processes: int
    ) -> Iterator[None]:
        """Make passes over and over until none of them finds a smaller play."""
        while True:
            before = self.smallest.size
            for each in passes:
                yield from self._pass(each(self.smallest), workers, work, processes)
            if self.smallest.size == before:
                return

    def _pass(
        self,
        candidates: Generator[Iterable[Play], Answer, None],
        workers: ProcessPoolExecutor | None,
        work: bytes,
        processes: int,
    ) -> Iterator[None]:
        try:
            batch = next(candidates)
            while True:
                found = yield from self._first(batch, workers, work, processes)
                batch = candidates.send(found)
        except StopIteration:
            return

    def _first(
        self, batch: Iterable[Play], workers: ProcessPoolExecutor | None, work: bytes, processes: int
    ) -> Generator[None, None, Answer]:
        """Try candidates until one fails and is smaller; its place and what of it was done."""
        waiting: deque[tuple[int, Play, Future[TriedPlay] | None]] = deque()
        numbered = ((place, play) for place, play in enumerate(batch) if self._is_worth(play))
        while True:
            while len(waiting) < processes and (following := next(numbered, None)) is not None:
                place, play = following
                waiting.append((place, play, self._begun(play, workers, work)))
            if not waiting:
                return None
            place, play, future = waiting.popleft()
            tried = self._trials.run(play) if future is None else future.result()
            self.tries += 1
            self._known.add(play.key)
            if tried.seen is not None and tried.play.size < self.smallest.size:
                self.smallest, self.seen = tried.play, tried.seen
                for _, _, other in waiting:
                    if other is not None:
                        other.cancel()
                yield
                return place, tried.play
            yield

    def _is_worth(self, play: Play) -> bool:
        return play.size < self.smallest.size and play.key not in self._known

    def _begun(self, play: Play, workers: ProcessPoolExecutor | None, work: bytes) -> "Future[TriedPlay] | None":
        if workers is None:
            return None
        with interrupts_ignored():
            return workers.submit(try_play, work, play)


def find_failure(replay: Replay, failure: Failure, level: Level | None = None) -> FailureSeen | None:
    """Run a recording's commands, on its own level or on another, and say how they fail; None where they do not.

    Commands that cannot be carried out are left out. Raises FailureError where the level has nothing of the kind.
    """
    return shrinker_of(replay, failure, level).seen


def shrinker_of(replay: Replay, failure: Failure, level: Level | None = None) -> Shrinker:
    """A shrinker of what a recording did, on its own level or on another. Raises FailureError."""
    if isinstance(failure, Diverges):
        failure = replace(failure, level=replay.on(failure.level))
    return Shrinker(replay.on(level), Play(replay.script, replay.ticks), failure)


def shrinker_against(replay: Replay, level: Level) -> Shrinker:
    """A shrinker of how a recording comes apart from itself on another level: as people see it, or else in a bit."""
    visible = shrinker_of(replay, Diverges(level, apart=VISIBLE))
    return visible if visible.seen is not None else shrinker_of(replay, Diverges(level))


# In a process that tries plays: what it was given last, and its trials.
_work: list[tuple[bytes, Trials]] = []


def try_play(work: bytes, play: Play) -> TriedPlay:
    """Run a play in a process of a pool; work: the level and the failure."""
    if not _work or _work[0][0] != work:
        _work[:] = [(work, Trials(*pickle.loads(work)))]
    return _work[0][1].run(play)


def write_recording(play: Play, level: Level, path: Path) -> None:
    """Record a play of a level; where a tick crashes, up to that. Raises OSError where the file cannot be written."""
    session = Session(level)
    session.record_to(path)
    lines = list(play.lines)
    try:
        while session.tick < play.ticks:
            while lines and lines[0].tick == session.tick:
                line = lines.pop(0)
                session.attempt(line.record, line.gesture)
            session.advance()
    except OSError:
        session.abandon_recording()
        raise
    except Exception:
        # The crash is what is recorded.
        pass
    session.take_messages()
    if session.stop_recording() is None:
        raise OSError(0, "; ".join(session.messages), str(path))


def test_text(play: Play, failure: Failure, source: str, recording: Path, levels: dict[str, str | None]) -> str:
    """A test that passes once the smallest run does not fail any more.

    source: the recording that it was made from. levels: names or files, as seen from the test: `own`, of the level that
    the commands run on, None: the recorded one; `other`, of the level that the failure compares it with.
    """
    own, other = levels.get("own"), levels.get("other")
    name = re.sub(r"\W+", "_", recording.name.partition(".replay")[0], flags=re.ASCII).strip("_").lower()
    level = f", {_loaded(own)}" if own else ""
    imports = "CheckFails" if not other and type(failure).__name__ == "CheckFails" else type(failure).__name__
    needs_load = own is not None or other is not None
    shown = [f"    # tick {line.tick}: {short_json(line.record)}" for line in play.lines[:MOST_SHOWN]]
    more = len(play.lines) - MOST_SHOWN
    return "\n".join([
        f'"""The smallest run in which {_plain(failure)}, made from {source} by `sandbox shrink`."""',
        "",
        "from pathlib import Path",
        "",
        *(["from sandbox import load_level"] if needs_load else []),
        f"from sandbox.replay import {', '.join(sorted([imports, 'find_failure', 'read_replay'], key=str.casefold))}",
        "",
        "HERE = Path(__file__).parent",
        "",
        "",
        f"def test_{name}():",
        *shown,
        *([f"    # and {more} more"] if more > 0 else []),
        f'    run = read_replay(HERE / "{recording.name}", retold=True)',
        f"    found = find_failure(run, {code_of(failure, other)}{level})",
        "    assert found is None, found",
        "",
    ])  # fmt: skip


def code_of(failure: Failure, other: str | None) -> str:
    """A failure as Python makes it; other: where its other level is."""
    arguments = []
    for place, each in enumerate(fields(failure)):  # type: ignore[arg-type]
        value = getattr(failure, each.name)
        if isinstance(value, Level):
            arguments.append(_loaded(str(other)))
        elif value != each.default:
            arguments.append(f"{each.name}={_quoted(value)}" if place else _quoted(value))
    return f"{type(failure).__name__}({', '.join(arguments)})"


def _quoted(value: object) -> str:
    return '"' + value.replace("\\", "\\\\").replace('"', '\\"') + '"' if isinstance(value, str) else repr(value)


def _plain(failure: Failure) -> str:
    return str(failure).replace("\\", "\\\\").replace('"""', "'''")


def _loaded(place: str) -> str:
    """How a level is read: a shipped one by its name, a file as seen from the test."""
    return f'load_level("{place}")' if "." not in place else f'load_level(HERE / "{place}")'


def seen_from(path: Path, folder: Path) -> str:
    """A file as seen from a folder, with slashes."""
    return Path(os.path.relpath(path.resolve(), folder.resolve())).as_posix()
