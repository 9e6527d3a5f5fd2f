"""Towers and pyramids of rigid boxes: they settle by little, and then they stand."""

import numpy as np
import pytest

from sandbox.level.kinds.bodies import expansion
from sandbox.level.kinds.jelly import JellyDef
from sandbox.physics.arrays import Floats
from sandbox.physics.jit import COMPILED
from sandbox.physics.marks import ALL_GROUPS
from sandbox.physics.world import World
from tests.support.contact_scenes import BODIES, FLOOR, world
from tests.support.physics_scenes import run

# Of a particle and of a box with it [m]; a box of 1 m.
RADIUS = 0.02
SETTLES = 2e-3
CREEPS = 1e-3


def _add_box(to: World, x: float, y: float, across: int) -> None:
    """A rigid box of so many particles in a row, with its lower edge at y."""
    size = 1.0 - 2.0 * RADIUS
    made = expansion(
        JellyDef.model_validate({
            "type": "jelly", "id": "box", "shape": {"box": (size, size)}, "position": (x, y + 0.5),
            "spacing": size / (across - 1), "mesh": "grid",
        })
    )  # fmt: skip
    first = to.particle_count
    assert len(made.form) == across * across
    to.add_particles(
        [f"box.{first + k}" for k in range(len(made.form))], made.form, radius=RADIUS, friction=0.6, owner=first,
        group=BODIES, collides=ALL_GROUPS,
    )  # fmt: skip
    to.add_springs(
        [f"box:{to.spring_count + k}" for k in range(len(made.pairs))], made.pairs[:, 0] + first,
        made.pairs[:, 1] + first, stiffness=1.0, damping=1.0, edge=made.edges,
    )  # fmt: skip


def _centres(w: World, across: int) -> Floats:
    return w.position.reshape(-1, across * across, 2).mean(axis=1)


def _tower(across: int, substeps: int) -> World:
    w = world(FLOOR, substeps=substeps)
    for level in range(10):
        _add_box(w, 0.0, float(level), across)
    return w


def _pyramid(rows: int) -> World:
    w = world(FLOOR)
    for level in range(rows):
        for k in range(rows - level):
            _add_box(w, 1.1 * (k - 0.5 * (rows - level - 1)), float(level), 2)
    return w


def _holds(w: World, across: int, ticks: int) -> None:
    """It settles by SETTLES at most in 5 s, and then stays where it is to CREEPS."""
    start = _centres(w, across)
    run(w, 300)
    settled = _centres(w, across)
    assert np.hypot(*(settled - start).T).max() <= SETTLES
    run(w, ticks)
    assert np.hypot(*(_centres(w, across) - settled).T).max() <= CREEPS


@pytest.mark.parametrize("across", [2, 3])
@pytest.mark.parametrize("substeps", [1, 4])
@pytest.mark.skipif(not COMPILED, reason="interpreted kernels take minutes")
def test_a_tower_of_ten_rigid_boxes_stands(across, substeps):
    _holds(_tower(across, substeps), across, 1200)


@pytest.mark.skipif(not COMPILED, reason="interpreted kernels take minutes")
def test_a_pyramid_of_55_rigid_boxes_stands():
    _holds(_pyramid(10), 2, 600)
