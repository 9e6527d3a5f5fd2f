"""Surfaces at contacts: friction acts at the rim of a disc, discs roll, and boxes bounce as `restitution` says."""

import math

import numpy as np
import pytest

from sandbox.level.assembly.build_world import build_world
from sandbox.level.document.model import Level
from sandbox.physics.analysis.energy import total_energy
from sandbox.physics.marks import ALL_GROUPS, LINE, SOLID_LEFT
from sandbox.physics.snapshot import restore, state_hash, take
from sandbox.physics.solvers import SOLVERS
from sandbox.physics.step import step
from sandbox.physics.terrain import Chain
from sandbox.physics.world import World
from tests.abuse.discs import angular_momentum, crowd, expected, fastest, heap, lost_turning, rolled, turning
from tests.support.contact_scenes import BODIES, FLOOR, GROUND, add_discs, add_jelly, world
from tests.support.physics_scenes import run, scaled

both_solvers = pytest.mark.parametrize("solver", ["direct", "iterative"])


def add_box(
    to: World, centre, size, rim, *, angle=0.0, velocity=(0.0, 0.0), spin=0.0, friction=0.5, firmness=1.0
) -> int:
    """A box of four particles of 1 kg, of springs of Cs = Cd = firmness; the first slot."""
    x, y = 0.5 * np.asarray(size)
    corners = np.array([(-x, -y), (x, -y), (x, y), (-x, y)])
    along, across = np.array([math.cos(angle), math.sin(angle)]), np.array([-math.sin(angle), math.cos(angle)])
    arms = corners[:, :1] * along + corners[:, 1:] * across
    first = to.particle_count
    to.add_particles(
        [f"box.{first + k}" for k in range(4)], np.asarray(centre) + arms,
        velocity=np.asarray(velocity) + spin * arms @ np.array([[0.0, 1.0], [-1.0, 0.0]]), radius=rim,
        friction=friction, rolling=0.0, owner=first, group=BODIES, collides=ALL_GROUPS,
    )  # fmt: skip
    a, b = first + np.array([0, 1, 2, 3, 0, 1]), first + np.array([1, 2, 3, 0, 2, 3])
    names = [f"box:{first}.{k}" for k in range(6)]
    to.add_springs(names[:4], a[:4], b[:4], stiffness=firmness, damping=firmness, edge=SOLID_LEFT)
    to.add_springs(names[4:], a[4:], b[4:], stiffness=firmness, damping=firmness)
    return first


def tips(size, rim: float, angle: float, solver: str, substeps: int) -> bool:
    """Whether a box on a slope [rad] on which it cannot slide tips over within 6 s."""
    along, across = np.array([math.cos(angle), math.sin(angle)]), np.array([-math.sin(angle), math.cos(angle)])
    w = world(Chain([-50.0 * along, 50.0 * along]), solver=solver, substeps=substeps)
    a = add_box(w, (0.5 * size[1] + rim) * across, size, rim, angle=angle, friction=10.0)
    for _ in range(360):
        step(w)
        x, y = w.position[a + 1] - w.position[a]
        if abs(math.atan2(y, x) - angle) > 0.3:
            return True
    return False


# In one step the iterative solver lets the lower corner sink by 2 cm, which tips it 0.6 degrees sooner.
@pytest.mark.parametrize("solver, substeps", [("direct", 1), ("iterative", 4)])
@pytest.mark.parametrize("size, rim", [((0.4, 1.2), 0.1), ((0.9, 1.0), 0.3), ((0.6, 0.8), 0.02)])
def test_a_box_tips_over_the_rim_of_its_lower_corner(size, rim, solver, substeps):
    critical = math.atan2(0.5 * size[0], 0.5 * size[1] + rim)
    assert not tips(size, rim, critical - math.radians(0.4), solver, substeps)
    assert tips(size, rim, critical + math.radians(0.4), solver, substeps)


@pytest.mark.parametrize("solver, firmness", [("direct", 1.0), ("iterative", 1.0), ("single_pass", 0.2)])
@pytest.mark.parametrize("substeps", [1, 4])
@pytest.mark.parametrize("rim, friction", [(0.1, 0.3), (0.25, 1.5)])
def test_boxes_that_rub_in_empty_space_keep_their_angular_momentum(rim, friction, substeps, solver, firmness):
    w = world(solver=solver, substeps=substeps, gravity=(0.0, 0.0))
    add_box(w, (0.0, 0.0), (1.0, 0.7), rim, friction=friction, firmness=firmness)
    add_box(
        w, (-0.7, 0.8 + 2.0 * rim), (0.8, 0.8), rim, angle=0.2, velocity=(1.5, -0.7), spin=0.4, friction=friction,
        firmness=firmness,
    )  # fmt: skip
    before, whole, energy = angular_momentum(w), turning(w), total_energy(w)
    for _ in range(120):
        step(w)
        assert total_energy(w) <= energy * (1.0 + (1e-9 if solver == "direct" else 1e-3))
        assert abs(angular_momentum(w) - before) <= 1e-9 * whole
    assert not np.allclose(w.velocity[:4], 0.0), "they have met"


@both_solvers
def test_a_disc_and_a_box_that_rub_keep_their_angular_momentum(solver):
    w = world(solver=solver, gravity=(0.0, 0.0))
    add_box(w, (0.0, 0.0), (1.0, 0.7), 0.15)
    add_discs(w, [(-0.2, 0.9)], radius=0.2, velocity=(1.5, -0.7), spin=-3.0, rolling=0.0)
    before, whole = angular_momentum(w), turning(w)
    for _ in range(120):
        step(w)
        assert abs(angular_momentum(w) - before) <= 1e-9 * whole
    assert not np.allclose(w.velocity[:4], 0.0), "they have met"


# In the iterative solver it gives way where it stands, and rolls by a little less.
@pytest.mark.parametrize(
    "solver, substeps, firmness, within",
    [("direct", 1, 1.0, 0.01), ("iterative", 1, 0.9, 0.04), ("iterative", 4, 0.9, 0.03)],
)
@pytest.mark.parametrize("radius, rim, corners", [(0.4, 0.15, 12), (0.7, 0.2, 16)])
def test_a_wheel_rolls_by_the_radius_of_its_rim(radius, rim, corners, solver, substeps, firmness, within):
    w = world(FLOOR, solver=solver, substeps=substeps)
    turns = math.tau * np.arange(corners) / corners
    rounds = radius * np.stack([np.cos(turns), np.sin(turns)], axis=1)
    hub = np.array([0.0, radius + rim])
    speed = 1.5
    spin = -speed / (radius + rim)
    arms = np.concatenate([[(0.0, 0.0)], rounds])
    w.add_particles(
        [f"wheel.{k}" for k in range(corners + 1)], hub + arms,
        velocity=np.array([speed, 0.0]) + spin * arms @ np.array([[0.0, 1.0], [-1.0, 0.0]]), radius=rim, friction=1.0,
        owner=0, group=BODIES, collides=ALL_GROUPS,
    )  # fmt: skip
    corner, following = 1 + np.arange(corners), 1 + (1 + np.arange(corners)) % corners
    w.add_springs([f"rim:{k}" for k in corner], corner, following, stiffness=firmness, damping=firmness, edge=LINE)
    w.add_springs([f"spoke:{k}" for k in corner], 0 * corner, corner, stiffness=firmness, damping=firmness)
    turned, last = 0.0, 0.0
    for _ in range(120):
        step(w)
        x, y = w.position[1] - w.position[0]
        now = math.atan2(y, x)
        turned += (now - last + math.pi) % math.tau - math.pi
        last = now
    assert float(w.position[0, 0]) / -turned == pytest.approx(radius + rim, rel=within)


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


# Of Cs and Cd: the part of the height to which a box rises, flat of 4 cells, flat of 8, and 0.3 rad askew of 4.
BOUNCES = {
    (1.0, 1.0): (1.0, 1.0, 0.61),
    (0.9, 0.99): (0.76, 0.38, 0.34),
    (0.7, 0.95): (0.28, 0.0, 0.08),
    (0.5, 0.9): (0.01, 0.01, 0.08),
}


def part_of_height(stiffness, damping, *, size, cells, angle=0.0):
    """Drop a box of restitution 1 by 2 m; the part of that to which its middle rises again."""
    middle = 2.0 + 0.5 * size * (math.cos(angle) + math.sin(angle)) + 0.05
    box = {
        "type": "jelly", "id": "box", "shape": {"box": (size, size)}, "spacing": size / cells,
        "position": (0.0, middle), "angle": angle, "material": "soft",
    }  # fmt: skip
    world = build_world(Level.model_validate({
        "format": "spring-sandbox/level", "version": 4, "name": "bounce", "bodies": (box,),
        "materials": {"soft": {"stiffness": stiffness, "damping": damping}},
        "contacts": {"friction": 0.0, "restitution": 1.0},
        "terrain": ({"id": "ground", "polyline": ((-50.0, 0.0), (50.0, 0.0))},),
    }))  # fmt: skip
    heights = []
    for _ in range(110):
        step(world)
        heights.append(float(world.position[world.particle_active, 1].mean()))
    lowest = heights.index(min(heights[:60]))
    return (max(heights[lowest:]) - 0.5 * size - 0.05) / 2.0


@pytest.mark.parametrize(("stiffness", "damping"), list(BOUNCES))
def test_a_box_bounces_as_high_as_the_level_format_says(stiffness, damping):
    flat, fine, askew = BOUNCES[stiffness, damping]
    for size in (0.7, 1.3):
        assert part_of_height(stiffness, damping, size=size, cells=4) == pytest.approx(flat, abs=0.03)
    assert part_of_height(stiffness, damping, size=1.0, cells=8) == pytest.approx(fine, abs=0.03)
    assert part_of_height(stiffness, damping, size=1.0, cells=4, angle=0.3) == pytest.approx(askew, abs=0.03)
