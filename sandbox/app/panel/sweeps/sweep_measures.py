"""How measures of a sweep are called and shown on its maps."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from sandbox.physics.arrays import Floats

# Two values further apart than this are seen on a logarithmic scale alone; what is that much smaller than the largest
# counts as nothing.
WIDE, NOTHING = 50.0, 1e-6


class SweepMeasure(NamedTuple):
    """title: with its unit; missing: what a run without a value has done; is_flag: whether it is only 0 or 1."""

    title: str
    missing: str = "no number"
    is_flag: bool = False
    # What 0 and 1 are called.
    words: tuple[str, str] = ("no", "yes")


MEASURES = {
    "settle_time": SweepMeasure("settles after [s]", "never settles"),
    "max_strain": SweepMeasure("largest strain"),
    "energy_drift": SweepMeasure("energy gained [J]"),
    "broken_springs": SweepMeasure("broken springs"),
    "blew_up": SweepMeasure("blew up", is_flag=True),
}


def measure_of(figure: str) -> SweepMeasure:
    """A measure by the name that it has in the table; all that are not listed are checks."""
    return MEASURES.get(figure) or SweepMeasure(figure.removeprefix("check: "), "", True, ("fails", "holds"))


def shown_values(figure: str, values: Mapping[str, Floats]) -> Floats:
    """What a map shows of the values of all measures: NaN where a run blew up, which says all of it."""
    if measure_of(figure).is_flag:
        return values[figure]
    return np.where(values["blew_up"] > 0.0, np.nan, values[figure])


def scale_of(values: Floats) -> tuple[float, float, bool]:
    """The lowest and the highest value of a scale for finite ones among values, and whether it is logarithmic."""
    known = values[np.isfinite(values)]
    if not len(known) or known.max() <= 0.0:
        return 0.0, 1.0, False
    highest = float(known.max())
    positive = known[known > NOTHING * highest]
    lowest = float(positive.min())
    if highest > WIDE * lowest:
        return lowest, highest, True
    lowest = min(float(known.min()), highest)
    return (lowest, highest, False) if highest - lowest > NOTHING * highest else (min(lowest, 0.0), highest, False)
