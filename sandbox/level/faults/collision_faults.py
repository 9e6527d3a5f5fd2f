"""Faults of terrain, walls and collision groups that involve several fields."""

import itertools
from collections.abc import Iterator

from sandbox.level.document.model import Level, TerrainDef
from sandbox.level.format.level_error import Fault, shown, suggestion
from sandbox.level.format.limits import COLLISION_GROUP_LIMIT, CORNER_LIMIT
from sandbox.level.kinds.polygon import is_simple
from sandbox.level.kinds.wheel import WheelDef
from sandbox.level.plan.surfaces import TERRAIN_NAME, colliding_items, group_bits


def collision_faults(level: Level) -> Iterator[Fault]:
    """Faults of terrain, walls and collision groups."""
    taken: set[str] = {item.id for _, item in colliding_items(level)}
    corners = 0
    for index, piece in enumerate(level.terrain):
        path = f"terrain.{index}"
        if piece.id in taken:
            yield f"{path}.id", f"{shown(piece.id)} is taken; every piece of terrain needs an id of its own"
        taken.add(piece.id)
        corners += len(piece.polyline or piece.polygon or ())
        if corners > CORNER_LIMIT:
            yield path, f"brings the corners of all terrain above {CORNER_LIMIT:,}; use fewer"
            break
        yield from _shape_faults(path, piece)
    walls = level.walls
    if walls is not None and not (walls.box[0] < walls.box[2] and walls.box[1] < walls.box[3]):
        yield "walls.box", "left and bottom come first and must be below right and top"
    groups = group_bits(level)
    for path, item in colliding_items(level):
        if item.collision_group == TERRAIN_NAME:
            yield f"{path}.collision_group", f'"{TERRAIN_NAME}" is the group of terrain and walls; take another name'
        for number, name in enumerate(item.collides if isinstance(item.collides, tuple) else ()):
            if name not in groups:
                yield f"{path}.collides.{number}", f"there is no group {shown(name)}" + suggestion(name, groups)
    free = sum(isinstance(body, WheelDef) and not body.touches_mount for body in level.bodies)
    if free and len(groups) + free > COLLISION_GROUP_LIMIT:
        most = max(COLLISION_GROUP_LIMIT - len(groups), 0)
        yield "bodies", f"have {free} wheels that do not touch their mounts; at most {most} may beside the groups"
    elif len(groups) > COLLISION_GROUP_LIMIT:
        yield "bodies", f"name {len(groups) - 2} collision groups; at most {COLLISION_GROUP_LIMIT - 2} are allowed"


def _shape_faults(path: str, piece: TerrainDef) -> Iterator[Fault]:
    if (piece.polyline is None) == (piece.polygon is None):
        yield path, "needs one of polyline and polygon"
    elif piece.polygon is not None:
        if len(piece.polygon) < 3:
            yield f"{path}.polygon", f"has {len(piece.polygon)} corners; a polygon has at least 3"
        elif not is_simple(piece.polygon):
            yield f"{path}.polygon", "its sides touch or cross, or a corner comes twice; draw it without"
    elif any(a == b for a, b in itertools.pairwise(piece.polyline or ())):
        yield f"{path}.polyline", "a corner comes twice in a row; take one out"
