"""Zone outlines: where the zones of a level are, in dashes, and places for their names."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sandbox.app.draw.camera import Camera
from sandbox.app.draw.colours import packed
from sandbox.app.draw.raster.painter import MarkList
from sandbox.app.draw.themes import Theme
from sandbox.level.document.model import ZoneDef

# Sizes [pixels at scale 1]: half width of a dash and of what surrounds it, length of a dash and of the gap behind it.
HALF, HALO, DASH, SPACE = 0.9, 1.2, 8.0, 5.0
# A circle is drawn with so many sides; of an outline at most so many dashes, longer ones where it is long.
SIDES, MOST_DASHES = 72, 400

Floats = NDArray[np.float64]


def corners_of(zone: ZoneDef) -> Floats:
    """Corners (k, 2) [m] of a zone, in order; of a circle many."""
    if zone.box is not None:
        left, bottom, right, top = zone.box
        return np.array([(left, bottom), (right, bottom), (right, top), (left, top)])
    if zone.circle is not None:
        x, y, radius = zone.circle
        turn = np.linspace(0.0, 2.0 * math.pi, SIDES, endpoint=False)
        return np.stack([x + radius * np.cos(turn), y + radius * np.sin(turn)], axis=1)
    return np.array(zone.polygon or (), dtype=np.float64)


def name_place(zone: ZoneDef) -> tuple[float, float]:
    """Where the name of a zone stands [m]: at the middle of its top."""
    corners = corners_of(zone)
    return float(corners[:, 0].min() + corners[:, 0].max()) / 2, float(corners[:, 1].max())


def mark_zones(marks: MarkList, zones: Sequence[ZoneDef], camera: Camera, theme: Theme, scale: float) -> None:
    """Draw the outlines of zones; scale: pixels per layout unit."""
    dashes = [_dashes(camera.project(corners_of(zone)), scale) for zone in zones]
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
