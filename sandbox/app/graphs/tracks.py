"""Track: values over ticks, as many as there is room for, the oldest forgotten first."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

# Samples that are kept at least: two minutes of frames. Twice as many fit, so that few of them are ever moved.
KEPT = 7200
# Values side by side; more names than this, those that came first are forgotten.
MOST_NAMES = 12

Floats = NDArray[np.float64]


class Track:
    """Values by name at ticks that rise; where a name has none it is NaN."""

    def __init__(self, kept: int = KEPT) -> None:
        self._kept, self._count = kept, 0
        self._ticks = np.zeros(2 * kept, dtype=np.int64)
        self._values: dict[str, Floats] = {}

    @property
    def last_tick(self) -> int:
        """The last tick that there is a value of; -1: none."""
        return int(self._ticks[self._count - 1]) if self._count else -1

    def forget_from(self, tick: int) -> None:
        """Forget a tick and what follows: the run was changed there."""
        self._count = int(np.searchsorted(self._ticks[: self._count], tick))

    def add(self, tick: int, values: Mapping[str, float]) -> None:
        """Add what was measured at a tick after all others."""
        if self._count == 2 * self._kept:
            for array in (self._ticks, *self._values.values()):
                array[: self._kept] = array[self._kept :]
            self._count = self._kept
        for name in values:
            if name not in self._values:
                self._values[name] = np.full(2 * self._kept, np.nan)
        while len(self._values) > MOST_NAMES:
            del self._values[next(iter(self._values))]
        self._ticks[self._count] = tick
        for name, array in self._values.items():
            array[self._count] = values.get(name, np.nan)
        self._count += 1

    def between(self, first: float, last: float) -> tuple[NDArray[np.int64], dict[str, Floats]]:
        """Ticks (k,) from first to last, and the values (k,) of each name that has some there."""
        start, end = np.searchsorted(self._ticks[: self._count], (first, last + 1e-9))
        part = slice(int(start), int(end))
        values = {name: array[part] for name, array in self._values.items() if np.isfinite(array[part]).any()}
        return self._ticks[part], values
