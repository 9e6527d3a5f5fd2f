"""Ways to run a recording again in this process; each must come to its bits at every tick."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sandbox.level.reading.files import read_level, write_level
from sandbox.session.compare.comparison import verify
from sandbox.session.compare.divergence import Divergence
from sandbox.session.replay.reader import read_replay
from sandbox.session.replay.recording import Replay, ReplayError
from sandbox.session.replay.rerecord import resume
from sandbox.session.session import Session
from tests.determinism.elsewhere import WEB
from tests.determinism.seeds.calls_elsewhere import run_elsewhere
from tests.determinism.seeds.detours import undone
from tests.determinism.seeds.difference import Difference, Differs, Watch

# Why a recording cannot be verified from the middle: what is undone or redone after it was done before it.
EARLIER = ("undo reaches back", "nothing to redo", "nothing to undo")


@dataclass
class Result:
    """What came of one way with one seed: ticks that were run, states compared, and the difference, if there is one.

    put: a fault was planted.
    """

    way: str
    ticks: int
    checks: int
    difference: Difference | None = None
    put: bool = False


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


def _follow(watch: Watch, session: Session) -> None:
    watch.see(session.world)
    while session.tick < watch.replay.ticks:
        session.advance()
        watch.see(session.world)


def cramped(watch: Watch, seed: int, folder: Path) -> None:
    """With no room kept from one tick to the next: what is found to need more is made again. Raises Differs."""
    session = Session(watch.replay.level, watch.replay.script)
    watch.see(session.world)
    while session.tick < watch.replay.ticks:
        session.world._lasting.clear()
        session.advance()
        watch.see(session.world)


def web(watch: Watch, seed: int, folder: Path) -> None:
    """The same calls of kernels in WebAssembly, as a machine of its own makes them. Raises Differs."""
    run_elsewhere(watch, WEB)


Way = Callable[[Watch, int, Path], None]
WAYS: dict[str, Way] = {"library": library, "undone": undone, "saved": saved, "cramped": cramped, "web": web}


def failure(seed: int, way: str, ticks: int, error: Exception) -> Difference:
    """An error that ended a run, told as a difference: in the reference there was none."""
    return Difference(seed, way, ticks, Divergence(0, "the run", None, "no error", f"{type(error).__name__}: {error}"))


def run_way(way: str, watch: Watch, seed: int, folder: Path) -> Result:
    """Run a recording again one way, up to the first difference."""
    result = Result(way, watch.replay.ticks, 0)
    try:
        # What blows up differs no less from what blows up otherwise.
        with np.errstate(all="ignore"):
            WAYS[way](watch, seed, folder)
    except Differs as error:
        result.difference = Difference(seed, way, watch.replay.ticks, error.divergence)
    except Exception as error:
        result.difference = failure(seed, way, watch.replay.ticks, error)
    result.checks, result.put = watch.checks, watch.put
    return result
