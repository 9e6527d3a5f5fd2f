"""Discs that roll: friction turns what nothing holds, and takes as much from its motion as it gives to its turning."""

import math

import numpy as np
import pytest

from sandbox.physics.analysis.energy import total_energy
from sandbox.physics.snapshot import restore, state_hash, take
from sandbox.physics.solvers import SOLVERS
from sandbox.physics.step import step
from sandbox.physics.world import World
from tests.abuse.discs import angular_momentum, crowd, expected, fastest, heap, lost_turning, rolled, turning
from tests.support.contact_scenes import ALL_GROUPS, BODIES, FLOOR, GROUND, LINE, add_discs, add_jelly, world
from tests.support.physics_scenes import run, scaled

every_solver = pytest.mark.parametrize("solver", SOLVERS)


@every_solver
@pytest.mark.parametrize("substeps", [1, 4])
@pytest.mark.parametrize("degrees, friction", [(10.0, 0.5), (30.0, 0.2), (30.0, 0.19), (45.0, 0.2)])
def test_a_disc_rolls_down_a_slope_of_less_than_three_times_its_friction_and_slides_beyond(
    solver, substeps, degrees, friction
):
    found = rolled(degrees, friction, 0.5, solver=solver, substeps=substeps)
    np.testing.assert_allclose(found, expected(degrees, friction), rtol=0.01)


@every_solver
def test_a_disc_rolls_down_a_plank_of_springs_as_down_a_slope(solver):
    angle = math.radians(20.0)
    along, across = np.array([math.cos(angle), -math.sin(angle)]), np.array([math.sin(angle), math.cos(angle)])
    w = world(solver=solver)
    # Heavy and afloat, so that it stays where it is and yet can move.
    w.add_particles(["a", "b"], [-along, 9.0 * along], mass=1e6, gravity_scale=0.0, friction=0.5, owner=0,
                    group=BODIES, collides=ALL_GROUPS)  # fmt: skip
    w.add_springs(["ab"], [0], [1], stiffness=0.9, damping=0.99, edge=LINE)
    add_discs(w, [0.15 * across], rolling=0.0)
    run(w, 30)
    speed = float(w.velocity[2] @ along)
    assert speed == pytest.approx(0.5 * 2.0 / 3.0 * 9.81 * math.sin(angle), rel=0.01)
    assert -0.1 * w.spin[2] == pytest.approx(speed, rel=1e-3)


@pytest.mark.parametrize("restitution, speed", [(0.0, 1.0), (0.8, 4.0), (1.0, 20.0)])
def test_a_crowd_in_empty_space_keeps_its_angular_momentum_and_gains_no_energy(restitution, speed):
    lost, energy = lost_turning(crowd(scaled(60, 12), 3, speed, restitution), scaled(120, 20))
    assert lost < 1e-9
    assert energy < 1.0 + 1e-9


def test_a_ball_that_turns_gives_its_turning_to_one_that_it_meets():
    w = world(gravity=(0.0, 0.0))
    add_discs(w, [(0.0, 0.0), (0.25, 0.0)], velocity=[(2.0, 0.0), (0.0, 0.0)], spin=[20.0, 0.0])
    before = angular_momentum(w)
    run(w, 12)
    assert w.spin[1] < -1.0, "surfaces that touch run along together: the other one turns the other way round"
    assert angular_momentum(w) == pytest.approx(before, rel=1e-12)


@pytest.mark.parametrize("solver", ["direct", "iterative"])
def test_a_disc_thrown_at_a_jelly_in_empty_space_gains_no_energy_and_takes_its_turning_from_the_jelly(solver):
    w = world(solver=solver, gravity=(0.0, 0.0))
    add_jelly(w, (0.0, 0.0), size=(0.9, 0.5))
    add_discs(w, [(-0.3, 0.9)], radius=0.2, mass=3.0, velocity=(2.0, -3.0))
    before, energy = angular_momentum(w), total_energy(w)
    for _ in range(40):
        step(w)
        assert total_energy(w) <= energy * (1.0 + 1e-9)
    assert w.spin[-1] < -1.0
    # Of the 5 N m s of what moves; alone, the disc's turning would be a tenth of them.
    assert abs(angular_momentum(w) - before) < 0.05


@every_solver
def test_a_disc_with_back_spin_comes_back(solver):
    w = world(FLOOR, solver=solver)
    add_discs(w, [(0.0, 0.1)], velocity=(2.0, 0.0), spin=80.0)
    furthest = 0.0
    for _ in range(180):
        step(w)
        furthest = max(furthest, w.position[0, 0])
    assert furthest > 0.2
    # v = (v0 - s0 / 2) 2 / 3 once it rolls, s = the speed of its surface.
    assert w.velocity[0, 0] == pytest.approx((2.0 - 8.0 / 2.0) * 2.0 / 3.0, rel=0.05)
    assert w.velocity[0, 0] == pytest.approx(-0.1 * w.spin[0], rel=1e-3)


def test_a_heap_of_discs_that_roll_comes_to_rest():
    w = heap(scaled(100, 12), 10, 1)
    run(w, scaled(480, 60))
    assert fastest(w) < 1e-4


@every_solver
def test_rolling_resistance_stops_a_disc_on_the_flat_as_it_says(solver):
    w = world(FLOOR, solver=solver)
    add_discs(w, [(0.0, 0.1)], velocity=(1.0, 0.0), spin=-10.0, rolling=0.05)
    run(w, 60)
    # 3/2 m a = -c m g
    assert 1.0 - w.velocity[0, 0] == pytest.approx(2.0 / 3.0 * 0.05 * 9.81, rel=0.02)
    run(w, 240)
    assert fastest(w) < 1e-6


@every_solver
def test_what_does_not_roll_slides_and_stays_as_it_is_turned(solver):
    w = world(FLOOR, solver=solver)
    add_discs(w, [(0.0, 0.1), (2.0, 0.1)], velocity=(1.0, 0.0), rolls=[False, True], angle=0.3)
    run(w, 120)
    assert abs(w.velocity[0, 0]) < 1e-9 and w.velocity[1, 0] > 0.6
    assert w.angle[0] == 0.3 and w.spin[0] == 0.0 and w.spin[1] < -6.0


def test_a_disc_turns_only_while_nothing_holds_it():
    w = world(FLOOR)
    add_discs(w, [(0.0, 0.1), (1.0, 0.1), (2.0, 0.1), (3.0, 0.1), (4.0, 0.1)], velocity=(1.0, 0.0), spin=-10.0)
    w.reserve_grabs()
    run(w, 5)
    assert np.all(w.spin[:5] < -9.0)
    w.add_springs(["s"], [0], [1])
    w.pin(2)
    w.hold(0, 3, (3.5, 0.3))
    assert w.spin[:5].tolist()[:4] == [0.0] * 4
    run(w, 30)
    assert not w.spin[:4].any() and w.spin[4] < -9.0
    w.release(0)
    w.cut([w.spring_slot("s")])
    w.velocity[0, 0] = 1.0
    run(w, 30)
    assert w.spin[0] < -1.0, "what has come loose rolls on"


def test_angles_follow_the_spin_and_stay_within_half_a_turn():
    w = World()
    add_discs(w, [(0.0, 0.0)], spin=100.0)
    seen = []
    for _ in range(60):
        step(w)
        seen.append(w.angle[0])
    assert max(map(abs, seen)) <= math.pi
    assert math.remainder(100.0 - w.angle[0], 2.0 * math.pi) == pytest.approx(0.0, abs=1e-9)


@every_solver
def test_a_run_with_discs_that_roll_goes_on_from_a_snapshot_with_the_same_bits(solver):
    w = world(GROUND, solver=solver)
    add_jelly(w, (0.0, 0.3), size=(0.9, 0.5), stiffness=0.1, damping=0.1)
    add_discs(w, [(-0.3, 0.8), (0.1, 1.0), (0.9, 0.4), (1.2, 0.3)], velocity=(-1.0, 0.0), restitution=0.3)
    run(w, 20)
    middle = take(w)
    hashes = []
    for _ in range(2):
        restore(w, middle)
        run(w, 20)
        hashes.append(state_hash(w))
    assert hashes[0] == hashes[1] and w.spin.any() and turning(w) > 0.0
