"""What hands hold and how they move it: the bodies, drags and measures that tests and figures of the hand share."""

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from sandbox.level.assembly.build_world import build_world
from sandbox.level.document.model import Level
from sandbox.physics.analysis.query import grip_radius, load_bearing, strain
from sandbox.physics.step import step
from sandbox.physics.world import World
from sandbox.tools.drag import STRENGTHS

RATE = 60
# How long a body is held in place before it is dragged [ticks].
HELD_TICKS = 45


def world_of(*bodies: dict, particles: tuple = (), terrain: tuple = (), **settings) -> World:
    """A world of bodies as a level has them; where there is terrain, things touch."""
    level = {
        "format": "spring-sandbox/level", "version": 4, "name": "held", "settings": settings, "bodies": bodies,
        "particles": particles, "terrain": terrain, "materials": {"rigid": {"stiffness": 1.0, "damping": 1.0}},
    }  # fmt: skip
    return build_world(Level.model_validate(level))


def rope(**settings) -> World:
    """16 particles of 0.1 kg, 1.5 m long, loose."""
    body = {"type": "rope", "id": "body", "start": (0.0, 0.0), "end": (1.5, 0.0), "segments": 15, "particle_mass": 0.1}
    return world_of(body, **settings)


def jelly(size: float = 1.0, cells: int = 8, sag: float | None = None, **settings) -> World:
    """A box of jelly, 8 cells across; sag: how far it sinks under its own weight, as the editor's sinks by 0.1."""
    body = {
        "type": "jelly", "id": "body", "position": (0.0, 0.0), "shape": {"box": (size, size)},
        "spacing": size / cells, "particle_mass": 0.1, "firmness": None if sag is None else {"sag": sag},
    }  # fmt: skip
    return world_of(body, **settings)


def dough(stiffness: float, damping: float) -> World:
    """The jelly of 1 m, with springs that hardly carry it."""
    world = jelly()
    world.set_coefficients(stiffness, damping, None)
    return world


def truss(pins: tuple[str, ...] = (), **settings) -> World:
    """A rigid girder of 1,000 kg and 7 m."""
    body = {
        "type": "girder", "id": "body", "start": (0.0, 0.0), "end": (7.0, 0.0), "segments": 7, "height": 1.0,
        "particle_mass": 62.5, "material": "rigid", "pin": pins,
    }  # fmt: skip
    return world_of(body, **settings)


def nearest(world: World, point: tuple[float, float]) -> int:
    """The particle that is nearest to a point [m]."""
    away = world.position[: world.grab_particle] - point
    return int(np.argmin(np.sum(away * away, axis=1)))


@dataclass
class Drag:
    """What a drag was like, tick by tick: lag [m] of the particle held, force [N], largest strain; limit [N]."""

    lag: list[float]
    force: list[float]
    strain: list[float]
    limit: float


def free_mass(world: World) -> float:
    """Mass [kg] of what can move, hands left out."""
    return float(np.sum(world.mass[world.particle_active & (world.inverse_mass > 0.0)]))


def momentum_velocity(world: World) -> np.ndarray:
    """Velocity [m/s] of the centre of mass of what can move."""
    free = world.particle_active & (world.inverse_mass > 0.0)
    return np.sum(world.mass[free, None] * world.velocity[free], axis=0) / free_mass(world)


def follow(world: World, particle: int, path: Iterable[np.ndarray]) -> Drag:
    """Let hand 0, which holds that particle, follow a path: a target for each tick."""
    drag = Drag([], [], [], float(world.hand_strength[0]) * free_mass(world))
    bearing = load_bearing(world) & (world.material >= 0)
    for target in path:
        world.move_grab(0, tuple(target))
        step(world)
        drag.lag.append(float(math.dist(world.position[particle], target)))
        drag.force.append(float(np.hypot(*world.hand_force[0])))
        drag.strain.append(float(np.max(np.abs(strain(world)[bearing]), initial=0.0)))
    return drag


def line(start: np.ndarray, speed: float, ticks: int) -> list[np.ndarray]:
    """A path to the right at that speed [m/s]."""
    return [start + np.array([speed * (tick + 1) / RATE, 0.0]) for tick in range(ticks)]


def drag_away(world: World, particle: int, strength: str, speed: float, ticks: int = 45) -> tuple[Drag, Drag]:
    """Hold a particle as the mouse would for a while, then drag it to the right: what either is like."""
    start = world.position[particle].copy()
    world.hold(0, particle, tuple(start), STRENGTHS[strength], grip_radius(world, particle))
    held = follow(world, particle, [start] * HELD_TICKS)
    return held, follow(world, particle, line(start, speed, ticks))
