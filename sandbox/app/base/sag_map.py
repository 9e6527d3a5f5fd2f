"""How far a body sags at every Cs and Cd: axes, maps and sentences, which the panel and the page share.

An axis goes by Cs where that is small and by 1 - Cs where it is near 1: what is seen goes by Cs / (1 - Cd).
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from sandbox.app.base.sentences import capitalised
from sandbox.level.document.model import Level, NissenMaterial
from sandbox.physics.arrays import Floats
from sandbox.physics.softness.body_motion import BodyMotion, word_edges
from sandbox.physics.softness.firmness import WORDS
from sandbox.physics.softness.sag_meter import SagMeter
from sandbox.physics.softness.settling import Support

# Sags (k,) of pairs of Cs and Cd (k,) each.
SagOf = Callable[[Floats, Floats], Floats]
# Values that have a number on an axis, where there is room.
NUMBERED = (1e-5, 1e-4, 1e-3, 3e-3, 0.01, 0.03, 0.1, 0.3, 0.5, 0.7, 0.9, 0.97, 0.99, 0.997, 0.999, 1.0)
# Significant digits of a value, or of what it is below 1 by.
DIGITS = 3
# The last part of an axis is 1 itself.
END = 0.997


@dataclass(frozen=True)
class CoefficientScale:
    """An axis from `lowest` to 1; `rest`: what 1 - value fades out at, the less the wider the last tenth."""

    lowest: float
    rest: float

    def _height(self, value: float | Floats) -> Floats:
        return np.log10(np.asarray(value) / (1.0 - np.asarray(value) + self.rest))

    @property
    def _ends(self) -> tuple[float, float]:
        return float(self._height(self.lowest)), -math.log10(self.rest)

    def place_of(self, value: float) -> float:
        """Where on the axis (0..1) a value lies; values below it, 0 among them, lie at its start."""
        if value <= self.lowest:
            return 0.0
        low, high = self._ends
        return min((float(self._height(min(value, 1.0))) - low) / (high - low), 1.0)

    def values(self, count: int) -> Floats:
        """Values (count,) at equal distances, from the lowest to 1."""
        power = 10.0 ** np.linspace(*self._ends, count)
        return np.minimum(1.0, power * (1.0 + self.rest) / (1.0 + power))

    def value_at(self, place: float) -> float:
        """The value at a place on the axis, in three significant digits, of 1 - value where that is small."""
        if place >= END:
            return 1.0
        low, high = self._ends
        power = 10.0 ** (low + max(place, 0.0) * (high - low))
        value = min(1.0, power * (1.0 + self.rest) / (1.0 + power))
        if value < 0.9:
            return float(f"{value:.{DIGITS}g}")
        below = float(f"{1.0 - value:.{DIGITS - 1}g}")
        return round(1.0 - below, 9)

    def numbers(self) -> list[float]:
        """The values with a number that lie on it."""
        return [value for value in NUMBERED if value >= self.lowest * 0.999]


# Where nothing is known of what is seen.
PLAIN = CoefficientScale(0.003, 0.02)
# Softest ends and widths of the last tenth that an axis may have.
_LOWEST, _RESTS = (0.03, 0.01, 0.003, 0.001, 3e-4, 1e-4), (0.1, 0.03, 0.01, 0.003, 0.001, 0.0003)
# From 0.9 to 1 is this share of an axis at least: a thumb of a pad as wide as the panel.
_THUMB = 0.13
ALIVE = (0.005, 1.0)
_SAMPLES = 40


def scale_for(sag_of: SagOf, includes: tuple[float, ...]) -> CoefficientScale:
    """The axis for Cs and Cd on which most pairs sag by what can be seen, and that has these values on it."""
    best, most = PLAIN, -1.0
    for lowest in _LOWEST:
        if any(0.0 < value < lowest for value in includes):
            continue
        for rest in _RESTS:
            scale = CoefficientScale(lowest, rest)
            if 1.0 - scale.place_of(0.9) < _THUMB:
                continue
            alive = fraction_alive(scale, sag_of)
            if alive > most + 0.01:
                best, most = scale, alive
    return best


def fraction_alive(scale: CoefficientScale, sag_of: SagOf) -> float:
    """The share of a pad of this axis both ways on which what is seen sags by a half to a hundred per cent."""
    values = scale.values(_SAMPLES)
    stiffness, damping = (axis.reshape(-1) for axis in np.meshgrid(values, values, indexing="ij"))
    sag = sag_of(stiffness, damping)
    return float(np.mean((sag > ALIVE[0]) & (sag < ALIVE[1])))


# Values across and up, at equal distances on the axes.
SIZE = 33
# A word is written where it has at least this share of the map, this far down if there is room for it, and in rows
# where its part is at least this share of the map wide.
WORD_SHARE, WORD_DOWN, WORD_WIDTH = 0.015, 0.34, 0.16
# Logarithms of sags are kept in this part of 1.
STEP = 0.02

# Halvings of the range of frequencies in which a word is looked for.
_HALVINGS = 39
# Digits, and decimals at most, of its Cs and Cd.
_PAIR_DIGITS, _DECIMALS = 4, 12

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
            lambda pair: float(body.sag_of_tick(np.array(pair[:1]), np.array(pair[1:2]))[0]) > sag, _HALVINGS
        )
        return _coefficient(stiffness), _coefficient(damping)

    return {word: of_sag(sag) if sag > 0.0 else (1.0, 1.0) for word, sag in WORDS.items()}


def _coefficient(value: float) -> float:
    """A coefficient in few digits, or by few digits of its distance from 1: that says how firm a stiff body is."""
    if value < 0.5:
        return float(f"{value:.{_PAIR_DIGITS}g}")
    return round(1.0 - float(f"{1.0 - value:.{_PAIR_DIGITS}g}"), _DECIMALS)


# What one sees of a body under its weight: the part that moves, how, and of what that is a share.
_SEEN = {
    Support.FLOOR: ("", "sags by", "height"),
    Support.ENDS: ("'s middle", "drops by", "length"),
    Support.HANGING: ("", "stretches by", "height"),
    Support.SPANNED: ("'s middle", "drops by", "length"),
    Support.ARM: ("'s end", "drops by", "length"),
    Support.HUB: ("'s rim", "drops by", "height"),
}


# What sags by a smaller share is said not to sag.
NO_SAG = 1e-3


class SagSentence(NamedTuple):
    """Words for a sag: `sag` has {} where the number goes; `flat` and `none` are said where a number says nothing."""

    sag: str
    flat: str
    none: str


def subject_words(name: str, support: Support) -> str:
    """The sagging part of a body, as it stands in a sentence: "the girder's end"."""
    article = "" if name[-1:].isdigit() else "the "
    return f"{article}{name}{_SEEN[support][0]}"


def size_word(support: Support) -> str:
    """What a sag is measured against, by how the body is held: its "height", or what else it hangs by."""
    return _SEEN[support][2]


def sag_sentence(name: str, support: Support) -> SagSentence:
    """How far a body sags that is held so."""
    _, verb, of = _SEEN[support]
    subject = capitalised(subject_words(name, support))
    flat = "lies flat under its own weight" if support is Support.FLOOR else f"{verb} more than half its {of}"
    return SagSentence(f"{subject} {verb} {{}} of its {of}", f"{subject} {flat}", f"{subject} does not sag")
