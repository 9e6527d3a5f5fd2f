"""Room to grow: rows are added behind an array in time that grows with those rows, not with the array."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]

# How many times the rows in use there is room for where more room is made [1], and at least so many rows more: lower
# copies more often, higher wastes memory.
GROWTH, LEAST = 1.5, 16


class Capacity:
    """Larger arrays, by name, of which those in use are the first rows."""

    def __init__(self) -> None:
        self._larger: dict[str, Array] = {}

    def appended(self, name: str, present: Array, count: int) -> Array:
        """The array of that name with `count` rows more, to be written; `present` must not be used any more."""
        used, larger = len(present), self._larger.get(name)
        if larger is None or present.base is not larger or used + count > len(larger):
            rows = max(used + count, int(GROWTH * used)) + LEAST
            larger = self._larger[name] = np.zeros((rows, *present.shape[1:]), present.dtype)
            larger[:used] = present
        return larger[: used + count]
