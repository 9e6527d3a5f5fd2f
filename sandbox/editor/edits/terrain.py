"""Terrain, walls and zones: putting them into a level, changing outlines, and where a motion takes zones."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import ValidationError

from sandbox.editor.document import Document, EditError, check_terrain, checked, first_fault, subject, validated
from sandbox.editor.edits.names import free_id
from sandbox.editor.items import Definition, Item, Selection, changed
from sandbox.editor.kinds.editing import PlaneMap
from sandbox.editor.scene import outline_of
from sandbox.level.document.model import Level, TerrainDef, WallsDef, ZoneDef
from sandbox.level.format.level_error import shown
from sandbox.level.format.quantities import Point, replaced

Corners = tuple[Point, ...]
Outlined = TerrainDef | ZoneDef
Form = Literal["line", "solid"]
# Fewest corners of each.
FEWEST = {"line": 2, "solid": 3}


# Sides count as level and upright where they are off by no more than this share of the zone's size.
UPRIGHT = 1e-9


def form_of(piece: Outlined) -> Form:
    """Whether a piece is a line with two sides or a closed shape."""
    return "line" if piece.polygon is None else "solid"


FORMS: tuple[Form, ...] = ("line", "solid")


def corners_of(piece: Outlined) -> Corners:
    """Corners [m] of a piece, or of a zone that is a polygon."""
    return getattr(piece, "polyline", None) or piece.polygon or ()


def with_corners(piece: TerrainDef, corners: Sequence[Point], form: Form | None = None) -> TerrainDef:
    """A piece with other corners [m], of the same form unless another is given; NOT validated."""
    is_line = (form or form_of(piece)) == "line"
    points = tuple(corners)
    return replaced(piece, polyline=points if is_line else None, polygon=None if is_line else points)


def add_terrain(document: Document, piece: TerrainDef) -> Document:
    """Add a piece of terrain, by a free id, and select it. Raises EditError."""
    level = document.level
    piece = validated(replaced(piece, id=free_id(level, piece.id)))
    level = checked(replaced(level, terrain=(*level.terrain, piece)))
    return Document(level, frozenset([Item("terrain", piece.id)]))


def set_walls(document: Document, walls: WallsDef | None) -> Document:
    """Put walls around the level, or none. Raises EditError."""
    if walls == document.level.walls:
        return document
    if walls is not None:
        try:
            walls = WallsDef.model_validate(walls.__dict__)
        except ValidationError as error:
            raise EditError(first_fault(error, "the walls", depth=0)) from None
    return replace(document, level=checked(replaced(document.level, walls=walls)))


def move_corner(document: Document, name: str, index: int, point: Point) -> Document:
    """Move a corner of a piece or a zone, by its index, to a point [m]. Raises EditError."""
    return _outlined(document, name, lambda corners: (*corners[:index], point, *corners[index + 1 :]))


def insert_corner(document: Document, name: str, index: int, point: Point) -> Document:
    """Put a corner at a point [m] before the one of that index, at the end for their number. Raises EditError."""
    return _outlined(document, name, lambda corners: (*corners[:index], point, *corners[index:]))


def delete_corner(document: Document, name: str, index: int) -> Document:
    """Take a corner out of a piece. Raises EditError where too few would stay."""
    piece = piece_of(document.level, name)
    form = form_of(piece)
    if len(corners_of(piece)) <= FEWEST[form]:
        what = "line" if form == "line" else "closed shape"
        raise EditError(f"a {what} has {FEWEST[form]} corners or more; delete the whole piece instead")
    return _outlined(document, name, lambda corners: (*corners[:index], *corners[index + 1 :]))


def piece_of(level: Level, name: str) -> Outlined:
    """The piece of terrain or the zone of that id. Raises EditError."""
    pieces: tuple[Outlined, ...] = (*level.terrain, *level.zones)
    found = next((piece for piece in pieces if piece.id == name), None)
    if found is None:
        raise EditError(f"there is no terrain or zone {shown(name)}")
    return found


def outlined(document: Document, pieces: Selection, change: Callable[[Any], Outlined]) -> Document:
    """Change the outlines of pieces of terrain or of zones. Raises EditError."""

    def with_outline(piece: Definition) -> Definition:
        new = change(piece)
        return piece if new == piece else validated(new)

    level = changed(document.level, pieces, with_outline)
    if level is document.level:
        return document
    check_terrain(level)
    return replace(document, level=level)


def _outlined(document: Document, name: str, change: Callable[[Corners], Corners]) -> Document:
    def with_change(piece: Outlined) -> Outlined:
        corners = change(corners_of(piece))
        return replaced(piece, polygon=corners) if isinstance(piece, ZoneDef) else with_corners(piece, corners)

    item = Item("zone" if isinstance(piece_of(document.level, name), ZoneDef) else "terrain", name)
    return outlined(document, frozenset([item]), with_change)


def add_zone(document: Document, zone: ZoneDef) -> Document:
    """Add a zone, by a free id, and select it. Raises EditError."""
    level = document.level
    zone = validated(replaced(zone, id=free_id(level, zone.id)))
    level = checked(replaced(level, zones=(*level.zones, zone)))
    return Document(level, frozenset([Item("zone", zone.id)]))


def shifted_zone(zone: ZoneDef, dx: float, dy: float) -> ZoneDef:
    """A zone moved by dx, dy [m]."""
    return _placed(zone, lambda x, y: (x + dx, y + dy))


def mapped_zone(zone: ZoneDef, motion: PlaneMap) -> ZoneDef:
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
