"""Levels with water, worlds of them, and what is known of floating by hand."""

import json
import math

import numpy as np

from sandbox.level.assembly.build_world import build_world
from sandbox.level.reading.parse import parse_level
from sandbox.physics.pipeline.block_owner import block_of
from sandbox.physics.step import step
from sandbox.physics.water.displacers import FY

G = 9.81
DENSITY = 10.0
CALM = {"fast_drag": 0.0, "slow_drag": 0.0}


def pool(box=(-20.0, -20.0, 20.0, 0.0), **water):
    """A zone of water."""
    return {"id": "pool", "box": list(box), "water": water}


def water_world(zones=None, **parts):
    """A world of a level with a pool, without contacts if none are asked for."""
    head = {"format": "spring-sandbox/level", "version": 3, "name": "water", "zones": zones or [pool()]}
    return build_world(parse_level(json.dumps(head | parts).encode(), "water"))


def jelly(size, share, y, stiffness=1.0, damping=1.0, spacing=0.25, **body):
    """Parts of a level: a box [m] with this share of the water's density, its middle at height y [m]."""
    particles = (round(size[0] / spacing) + 1) * (round(size[1] / spacing) + 1)
    mass = share * DENSITY * size[0] * size[1] / particles
    made = {"type": "jelly", "id": "box", "shape": {"box": list(size)}, "position": [0.0, y], "spacing": spacing,
            "material": "m", "particle_mass": mass}  # fmt: skip
    return {"materials": {"m": {"stiffness": stiffness, "damping": damping}}, "bodies": [made | body]}


def after(world, seconds):
    """The world after so many seconds."""
    for _ in range(round(seconds * world.settings.tick_rate)):
        step(world)
    return world


def free(world):
    """Which particles move."""
    return world.particle_active & (world.inverse_mass > 0.0)


def lift_over_weight(world):
    """What water lifted in the last step, over the weight of all that moves."""
    lift = block_of(world).arrays.water.load[:, FY].sum()
    return float(lift / (world.mass[free(world)].sum() * G))


def wet_area(corners, top=0.0):
    """Area [m^2] of a polygon below a surface, by clipping it."""
    below = []
    for p, q in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        if p[1] <= top:
            below.append(p)
        if (p[1] <= top) != (q[1] <= top):
            below.append(p + (q - p) * ((top - p[1]) / (q[1] - p[1])))
    x, y = np.array(below).reshape(-1, 2).T
    return float(0.5 * np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


def outline(world):
    """Corners [m] of the outline of a box that is the first body of a world, counter-clockwise."""
    solid = np.flatnonzero(world.edge > 1)
    ends = zip(
        world.particle_a[solid].tolist(), world.particle_b[solid].tolist(), world.edge[solid].tolist(), strict=True
    )
    following = dict((a, b) if kind == 2 else (b, a) for a, b, kind in ends)
    found = [min(following)]
    while following[found[-1]] != found[0]:
        found.append(following[found[-1]])
    return world.position[found]


def terminal_speed(mass, area, slow, fast):
    """Speed u [m/s] at which fast u^2 + slow u carries what is lighter or heavier than the water that it displaces."""
    load = G * abs(mass - DENSITY * area)
    return (-slow + math.sqrt(slow * slow + 4.0 * fast * load)) / (2.0 * fast)
