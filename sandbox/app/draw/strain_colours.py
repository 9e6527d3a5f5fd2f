"""Colours of springs by their strain, for legend and lattice."""

import numpy as np
from numpy.typing import NDArray

from sandbox.app.draw.colours import Colour

# The colour goes with the logarithm of the strain: from this strain on it shows, at FULL_STRAIN it is at its end.
# Larger: the load in stiff bodies stays grey.
SLIGHT_STRAIN = 0.004
FULL_STRAIN = 1.0

# Where a theme's colours are at their end, on that scale.
_FULL_PLACE = 0.62


def strain_place(strain: NDArray[np.float64]) -> NDArray[np.float64]:
    """Places (m,) of signed strains on the scale, -1..1 up to FULL_STRAIN."""
    finite = np.nan_to_num(strain, nan=0.0, posinf=1e9, neginf=-1e9)
    place = np.sign(finite) * np.log1p(np.abs(finite) / SLIGHT_STRAIN) / np.log1p(FULL_STRAIN / SLIGHT_STRAIN)
    return np.asarray(np.clip(place, -1.0, 1.0))


def strain_tones(strain: NDArray[np.float64], colours: tuple[Colour, Colour, Colour]) -> NDArray[np.int64]:
    """Colours (m,) of signed strains between those of a theme: squeezed, at rest, stretched."""
    place, stops = strain_place(strain), (-_FULL_PLACE, 0.0, _FULL_PLACE)
    red, green, blue = (np.interp(place, stops, [colour[k] for colour in colours]).astype(np.int64) for k in range(3))
    return np.asarray(red << 16 | green << 8 | blue)
