"""Strain of springs: how far each is from its rest length, as a fraction of it."""

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.snapshot import Snapshot
from sandbox.physics.world import Floats, World


@np.errstate(over="ignore", invalid="ignore")
def strain(state: World | Snapshot) -> Floats:
    """Signed strain (l - L) / L of every spring (m,): above 0 stretched; 0 where inactive or of rest length 0."""
    separation = state.position[state.particle_b] - state.position[state.particle_a]
    length = np.sqrt(separation[:, 0] ** 2 + separation[:, 1] ** 2)
    counted = state.spring_active & (state.rest_length > 0.0)
    rest = state.rest_length
    return np.divide(length - rest, rest, out=np.zeros_like(length), where=counted)


def load_bearing(state: World | Snapshot) -> NDArray[np.bool_]:
    """Springs (m,) whose strain counts: active, of a rest length above 0, with a free end."""
    free = (state.inverse_mass[state.particle_a] > 0.0) | (state.inverse_mass[state.particle_b] > 0.0)
    return state.spring_active & (state.rest_length > 0.0) & free
