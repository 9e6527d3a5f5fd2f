"""SweepLayer: the colours of one measure of a sweep behind the pad, its numbers and its scale."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from sandbox.app.draw.colours import FIELD, MUTED, Colour, mixed
from sandbox.app.panel.sweeps.sweep_measures import SweepMeasure, measure_of, scale_of, shown_values
from sandbox.physics.arrays import Floats
from sandbox.session.sweep.sweep_map import edges

# Colours from little to much, alike to every kind of colour vision (cividis, Nunez and others 2018).
STOPS = np.array([(253, 231, 55), (213, 191, 88), (167, 156, 117), (124, 123, 120), (85, 91, 109), (38, 61, 110),
                  (0, 32, 77)], dtype=np.float64)  # fmt: skip
FAILS, HOLDS = (230, 159, 0), (86, 180, 233)
BLOWN = (176, 58, 0)


@dataclass(frozen=True)
class SweepLayer:
    """A measure by its name in the table, Cs (m,) and Cd (n,) of its cells, and the values (n, m) of all measures.

    NaN in `blew_up`: that run is not known yet.
    """

    figure: str
    stiffness: Floats
    damping: Floats
    values: Mapping[str, Floats]
    scale: tuple[float, float, bool] = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "scale", scale_of(shown_values(self.figure, self.values)))

    @property
    def measure(self) -> SweepMeasure:
        """The measure that is shown."""
        return measure_of(self.figure)

    @property
    def has_blown(self) -> bool:
        """Whether any run blew up."""
        return bool(np.any(self.values["blew_up"] > 0.0))

    @property
    def has_missing(self) -> bool:
        """Whether any run that did not blow up has no value."""
        shown = shown_values(self.figure, self.values)
        return bool(np.any(np.isnan(shown) & (self.values["blew_up"] == 0.0)))

    def pixels(self, stiffness: Floats, damping: Floats, hatch: np.ndarray) -> np.ndarray:
        """Colours (w, h, 3) at Cs (w,) and Cd (h,); hatch (w, h): where a pattern has its lines."""
        across, up = _cells(self.stiffness, stiffness), _cells(self.damping, damping)
        at = np.ix_(up, across)
        values, blown = self.values[self.figure][at].T, self.values["blew_up"][at].T
        found = np.empty((*values.shape, 3), dtype=np.uint8)
        found[:] = mixed(FIELD, MUTED, 0.3)
        known = np.isfinite(values)
        found[known] = self.colours(values[known])
        is_blown = blown > 0.0
        if not self.measure.is_flag:
            found[is_blown] = mixed(FIELD, BLOWN, 0.45)
        found[is_blown & hatch] = BLOWN
        found[np.isnan(blown) | (across < 0)[:, None] | (up < 0)[None, :]] = FIELD
        return found

    def colours(self, values: Floats) -> np.ndarray:
        """Colours (k, 3) of values (k,)."""
        if self.figure == "blew_up":
            return np.where(values[:, None] > 0.0, BLOWN, mixed(FIELD, MUTED, 0.3)).astype(np.uint8)
        if self.measure.is_flag:
            return np.where(values[:, None] > 0.0, HOLDS, FAILS).astype(np.uint8)
        low, high, is_wide = self.scale
        place = (values - low) / (high - low)
        if is_wide:
            place = np.log(np.maximum(values, low) / low) / np.log(high / low)
        stops = np.linspace(0.0, 1.0, len(STOPS))
        return np.stack([np.interp(place, stops, STOPS[:, k]) for k in range(3)], axis=1).astype(np.uint8)

    def text_at(self, stiffness: float, damping: float) -> str:
        """What is known of the cell that a Cs and Cd lie in, in a few words."""
        across, up = (int(_cells(axis, np.array([value]))[0]) for axis, value in
                      ((self.stiffness, stiffness), (self.damping, damping)))  # fmt: skip
        if across < 0 or up < 0:
            return "outside the sweep"
        value, blown = float(self.values[self.figure][up, across]), float(self.values["blew_up"][up, across])
        if np.isnan(blown):
            return "not run yet"
        if blown > 0.0:
            return "blew up"
        if np.isnan(value):
            return self.measure.missing
        if self.measure.is_flag:
            return self.measure.words[int(value)]
        return f"{value:.3g}{self.unit}"

    @property
    def unit(self) -> str:
        """The unit of the values, after a space."""
        _, bracket, unit = self.measure.title.partition(" [")
        return f" {unit.rstrip(']')}" if bracket else ""

    @property
    def missing_colour(self) -> Colour:
        """The colour of runs without a value."""
        return mixed(FIELD, MUTED, 0.3)


def _cells(axis: Floats, values: Floats) -> np.ndarray:
    """Numbers (k,) of the cells of an axis that values (k,) lie in; -1: in none."""
    between = edges(axis)
    found = np.searchsorted(between, values, side="right") - 1
    return np.where((values < between[0]) | (values > between[-1]), -1, np.minimum(found, len(axis) - 1))
