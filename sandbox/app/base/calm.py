"""Calm: the loop goes slowly while nobody does anything and nothing on the screen moves, and wakes at an event."""

import time

import pygame

# It is calm once nothing has happened for this long [s]; then this many frames a second are enough, and this many of a
# run that goes on at rest: with fewer of them each would have more ticks to make than it has time for.
CALM_AFTER, CALM_RATE, RESTING_RATE = 1.0, 10, 20
# How often it is looked for events meanwhile [s]: a person who comes back waits no longer. Where the library waits by
# itself it looks every millisecond, which costs four times as much.
NAP = 0.01


class Calm:
    """Follows frames; has_come: nothing has happened for so long that they may come rarely."""

    def __init__(self) -> None:
        self._quiet = 0.0

    @property
    def has_come(self) -> bool:
        """Whether nothing has happened for a while."""
        return self._quiet >= CALM_AFTER

    def follow(self, frame_time: float, is_busy: bool) -> None:
        """Let a frame of frame_time [s] pass, in which something has happened or moved, or not."""
        self._quiet = 0.0 if is_busy else self._quiet + frame_time


def wait_for_event(longest: float) -> bool:
    """Sleep for so long [s], but no longer than until there is an event, which stays in the queue; whether one came."""
    end = time.perf_counter() + longest
    while not pygame.event.peek():
        left = end - time.perf_counter()
        if left <= 0.0:
            return False
        time.sleep(min(left, NAP))
    return True
