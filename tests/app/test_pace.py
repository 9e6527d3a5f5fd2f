"""Whether a level is played while its kernels are interpreted."""

import threading
from collections import deque

from sandbox.app.kernels import pace
from sandbox.app.kernels.pace import FIRST_TICK_LIMIT, PATIENCE, TICK_LIMIT, TRIAL_TICKS, Pace
from tests.app.conftest import small_level


def tried(*times):
    """The pace of a level whose ticks take these times [s], the last one again and again."""
    left, now = deque(times), [0.0]
    is_end = [False]

    def clock():
        if is_end[0]:
            now[0] += left.popleft() if len(left) > 1 else left[0]
        is_end[0] = not is_end[0]
        return now[0]

    found = Pace(small_level(), clock)
    found.wait()
    return found


def test_a_level_holds_the_pace_where_its_ticks_are_short_enough():
    assert tried(0.9 * TICK_LIMIT).holds
    assert not tried(1.1 * TICK_LIMIT).holds


def test_the_first_tick_may_take_longer_but_not_so_long_that_the_window_stands_still():
    assert tried(0.9 * FIRST_TICK_LIMIT, 0.5 * TICK_LIMIT).holds
    assert not tried(1.1 * FIRST_TICK_LIMIT, 0.5 * TICK_LIMIT).holds


def test_a_level_that_would_take_minutes_is_not_tried(monkeypatch):
    monkeypatch.setattr(pace, "SIZE_LIMIT", 3)
    monkeypatch.setattr(pace.Session, "advance", lambda self: 1 / 0)
    found = tried(0.0)
    assert found.is_known and not found.holds


def test_a_run_that_becomes_slow_is_stopped_after_a_while_and_a_slow_tick_alone_does_not_matter():
    found = tried(0.5 * TICK_LIMIT)
    found.note(1, 0.9 * PATIENCE)
    for _ in range(200):
        found.note(2, TICK_LIMIT)
    assert found.holds
    for _ in range(int(PATIENCE / TICK_LIMIT) + 2):
        found.note(1, 2.0 * TICK_LIMIT)
    assert not found.holds


def test_frames_without_ticks_make_no_run_late():
    found = tried(0.5 * TICK_LIMIT)
    for _ in range(10):
        found.note(0, PATIENCE)
    assert found.holds


def test_a_trial_that_is_no_longer_wanted_ends_after_its_tick(monkeypatch):
    in_first_tick, is_ended = threading.Event(), threading.Event()
    ticks = []

    def advance(session):
        ticks.append(session)
        in_first_tick.set()
        is_ended.wait()

    monkeypatch.setattr(pace.Session, "advance", advance)
    found = Pace(small_level())
    in_first_tick.wait()
    assert not found.end()
    is_ended.set()
    found.wait()
    assert found.end() and not found.holds
    assert len(ticks) == 1 < TRIAL_TICKS
