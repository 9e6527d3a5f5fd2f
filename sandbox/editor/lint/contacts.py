"""What starts inside something else, where things touch."""

from collections.abc import Callable, Generator

import numpy as np
from numpy.typing import NDArray

from sandbox.editor.document import Document, select
from sandbox.editor.edits.moving import move
from sandbox.editor.items import Item
from sandbox.editor.lint.finding import Finding, Remedy, Rule, called
from sandbox.editor.scene import Scene
from sandbox.level.document.model import Level
from sandbox.physics.geometry.segment import lengths, nearest_on_segments
from sandbox.physics.marks import TERRAIN_GROUP

Floats = NDArray[np.float64]
Slots = NDArray[np.int64]

# A disc that reaches less than this part of its radius into something rests on it.
DEEP = 0.5
# What is moved out of something keeps this distance from it [m].
ROOM = 1e-3
# Edges of a polygon that are looked at before the window may draw.
EDGES = 64
# More rolling resistance than this keeps heaps from coming to rest.
MOST_ROLLING = 0.05


def buried_particles(level: Level, scene: Scene) -> Rule:
    """Items that start inside solid terrain or beyond walls, which they touch."""
    if not level.terrain and level.walls is None:
        return
    touches = scene.collision.touches & TERRAIN_GROUP != 0
    free = np.flatnonzero(touches & ~scene.pinned)
    yield None
    for piece in level.terrain:
        if piece.polygon is None:
            continue
        corners, place = np.array(piece.polygon), scene.position[free]
        near = free[np.all((place > corners.min(axis=0)) & (place < corners.max(axis=0)), axis=1)]
        out = yield from _ways_out(corners, scene.position[near])
        depth = np.hypot(*out.T)
        deep = depth > DEEP * scene.radius[near]
        slots, out = near[deep], out[deep] * (1.0 + scene.radius[near] / np.maximum(depth, ROOM))[deep, None]
        yield from _buried(scene, slots, out, f'inside "{piece.id}"')
    if level.walls is not None:
        left, bottom, right, top = level.walls.box
        place = scene.position[free]
        out = np.clip(place, (left, bottom), (right, top)) - place
        slots = np.flatnonzero(np.hypot(*out.T) > DEEP * scene.radius[free])
        out[slots] += np.sign(out[slots]) * scene.radius[free[slots], None]
        yield from _buried(scene, free[slots], out[slots], "beyond the walls")


def _ways_out(corners: Floats, points: Floats) -> Generator[None, None, Floats]:
    """The shortest way [m] (k, 2) from each point out of a polygon with those corners (c, 2); none from outside."""
    inside = np.zeros(len(points), dtype=np.bool_)
    best, out = np.full(len(points), np.inf), np.zeros_like(points)
    x, y = points.T
    for number, (a, b) in enumerate(zip(corners, np.roll(corners, -1, axis=0), strict=True)):
        along = b - a
        _, away = nearest_on_segments(points, a, b)
        distance = lengths(away)
        nearer = distance < best
        best, out = np.where(nearer, distance, best), np.where(nearer[:, None], -away, out)
        if a[1] != b[1]:
            inside ^= ((a[1] > y) != (b[1] > y)) & (x < a[0] + along[0] * ((y - a[1]) / along[1]))
        if number % EDGES == 0:
            yield None
    return np.where(inside[:, None], out, 0.0)


def _buried(scene: Scene, slots: Slots, out: Floats, where: str) -> Rule:
    """A finding for each item with particles in a place, slots (k,), and the way out for each [m] (k, 2)."""
    owners = scene.particle_item[slots]
    for index in np.unique(owners).tolist():
        mine = np.flatnonzero(owners == index)
        worst = mine[np.argmax(np.hypot(*out[mine].T))]
        item, count = scene.items[index], int(np.sum(scene.particle_item == index))
        some = "" if len(mine) == count else f" with {len(mine)} of {count} particles"
        text = f"{called(scene.level, item)} starts{some} {where}, and will be pushed out; move it"
        x, y = (out[worst] + ROOM * np.sign(out[worst])).tolist()
        remedy = Remedy("Move it out", _moved(item, x, y))
        yield Finding("warning", text, frozenset([item]), scene.place(int(slots[worst])), remedy,
                      f"{{count}} things start {where}, and will be pushed out; move them")  # fmt: skip
        yield None


def _moved(item: Item, dx: float, dy: float) -> Callable[[Document], Document]:
    def out(document: Document) -> Document:
        return move(select(document, frozenset([item])), dx, dy)

    return out


def turning_in_vain(level: Level, scene: Scene) -> Rule:
    """Loose particles with a rolling resistance that shakes heaps, or with a spin though springs or pins hold them."""
    held = scene.pinned.copy()
    for ends in (scene.particle_a, scene.particle_b):
        held[ends] = True
    slots = np.flatnonzero(scene.particle_item >= len(level.bodies))
    for slot, particle in zip(slots.tolist(), level.particles, strict=True):
        item = scene.items[int(scene.particle_item[slot])]
        if particle.rolling > MOST_ROLLING and particle.rolls:
            text = (
                f"{called(level, item)} has a rolling resistance of {particle.rolling:g}: with more than "
                f"{MOST_ROLLING:g} heaps do not come to rest; lower it, or let it not roll"
            )
            many = f"{{count}} discs have a rolling resistance above {MOST_ROLLING:g}: no heap comes to rest; lower it"
            yield Finding("warning", text, frozenset([item]), scene.place(slot), many=many)
        if particle.spin != 0.0 and held[slot]:
            text = f"{called(level, item)} is held and does not turn; its spin of {particle.spin:g} rad/s is lost"
            many = "{count} particles are held and do not turn; their spin is lost"
            yield Finding("hint", text, frozenset([item]), scene.place(slot), many=many)
    yield None
