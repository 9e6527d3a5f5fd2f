"""A body on too many contacts for its exact answer takes a cheaper one: it lands softer, and gains nothing."""

import json

import numpy as np
import pytest

from sandbox.level.reading.parse import parse_level
from sandbox.physics.analysis.energy import gravity_energy, kinetic_energy, spring_energy, steps_by_mass
from sandbox.session.session import Session
from sandbox.session.summary import run
from tests.support.wholes import part_and_whole

RADIUS = 0.04
GROUND = {"id": "ground", "polyline": [[-20, 0], [20, 0]]}


def net(lines):
    """A loose net that falls edgewise, so that all of it comes to lie on the ground."""
    spacing = 0.18
    name = "p{}_{}".format
    across = [(name(i, j), name(i + 1, j)) for j in range(lines) for i in range(lines - 1)]
    along = [(name(i, j), name(i, j + 1)) for j in range(lines - 1) for i in range(lines)]
    return {
        "particles": [
            {"id": name(i, j), "position": [spacing * i, 0.5 + spacing * j], "radius": RADIUS}
            for j in range(lines)
            for i in range(lines)
        ],
        "springs": [{"a": a, "b": b, "material": "m"} for a, b in across + along],
    }


def block(size, angle=0.0):
    """A jelly whose lowest corner is 0.3 m above the ground."""
    return {
        "type": "jelly", "id": "block", "shape": {"box": [size, size]}, "spacing": 0.1, "material": "m", "angle": angle,
        "position": [0.0, 0.3 + size / 2 * (np.cos(angle) + np.sin(angle))], "particle_radius": RADIUS,
    }  # fmt: skip


def session_of(materials, **parts):
    return Session(
        parse_level(
            json.dumps({
                "format": "spring-sandbox/level", "version": 3, "name": "budget",
                "materials": {"m": {"stiffness": materials[0], "damping": materials[1]}}, "terrain": [GROUND], **parts,
            }).encode(),
            "budget",
        )
    )  # fmt: skip


def energy_of(world):
    return kinetic_energy(world) + gravity_energy(world) + spring_energy(world)


@pytest.mark.parametrize("materials", [(0.8, 0.9), (0.4, 0.7)])
def test_a_net_that_lies_on_the_ground_stays_on_it_and_gains_nothing(materials):
    session = session_of(materials, **net(22))
    world = session.world
    start = energy_of(world)
    for _ in range(240):
        session.advance()
        assert energy_of(world) <= start
    assert steps_by_mass(world) > 50
    height = world.position[world.particle_active, 1]
    assert height.min() > 0.5 * RADIUS
    assert height.max() < 0.18 * 22 / 2
    assert np.abs(world.velocity[world.particle_active]).max() < 1.0


@pytest.mark.parametrize("angle", part_and_whole(0.35, 0.0))
def test_a_large_block_lands_and_comes_to_lie_on_its_side(angle):
    session = session_of((0.8, 0.9), bodies=[block(5.0, angle)])
    world = session.world
    before = energy_of(world)
    figures = run(session, 240)
    assert figures.steps_by_mass == steps_by_mass(world) > 30
    assert energy_of(world) < before
    assert world.position[world.particle_active, 1].min() > 0.5 * RADIUS


def test_a_block_on_few_contacts_is_answered_exactly():
    session = session_of((0.8, 0.9), bodies=[block(2.0)])
    assert run(session, 120).steps_by_mass == 0
