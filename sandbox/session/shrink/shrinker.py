"""Shrinker: makes a failing play as small as it gets, in this process or in several."""

import pickle
from collections import deque
from collections.abc import Generator, Iterable, Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from contextlib import ExitStack
from dataclasses import replace

from sandbox.level.document.model import Level
from sandbox.session.replay.recording import Replay
from sandbox.session.shrink.failure import Failure, FailureSeen
from sandbox.session.shrink.passes import ROUNDER, SHORTER, Answer, Pass
from sandbox.session.shrink.play import Play
from sandbox.session.shrink.trials import Trials, TriedPlay
from sandbox.session.worker_pool import interrupts_ignored, worker_pool


class Shrinker:
    """Makes a play that fails smaller. smallest: until now; seen: what it does; tries: how many plays were run.

    What it finds is the same for any number of processes: of the candidates of a pass the first counts that fails.
    """

    def __init__(self, level: Level, play: Play, failure: Failure) -> None:
        """Run the play once; seen is None where it does not fail. Raises FailureError."""
        self.level, self.original = level, play
        self._trials = Trials(level, failure)
        first = self._trials.run(replace(play, ticks=play.ticks + failure.beyond))
        self.seen: FailureSeen | None = first.seen
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
        """All of some passes, until none of them finds anything."""
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


def shrinker_of(replay: Replay, failure: Failure, level: Level | None = None) -> Shrinker:
    """A shrinker of what a recording did, on its own level or on another. Raises FailureError."""
    return Shrinker(level or replay.level, Play(replay.script, replay.ticks), failure)


def find_failure(replay: Replay, failure: Failure, level: Level | None = None) -> FailureSeen | None:
    """Run a recording's commands, on its own level or on another, and say how they fail; None where they do not.

    Commands that cannot be carried out are left out. Raises FailureError where the level has nothing of the kind.
    """
    return shrinker_of(replay, failure, level).seen


# In a process that tries plays: what it was given last, and its trials.
_work: list[tuple[bytes, Trials]] = []


def try_play(work: bytes, play: Play) -> TriedPlay:
    """Run a play in a process of a pool; work: the level and the failure."""
    if not _work or _work[0][0] != work:
        _work[:] = [(work, Trials(*pickle.loads(work)))]
    return _work[0][1].run(play)
