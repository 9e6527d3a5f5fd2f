"""What hands do to bodies: a bounded force and speed, shared over what would tear, alike in every solver."""

import math

import numpy as np
import pytest

from sandbox.physics.analysis.applied_forces import pulls_of
from sandbox.physics.analysis.query import grip_radius
from sandbox.physics.analysis.stability import report
from sandbox.physics.jit import COMPILED
from sandbox.physics.joints.hands import FASTEST_HAND
from sandbox.physics.pipeline.block_owner import block_of
from sandbox.physics.solvers import SOLVERS
from sandbox.physics.step import step
from sandbox.physics.world import HAND_STRENGTH
from sandbox.tools.drag import STRENGTHS
from tests.support.hands import (
    RATE,
    dough,
    drag_away,
    follow,
    free_mass,
    jelly,
    line,
    momentum_velocity,
    nearest,
    rope,
    truss,
    world_of,
)
from tests.support.physics_scenes import network, run, scaled

GROUND = ({"id": "ground", "polyline": ((-50.0, -2.0), (50.0, -2.0))},)
# The editor's jelly stands at nine tenths of its height.
SAG = 0.1
BODIES = {"rope": (rope, (1.5, 0.0)), "jelly": (jelly, (0.0, 0.0)), "truss": (truss, (7.0, 1.0))}


def loose(**settings):
    """One particle."""
    return world_of(particles=({"id": "d", "position": (7.0, 1.0)},), **settings)


def within_limits(world):
    """The same world, its springs soft enough for the single pass where it has that."""
    if world.settings.solver == "single_pass":
        limit = 0.99 * report(world).proven_limit
        world.set_coefficients(limit, limit, None)
    return world


def shaken(world, particle, ticks, seed=1):
    """Targets that jump about by some metres."""
    generator, target = np.random.default_rng(seed), world.position[particle].copy()
    for tick in range(ticks):
        if tick % 7 == 0:
            target = target + generator.uniform(-4.0, 4.0, 2)
        yield target


@pytest.mark.parametrize("solver", list(SOLVERS))
@pytest.mark.parametrize("substeps", ["auto", 1, 4])
@pytest.mark.parametrize("body", list(BODIES))
def test_a_hand_never_pulls_harder_than_its_strength_times_the_mass_of_the_body(solver, substeps, body):
    make, where = BODIES[body]
    world = within_limits(make(solver=solver, substeps=substeps, terrain=GROUND))
    particle = nearest(world, where)
    world.hold(0, particle, tuple(world.position[particle]), 30.0, grip_radius(world, particle))
    drag = follow(world, particle, shaken(world, particle, scaled(90, 10)))
    assert drag.limit == pytest.approx(30.0 * free_mass(world), rel=1e-12)
    assert max(drag.force) <= drag.limit * (1.0 + 1e-12)
    assert max(drag.force) > 0.9 * drag.limit


def test_a_body_that_a_hand_alone_moves_is_as_fast_as_force_and_time_allow():
    world = network([(0.0, 0.0), (1.0, 0.0)], [(0, 1)], solver="direct", masses=3.0)
    world.hold(0, 0, (50.0, 0.0), 12.0)
    run(world, 30)
    assert momentum_velocity(world) == pytest.approx([12.0 * 30 / RATE, 0.0], rel=1e-9, abs=1e-9)
    assert world.hand_force[0] == pytest.approx([72.0, 0.0], rel=1e-9, abs=1e-6)


@pytest.mark.parametrize("solver", list(SOLVERS))
def test_a_hand_moves_nothing_faster_than_it_may(solver):
    world = network([(0.0, 0.0)], [], solver=solver)
    world.hold(0, 0, (0.0, 0.0), 1e4)
    for target in line(np.zeros(2), 200.0, 60):
        world.move_grab(0, tuple(target))
        step(world)
        assert np.hypot(*world.velocity[0]) <= FASTEST_HAND * (1.0 + 1e-9)


@pytest.mark.parametrize("solver", list(SOLVERS))
@pytest.mark.parametrize("body", list(BODIES))
def test_what_is_dragged_at_five_metres_a_second_stays_at_the_mouse(solver, body):
    make, where = BODIES[body]
    world = within_limits(make(solver=solver, gravity=(0.0, -9.81)))
    _, drag = drag_away(world, nearest(world, where), "normal", 5.0)
    assert max(drag.lag) <= 0.15
    assert drag.lag[-1] <= 0.05


@pytest.mark.parametrize("size", [0.5, 2.0, 3.0, 5.0])
def test_the_corner_of_a_soft_jelly_stays_at_the_mouse_that_pulls_it(size):
    world = jelly(size, sag=SAG)
    _, drag = drag_away(world, nearest(world, (-9.0, 9.0)), "normal", 5.0)
    assert max(drag.lag) <= 0.15
    assert drag.lag[-1] <= 0.05


@pytest.mark.parametrize("strength", ["gentle", "normal"])
@pytest.mark.parametrize("where", [(0.0, 0.0), (0.0, 0.5), (-0.5, 0.5)])
def test_a_soft_jelly_that_is_dragged_at_twenty_metres_a_second_is_not_torn(strength, where):
    world = jelly(sag=SAG)
    held, drag = drag_away(world, nearest(world, where), strength, 20.0)
    assert max(held.strain) < 0.2
    assert max(drag.strain) < 1.0


@pytest.mark.skipif(not COMPILED, reason="interpreted kernels take minutes")
def test_a_very_soft_jelly_that_is_held_still_by_a_corner_does_not_swing_ever_wider():
    world = dough(0.02, 0.1)
    corner = nearest(world, (-9.0, 9.0))
    start = world.position[corner].copy()
    world.hold(0, corner, tuple(start), HAND_STRENGTH, grip_radius(world, corner))
    drag = follow(world, corner, [start] * (10 * RATE))
    assert max(drag.strain) < 1.6
    assert max(drag.strain[-2 * RATE :]) < max(drag.strain[: 2 * RATE])


def test_one_particle_of_a_soft_jelly_would_be_torn_out():
    world = jelly(sag=SAG)
    corner = nearest(world, (-0.5, 0.5))
    start = world.position[corner].copy()
    world.hold(0, corner, tuple(start), HAND_STRENGTH)
    assert max(follow(world, corner, line(start, 20.0, 45)).strain) > 3.0


@pytest.mark.parametrize("solver", list(SOLVERS))
@pytest.mark.parametrize("strength", list(STRENGTHS))
@pytest.mark.parametrize("make", [truss, loose])
def test_after_a_jump_of_the_mouse_nothing_rigid_swings_past_it(solver, strength, make):
    world = within_limits(make(solver=solver, gravity=(0.0, 0.0)))
    particle = nearest(world, (7.0, 1.0))
    x, y = world.position[particle].tolist()
    world.hold(0, particle, (x, y), STRENGTHS[strength])
    world.move_grab(0, (x + 3.0, y))
    farthest = x
    for _ in range(120):
        step(world)
        farthest = max(farthest, float(world.position[particle, 0]))
    assert x + 2.97 < farthest < x + 3.15


@pytest.mark.parametrize("strength", list(STRENGTHS))
@pytest.mark.parametrize("where", [(0.0, 0.5), (-0.5, 0.5), (0.5, 0.5)])
def test_after_a_jump_of_the_mouse_a_soft_jelly_swings_past_it_by_a_twentieth_at_most(strength, where):
    world = jelly(sag=SAG, substeps="auto", gravity=(0.0, 0.0))
    particle = nearest(world, where)
    x, y = world.position[particle].tolist()
    world.hold(0, particle, (x, y), STRENGTHS[strength], grip_radius(world, particle))
    world.move_grab(0, (x + 3.0, y))
    farthest = x
    for _ in range(scaled(120, 3)):
        step(world)
        farthest = max(farthest, float(world.position[particle, 0]))
    assert farthest <= x + 3.15


@pytest.mark.parametrize("solver", list(SOLVERS))
def test_a_release_leaves_a_body_the_velocity_that_it_has(solver):
    world = within_limits(rope(solver=solver, gravity=(0.0, 0.0)))
    drag_away(world, nearest(world, (1.5, 0.0)), "normal", 5.0)
    flung = momentum_velocity(world)
    world.release(0)
    run(world, 30)
    assert flung[0] > 3.0
    assert momentum_velocity(world) == pytest.approx(flung, abs=1e-9)


@pytest.mark.parametrize("strength", list(STRENGTHS))
def test_a_girder_that_is_pinned_shows_the_force_and_that_it_is_pinned(strength):
    world = truss(("start", "end"))
    _, drag = drag_away(world, nearest(world, (3.0, 1.0)), strength, 5.0)
    (pull,) = pulls_of(world)
    assert pull.pinned and pull.at_limit
    assert pull.force == pytest.approx(STRENGTHS[strength] * free_mass(world), rel=1e-9)
    assert max(drag.strain) < 1e-3


def test_a_loose_body_is_not_pinned_and_a_light_pull_is_not_at_its_limit():
    world = rope()
    end = nearest(world, (1.5, 0.0))
    follow_in_place = [world.position[end].copy()] * 60
    world.hold(0, end, tuple(follow_in_place[0]))
    follow(world, end, follow_in_place)
    (pull,) = pulls_of(world)
    assert not pull.pinned and not pull.at_limit
    assert pull.limit == pytest.approx(HAND_STRENGTH * 1.6)


def test_a_hand_reaches_into_soft_bodies_alone_and_all_through_them():
    soft, stiff = jelly(), truss()
    corner = nearest(soft, (-0.5, 0.5))
    assert grip_radius(soft, corner) == pytest.approx(2.0 * math.sqrt(2.0))
    assert grip_radius(stiff, 0) == grip_radius(rope(), 3) == 0.0
    soft.hold(0, corner, (-0.5, 0.5), radius=grip_radius(soft, corner))
    grips = block_of(soft).arrays.joints.hands.grips
    assert len(grips.particle) == 81 and grips.ratio.sum() == pytest.approx(1.0)
    assert grips.particle[np.argmax(grips.ratio)] == corner


def test_the_force_on_a_soft_body_acts_at_the_point_that_is_held():
    world = jelly(gravity=(0.0, 0.0))
    corner = nearest(world, (-0.5, 0.5))
    world.hold(0, corner, (-0.5, 3.0), radius=grip_radius(world, corner))
    step(world)
    free, h = slice(0, 81), 1.0 / RATE
    momentum = world.mass[free, None] * world.velocity[free]
    assert momentum.sum(axis=0) == pytest.approx(h * world.hand_force[0], rel=1e-9, abs=1e-12)
    # About the places where the step ends, to which its velocities belong.
    place = world.position[free]
    spin = np.sum(place[:, 0] * momentum[:, 1] - place[:, 1] * momentum[:, 0])
    x, y = world.origin[corner]
    fx, fy = h * world.hand_force[0]
    assert spin == pytest.approx(x * fy - y * fx, rel=1e-6)


def test_a_hand_keeps_the_part_of_a_torn_body_that_it_has_its_point_in():
    world = network([(x, 0.0) for x in range(6)], [(x, x + 1) for x in range(5)], solver="direct")
    world.change("owner", 0, slice(6))
    world.hold(0, 1, (1.0, 0.0), radius=10.0)
    assert (
        block_of(world).arrays.joints.hands.grips.mass.tolist() == [6.0]
        and len(block_of(world).arrays.joints.hands.grips.particle) == 6
    )
    world.cut([2])
    assert block_of(world).arrays.joints.hands.grips.mass.tolist() == [3.0]
    assert block_of(world).arrays.joints.hands.grips.particle.tolist() == [0, 1, 2]


@pytest.mark.parametrize("solver", list(SOLVERS))
def test_a_disc_that_a_hand_presses_on_the_ground_stays_above_it(solver):
    ball = ({"id": "d", "position": (0.0, 0.0), "radius": 0.1, "mass": 2.0},)
    world = world_of(particles=ball, solver=solver, terrain=GROUND)
    world.hold(0, 0, (0.0, -4.0))
    run(world, scaled(120, 30))
    assert world.position[0, 1] == pytest.approx(-1.9, abs=0.02)
    assert world.hand_force[0] == pytest.approx([0.0, -200.0], abs=1e-6)


def test_two_hands_pull_a_body_apart_with_what_each_of_them_may():
    world = truss(gravity=(0.0, 0.0))
    ends = nearest(world, (0.0, 0.0)), nearest(world, (7.0, 0.0))
    for hand, (end, side) in enumerate(zip(ends, (-1.0, 1.0), strict=True)):
        world.hold(hand, end, (3.5 + 20.0 * side, 0.0), 30.0)
    run(world, 60)
    limit = 30.0 * free_mass(world)
    assert np.hypot(*world.hand_force[:2].T) == pytest.approx([limit, limit], rel=1e-9)
    assert abs(momentum_velocity(world)[0]) < 1e-6
