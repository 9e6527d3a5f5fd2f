"""What touches, with what pulls, blows, drives and breaks besides."""

import numpy as np
import pytest

from sandbox.physics.pipeline.block_owner import outline_of
from sandbox.physics.solvers import SOLVERS
from sandbox.physics.step import step
from sandbox.physics.terrain import Chain
from tests.support.contact_scenes import FLOOR, GROUND, add_discs, add_jelly, world
from tests.support.physics_scenes import run

every_solver = pytest.mark.parametrize("solver", SOLVERS)
# What pulls at a disc like gravity does: gravity itself, less of it by a larger scale, and a hurricane in thin air.
PULLS = {
    "gravity": ({}, 1.0),
    "scale": ({"gravity": (0.0, -1.962)}, 5.0),
    "wind": ({"gravity": (0.0, 0.0), "wind": (0.0, -9.81e6), "drag": 1e-6}, 1.0),
}


@every_solver
@pytest.mark.parametrize("pull", PULLS)
@pytest.mark.parametrize("restitution", [0.5, 1.0])
def test_a_disc_bounces_to_the_same_height_whatever_pulls_it_down(solver, pull, restitution):
    settings, scale = PULLS[pull]
    w = world(FLOOR, solver=solver, **settings)
    add_discs(w, [(0.0, 1.1)], restitution=restitution, gravity_scale=scale)
    heights = []
    for _ in range(70):
        step(w)
        heights.append(w.position[0, 1] - 0.1)
    lowest = int(np.argmax(np.diff(heights) > 0.0))
    assert max(heights[lowest:]) == pytest.approx(restitution**2, rel=0.05)


@every_solver
def test_what_gravity_lifts_comes_to_rest_under_a_ceiling(solver):
    w = world(Chain([(-5.0, 2.0), (5.0, 2.0)]), solver=solver)
    add_discs(w, [(0.0, 1.0)], gravity_scale=-0.5)
    run(w, 120)
    assert 1.899 < w.position[0, 1] < 1.901


@every_solver
def test_wind_pushes_a_disc_over_the_floor_only_against_friction(solver):
    w = world(FLOOR, solver=solver, wind=(4.0, 0.0), drag=1.0)
    add_discs(w, [(0.0, 0.1), (5.0, 0.1)], friction=[0.9, 0.2], rolls=False)
    run(w, 60)
    # The wind pulls at 4 m/s^2; the floor's friction of 0.5 and theirs hold sqrt(0.45) g and sqrt(0.1) g.
    assert abs(w.position[0, 0]) < 1e-3
    assert w.position[1, 0] > 5.1


def torn_jelly(w):
    """A jelly whose outline is torn open on its right side; the slots of its particles."""
    jelly = add_jelly(w, (0.0, 0.0))
    right = np.flatnonzero(w.position[jelly, 0] > 0.44)
    ends = w.particle_a, w.particle_b
    side = np.flatnonzero((w.edge > 0) & np.isin(ends[0], right) & np.isin(ends[1], right))
    w.break_springs(side[3:5])
    return jelly


@every_solver
def test_a_broken_side_is_no_edge_and_its_body_is_no_longer_solid(solver):
    w = world(GROUND, solver=solver, gravity=(0.0, 0.0))
    whole = outline_of(w).side.tolist()
    torn_jelly(w)
    assert not outline_of(w).side[: outline_of(w).dynamic[0]].any()
    assert not np.isin(w.broken, outline_of(w).number[: outline_of(w).dynamic[0]]).any()
    assert whole == outline_of(w).side[outline_of(w).dynamic[0] :].tolist()


@every_solver
def test_a_torn_body_pulls_nothing_into_it_from_afar(solver):
    w = world(solver=solver, gravity=(0.0, 0.0))
    torn_jelly(w)
    disc = add_discs(w, [(x, y) for x in (-3.0, 3.0) for y in np.linspace(-0.4, 0.4, 9)], radius=0.02)
    before = w.position[disc:].copy()
    run(w, 20)
    assert np.array_equal(w.position[disc:], before)


@every_solver
def test_what_falls_into_the_tear_of_a_jelly_meets_its_inside(solver):
    w = world(solver=solver, gravity=(0.0, 0.0))
    torn_jelly(w)
    disc = add_discs(w, [(1.0, -0.05)], radius=0.03, velocity=(-5.0, 0.0), mass=0.1)
    # Not longer, as it is beyond what the single pass holds.
    run(w, 12)
    assert w.position[disc, 0] > 0.3
