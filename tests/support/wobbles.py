"""Levels of one firm body, and what its slowest wobble is, measured from its motion."""

import json
import math
from typing import Any

import numpy as np

from sandbox.level.assembly.build_world import build_world
from sandbox.level.format.limits import VERSION
from sandbox.level.reading.parse import parse_level
from sandbox.physics.analysis.energy import measure_constraints, reduced_masses
from sandbox.physics.arrays import Floats
from sandbox.physics.constraints import AREA
from sandbox.physics.step import step
from sandbox.physics.world import World

# How far the body is bent at first, as a share of its size: little enough to move as linear theory has it.
BENT = 1e-5


def firm_level(firmness: Any, settings: dict[str, Any] | None = None, floor: bool = False, **body: Any) -> bytes:
    """A level of one body, a jelly unless it says otherwise; in the air without gravity, or with a floor at 0."""
    made = {"type": "jelly", "id": "body", "firmness": firmness, **body}
    level: dict[str, Any] = {"format": "spring-sandbox/level", "version": VERSION, "name": "firm", "bodies": [made]}
    level["settings"] = {"solver": "direct", **({} if floor else {"gravity": [0, 0]}), **(settings or {})}
    if floor:
        level["contacts"] = {"friction": 0.5}
        level["terrain"] = [{"id": "ground", "polyline": [[-50, 0], [50, 0]]}]
    return json.dumps(level).encode()


def firm_world(firmness: Any, settings: dict[str, Any] | None = None, floor: bool = False, **body: Any) -> World:
    """The world of such a level."""
    return build_world(parse_level(firm_level(firmness, settings, floor, **body), "firm"))


def standing_box(size: float, cells: int, firmness: Any, load: float = 0.0, settings: Any = None) -> World:
    """A jelly box of that size [m], so many cells across, that stands on a floor; load [kg]: on its upper corners."""
    radius = min(0.05, 0.4 * size / cells)
    body = {"shape": {"box": [size, size]}, "position": [0, size / 2 + 1.02 * radius], "spacing": size / cells}
    world = firm_world(firmness, settings, floor=True, particle_radius=radius, **body)
    if load:
        top = np.flatnonzero(world.position[:, 1] > size)
        world.change("mass", world.mass[top] + load / len(top), top)
        world.change("inverse_mass", 1.0 / world.mass[top], top)
    return world


def height(world: World) -> float:
    """Height [m] of what is in a world, from centre to centre."""
    y = world.position[world.particle_active, 1]
    return float(y.max() - y.min())


def slowest_mode(world: World) -> tuple[float, Floats]:
    """The lowest eigenvalue of a world's one body that is no motion of the whole, and its shape (n, 2), densely."""
    count = int(world.particle_active.sum())
    matrix = np.zeros((2 * count, 2 * count))
    mass = world.mass[:count]
    springs = np.flatnonzero(world.spring_active)
    reduced = reduced_masses(world)
    for s in springs.tolist():
        a, b = int(world.particle_a[s]), int(world.particle_b[s])
        n = world.position[b] - world.position[a]
        n = n / math.sqrt(n @ n)
        at = [2 * a, 2 * a + 1, 2 * b, 2 * b + 1]
        row = np.concatenate([-n, n])
        matrix[np.ix_(at, at)] += reduced[s] * np.outer(row, row)
    _, effective, slope = measure_constraints(world)
    for k in range(world.constraint_count):
        first = int(world.constraint_first[k])
        corners = slice(first, first + int(world.constraint_corners[k]))
        if world.constraint_corners[k] > 3 and world.constraint_kind[k] == AREA:
            continue
        at = np.stack([2 * world.corner_particle[corners], 2 * world.corner_particle[corners] + 1], axis=1).reshape(-1)
        row = slope[corners].reshape(-1)
        matrix[np.ix_(at, at)] += effective[k] * np.outer(row, row)
    root = 1.0 / np.sqrt(np.repeat(mass, 2))
    values, vectors = np.linalg.eigh(matrix * root[:, None] * root)
    return float(values[3]), (vectors[:, 3] * root).reshape(-1, 2)


def measured_wobble(world: World) -> tuple[float, float]:
    """Frequency [Hz] and damping ratio of a body that is bent a little and let go, by the way it moves."""
    _, shape = slowest_mode(world)
    count = len(shape)
    form, mass = world.position[:count].copy(), world.mass[:count, None]
    size = float(np.ptp(form, axis=0).max())
    shape = shape / np.abs(shape).max() * BENT * size
    world.position[:count] += shape
    world.velocity[:] = 0.0
    world.slow_velocity[:] = 0.0
    amounts = []
    for _ in range(80):
        amounts.append(float(np.sum((world.position[:count] - form) * mass * shape)))
        step(world)
    q = np.array(amounts) / amounts[0]
    small = np.flatnonzero(np.abs(q) < 1e-4)
    q = q[: max(6, int(small[0]) if len(small) else 80)]
    # q'' = t q' - p q by least squares: t and p give the poles
    trace, product = np.linalg.lstsq(np.stack([q[1:-1], -q[:-2]], axis=1), q[2:], rcond=None)[0]
    root = complex(np.roots([1.0, -trace, product])[0])
    pole = np.log(root) * world.settings.tick_rate
    return float(abs(pole) / (2.0 * math.pi)), float(-pole.real / abs(pole))
