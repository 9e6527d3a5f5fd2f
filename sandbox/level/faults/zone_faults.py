"""Faults of zones that involve several fields."""

from collections.abc import Iterator

from sandbox.level.document.model import Level, ZoneDef
from sandbox.level.format.level_error import Fault, shown
from sandbox.level.format.limits import CORNER_LIMIT
from sandbox.level.kinds.polygon import is_simple


def zone_faults(level: Level) -> Iterator[Fault]:
    """Faults of the ids, shapes and water of zones."""
    taken = {item.id for items in (level.bodies, level.particles, level.terrain) for item in items}
    corners = 0
    for index, zone in enumerate(level.zones):
        path = f"zones.{index}"
        if zone.id in taken:
            yield f"{path}.id", f"{shown(zone.id)} is taken; every zone needs an id of its own"
        taken.add(zone.id)
        corners += len(zone.polygon or ())
        if corners > CORNER_LIMIT:
            yield path, f"brings the corners of all zones above {CORNER_LIMIT:,}; use fewer"
            break
        yield from _shape_faults(path, zone)
        if zone.water is not None and zone.box is None:
            yield f"{path}.water", "only a box holds water; give the zone a box, or take the water out"


def _shape_faults(path: str, zone: ZoneDef) -> Iterator[Fault]:
    box, polygon = zone.box, zone.polygon
    if sum(shape is not None for shape in (box, zone.circle, polygon)) != 1:
        yield path, "needs one of box, circle and polygon"
    elif box is not None and not (box[0] < box[2] and box[1] < box[3]):
        yield f"{path}.box", "left and bottom come first and must be below right and top"
    elif polygon is not None and not is_simple(polygon):
        yield f"{path}.polygon", "its sides touch or cross, or a corner comes twice; draw it without"
