"""SagMap: what a body sags at every Cs and Cd of a pad, and where the words for that are written: window and page."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from sandbox.app.base.coefficient_scale import CoefficientScale, scale_for
from sandbox.level.document.model import Level, NissenMaterial
from sandbox.physics.arrays import Floats
from sandbox.physics.softness.body_motion import BodyMotion, word_edges
from sandbox.physics.softness.firmness import WORDS
from sandbox.physics.softness.sag_meter import SagMeter

# Values across and up, at equal distances on the axes.
SIZE = 33
# A word is written where it has at least this share of the map, this far down if there is room for it, and in rows
# where its part is at least this share of the map wide.
WORD_SHARE, WORD_DOWN, WORD_WIDTH = 0.015, 0.34, 0.16
# Logarithms of sags are kept in this part of 1.
STEP = 0.02

# Halvings of the range of frequencies in which a word is looked for.
HALVINGS = 39
# Digits, and decimals at most, of its Cs and Cd.
DIGITS, DECIMALS = 4, 12

Pairs = dict[str, tuple[float, float]]


@dataclass(frozen=True)
class SagMap:
    """Logarithms of sags (SIZE, SIZE), Cs across and Cd up, on an axis both ways."""

    scale: CoefficientScale
    logs: tuple[tuple[float, ...], ...]

    @classmethod
    def of(cls, body: BodyMotion, scale: CoefficientScale) -> "SagMap":
        """The map of a body whose sag is known."""
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
        """Numbers that a page makes the same map of; logarithms in steps, column by column."""
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


def own_of(level: Level, material: str) -> tuple[float, float] | None:
    """Cs and Cd that a level gives a material; None: it has none of its own."""
    own = level.materials.get(material)
    return (own.stiffness, own.damping) if isinstance(own, NissenMaterial) else None


def scale_of(body: BodyMotion, pairs: Pairs, own: tuple[float, ...]) -> CoefficientScale:
    """The axis of a body's pad, on which are its words and the level's own Cs and Cd."""
    return scale_for(body.sag_of_tick, (*own, *(value for pair in pairs.values() for value in pair)))


def word_pairs(meter: SagMeter, body: BodyMotion) -> Pairs:
    """Cs and Cd per tick of springs at which a body sags as each word says, with the damping that a firmness has."""

    def of_sag(sag: float) -> tuple[float, float]:
        _, (stiffness, damping, _) = meter.firmness_at(
            lambda pair: float(body.sag_of_tick(np.array(pair[:1]), np.array(pair[1:2]))[0]) > sag, HALVINGS
        )
        return _coefficient(stiffness), _coefficient(damping)

    return {word: of_sag(sag) if sag > 0.0 else (1.0, 1.0) for word, sag in WORDS.items()}


def _coefficient(value: float) -> float:
    """In few digits, or with few digits of what it is below 1 by: that says how firm a stiff body is."""
    if value < 0.5:
        return float(f"{value:.{DIGITS}g}")
    return round(1.0 - float(f"{1.0 - value:.{DIGITS}g}"), DECIMALS)
