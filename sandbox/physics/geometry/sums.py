"""Sums whose order is ours: those of a library may be made in another one on another machine, with other bits."""

import numpy as np

from sandbox.physics.arrays import Floats


def sum_in_order(values: Floats) -> float:
    """The sum of values (n,), added one after another from the first; 0 of none."""
    # Partial sums can only be made in order, other than by numpy.sum.
    return float(np.add.accumulate(values)[-1]) if len(values) else 0.0
