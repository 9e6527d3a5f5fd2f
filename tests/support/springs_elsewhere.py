"""Weights and lattices whose springs go into other engines, and how what moves there swings."""

import json
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from sandbox.level.assembly.build_world import build_world
from sandbox.level.reading.parse import parse_level
from sandbox.physics.step import step
from sandbox.physics.world import World


@dataclass(frozen=True)
class Swing:
    """Where something rests in the end [m], its period [s], and what is left of the second turn at the third."""

    rest: float
    period: float
    kept: float


def level_of_springs(stiffness: float, damping: float, solver: str = "direct", **parts: Any) -> World:
    """The world of a level with one material of that Cs and Cd, `m`."""
    level = {
        "format": "spring-sandbox/level", "version": 3, "name": "springs", "settings": {"solver": solver},
        "materials": {"m": {"stiffness": stiffness, "damping": damping}}, **parts,
    }  # fmt: skip
    return build_world(parse_level(json.dumps(level).encode(), "springs"))


def weight(stiffness: float, damping: float, solver: str = "direct") -> World:
    """2 kg on one spring of 1 m, which hangs from a pin at the origin; the weight is particle 1."""
    particles = [{"id": "pin", "pinned": True}, {"id": "weight", "position": [0, -1], "mass": 2.0}]
    springs = [{"a": "pin", "b": "weight", "material": "m"}]
    return level_of_springs(stiffness, damping, solver, particles=particles, springs=springs)


def lattice(stiffness: float, damping: float, count: int = 4, spacing: float = 0.25) -> World:
    """A braced square of so many particles across, 0.5 kg each, hung by its upper row; particle 1 is at its foot."""
    rows = range(count)
    pairs = [(j * count + i, j * count + i + 1) for j in rows for i in rows[:-1]]
    pairs += [(j * count + i, (j + 1) * count + i) for j in rows[:-1] for i in rows]
    pairs += [(j * count + i, (j + 1) * count + i + 1) for j in rows[:-1] for i in rows[:-1]]
    pairs += [(j * count + i + 1, (j + 1) * count + i) for j in rows[:-1] for i in rows[:-1]]
    body = {
        "type": "mesh", "id": "lattice", "material": "m", "springs": pairs, "masses": [0.5] * count**2,
        "particles": [[i * spacing, j * spacing] for j in rows for i in rows],
        "pinned": [(count - 1) * count + i for i in rows],
    }  # fmt: skip
    return level_of_springs(stiffness, damping, bodies=[body])


def swing(heights: list[float], h: float) -> Swing:
    """How heights [m], taken every h [s] until all is at rest, swing."""
    y = np.array(heights)
    rest = float(y[-len(y) // 4 :].mean())
    d = y - rest
    turns = [i + d[i] / (d[i] - d[i + 1]) for i in range(len(d) - 1) if d[i] * d[i + 1] < 0.0][:7]
    peaks = [np.abs(d[int(a) + 1 : int(b) + 1]).max() for a, b in pairwise(turns)]
    return Swing(rest, 2.0 * h * (turns[-1] - turns[0]) / (len(turns) - 1), float(peaks[2] / peaks[1]))


def swing_here(world: World, ticks: int) -> Swing:
    """How particle 1 of a world swings."""
    heights = []
    for _ in range(ticks):
        step(world)
        heights.append(float(world.position[1, 1]))
    return swing(heights, 1.0 / world.settings.tick_rate)
