"""A heap of bodies that a hand stirs: twelve of them, boxes, discs, planks, a rope and a cloth, between walls."""

import json
import math
from typing import Any, NamedTuple

import numpy as np

from sandbox.level.assembly.build_world import build_world
from sandbox.level.reading.parse import parse_level
from sandbox.physics.analysis.energy import kinetic_energy, spring_energy, total_energy
from sandbox.physics.step import step
from sandbox.physics.world import World
from tests.support.overlaps import overlaps

KINDS = ("box", "disc", "box", "disc", "plank", "box", "rope", "disc", "disc", "plank", "box", "cloth")
# Ticks in which the heap settles, in which it comes to rest again, and in which a second look follows.
SETTLING, RESTING = 240, 300
# The hand holds the first corner of the sixth body, and goes round this ellipse [m].
HELD, MIDDLE, HALF = "j5.0", (0.0, 1.6), (2.2, 1.3)
STIRRED = 4


class Stirred(NamedTuple):
    """What a stirred heap is like at rest again.

    deepest [radii] and lines, see overlaps.py; springs: their energy over that before; gain: most energy after the
    release, as a multiple of that at the release; stays: whether a pair is still deep in each other as long again.
    """

    world: World
    deepest: float
    lines: int
    springs: float
    gain: float
    kinetic: float
    stays: bool


def _body(kind: str, name: str, x: float, y: float) -> dict[str, Any]:
    body: dict[str, Any] = {"id": name, "material": "m"}
    jelly = body | {"type": "jelly", "position": [x, y], "spacing": 0.25}
    match kind:
        case "box":
            return jelly | {"shape": {"box": [1.0, 1.0]}}
        case "disc":
            return jelly | {"shape": {"circle": 0.55}}
        case "plank":
            return jelly | {"shape": {"box": [1.2, 0.3]}, "spacing": 0.15}
        case "rope":
            return body | {"type": "rope", "start": [x - 0.6, y], "end": [x + 0.6, y], "segments": 12}
    side = 7
    places = [[x + 0.15 * (i - 3), y + 0.15 * (j - 3)] for j in range(side) for i in range(side)]
    across = [[k, k + 1] for k in range(side * side) if k % side < side - 1]
    springs = across + [[k, k + side] for k in range(side * (side - 1))]
    return body | {"type": "mesh", "particles": places, "springs": springs}


def heap(stiffness: float, damping: float, seed: int, solver: str = "direct") -> World:
    """The heap as it is dropped."""
    generator, bodies = np.random.default_rng(seed), []
    for k, kind in enumerate(KINDS):
        row, column = divmod(k, 4)
        bodies.append(_body(kind, f"j{k}", -2.1 + 1.4 * column + 0.05 * generator.random(), 0.8 + 1.3 * row))
    level = {
        "format": "spring-sandbox/level", "version": 3, "name": "heap", "contacts": {"friction": 0.4}, "bodies": bodies,
        "walls": {"box": [-3.2, 0, 3.2, 12]}, "materials": {"m": {"stiffness": stiffness, "damping": damping}},
        "settings": {"solver": solver, "substeps": "auto"},
    }  # fmt: skip
    return build_world(parse_level(json.dumps(level).encode(), "heap"))


def stir(world: World, speed: float, seed: int, strength: float = 100.0) -> Stirred:
    """Let it settle, stir it at a speed [m/s], let go, and look at it when it rests."""
    for _ in range(SETTLING):
        step(world)
    before = spring_energy(world)
    held = world.particle_slot(HELD)
    world.hold(0, held, tuple(world.position[held]), strength)
    turn = max(4, round(math.tau * 0.5 * (HALF[0] + HALF[1]) / speed * world.settings.tick_rate))
    for tick in range(max(STIRRED * turn, 2 * world.settings.tick_rate)):
        angle = math.tau * (tick + 0.37 * seed) / turn
        world.move_grab(0, (MIDDLE[0] + HALF[0] * math.cos(angle), MIDDLE[1] + HALF[1] * math.sin(angle)))
        step(world)
    world.release(0)
    start = most = total_energy(world)
    for _ in range(RESTING):
        step(world)
        most = max(most, total_energy(world))
    found, springs = overlaps(world), spring_energy(world) / before
    stays = False
    if any(deep > 1.0 for deep in found.depth.values()) or found.lines:
        for _ in range(RESTING):
            step(world)
        again = overlaps(world)
        stays = any(deep > 1.0 and again.depth.get(pair, 0.0) > 1.0 for pair, deep in found.depth.items())
        stays = stays or (found.lines > 0 and again.lines > 0)
    deepest = max(found.depth.values(), default=0.0)
    return Stirred(world, deepest, found.lines, springs, most / start, kinetic_energy(world), stays)
