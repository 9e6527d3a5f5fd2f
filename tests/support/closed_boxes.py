"""Random closed boxes: jellies, discs and ropes of any coefficients and masses; and the energy they may have."""

import math
from typing import Any, Literal, NamedTuple

import numpy as np

from sandbox.level.kinds.bodies import expansion
from sandbox.level.kinds.jelly import JellyDef
from sandbox.physics.analysis.energy import (
    gravity_energy,
    kinetic_energy,
    spring_energy,
)
from sandbox.physics.constraints import AREA
from sandbox.physics.marks import ALL_GROUPS, LINE
from sandbox.physics.settings import AUTO
from sandbox.physics.solvers.direct.energy_budget import UNDERDAMPED_BUDGET_SHARE
from sandbox.physics.terrain import Chain
from sandbox.physics.world import World
from tests.support.contact_scenes import BODIES, add_discs, world

# Half the width and the height [m] of a box, the cells of it that bodies start in, and their fastest start [m/s].
HALF, HEIGHT, COLUMNS, ROWS, FASTEST = 4.0, 8.0, 5, 4, 20.0
SHAPES: tuple[dict[str, Any], ...] = (
    {"box": (1.0, 0.8)},
    {"circle": 0.55},
    {"polygon": ((-0.5, -0.4), (0.6, -0.4), (0.0, 0.6))},
)


class Box(NamedTuple):
    """A closed box and what is in it; energy [J]: of its start, from the floor on; bouncy: some Cs is above its Cd."""

    world: World
    energy: float
    bouncy: bool


def _walls(kind: str) -> list[Chain]:
    if kind == "walls":
        return [Chain([(-HALF, 0.0), (HALF, 0.0), (HALF, HEIGHT), (-HALF, HEIGHT)], "hollow")]
    wide, high = HALF + 0.5, HEIGHT + 0.5
    bars = ((-wide, -0.5, wide, 0.0), (-wide, HEIGHT, wide, high), (-wide, -0.5, -HALF, high), (HALF, -0.5, wide, high))
    return [Chain([(a, b), (c, b), (c, d), (a, d)], "solid") for a, b, c, d in bars]


def _add_body(to: World, generator: np.random.Generator, centre: tuple[float, float], bouncy: bool) -> None:
    first, kind = to.particle_count, generator.integers(3)
    damping = generator.uniform(0.0, 1.0)
    stiffness = generator.uniform(0.0, 1.0 if bouncy else damping)
    mass = 10.0 ** generator.uniform(-2.0, 2.0)
    speed, way = generator.uniform(0.0, FASTEST), generator.uniform(0.0, math.tau)
    touch = {
        "velocity": (speed * math.cos(way), speed * math.sin(way)), "friction": generator.uniform(0.0, 1.0),
        "restitution": generator.choice([0.0, generator.uniform(0.0, 1.0)]),
    }  # fmt: skip
    if kind == 0:
        add_discs(to, [centre], radius=generator.uniform(0.1, 0.6), mass=mass, **touch)
        return
    if kind == 1:
        along = 0.15 * (np.arange(7) - 3.0)[:, None] * np.array([[math.cos(way), math.sin(way)]])
        points, radius = np.asarray(centre) + along, 0.06
        pairs, sides = np.stack([np.arange(6), np.arange(1, 7)], axis=1), np.full(6, LINE)
        triangles = []
    else:
        body = JellyDef.model_validate(
            {"type": "jelly", "id": "j", "shape": SHAPES[generator.integers(3)], "position": centre, "angle": way,
             "spacing": 0.25}
        )  # fmt: skip
        made = expansion(body)
        points, pairs, sides, radius = made.form, made.pairs, made.edges, 0.06
        triangles = made.polygons() if generator.integers(2) else []
    to.add_particles(
        [f"{first}.{k}" for k in range(len(points))], points, radius=radius, mass=mass / len(points), owner=first,
        group=BODIES, collides=ALL_GROUPS, **touch,
    )  # fmt: skip
    to.add_springs(
        [f"{first}:{k}" for k in range(len(pairs))], pairs[:, 0] + first, pairs[:, 1] + first, stiffness=stiffness,
        damping=damping, edge=sides,
    )  # fmt: skip
    if len(triangles):
        to.add_constraints(AREA, np.asarray(triangles) + first, stiffness=stiffness, damping=damping)


def random_box(seed: int, solver: str = "direct", bouncy: bool | None = None, most: int = COLUMNS * ROWS) -> Box:
    """A box with 2 to `most` bodies; bouncy: whether coefficients may have Cs > Cd, None: in every other box."""
    generator = np.random.default_rng(seed)
    kind: Literal["walls", "bars"] = "walls" if seed % 3 == 0 else "bars"
    if bouncy is None:
        bouncy = seed % 2 == 0
    to = world(*_walls(kind), solver=solver, substeps=(1, 2, 4, AUTO)[seed // 2 % 4])
    for cell in generator.permutation(COLUMNS * ROWS)[: generator.integers(2, most + 1)].tolist():
        centre = (-3.2 + 1.6 * (cell % COLUMNS), 1.0 + 2.0 * (cell // COLUMNS))
        _add_body(to, generator, centre, bouncy)
    return Box(to, energy(to), bool(np.any(to.stiffness > to.damping)))


def energy(of: World) -> float:
    """Kinetic energy, that of gravity and of springs [J]."""
    return kinetic_energy(of) + gravity_energy(of) + spring_energy(of)


def allowed(box: Box) -> float:
    """The most energy [J] that a box may have: its start's, four times that where springs are bouncy, and the step's.

    A step of h at 60 Hz knows the height of what falls at v to within h v / 2.
    """
    of = box.world
    speed = np.sqrt(np.sum(of.velocity**2, axis=1))
    step_error = 0.5 / 60.0 * 9.81 * float(np.sum(of.mass * (speed + FASTEST)))
    return box.energy * (1.0 + UNDERDAMPED_BUDGET_SHARE if box.bouncy else 1.0) + step_error


def outside(of: World) -> int:
    """How many particles' centres are outside the box."""
    x, y = of.position[:, 0], of.position[:, 1]
    return int(np.sum((np.abs(x) > HALF) | (y < 0.0) | (y > HEIGHT)))
