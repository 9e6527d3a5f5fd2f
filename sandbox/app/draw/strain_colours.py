"""Colours of springs and areas by their strain."""

import numpy as np
from numpy.typing import NDArray

from sandbox.app.draw.colours import COMPRESSED, OVERSTRETCHED, RELAXED, STRETCHED

# The colour goes with the logarithm of the strain: from this strain on it shows, at FULL_STRAIN it is at its end.
# Larger: the load in stiff bodies stays grey.
SLIGHT_STRAIN = 0.004
FULL_STRAIN = 1.0

_STOPS = np.array([-1.0, -0.5, 0.0, 0.5, 1.0])
_RAMP = np.array([(40, 110, 255), COMPRESSED, RELAXED, STRETCHED, OVERSTRETCHED], dtype=np.float64)


def strain_colours(strain: NDArray[np.float64]) -> NDArray[np.int64]:
    """Colours (m,) as 0xRRGGBB of signed strains (m,): blue = compressed, grey = at rest, warm = stretched."""
    finite = np.nan_to_num(strain, nan=0.0, posinf=1e9, neginf=-1e9)
    full = np.log1p(FULL_STRAIN / SLIGHT_STRAIN)
    place = np.sign(finite) * np.log1p(np.abs(finite) / SLIGHT_STRAIN) / full
    channels = [np.interp(place, _STOPS, _RAMP[:, k]).astype(np.int64) for k in range(3)]
    return (channels[0] << 16) | (channels[1] << 8) | channels[2]
