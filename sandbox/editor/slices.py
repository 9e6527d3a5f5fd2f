"""Slices: long work, written as an iterator, done a slice of time after the other, so that a window goes on."""

import time
from collections.abc import Iterator


def work_for(work: Iterator[None], seconds: float) -> bool:
    """Go on with some work for about that long [s], at least one step of it; whether it is done."""
    # The clock says when to pause, never what comes out.
    end = time.perf_counter() + seconds
    return all(time.perf_counter() < end for _ in work)
