"""Zone outlines: where the zones of a level are, in dashes, and places for their names."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sandbox.app.draw.camera import Camera
from sandbox.app.draw.colours import packed
from sandbox.app.draw.raster.painter import MarkList
from sandbox.app.draw.themes import Theme
from sandbox.editor.zone_outline import outline_of
from sandbox.level.document.model import ZoneDef

# Sizes [pixels at scale 1]: half width of a dash and of what surrounds it, length of a dash and of the gap behind it.
HALF, HALO, DASH, SPACE = 0.9, 1.2, 8.0, 5.0
# Of an outline at most so many dashes, longer ones where it is long.
MOST_DASHES = 400

Floats = NDArray[np.float64]


def name_place(zone: ZoneDef) -> tuple[float, float]:
    """Where the name of a zone stands [m]: at the middle of its top."""
    corners = outline_of(zone)
    return float(corners[:, 0].min() + corners[:, 0].max()) / 2, float(corners[:, 1].max())


def mark_zones(marks: MarkList, zones: Sequence[ZoneDef], camera: Camera, theme: Theme, scale: float) -> None:
    """Draw the outlines of zones; scale: pixels per layout unit."""
    dashes = [_dashes(camera.project(outline_of(zone)), scale) for zone in zones]
    if dashes:
        ends = np.concatenate(dashes)
        marks.strokes(ends, (HALF + HALO) * scale, packed(theme.card), 0.6)
        marks.strokes(ends, HALF * scale, packed(theme.accent))


def _dashes(corners: Floats, scale: float) -> Floats:
    """Dashes (m, 4) [pixels] along the closed line through corners (k, 2) [pixels]."""
    closed = np.concatenate([corners, corners[:1]])
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(closed, axis=0).T))])
    count = min(max(int(along[-1] / ((DASH + SPACE) * scale)), 4), MOST_DASHES)
    first = np.arange(count) * along[-1] / count
    last = first + DASH / (DASH + SPACE) * along[-1] / count
    points = [np.interp(place, along, closed[:, axis]) for place in (first, last) for axis in range(2)]
    return np.ascontiguousarray(np.stack(points, axis=1))
