"""Ways to run a recording again in this process; each must come to its bits at every tick."""

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np

from sandbox.level.reading.files import read_level, write_level
from sandbox.physics.snapshot import state_hash
from sandbox.physics.solvers.linear import dissection, parallel
from sandbox.session.commands import CommandError
from sandbox.session.replay.divergence import Divergence
from sandbox.session.replay.reader import read_replay
from sandbox.session.replay.recording import Replay, ReplayError
from sandbox.session.replay.resume import resume
from sandbox.session.replay.verify import verify
from sandbox.session.session import Session
from tests.determinism.elsewhere import WEB
from tests.determinism.seeds.calls_elsewhere import run_elsewhere
from tests.determinism.seeds.detours import undone
from tests.determinism.seeds.difference import Difference, Differs, Watch, arrays_of, first_of_two

# Where threads are compared, bodies of this many particles have fronts, however narrow, and a single multiplication is
# worth a half: else those of the levels would be too small for two threads.
SMALLEST = 20
# Why a recording cannot be verified from the middle: what is undone or redone after it was done before it.
EARLIER = ("undo reaches back", "nothing to redo", "nothing to undo")


@dataclass
class Result:
    """What came of one way with one seed: ticks that were run, states compared, and the difference, if there is one.

    put: a fault was planted. helped: a second thread worked.
    """

    way: str
    ticks: int
    checks: int
    difference: Difference | None = None
    put: bool = False
    helped: bool = False


def library(watch: Watch, seed: int, folder: Path) -> None:
    """The same commands in a session of its own. Raises Differs."""
    _follow(watch, Session(watch.replay.level, watch.replay.script))


def saved(watch: Watch, seed: int, folder: Path) -> None:
    """The recording, verified whole, from the middle, and continued where it was cut off; the level, written and read.

    Raises Differs, and ReplayError where a recording that was cut off differs.
    """
    replay = watch.replay
    middle = min(replay.states, key=lambda tick: abs(2 * tick - replay.ticks))
    for start in (0, middle):
        try:
            divergence = verify(replay, start=start, on_tick=watch.disturb)
        except ReplayError as error:
            if not start or not any(reason in str(error) for reason in EARLIER):
                raise
            continue
        watch.checks += replay.ticks - start
        if divergence is not None:
            raise Differs(divergence)
    _continue(replay, folder / f"{seed}.cut.replay")
    path = folder / f"{seed}.json"
    write_level(replay.level, path)
    level = read_level(path)
    path.unlink()
    _follow(watch, Session(level, replay.script))


def _continue(replay: Replay, path: Path) -> None:
    """Record half of a run, cut the recording off, continue it to the end, and verify it."""
    session = Session(replay.level, replay.script)
    session.record_to(path)
    while 2 * session.tick < replay.ticks:
        session.advance()
    session.abandon_recording()
    resume(read_replay(path, partial=True), replay.ticks)
    divergence = verify(read_replay(path))
    path.unlink()
    if divergence is not None:
        raise Differs(divergence)


def threads(watch: Watch, seed: int, folder: Path) -> bool:
    """One thread and two in step; whether a second one worked. Raises Differs."""
    started: list[int] = []
    with _halves(1, started):
        alone = Session(watch.replay.level, watch.replay.script)
    with _halves(2, started):
        both = Session(watch.replay.level, watch.replay.script)
    while both.tick < watch.replay.ticks:
        with _halves(1, started):
            fault = _advance(alone)
        with _halves(2, started):
            assert _advance(both) == fault
        if fault:
            break
        watch.disturb(both.world)
        watch.checks += 1
        if state_hash(alone.world) != state_hash(both.world):
            raise Differs(first_of_two(arrays_of(alone.world), both.world))
    return bool(started)


def _advance(session: Session) -> str:
    """One tick, or why a command could not be carried out: other fronts come to other bits than the recording's."""
    try:
        session.advance()
    except CommandError as error:
        return str(error)
    return ""


@contextmanager
def _halves(processors: int, started: list[int]) -> Iterator[None]:
    """Factor also small bodies in two halves, with this many processors; notes second threads in `started`."""

    def start(*arguments: Any, **more: Any) -> threading.Thread:
        started.append(processors)
        return threading.Thread(*arguments, **more)

    with (
        patch.object(dissection, "SMALLEST_BODY", SMALLEST),
        patch.object(dissection, "NARROWEST_BORDER", 0.0),
        patch.object(parallel, "WORTH_HALVING", 1),
        patch.object(parallel, "_processor_count", lambda: processors),
        patch.object(parallel, "Thread", start),
    ):
        yield


def _follow(watch: Watch, session: Session) -> None:
    watch.see(session.world)
    while session.tick < watch.replay.ticks:
        session.advance()
        watch.see(session.world)


def web(watch: Watch, seed: int, folder: Path) -> None:
    """The same calls of kernels in WebAssembly, as a machine of its own makes them. Raises Differs."""
    run_elsewhere(watch, WEB)


Way = Callable[[Watch, int, Path], bool | None]
WAYS: dict[str, Way] = {"library": library, "undone": undone, "saved": saved, "threads": threads, "web": web}


def failure(seed: int, way: str, ticks: int, error: Exception) -> Difference:
    """An error that ended a run, told as a difference: in the reference there was none."""
    return Difference(seed, way, ticks, Divergence(0, "the run", None, "no error", f"{type(error).__name__}: {error}"))


def run_way(way: str, watch: Watch, seed: int, folder: Path) -> Result:
    """Run a recording again one way, up to the first difference."""
    result = Result(way, watch.replay.ticks, 0)
    try:
        # What blows up differs no less from what blows up otherwise.
        with np.errstate(all="ignore"):
            result.helped = bool(WAYS[way](watch, seed, folder))
    except Differs as error:
        result.difference = Difference(seed, way, watch.replay.ticks, error.divergence)
    except Exception as error:
        result.difference = failure(seed, way, watch.replay.ticks, error)
    result.checks, result.put = watch.checks, watch.put
    return result
