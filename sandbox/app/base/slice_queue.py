"""SliceQueue: what takes long to find out or to draw for many things, a slice of it each frame."""

import time
from collections import deque
from collections.abc import Iterator


class SliceQueue:
    """Work that goes on by slices; each work is an iterator that gives False where it has to wait."""

    def __init__(self) -> None:
        self._works: deque[Iterator[bool]] = deque()

    def __len__(self) -> int:
        return len(self._works)

    def add(self, work: Iterator[bool]) -> None:
        """Take in one more, after the others."""
        self._works.append(work)

    def go_on(self, budget: float) -> None:
        """Go on for about so long [s], or until everything waits."""
        end, waiting = time.perf_counter() + budget, 0
        while waiting < len(self._works):
            went_on = next(self._works[0], None)
            if went_on is None:
                self._works.popleft()
            elif not went_on:
                self._works.rotate(-1)
                waiting += 1
            if time.perf_counter() > end:
                return
