"""Jellies that are dropped, squeezed, thrown and stirred, and how near their triangles come to turning over."""

import json
from typing import Any, NamedTuple

import numpy as np

from sandbox.level.assembly.build_world import build_world
from sandbox.level.document.model import Level
from sandbox.physics.analysis.energy import total_energy
from sandbox.physics.arrays import Floats
from sandbox.physics.pipeline.block_owner import block_of
from sandbox.physics.step import step
from sandbox.physics.untangling.jellies import find_inverted, new_inversions
from sandbox.physics.world import World
from tests.support.laid_out import laid_out

DEEDS = ("dropped", "squeezed", "thrown", "stirred")
SHAPES: dict[str, Any] = {
    "box": {"box": [1, 1]},
    "disc": {"circle": 0.5},
    "L": {"polygon": [[-0.5, -0.5], [0.5, -0.5], [0.5, 0], [0, 0], [0, 0.5], [-0.5, 0.5]]},
    "U": {
        "polygon": [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [0.25, 0.5], [0.25, -0.2], [-0.25, -0.2], [-0.25, 0.5],
                    [-0.5, 0.5]]
    },
}  # fmt: skip
# Cs and Cd, of a tick.
COEFFICIENTS = ((0.001, 0.01), (0.02, 0.1), (0.1, 0.5), (0.5, 0.9), (0.9, 0.99), (0.99, 0.99))
HILLS = [[-300, 0], [0, 0], [3, 1], [5, 0], [8, 2], [9, 0], [12, 4], [300, 4]]
# An outline that is wound for longer is not on its way back [ticks].
WOUND_AT_MOST = 3
# How often heavier what lies on a squeezed jelly is, and how many particles each has.
HEAVIER = 100.0


class Found(NamedTuple):
    """Least area of any triangle at the end of any tick, and at the end, as a share of that wanted.

    most_energy: the highest total, as a multiple of that at the start; wound: the most ticks in a row in which a jelly
    was: one that a hard hit winds in a tick is unwound in the next.
    """

    least_area: float
    last_area: float
    most_energy: float
    wound: int


def level(deed: str, shape: str, coefficients: tuple[float, float], **settings: Any) -> Level:
    """A jelly `j`, and what is needed for a deed."""
    place = {"dropped": (0.0, 5.6), "thrown": (-2.0, 1.5)}.get(deed, (0.0, 0.6))
    soft = {
        "type": "jelly", "id": "j", "shape": SHAPES[shape], "position": place, "spacing": 0.125, "material": "m",
        "particle_radius": 0.05, "velocity": (50.0, 0.0) if deed == "thrown" else (0.0, 0.0),
    }  # fmt: skip
    bodies = [soft]
    if deed == "squeezed":
        bodies.append(
            {
                "type": "jelly", "id": "w", "shape": {"box": [1.5, 1]}, "position": (0.0, 3.0), "spacing": 0.25,
                "material": "hard", "particle_mass": HEAVIER * 81 / 35,
            }
        )  # fmt: skip
    ground = HILLS if deed == "thrown" else [[-300, 0], [300, 0]]
    given = {
        "format": "spring-sandbox/level", "version": 4, "name": deed, "settings": settings, "bodies": bodies,
        "contacts": {"friction": 0.5}, "terrain": [{"id": "ground", "polyline": ground}],
        "materials": {
            "m": dict(zip(("stiffness", "damping"), coefficients, strict=True)),
            "hard": {"stiffness": 0.9, "damping": 0.999},
        },
    }  # fmt: skip
    return Level.model_validate_json(json.dumps(given))


def make(deed: str, shape: str, coefficients: tuple[float, float], **settings: Any) -> World:
    """The world of `level`."""
    return build_world(level(deed, shape, coefficients, **settings))


def _alone(shape: dict[str, Any], stiffness: float, damping: float) -> World:
    """A coarse jelly without weight."""
    body = {"type": "jelly", "id": "j", "shape": shape, "spacing": 0.25, "material": "m"}
    given = {
        "format": "spring-sandbox/level", "version": 4, "name": "alone", "settings": {"gravity": (0.0, 0.0)},
        "bodies": [body], "contacts": {}, "materials": {"m": {"stiffness": stiffness, "damping": damping}},
    }  # fmt: skip
    return build_world(Level.model_validate_json(json.dumps(given)))


def wound() -> World:
    """A disc by itself, whose outline begins folded over; no triangle is turned over."""
    world = _alone({"circle": 0.55}, 0.1, 0.5)
    world.position[:13] = (
        (-0.18, -0.23), (-0.07, -0.06), (0.05, 0.01), (0.05, -0.18), (0.07, -0.18), (-0.24, -0.02), (-0.03, 0.13),
        (0.24, 0.02), (0.27, -0.18), (-0.32, -0.03), (-0.0, 0.22), (0.27, 0.23), (-0.12, 0.27),
    )  # fmt: skip
    return world


def drawn_through() -> World:
    """A box, a corner of which a hand has drawn through it to its other side, on nine times as long edges."""
    world = _alone({"box": [1.0, 1.0]}, 0.02, 0.1)
    world.position[:25] = (
        (1.117, 2.064), (0.55, -0.188), (0.55, -0.182), (0.652, -0.152), (0.693, -0.156), (0.532, -0.262),
        (0.276, -0.014), (0.221, 0.073), (0.343, 0.112), (0.403, 0.155), (-0.145, -0.212), (0.064, -0.169),
        (-0.018, -0.11), (-0.05, 0.091), (0.017, 0.174), (-0.509, -0.212), (-0.373, -0.175), (-0.243, -0.137),
        (-0.312, -0.067), (-0.378, 0.096), (-0.813, -0.212), (-0.74, -0.161), (-0.637, -0.127), (-0.512, -0.091),
        (-0.689, -0.138),
    )  # fmt: skip
    return world


def areas(world: World, body: str = "") -> Floats:
    """Areas of all triangles of a world, or of a body, as shares of those wanted."""
    triangles = block_of(world).arrays.triangles.of_world
    place = world.position[triangles.corners]
    a, b = place[:, 1] - place[:, 0], place[:, 2] - place[:, 0]
    area = 0.5 * (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) / world.constraint_rest[triangles.constraint, 0]
    names = np.array(world.particle_names)
    return area[np.char.startswith(names[triangles.corners[:, 0]], f"{body}." if body else "")]


def is_any_wound(world: World) -> bool:
    """Whether triangles about a particle of an outline go on round it, of a jelly that is not inverted."""
    triangles = block_of(world).arrays.triangles.of_world
    found, marked = laid_out(new_inversions, triangles.jellies), np.zeros(world.particle_count, np.bool_)
    find_inverted(world.position, world.constraint_rest, triangles, found, marked)
    return bool(marked[triangles.corners[triangles.jellies.first, 0]][~found.is_inverted].any())


def stir(world: World, generator: np.random.Generator, speed: float) -> None:
    """Take hold of a particle of the jelly, or go on; let go now and then. Hands move at up to so many m/s."""
    if not world.is_held(0):
        slot = int(generator.integers(0, int(np.sum(world.particle_active))))
        world.hold(0, slot, tuple(world.position[slot]))
    elif generator.random() < 0.02:
        world.release(0)
    else:
        cursor = world.position[world.grab_particle]
        way = generator.uniform(-1.0, 1.0, 2) * speed / world.settings.tick_rate
        world.move_grab(0, (float(cursor[0] + way[0]), float(abs(cursor[1] + way[1]))))


def play(
    deed: str, shape: str, coefficients: tuple[float, float], *, seconds: float, seed: int, **settings: Any
) -> Found:
    """Do it for so long, and look at every triangle at the end of every tick."""
    world, generator = make(deed, shape, coefficients, **settings), np.random.default_rng(seed)
    speed = float(generator.choice([5.0, 20.0, 80.0]))
    start = total_energy(world)
    least, most, wound, longest = 1.0, start, 0, 0
    for _ in range(round(seconds * world.settings.tick_rate)):
        if deed == "stirred":
            stir(world, generator, speed)
        step(world)
        least, most = min(least, float(areas(world).min())), max(most, total_energy(world))
        wound = wound + 1 if is_any_wound(world) else 0
        longest = max(longest, wound)
    return Found(least, float(areas(world).min()), most / start, longest)
