"""Random scenes that hands abuse, and what energy they have after the hands let go."""

import gzip
import json
import math
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from sandbox.level.assembly.build_world import build_world
from sandbox.level.reading.parse import parse_level
from sandbox.physics.analysis.energy import kinetic_energy, total_energy
from sandbox.physics.pipeline.block_owner import outline_of
from sandbox.physics.settings import Substeps
from sandbox.physics.solvers import SOLVERS
from sandbox.physics.solvers.contact.free_constraints import small_steps
from sandbox.physics.step import step
from sandbox.physics.substeps import substep_time
from sandbox.physics.world import World
from sandbox.session.commands.grabbing import STRONGEST_HAND

SCENES = Path(__file__).resolve().parents[1] / "abuse" / "scenes"
BOX = (-8.0, 0.0, 8.0, 10.0)
# Hands drag for so many ticks, at up to this speed [m/s].
DRAGGED, FASTEST = 300, 50.0


class Drag(NamedTuple):
    """One hand's deeds: the particle that it holds, its strength [m/s^2], and its place [m] in each tick (k, 2)."""

    particle: str
    strength: float
    way: np.ndarray


class Energies(NamedTuple):
    """From the release on, a value a tick [J]: all energy, gravity's from the room's lowest corner, and the kinetic.

    Velocities are those of the middle of a step, so gravity's energy is that of the places half a step ago: what falls
    freely keeps that sum (docs/physics.md, restitution), and not that with the height at the end of the step.
    """

    total: np.ndarray
    kinetic: np.ndarray

    @property
    def over(self) -> float:
        """The most energy after the release, as a multiple of that at the release."""
        return float(self.total.max() / max(self.total[0], 1e-12))

    @property
    def growth(self) -> float:
        """The most that energy grows within a second, as a share of that at the release."""
        grown = max(float(np.max(self.total[i + 1 : i + 61] - self.total[i])) for i in range(len(self.total) - 1))
        return grown / max(float(self.total[0]), 1e-12)


def _body(generator: np.random.Generator, name: str, place: tuple[float, float], material: str) -> dict[str, Any]:
    x, y = place
    mass = float(10.0 ** generator.uniform(-2.0, 4.0))
    body: dict[str, Any] = {"id": name, "material": material, "particle_mass": mass}
    if generator.integers(2):
        body["velocity"] = generator.uniform(-5.0, 5.0, 2).tolist()
    if generator.integers(2):
        body["friction"] = float(generator.choice([0.0, 0.5, 2.0]))
    match int(generator.integers(5)):
        case 0:
            size = generator.uniform(0.5, 1.2, 2).tolist()
            shape: dict[str, Any] = {"box": size} if generator.integers(2) else {"circle": 0.6}
            spacing, angle = float(generator.choice([0.15, 0.3])), float(generator.uniform(0.0, 6.28))
            return body | {"type": "jelly", "shape": shape, "position": [x, y], "spacing": spacing, "angle": angle}
        case 1:
            segments = int(generator.integers(3, 15))
            return body | {"type": "rope", "start": [x - 0.9, y], "end": [x + 0.9, y], "segments": segments}
        case 2:
            spokes = int(generator.integers(5, 9))
            return body | {"type": "web", "position": [x, y], "radius": 0.7, "spokes": spokes, "rings": 3}
        case 3:
            return body | {"type": "wheel", "position": [x, y], "radius": 0.6, "thickness": 0.2, "segments": 12}
    return body | {"type": "girder", "start": [x - 0.9, y], "end": [x + 0.9, y], "segments": 5, "height": 0.4}


def random_level(seed: int, softest: bool = False, solver: str = "direct") -> dict[str, Any]:
    """A level of a few bodies in a room; softest: every Cs is below 0.01."""
    generator = np.random.default_rng(seed)
    materials = {}
    for k in range(3):
        damping = float(generator.choice([generator.uniform(0.0, 1.0), 0.99, 1.0, 0.05]))
        most = min(damping, 0.01) if softest else damping
        stiffness = float(generator.choice([0.0, most, generator.uniform(0.0, most), min(most, 1e-4)]))
        materials[f"m{k}"] = {"stiffness": stiffness, "damping": damping}
    cells = [(-6.0 + 3.0 * i, 3.0 + 2.5 * j) for j in range(3) for i in range(5)]
    chosen = generator.permutation(len(cells))[: generator.integers(1, 5)]
    bodies = [_body(generator, f"b{k}", cells[cell], f"m{generator.integers(3)}") for k, cell in enumerate(chosen)]
    terrain = []
    if generator.integers(2):
        x = np.linspace(8.5, -8.5, 9)
        heights = generator.uniform(0.2, 1.3, len(x))
        hill = [[-8.5, -1.0], [8.5, -1.0], *np.stack([x, heights], axis=1).tolist()]
        terrain.append({"id": "hill", "polygon": hill})
    particles = [
        {"id": f"p{k}", "position": [-7.2 + 0.9 * k, 1.75], "mass": float(10.0 ** generator.uniform(-2.0, 4.0)),
         "radius": float(generator.choice([0.05, 0.15, 0.3]))}
        for k in range(int(generator.integers(0, 8)))
    ]  # fmt: skip
    contacts = {
        "friction": float(generator.choice([0.0, 0.5, 3.0])),
        "restitution": float(generator.choice([0, 0.3, 1])),
    }
    gravity = [0.0, float(generator.choice([0.0, -9.81]))]
    return {
        "format": "spring-sandbox/level", "version": 3, "name": f"random {seed}", "materials": materials,
        "contacts": contacts, "walls": {"box": list(BOX)}, "terrain": terrain, "bodies": bodies, "particles": particles,
        "settings": {"solver": solver, "substeps": (1, 2, 4)[seed % 3], "gravity": gravity},
    }  # fmt: skip


def random_drags(seed: int, world: World) -> list[Drag]:
    """What one to three hands do in it: each goes straight on to one place after another."""
    generator = np.random.default_rng(10_000 + seed)
    drags = []
    held = [slot for slot in range(world.particle_count) if world.inverse_mass[slot] > 0.0]
    for slot in generator.permutation(held)[: generator.integers(1, 4)].tolist():
        place, way = world.position[slot].copy(), []
        while len(way) < DRAGGED:
            goal = generator.uniform((-7.5, 0.5), (7.5, 9.5))
            speed = generator.uniform(1.0, FASTEST) / world.settings.tick_rate
            ticks = max(1, math.ceil(float(np.linalg.norm(goal - place)) / speed))
            way += [place + (goal - place) * (k + 1) / ticks for k in range(ticks)]
            place = goal
        strength = float(generator.choice([30.0, 100.0, 300.0, STRONGEST_HAND]))
        drags.append(Drag(world.particle_names[slot], strength, np.array(way[:DRAGGED])))
    return drags


def kept_scene(name: str) -> tuple[World, list[Drag]]:
    """A scene of tests/abuse/scenes, in which energy once came from nowhere, with hands as strong as they were then."""
    world = build_world(parse_level((SCENES / f"{name}.json").read_bytes(), name))
    lines = [
        json.loads(line) for line in gzip.decompress((SCENES / f"{name}.commands.jsonl.gz").read_bytes()).splitlines()
    ]
    drags = []
    for hand in sorted({line["command"]["grab"] for line in lines}):
        own = [line["command"] | {"tick": line["tick"]} for line in lines if line["command"]["grab"] == hand]
        way = {command["tick"]: command["target"] for command in own if command["type"] == "move_grab"}
        ticks = [way[tick] for tick in sorted(way)]
        drags.append(Drag(own[0]["particle"], STRONGEST_HAND, np.array(ticks[:DRAGGED])))
    return world, drags


def energies(world: World, drags: list[Drag], after: int) -> Energies:
    """Let hands drag, let go, and measure for so many ticks."""
    for hand, drag in enumerate(drags):
        slot = world.particle_slot(drag.particle)
        world.hold(hand, slot, tuple(world.position[slot]), drag.strength)
    for tick in range(DRAGGED):
        for hand, drag in enumerate(drags):
            world.move_grab(hand, tuple(drag.way[min(tick, len(drag.way) - 1)]))
        step(world)
    for hand in range(len(drags)):
        world.release(hand)
    live = world.particle_active & (world.inverse_mass > 0.0)
    weight = (world.mass * world.gravity_scale)[live, None] * np.array(world.settings.gravity)
    lowest, h = float(np.sum(weight[:, 1])) * BOX[1], substep_time(world.settings)
    # What nothing holds falls in small steps.
    half = np.where(outline_of(world).attached[live], 0.5 * h, 0.5 * h / small_steps(h))[:, None]
    rows = []
    for tick in range(after + 1):
        if tick:
            step(world)
        back = float(np.sum(half * weight * world.velocity[live]))
        rows.append((total_energy(world) + lowest + back, kinetic_energy(world)))
    return Energies(*np.array(rows).T)


def random_scene(
    seed: int, softest: bool = False, solver: str = "direct", substeps: Substeps | None = None
) -> tuple[World, list[Drag]]:
    """A random scene and its hands; substeps: None: 1, 2 or 4, by the seed."""
    assert solver in SOLVERS
    level = random_level(seed, softest, solver)
    level["settings"]["substeps"] = substeps or level["settings"]["substeps"]
    world = build_world(parse_level(json.dumps(level).encode(), level["name"]))
    return world, random_drags(seed, world)
