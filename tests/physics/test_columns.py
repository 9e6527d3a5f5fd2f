"""Columns of jelly stand to the height that Greenhill's formula says, and buckle above it."""

import json

import numpy as np
import pytest

from sandbox.level.kinds.bodies import expansion
from sandbox.level.reading.parse import parse_level
from sandbox.physics.analysis.column import critical_height
from sandbox.session.session import Session

GROUND = {"id": "ground", "polygon": [[-9, -1], [9, -1], [9, 0], [-9, 0]]}
DOWN = (0.0, -9.81)


def level_of(height, width, spacing, stiffness, damping, **more):
    """A column on the ground that begins with a push of 1 cm/s."""
    body = {
        "type": "jelly", "id": "column", "shape": {"box": [width, height]}, "spacing": spacing, "material": "m",
        "position": [0.0, height / 2 + 0.03], "velocity": [0.01, 0.0], "particle_radius": 0.03, **more,
    }  # fmt: skip
    return parse_level(
        json.dumps({
            "format": "spring-sandbox/level", "version": 3, "name": "column", "bodies": [body], "terrain": [GROUND],
            "materials": {"m": {"stiffness": stiffness, "damping": damping}}, "contacts": {"friction": 0.8},
        }).encode(),
        "column",
    )  # fmt: skip


def critical(*of, **more):
    level = level_of(*of, **more)
    return critical_height(expansion(level.bodies[0]).stiff_form, DOWN, *of[-2:], 1.0 / level.settings.tick_rate)


@pytest.mark.parametrize(("width", "spacing", "coefficients"), [(0.8, 0.2, (0.5, 0.9)), (1.2, 0.4, (0.4, 0.85))])
def test_a_column_of_jelly_stands_to_its_critical_height_and_buckles_above_it(width, spacing, coefficients):
    most = critical(1.5 * width, width, spacing, *coefficients)
    leans = []
    for share in (0.8, 1.35):
        height = round(share * most / spacing) * spacing
        session = Session(level_of(height, width, spacing, *coefficients))
        world = session.world
        top = int(np.argmax(np.where(world.particle_active, world.position[:, 1], -np.inf)))
        for _ in range(600):
            session.advance()
        leans.append(abs(world.position[top, 0] - world.position[0, 0]) - width)
    assert leans[0] < 0.05
    assert leans[1] > 1.0


def test_a_column_stands_as_high_as_the_cube_root_of_its_stiffness_says():
    soft, firm = (critical(1.5, 1.0, 0.25, stiffness, 0.9) for stiffness in (0.05, 0.4))
    assert firm / soft == pytest.approx(2.0, rel=1e-9)


def test_a_column_of_springs_alone_stands_as_a_beam_of_them_does():
    # A strip of one cell: two posts of k, two diagonals of k, with rungs that hold it across.
    width, h, stiffness, damping = 0.5, 1.0 / 60.0, 0.3, 0.8
    of = (0.5, width, 0.5, stiffness, damping)
    form = expansion(level_of(*of, area=False).bodies[0]).stiff_form
    assert len(form.pairs) == 6
    mass = float(form.mass[0])
    k = stiffness / (1.0 - damping) * 0.5 * mass / (h * h)
    # Of an even stretch e along or across: two posts or rungs k (e w)^2, two diagonals k (e w)^2 / 2; of both at once,
    # the diagonals alone.
    alone, both = 3.0 * k * width**2, k * width**2
    held = alone - both * both / alone
    most = (7.837 / 12.0 * held * width**2 / (4.0 * mass * 9.81)) ** (1.0 / 3.0)
    assert critical(*of, area=False) == pytest.approx(most, rel=1e-9)
    assert critical(*of) > most
