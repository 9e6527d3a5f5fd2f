"""Zones: their outlines, new ones, and where a motion takes them."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from sandbox.editor.document import Document, EditError, checked, subject, validated
from sandbox.editor.edits.names import free_id
from sandbox.editor.items import Item
from sandbox.editor.kinds.motion import Motion
from sandbox.editor.zone_outline import outline_of
from sandbox.level.document.model import ZoneDef
from sandbox.level.format.quantities import Point, replaced

# Sides count as level and upright where they are off by no more than this share of the zone's size.
UPRIGHT = 1e-9


def add_zone(document: Document, zone: ZoneDef) -> Document:
    """Add a zone, by a free id, and select it. Raises EditError."""
    level = document.level
    zone = validated(replaced(zone, id=free_id(level, zone.id)))
    level = checked(replaced(level, zones=(*level.zones, zone)))
    return Document(level, frozenset([Item("zone", zone.id)]))


def shifted_zone(zone: ZoneDef, dx: float, dy: float) -> ZoneDef:
    """A zone moved by dx, dy [m]."""
    return _placed(zone, lambda x, y: (x + dx, y + dy))


def mapped_zone(zone: ZoneDef, motion: Motion) -> ZoneDef:
    """A zone mapped; a box that then lies askew becomes a polygon. Raises EditError where it cannot be so."""
    if zone.circle is not None:
        if not motion.is_even:
            raise EditError(f"{subject(zone)}: a circle can only be scaled evenly")
        x, y = motion.point(zone.circle[:2])
        return replaced(zone, circle=(x, y, zone.circle[2] * motion.factor))
    if zone.box is None:
        return replaced(zone, polygon=motion.points(zone.polygon or ()))
    corners = motion.points([(x, y) for x, y in outline_of(zone).tolist()])
    box = _box_around(corners)
    if box is not None:
        return replaced(zone, box=box)
    if zone.water is not None:
        raise EditError(f"{subject(zone)}: water stays upright")
    return replaced(zone, box=None, polygon=corners)


def _placed(zone: ZoneDef, place: Callable[[float, float], Point]) -> ZoneDef:
    if zone.box is not None:
        left, bottom, right, top = zone.box
        return replaced(zone, box=(*place(left, bottom), *place(right, top)))
    if zone.circle is not None:
        return replaced(zone, circle=(*place(*zone.circle[:2]), zone.circle[2]))
    return replaced(zone, polygon=tuple(place(x, y) for x, y in zone.polygon or ()))


def _box_around(corners: tuple[Point, ...]) -> tuple[float, float, float, float] | None:
    """The box [m] that four corners are those of; None where they lie askew."""
    points: NDArray[np.float64] = np.array(corners)
    low, high = points.min(axis=0), points.max(axis=0)
    off = np.minimum(points - low, high - points)
    if float(np.max(off)) > UPRIGHT * float(np.max(high - low)):
        return None
    (left, bottom), (right, top) = low.tolist(), high.tolist()
    return left, bottom, right, top
