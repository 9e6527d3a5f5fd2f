"""Frame: what every thing is drawn from: where particles are in this picture, and how large a metre is."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from sandbox.app.draw.textures import Tiles
from sandbox.app.draw.themes import Theme

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]

# Strain from which it shows as a flush, and how much more of it shows fully.
FLUSH_FROM, FLUSH_RANGE = 0.03, 0.22


class Seen(Protocol):
    """What of a world's state drawing reads."""

    position: Floats
    velocity: Floats
    mass: Floats
    inverse_mass: Floats
    radius: Floats
    particle_active: Mask
    particle_a: NDArray[np.int32]
    particle_b: NDArray[np.int32]
    rest_length: Floats
    stiffness: Floats
    spring_active: Mask


@dataclass(frozen=True, eq=False)
class Frame:
    """One picture of a state.

    at (n, 2) [pixels], angle (n,) [rad] by which particles have turned, strain (m,); zoom [pixels/m], scale [pixels a
    layout unit]; seconds: time of the picture; asleep: faces have their eyes shut; pointer [pixels]: what those look at
    that rest, None = straight ahead.
    """

    state: Seen
    at: Floats
    angle: Floats
    strain: Floats
    zoom: float
    scale: float
    theme: Theme
    tiles: Tiles
    seconds: float = 0.0
    asleep: bool = False
    pointer: tuple[float, float] | None = None

    def ends(self, pairs: NDArray[np.int64]) -> Floats:
        """Lines (m, 4) [pixels] between pairs of particles."""
        return self.at[pairs].reshape(-1, 4)

    def flush(self, springs: NDArray[np.int64]) -> tuple[NDArray[np.int64], Floats]:
        """Colours of strain of springs, and how much of them shows, 0..1."""
        strain = np.nan_to_num(self.strain[springs], nan=0.0, posinf=9.0, neginf=-9.0)
        squeezed, _, stretched = (r << 16 | g << 8 | b for r, g, b in self.theme.strain)
        share = np.clip((np.abs(strain) - FLUSH_FROM) / FLUSH_RANGE, 0.0, 1.0)
        return np.where(strain > 0.0, stretched, squeezed), 0.7 * share


def strain_of(state: Seen, position: Floats) -> Floats:
    """Signed strain (m,) of springs between particles at (n, 2) [m]; 0 where inactive or of rest length 0."""
    apart = position[state.particle_b] - position[state.particle_a]
    length = np.sqrt(apart[:, 0] * apart[:, 0] + apart[:, 1] * apart[:, 1])
    counted = state.spring_active & (state.rest_length > 0.0)
    return np.divide(length - state.rest_length, state.rest_length, out=np.zeros_like(length), where=counted)
