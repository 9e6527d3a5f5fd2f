"""SagMap: what a body sags at every Cs and Cd of a pad, and where the words for that are written: window and page."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from sandbox.app.widgets.coefficient_scale import CoefficientScale
from sandbox.physics.analysis.body_motion import BodyMotion, word_edges
from sandbox.physics.arrays import Floats

# Values across and up, at equal distances on the axes.
SIZE = 33
# A word is written where it has at least this share of the map, this far down if there is room for it, and in rows
# where its part is at least this share of the map wide.
WORD_SHARE, WORD_DOWN, WORD_WIDTH = 0.015, 0.34, 0.16
# Logarithms of sags are kept in this part of 1.
STEP = 0.02


@dataclass(frozen=True)
class SagMap:
    """Logarithms of sags (SIZE, SIZE), Cs across and Cd up, on an axis both ways."""

    scale: CoefficientScale
    logs: tuple[tuple[float, ...], ...]

    @classmethod
    def of(cls, body: BodyMotion, scale: CoefficientScale) -> "SagMap":
        """That of a body that tells its sag."""
        values = scale.values(SIZE)
        stiffness, damping = (axis.reshape(-1) for axis in np.meshgrid(values, values, indexing="ij"))
        sag = np.clip(body.sag_of_tick(stiffness, damping), 1e-9, 1e3)
        rows = np.round(np.log(sag) / STEP).reshape(SIZE, SIZE) * STEP
        return cls(scale, tuple(tuple(row) for row in rows.tolist()))

    def number(self, across: int, up: int) -> Floats:
        """Which word (w, h), from the softest, each pixel of a map of that size has; up goes up."""
        logs = np.array(self.logs)
        x, y = np.linspace(0.0, SIZE - 1.0, across), np.linspace(0.0, SIZE - 1.0, up)
        left, low = (np.minimum(at.astype(np.int64), SIZE - 2) for at in (x, y))
        right, high = (x - left)[:, None], (y - low)[None, :]
        upper = logs[np.ix_(left, low + 1)] * (1.0 - right) + logs[np.ix_(left + 1, low + 1)] * right
        lower = logs[np.ix_(left, low)] * (1.0 - right) + logs[np.ix_(left + 1, low)] * right
        found = lower * (1.0 - high) + upper * high
        return np.searchsorted(-np.log(word_edges()[1]), -found)

    @cached_property
    def places(self) -> dict[str, tuple[float, float]]:
        """Where words are written: shares of the map's width and height, from its lower left corner."""
        number, found = self.number(100, 100), {}
        for k, word in enumerate(word_edges()[0]):
            mask = number == k
            if mask.mean() < WORD_SHARE:
                continue
            wide = mask.sum(axis=0)
            rows = np.flatnonzero(wide >= min(100 * WORD_WIDTH, wide.max()))
            row = int(rows[np.argmin(np.abs(rows - 100 * (1.0 - WORD_DOWN)))])
            found[word] = float(np.median(np.flatnonzero(mask[:, row]))) / 100.0, row / 100.0
        return found

    def as_data(self) -> dict[str, Any]:
        """What a page makes the same map of; logs in steps, column by column."""
        words, edges = word_edges()
        return {
            "lowest": self.scale.lowest,
            "rest": self.scale.rest,
            "size": SIZE,
            "step": STEP,
            "logs": [round(value / STEP) for column in self.logs for value in column],
            "names": words,
            "edges": [round(edge, 6) for edge in edges],
            "places": self.places,
        }
