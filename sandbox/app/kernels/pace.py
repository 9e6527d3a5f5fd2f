"""Pace: whether a run can be played while its kernels are still interpreted, by the time that its ticks take."""

import threading
import time
from collections.abc import Callable

import numpy as np

from sandbox.level.document.model import Level
from sandbox.session.session import Session

# A tick may take this long [s]: 30 of them in a second, half of what most levels ask for.
TICK_LIMIT = 1 / 30
# The first one lays the matrix out too, and may not stop the window for longer [s].
FIRST_TICK_LIMIT = 0.2
# Ticks that are tried out before a run begins.
TRIAL_TICKS = 6
# Levels of more particles and springs are not tried: no interpreter holds the pace, and one tick would take seconds.
SIZE_LIMIT = 1200
# A run is as fast as its last ticks were; one that is slower for longer than this [s] of its own time is stopped.
PATIENCE = 1.0


class Pace:
    """Tries a level out on a thread of its own, then follows how the run does; clock: time of a thread [s]."""

    def __init__(self, level: Level, clock: Callable[[], float] = time.thread_time) -> None:
        self.level = level
        self._clock = clock
        self._is_over = False
        self._has_held: bool | None = None
        self._late = 0.0
        self._trial = threading.Thread(target=self._try, daemon=True)
        self._trial.start()

    @property
    def holds(self) -> bool:
        """Whether the run can be played; False too while that is not known."""
        return bool(self._has_held)

    @property
    def is_known(self) -> bool:
        """Whether the trial has ended."""
        return self._has_held is not None

    def note(self, ticks: int, seconds: float) -> None:
        """Take into account that this many ticks of the run took this many seconds."""
        # While it is paused, or has not begun, nothing is late.
        if not ticks:
            return
        self._late = max(0.0, self._late + seconds - ticks * TICK_LIMIT)
        if self._late > PATIENCE:
            self._has_held = False

    def end(self) -> bool:
        """End the trial after the tick that it is in; whether it has ended."""
        self._is_over = True
        return not self._trial.is_alive()

    def wait(self) -> None:
        """Wait until the trial has ended."""
        self._trial.join()

    def _try(self) -> None:
        self._has_held = self._is_fast()

    def _is_fast(self) -> bool:
        session = Session(self.level)
        world = session.world
        if len(world.mass) + len(world.stiffness) > SIZE_LIMIT:
            return False
        spent = 0.0
        for tick in range(TRIAL_TICKS):
            if self._is_over:
                return False
            started = self._clock()
            with np.errstate(over="ignore", invalid="ignore"):
                session.advance()
            took = self._clock() - started
            if tick == 0 and took > FIRST_TICK_LIMIT:
                return False
            spent += took if tick else 0.0
            if spent > TICK_LIMIT * (TRIAL_TICKS - 1):
                return False
        return True
