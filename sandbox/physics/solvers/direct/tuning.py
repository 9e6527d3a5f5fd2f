"""What decides how systems are laid out, as it is set now."""

import numpy as np

from sandbox.physics.solvers.direct import choosing
from sandbox.physics.solvers.linear import dissection, halves
from sandbox.physics.solvers.linear.elimination import Tuning


def tuning() -> Tuning:
    """The numbers of the modules that kernels are given them from."""
    whole = dissection.SMALLEST_BODY, dissection.LEAF_SIZE, halves.WORTH_HALVING, choosing.NARROW
    return Tuning(np.array(whole, np.int64), np.array([dissection.NARROWEST_BORDER]))
