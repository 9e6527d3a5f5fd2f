"""Continues a recording that was cut off, as by a crash: it is run again, compared and written again."""

import os
from collections.abc import Callable
from pathlib import Path

from sandbox.physics.snapshot import state_hash
from sandbox.session.replay.recording import Replay, ReplayError
from sandbox.session.session import Session


def resume(replay: Replay, ticks: int, progress: Callable[[int], object] | None = None) -> None:
    """Put in the place of a recording one that goes on where it was cut off, to this many ticks in all, and is whole.

    progress: called with each tick that was run. Raises ReplayError where the run is not the recorded one any more,
    CommandError where a command cannot be carried out, OSError where the file cannot be written; whatever is raised,
    the recording stays as it is.
    """
    path = Path(replay.source)
    # Compressed where the recording is.
    part = path.with_name(f"{path.stem}.part{path.suffix}")
    session = Session(replay.level, replay.script)
    session.record_to(part)
    try:
        while session.tick < ticks:
            session.advance()
            _compare(session, replay)
            if progress is not None:
                progress(session.tick)
        if session.stop_recording() is None:
            raise OSError(None, "cannot be written to its end", str(part))
        os.replace(part, path)
    except BaseException:
        session.abandon_recording()
        part.unlink(missing_ok=True)
        raise


def _compare(session: Session, replay: Replay) -> None:
    tick = session.tick
    if tick <= replay.ticks and not replay.hashes[tick].fits(state_hash(session.world)):
        raise ReplayError(
            f"{replay.source}: the run differs at tick {tick}, so nothing goes on from there; "
            "`sandbox replay --partial` says what differs"
        )
