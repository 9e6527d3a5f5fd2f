"""Idle: while nobody does anything and nothing moves, frames come slowly, and garbage is searched for."""

import gc
import time

import numpy as np
import pygame
from numpy.typing import NDArray

from sandbox.physics.analysis.query import shown_particles
from sandbox.physics.snapshot import Snapshot

# Idle is who has done nothing for this long [s]; then this many frames a second are enough, and this many of a run that
# goes on at rest: with fewer of them each would have more ticks to make than it has time for.
IDLE_AFTER, IDLE_RATE, RESTING_RATE = 1.0, 10, 20
# How often it is looked for events meanwhile [s]: a person who comes back waits no longer. Where the library waits by
# itself it looks every millisecond, which costs four times as much.
_NAP = 0.01


class IdleTimer:
    """Idle time of the person: has_come once nothing was pressed and nothing moved for IDLE_AFTER."""

    def __init__(self) -> None:
        self._idle = 0.0

    @property
    def has_come(self) -> bool:
        """Whether nothing has happened for a while."""
        return self._idle >= IDLE_AFTER

    def follow(self, frame_time: float, is_busy: bool) -> None:
        """Let a frame of frame_time [s] pass, in which something has happened or moved, or not."""
        self._idle = 0.0 if is_busy else self._idle + frame_time


def wait_for_event(longest: float) -> bool:
    """Sleep for so long [s], but no longer than until there is an event, which stays in the queue; whether one came."""
    end = time.perf_counter() + longest
    while not pygame.event.peek():
        remaining = end - time.perf_counter()
        if remaining <= 0.0:
            return False
        time.sleep(min(remaining, _NAP))
    return True


# What moves by no more than this [pixels] in so long [s] stands.
_UNSEEN, _LOOK = 0.6, 0.5


class RestTimer:
    """How long everything in the run has been at rest, as seen on the screen: lasted [s]."""

    def __init__(self) -> None:
        self.lasted = 0.0
        self._since = 0.0
        # Places [m] (n, 2) and turns [rad] (n,) that are compared with.
        self._seen: tuple[NDArray[np.float64], NDArray[np.float64]] | None = None

    def follow(self, now: Snapshot, zoom: float, seconds: float) -> None:
        """Take in the state after a frame of `seconds`, a metre being `zoom` pixels."""
        self._since += seconds
        stands = self._stands(now, zoom)
        self.lasted = self.lasted + seconds if stands else 0.0
        if not stands or self._since >= _LOOK:
            self._since, self._seen = 0.0, (now.position.copy(), now.angle.copy())

    def _stands(self, now: Snapshot, zoom: float) -> bool:
        if self._seen is None or len(self._seen[0]) != len(now.position):
            return False
        free = shown_particles(now) & (now.inverse_mass > 0.0)
        places, turns = self._seen
        with np.errstate(over="ignore", invalid="ignore"):
            moved = np.abs(now.position - places)[free].max(initial=0.0)
            turned = (np.abs(now.angle - turns) * now.radius)[free].max(initial=0.0)
            return bool(max(moved, turned) * zoom <= _UNSEEN)


# It begins when nothing has happened for so long [s]: in the pauses of somebody who works, and not while they drag.
REST = 0.5
# New objects that are worth a search of them: a frame of a run makes less than a tenth.
_ENOUGH = 10_000
# Of this many searches one looks at all objects: it takes 0.1 s and more where the history of a large level is long.
_FULL_EVERY = 10


class IdleCollector:
    """Takes over from Python's own searches, which come in the midst of edits, until it is closed."""

    def __init__(self) -> None:
        self._was_enabled = gc.isenabled()
        self._rest = 0.0
        self._searches = 0
        self._full_is_due = False
        gc.disable()

    def update(self, frame_time: float, is_busy: bool) -> None:
        """Let frame_time [s] pass, in which something has happened or not."""
        self._rest = 0.0 if is_busy else self._rest + frame_time
        if self._rest < REST or not (self._full_is_due or gc.get_count()[0] >= _ENOUGH):
            return
        self._searches += 1
        gc.collect(2 if self._full_is_due or self._searches % _FULL_EVERY == 0 else 1)
        self._full_is_due = False

    def expect_old_garbage(self) -> None:
        """Look at all objects in the next pause: widgets hold each other, and those of a window 20 MB of pictures."""
        self._full_is_due = True

    def close(self) -> None:
        """Let Python collect garbage by itself again."""
        if self._was_enabled:
            gc.enable()
