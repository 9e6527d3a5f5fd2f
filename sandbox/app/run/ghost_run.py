"""GhostRun: a recorded run that goes along beside the one that is played, tick by tick, to be seen behind it."""

import time

import numpy as np

from sandbox.physics.snapshot import Snapshot
from sandbox.session.commands import CommandError
from sandbox.session.replay.recording import Replay
from sandbox.session.session import Session

# Wall time [s] that its ticks may take in a frame; where that is too little it is not seen until it has caught up.
BUDGET = 0.006


class GhostRun:
    """Follows another run; state: how it stood at that tick, None while it is not there yet."""

    def __init__(self, replay: Replay) -> None:
        self._session = Session(replay.level, script=replay.script)
        self._last = replay.ticks
        self._is_broken = False
        self.state: Snapshot | None = self._session.snapshot()

    def follow(self, tick: int) -> None:
        """Go to a tick, or as near as a frame has time for; beyond its end it stands as it ended."""
        session, tick = self._session, min(tick, self._last)
        if self._is_broken or (self.state is not None and self.state.tick == tick):
            return
        end = time.perf_counter() + BUDGET
        with np.errstate(over="ignore", invalid="ignore"):
            if tick <= session.last_tick and not session.tick <= tick <= session.tick + 1:
                session.seek(tick)
            try:
                while session.tick < tick and time.perf_counter() < end:
                    session.advance()
            except CommandError:
                self._is_broken = True
        session.take_messages()
        self.state = session.snapshot() if session.tick == tick and not self._is_broken else None
