"""The outline of a zone as corners, as it is drawn, picked and measured."""

import numpy as np
from numpy.typing import NDArray

from sandbox.level.document.model import ZoneDef

# Sides by which a circle is drawn.
ROUND = 72


def outline_of(zone: ZoneDef) -> NDArray[np.float64]:
    """Corners [m] (k, 2) of a zone, in order; of a circle many."""
    if zone.box is not None:
        left, bottom, right, top = zone.box
        return np.array([(left, bottom), (right, bottom), (right, top), (left, top)])
    if zone.circle is not None:
        x, y, radius = zone.circle
        turn = np.linspace(0.0, 2.0 * np.pi, ROUND, endpoint=False)
        return np.column_stack([x + radius * np.cos(turn), y + radius * np.sin(turn)])
    return np.array(zone.polygon, dtype=np.float64).reshape(-1, 2)
