"""Carts and wheels with motors, as levels: what tests of joints drive."""

import itertools
import json
import math

import numpy as np

from sandbox.level.assembly.build_world import build_world
from sandbox.level.reading.parse import parse_level
from sandbox.physics.driving import Actuators, Motors
from sandbox.physics.marks import TERRAIN_GROUP
from sandbox.physics.step import step
from sandbox.physics.terrain import Chain, make_terrain
from tests.support.physics_scenes import network

GRAVITY = 9.81


def cart_level(
    *, rim=0.2, load=30.0, torque=60.0, speed=-4.0, driven=2, slope=0.0, segments=20, wheels=2, friction=2.0, **settings
):
    """A cart of wheels with a radius of 0.6 m in a row, 1.6 m apart, with a load between and below their hubs.

    rim: mass of each particle of the wheels [kg]; driven: how many wheels have a motor; slope [degrees], up to the
    right. The wheels go to the right where the speed is negative.
    """
    angle = math.radians(slope)
    along, up = (math.cos(angle), math.sin(angle)), (-math.sin(angle), math.cos(angle))

    def place(x, y):
        return [round(x * along[0] + y * up[0], 9), round(x * along[1] + y * up[1], 9)]

    bodies = []
    for k in range(wheels):
        body = {"type": "wheel", "id": f"w{k}", "position": place(1.6 * k, 0.66), "radius": 0.6, "thickness": 0.15}
        body |= {"segments": segments, "particle_mass": rim, "angle": angle}
        if k < driven:
            body["motor"] = {"speed": speed, "torque": torque}
        bodies.append(body)
    hubs = [f"w{k}.hub" for k in range(wheels)]
    joined = [(hub, "load") for hub in hubs] + list(itertools.pairwise(hubs))
    data = {
        "format": "spring-sandbox/level",
        "version": 3,
        "name": "Cart",
        "settings": {"solver": "direct", "substeps": 1, **settings},
        "materials": {"steel": {"stiffness": 1.0, "damping": 1.0}},
        "contacts": {"friction": friction},
        "terrain": [{"id": "ground", "polyline": [place(-100.0, 0.0), place(200.0, 0.0)]}],
        "bodies": [{**body, "material": "steel"} for body in bodies],
        "particles": [{"id": "load", "position": place(0.8 * (wheels - 1), 0.36), "mass": load, "radius": 0.0}],
        "springs": [{"a": a, "b": b, "material": "steel"} for a, b in joined],
    }
    return parse_level(json.dumps(data).encode(), "cart")


def cart(**options):
    """The world of such a cart."""
    return build_world(cart_level(**options))


def cart_speed(rim, load, slope, solver, substeps, *, seconds=6, times=2.0, driven=2):
    """Mean speed of a cart along its slope, as a share of its motors' speed times the radius of its wheels.

    Its motors have together so many times the torque that it takes to climb over the wheels' corners; measured is the
    last third.
    """
    weight = (2 * rim * 41 + load) * GRAVITY
    torque = times * weight * 0.6 * math.sin(math.pi / 20 + math.radians(slope)) / driven
    world = cart(rim=rim, load=load, torque=torque, slope=slope, driven=driven, solver=solver, substeps=substeps)
    hub, ticks = world.particle_slot("w0.hub"), 60 * seconds
    for tick in range(ticks):
        if tick == ticks - ticks // 3:
            start = world.position[hub].copy()
        step(world)
    moved = world.position[hub] - start
    return math.copysign(math.sqrt(float(moved @ moved)), moved[0]) / (ticks // 3 / 60) / (4.0 * 0.6)


def ring_wheel(at=(0.0, 0.0), *, radius=0.6, thickness=0.15, segments=16, turn=0.0, first=0):
    """Points and springs of a wheel whose hub is slot `first`: hub, inner ring, outer ring; turned by `turn` [rad]."""
    points = [at]
    for r in (radius - thickness, radius):
        for k in range(segments):
            angle = turn + 2.0 * math.pi * k / segments
            points.append((at[0] + r * math.cos(angle), at[1] + r * math.sin(angle)))
    springs = []
    for k in range(segments):
        i, o = 1 + k, 1 + segments + k
        j, q = 1 + (k + 1) % segments, 1 + segments + (k + 1) % segments
        springs += [(0, i), (i, j), (o, q), (i, o), (i, q), (o, j)]
    return points, [(a + first, b + first) for a, b in springs]


def give_motors(world, wheels, speed, torque):
    """Give a world motors without keys: of each wheel its hub and the slots of its rim."""
    rims = [np.asarray(rim, dtype=np.int64) for _, rim in wheels]
    count = len(wheels)
    motors = Motors(
        hub=np.array([hub for hub, _ in wheels]),
        speed=np.full(count, float(speed)),
        torque=np.full(count, float(torque)),
        part=np.arange(count),
        rim_start=np.cumsum([0, *map(len, rims)]),
        rim=np.concatenate(rims),
    )
    world.fit(Actuators(tuple(f"wheel{k}" for k in range(count)), motors=motors), np.ones(count))
    return world


def weighted_wheel(share, *, weight=20.0, **settings):
    """A wheel on a pinned hub with a weight at its rim, 5 degrees below level; torque: a share of what holds it level.

    Slot 17 carries the weight.
    """
    points, springs = ring_wheel(turn=-math.radians(5.0))
    masses = np.full(len(points), 0.2)
    masses[17] += weight
    world = network(points, springs, masses=masses, pinned=(0,), gravity=(0.0, -GRAVITY), **settings)
    return give_motors(world, [(0, range(1, 33))], 1.0, share * weight * GRAVITY * 0.6)


def floating_cart(speed=4.0, torque=3.0, wheels=1, **settings):
    """A wheel, or two, on a frame that nothing holds, without gravity; slots 0.. are the first wheel, hub first."""
    points, springs = ring_wheel()
    if wheels == 2:
        more, joined = ring_wheel((1.6, 0.0), first=33)
        points, springs = points + more, springs + joined
    frame = len(points)
    springs = [*springs, (0, frame), (0, frame + 1), (frame, frame + 1)]
    if wheels == 2:
        springs += [(33, frame), (33, frame + 1), (0, 33)]
    points = [*points, (0.8, -0.5), (-0.8, -0.5)]
    masses = np.append(np.full(frame, 0.2), [5.0, 3.0])
    world = network(points, springs, masses=masses, **settings)
    rims = [(33 * k, range(33 * k + 1, 33 * k + 33)) for k in range(wheels)]
    return give_motors(world, rims, speed, torque)


def unicycle(torque, *, speed=-4.0, **settings):
    """A wheel on the ground with 30 kg that hang 0.3 m below its hub, slot 0."""
    points, springs = ring_wheel((0.0, 0.66))
    masses = np.append(np.full(33, 0.2), 30.0)
    world = network(
        [*points, (0.0, 0.36)], [*springs, (0, 33)], masses=masses, gravity=(0.0, -GRAVITY), **settings,
    )  # fmt: skip
    world.terrain = make_terrain([Chain([[-10.0, 0.0], [40.0, 0.0]], friction=2.0)])
    world.change("radius", np.append([0.0], np.append(np.full(32, 0.05), 0.0)))
    world.change("friction", 2.0)
    world.change("group", np.append([0], np.append(np.full(32, 1), 0)))
    world.change("collides", np.append([0], np.append(np.full(32, TERRAIN_GROUP), 0)))
    return give_motors(world, [(0, range(1, 33))], speed, torque)


def angular_momentum(world, group=slice(None)):
    """About the origin [kg m^2/s], of a group of slots."""
    x, v, m = world.position[group], world.velocity[group], world.mass[group]
    return float(np.sum(m * (x[:, 0] * v[:, 1] - x[:, 1] * v[:, 0])))


def spin(world, group):
    """Angular velocity [rad/s] of a group of slots about its centre of mass."""
    mass = world.mass[group, None]
    r = world.position[group] - (mass * world.position[group]).sum(0) / mass.sum()
    v = world.velocity[group] - (mass * world.velocity[group]).sum(0) / mass.sum()
    return float((mass[:, 0] * (r[:, 0] * v[:, 1] - r[:, 1] * v[:, 0])).sum() / (mass * r * r).sum())


def row_velocities(world, position, velocity):
    """How fast each motor's wheel turns against its mount, about where they were."""
    motors, found = world.actuators.motors, []
    for k, hub in enumerate(motors.hub.tolist()):
        rim = motors.rim[motors.rim_start[k] : motors.rim_start[k + 1]]
        ends = np.concatenate([world.particle_b[world.particle_a == hub], world.particle_a[world.particle_b == hub]])
        turns = []
        for group in (rim, np.append(np.setdiff1d(ends, rim), hub)):
            mass = world.mass[group, None]
            r = position[group] - (mass * position[group]).sum(0) / mass.sum()
            v = velocity[group]
            turns.append(float((mass[:, 0] * (r[:, 0] * v[:, 1] - r[:, 1] * v[:, 0])).sum() / (mass * r * r).sum()))
        found.append(turns[0] - turns[1])
    return np.array(found)
