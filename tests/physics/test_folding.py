"""No triangle of a jelly turns over, whatever is done to it; what holds it costs nobody energy or momentum."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest

from sandbox.physics.analysis.energy import spring_energy, total_energy
from sandbox.physics.constraints import AREA
from sandbox.physics.jit import COMPILED
from sandbox.physics.pipeline.block_owner import block_of
from sandbox.physics.solvers import SOLVERS
from sandbox.physics.step import step
from sandbox.physics.untangling.jellies import find_inverted, new_inversions
from tests.bench import jelly_abuse
from tests.support import folding
from tests.support.laid_out import laid_out
from tests.support.overlaps import overlaps
from tests.support.physics_scenes import network, run, scaled

CASES = list(itertools.product(folding.DEEDS, folding.SHAPES, folding.COEFFICIENTS, (1, 4)))


@pytest.mark.skipif(not COMPILED, reason="interpreted kernels take minutes")
@pytest.mark.parametrize("solver", SOLVERS)
def test_no_triangle_of_a_jelly_is_turned_over_whatever_is_done_to_it(solver):
    chosen = np.random.default_rng(len(solver)).choice(len(CASES), size=5, replace=False)
    for case in np.sort(chosen).tolist():
        deed, shape, coefficients, substeps = CASES[case]
        found = folding.play(deed, shape, coefficients, solver=solver, substeps=substeps, seconds=1.0, seed=case)
        assert found.least_area > 0.0, CASES[case]
        # Stiff springs explode in a single pass: triangles then pass over and on in one step.
        assert found.wound <= folding.WOUND_AT_MOST or solver == "single_pass", CASES[case]
        if solver == "direct" and coefficients[0] <= coefficients[1] and deed != "stirred":
            assert found.most_energy <= 1.0 + 1e-9, CASES[case]


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("speed", [3.0, 60.0])
def test_a_jelly_in_free_flight_keeps_its_momentum_while_its_triangles_are_held(solver, speed):
    world = jelly_abuse.jelly(5, 4, stiffness=0.02, damping=0.05, solver=solver)
    free = world.particle_active & (world.inverse_mass > 0.0)
    world.velocity[free] = np.random.default_rng(4).uniform(-speed, speed, (int(free.sum()), 2))
    world.slow_velocity[:] = world.velocity

    def momenta():
        push, place = world.mass[free, None] * world.velocity[free], world.position[free]
        return np.array([*push.sum(axis=0), np.sum(place[:, 0] * push[:, 1] - place[:, 1] * push[:, 0])])

    before, scale = momenta(), float(np.sum(world.mass[free]) * speed)
    for _ in range(scaled(20, 8)):
        step(world)
        assert folding.areas(world).min() > 0.0
        # Directions taken ahead make the direct solver keep linear momentum alone.
        kept = 2 if solver == "direct" else 3
        assert np.abs(momenta() - before)[:kept].max() < 1e-10 * scale


def test_without_areas_nothing_is_held():
    # A square of springs alone, thrown together so that it would turn inside out in one step.
    worlds = [network([(0, 0), (1, 0), (1, 1), (0, 1)], [(0, 1), (1, 2), (2, 3), (3, 0)]) for _ in range(2)]
    for world in worlds:
        world.set_coefficients(0.0, 0.0, None)
        world.velocity[1:3, 0] = -200.0
    worlds[1].add_constraints(AREA, [[0, 1, 2], [0, 2, 3]], stiffness=0.0, damping=0.0)
    for world in worlds:
        step(world)
    assert worlds[0].position[1, 0] < -1.0
    assert folding.areas(worlds[1]).min() > 0.0


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("pins", [(0,), (0, 1)])
def test_a_corner_that_is_thrown_over_its_pinned_side_stops_before_it(solver, pins):
    world = network([(0, 0), (1, 0), (0.4, 1)], [], pinned=pins, solver=solver)
    world.add_constraints(AREA, [[0, 1, 2]], stiffness=0.001, damping=0.002)
    for _ in range(scaled(300, 30)):
        world.velocity[2] = (0.0, -90.0)
        step(world)
        assert folding.areas(world)[0] > 0.0
    assert np.array_equal(world.position[list(pins)], world.origin[list(pins)])


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_triangle_that_is_listed_clockwise_keeps_its_side_too(solver):
    world = network([(0, 0), (1, 0), (0, 1)], [(0, 1), (1, 2), (2, 0)], solver=solver, stiffness=0.01, damping=0.02)
    world.add_constraints(AREA, [[0, 2, 1]], stiffness=0.01, damping=0.02)
    assert world.constraint_rest[0, 0] < 0.0
    world.velocity[2] = (0.0, -100.0)
    for _ in range(scaled(120, 20)):
        step(world)
        assert folding.areas(world)[0] > 0.0


def test_what_a_moved_pin_folds_is_let_go_and_comes_back():
    world = jelly_abuse.jelly(6, 5)
    a, b, c = corners = block_of(world).arrays.triangles.of_world.corners[0].tolist()
    for corner in corners:
        world.pin(corner)
    way = 0.5 * (world.position[b] + world.position[c]) - world.position[a]
    for _ in range(20):
        world.velocity[a] = 2.0 * way * world.settings.tick_rate / 20
        step(world)
    assert folding.areas(world).min() < 0.0
    world.velocity[a] = 0.0
    for corner in corners:
        world.unpin(corner)
    run(world, scaled(300, 60))
    assert folding.areas(world).min() > 0.9


@pytest.mark.parametrize("way", [1, -1])
@pytest.mark.parametrize("inner", [False, True])
def test_triangles_that_go_on_round_a_particle_of_the_outline_are_seen_from_every_side(way, inner):
    # Five about the first particle, or six that close the ring.
    corners = 6
    angles = np.append(0.0, np.arange(corners) * math.tau / corners)
    points = np.stack([np.cos(angles), np.sin(angles)], axis=1) * (np.arange(corners + 1) > 0)[:, None]
    world = network(points, [])
    ring = [[0, 1 + k, 1 + (k + 1) % corners][::way] for k in range(corners if inner else corners - 1)]
    world.add_constraints(AREA, ring)
    triangles = block_of(world).arrays.triangles.of_world
    found, marked = laid_out(new_inversions, triangles.jellies), np.zeros(world.particle_count, np.bool_)
    for between, turned in itertools.product((0.98, 1.02), np.linspace(0.0, math.tau, 17)):
        apart = math.tau / corners if inner else between * math.tau / (corners - 1)
        turn = turned + apart * np.arange(corners)
        world.position[1 : corners + 1] = np.stack([np.cos(turn), np.sin(turn)], axis=1)
        find_inverted(world.position, world.constraint_rest, triangles, found, marked)
        assert marked[: corners + 1].all() == marked.any() == (between > 1.0 and not inner)
        # Their triangles are held all the same.
        assert not found.is_inverted.any()


def fan(degrees, way=1, **settings):
    """Five triangles about the first particle, which is on the outline, over so many degrees."""
    angles = np.radians(degrees) * (np.arange(6) / 5.0 - 0.5)
    points = np.append([[0.0, 0.0]], np.stack([np.cos(angles), np.sin(angles)], axis=1), axis=0)
    world = network(points, [], **settings)
    world.add_constraints(AREA, [[0, 1 + k, 2 + k][::way] for k in range(5)], stiffness=0.001, damping=0.002)
    return world


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("way", [1, -1])
@pytest.mark.parametrize("speed", [3.0, 30.0])
def test_triangles_about_a_particle_of_the_outline_do_not_go_on_round_it(solver, way, speed):
    world = fan(330.0, way, solver=solver)
    for _ in range(scaled(120, 20)):
        # What ends them is thrown through each other.
        world.velocity[1] = (0.0, speed)
        world.velocity[6] = (0.0, -speed)
        step(world)
        assert not folding.is_any_wound(world)
        assert folding.areas(world).min() > 0.0


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_gap_in_an_outline_opens_and_closes_freely_while_it_is_wide(solver):
    world = fan(190.0, solver=solver)
    for speed in (-3.0, 3.0):
        # The outline is straight at the first particle in between.
        world.velocity[1] = (-speed, 0.0)
        world.velocity[6] = (-speed, 0.0)
        for _ in range(4):
            before = world.velocity[[1, 6], 0].copy()
            step(world)
            assert world.velocity[[1, 6], 0] == pytest.approx(before, rel=0.05)
        assert np.sign(world.position[1, 0]) == -np.sign(speed)
        assert np.sign(world.position[6, 0]) == -np.sign(speed)


@pytest.mark.parametrize("way", [1, -1])
@pytest.mark.parametrize("triangles", [[[0, 1, 2], [0, 2, 3]], [[0, 2, 3], [0, 1, 2]], [[0, 1, 2], [0, 1, 2]]])
def test_triangles_that_lie_over_each_other_in_their_own_form_are_not_out_of_shape(triangles, way):
    world = network([(0, 0), (1, 0), (0.6, 1), (0.9, 0.3)], [(0, 3)])
    world.add_constraints(AREA, [each[::way] for each in triangles])
    made = block_of(world).arrays.triangles.of_world
    found, marked = laid_out(new_inversions, made.jellies), np.zeros(world.particle_count, np.bool_)
    for turned in np.linspace(0.0, math.tau, 17):
        x, y = world.origin.T
        world.position[:4] = np.stack(
            [math.cos(turned) * x - math.sin(turned) * y, math.sin(turned) * x + math.cos(turned) * y], axis=1
        )[:4]
        find_inverted(world.position, world.constraint_rest, made, found, marked)
        assert not marked.any() and not found.is_inverted.any()


def test_a_jelly_that_is_folded_over_at_its_outline_comes_back_and_turns_no_triangle_over():
    world = folding.wound()
    start, most = total_energy(world), 0.0
    assert max(overlaps(world).depth.values()) > 1.0
    for _ in range(10):
        step(world)
        most = max(most, total_energy(world))
        assert folding.areas(world).min() > 0.0
    assert not overlaps(world).depth
    assert most <= start
    run(world, scaled(50, 10))
    assert folding.areas(world).min() > scaled(9, 5) / 10.0


def test_a_corner_that_was_drawn_through_its_jelly_comes_back_past_the_edge_that_it_lies_along():
    world = folding.drawn_through()
    start, most = total_energy(world), 0.0
    assert max(overlaps(world).depth.values()) > 1.0
    for _ in range(scaled(300, 8)):
        step(world)
        most = max(most, total_energy(world))
        assert not folding.is_any_wound(world)
        assert folding.areas(world).min() > 0.0
    assert most <= start
    assert spring_energy(world) < scaled(1, 200) * 1e-3 * start
    assert not overlaps(world).depth or not COMPILED


def test_a_jelly_on_its_floors_has_their_energy_and_gets_no_more_out_of_them():
    world = jelly_abuse.jelly(6, 5, stiffness=0.001, damping=0.01)
    body = world.particle_active
    world.position[body] *= (1.0, 0.1)
    explicit = total_energy(world)
    world.settings = replace(world.settings, solver="iterative")
    assert explicit > 50.0 * total_energy(world)
    world.settings = replace(world.settings, solver="direct")
    highest = 0.0
    for _ in range(scaled(120, 20)):
        step(world)
        highest = max(highest, total_energy(world))
        assert folding.areas(world).min() > 0.0
    assert highest <= explicit * (1.0 + 1e-9)
    assert folding.areas(world).min() > 0.2


@pytest.mark.skipif(not COMPILED, reason="interpreted kernels take minutes")
def test_a_soft_jelly_that_is_dropped_lies_on_its_floors_like_dough():
    found = folding.play("dropped", "box", (0.02, 0.1), solver="direct", substeps=1, seconds=4.0, seed=0)
    assert 0.2 < found.last_area < 0.3


@pytest.mark.skipif(not COMPILED, reason="interpreted kernels take minutes")
def test_a_jelly_comes_back_from_under_a_weight_that_is_taken_off():
    world = folding.make("squeezed", "box", (0.5, 0.9), solver="direct")
    run(world, 180)
    assert folding.areas(world, "j").min() < 0.25
    heavy = [world.particle_slot(name) for name in world.particle_names if name.startswith("w.")]
    world.velocity[heavy] = (0.0, 30.0)
    world.position[heavy] += (0.0, 30.0)
    world.energy_bank[:] = -1.0
    run(world, 150)
    assert folding.areas(world, "j").min() > 0.85
