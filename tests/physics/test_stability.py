"""What is proven about stability, held against dense eigenvalues and against runs."""

import dataclasses
import time

import numpy as np
import pytest

from sandbox.physics.analysis.energy import reduced_masses
from sandbox.physics.analysis.stability import (
    POWER_ITERATIONS,
    coefficient_limits,
    effective_count,
    largest_eigenvalue,
    report,
)
from sandbox.physics.marks import LAW_HOOKE
from sandbox.physics.substeps import substep_coefficients, substep_time
from sandbox.physics.world import World
from tests.support.physics_scenes import (
    SCENES,
    girder,
    grid_with_diagonals,
    lengths,
    network,
    random_graph,
    rope,
    run,
    scaled,
)


def incidence(world):
    """J: the velocity error of each spring from the velocities of all particles (m, 2 n)."""
    matrix = np.zeros((world.spring_count, 2 * world.particle_count))
    separation = world.position[world.particle_b] - world.position[world.particle_a]
    for s in np.flatnonzero(world.spring_active & (reduced_masses(world) > 0.0)):
        a, b = world.particle_a[s], world.particle_b[s]
        length = np.linalg.norm(separation[s])
        normal = separation[s] / length if length > 0.0 else np.array([1.0, 0.0])
        matrix[s, 2 * a : 2 * a + 2] = -normal
        matrix[s, 2 * b : 2 * b + 2] = normal
    return matrix


def dense_eigenvalue(world, weight=1.0):
    """Largest eigenvalue of sqrt(weight m_r) J W J^T sqrt(weight m_r)."""
    root = np.sqrt(weight * reduced_masses(world))[:, None] * incidence(world)
    root *= np.sqrt(np.repeat(world.inverse_mass, 2))
    return float(np.linalg.norm(root, 2) ** 2)


def spectral_radius(world):
    """Largest growth per substep of any motion near the rest shape under the single pass, by its dense matrix."""
    (stiffness, damping), h = substep_coefficients(world), substep_time(world.settings)
    mass = reduced_masses(world)
    hooke = (world.law == LAW_HOOKE) & (mass > 0.0)
    stiffness[hooke] = world.hooke_stiffness[hooke] * h * h / mass[hooke]
    damping[hooke] = world.hooke_damping[hooke] * h / mass[hooke]
    jacobian, inverse = incidence(world), np.repeat(world.inverse_mass, 2)[:, None]
    pull = inverse * (jacobian.T @ ((mass * stiffness)[:, None] * jacobian))
    drag = np.eye(len(inverse)) - inverse * (jacobian.T @ ((mass * damping)[:, None] * jacobian))
    return float(np.max(np.abs(np.linalg.eigvals(np.block([[np.eye(len(pull)) - pull, drag], [-pull, drag]])))))


@pytest.mark.slow
def test_n_eff_is_never_below_the_largest_eigenvalue_nor_above_the_article_s_n():
    generator = np.random.default_rng(1)
    for _ in range(scaled(300, 300)):
        particles = int(generator.integers(2, 16))
        world = random_graph(
            generator, particles=particles, springs=int(generator.integers(1, 3 * particles)),
            pinned=int(generator.integers(0, particles // 2 + 1)),
        )  # fmt: skip
        eigenvalue, counts = dense_eigenvalue(world), effective_count(world)
        degrees = np.bincount(np.concatenate([world.particle_a, world.particle_b]))
        assert counts.max() >= eigenvalue * (1.0 - 1e-12)
        assert np.all(counts <= np.maximum(degrees[world.particle_a], degrees[world.particle_b]) * (1.0 + 1e-12))
        assert largest_eigenvalue(world) <= eigenvalue * (1.0 + 1e-9)


@pytest.mark.parametrize("scene", SCENES)
def test_the_estimated_eigenvalue_is_within_1_percent_of_the_dense_one(scene):
    world = SCENES[scene]()
    dense = dense_eigenvalue(world)
    assert 0.99 * dense <= largest_eigenvalue(world) <= dense * (1.0 + 1e-9)


def test_the_article_s_example_figures_are_these():
    line = report(rope())
    assert line.n_eff == 2.0
    assert line.article_limit == pytest.approx(1.0 / 3.0)
    assert line.proven_limit == pytest.approx(2.0 / 3.0)
    mesh = report(grid_with_diagonals(columns=12, rows=12))
    assert mesh.article_limit == pytest.approx(1.0 / 9.0)
    assert mesh.proven_limit == pytest.approx(4.0 / 24.0)
    assert mesh.article_limit < mesh.proven_limit < mesh.estimated_limit
    assert mesh.estimated_limit == pytest.approx(0.34, abs=0.02)


@pytest.mark.parametrize("substeps", [1, 4, 64])
def test_the_article_s_limit_lies_inside_the_proven_and_that_inside_the_estimated(substeps):
    generator = np.random.default_rng(2)
    for _ in range(60):
        # Substeps only widen a limit per tick: the coefficients of each substep are smaller.
        state = report(random_graph(generator, substeps=substeps))
        assert state.article_limit < state.proven_limit <= state.estimated_limit * (1.0 + 1e-9)


@pytest.mark.parametrize("substeps", [1, 8])
def test_what_is_reported_stable_is_stable_with_mixed_coefficients_hooke_springs_and_hands(substeps):
    generator = np.random.default_rng(3)
    proven = 0
    for trial in range(scaled(200, 200)):
        world = random_graph(generator, decades=float(generator.uniform(0.0, 6.0)), pinned=2, substeps=substeps)
        count = world.spring_count
        reach = generator.uniform(0.1, 1.0) * 4.0 / effective_count(world).clip(1.0)
        world.stiffness[:] = np.minimum(reach * generator.random(count), 1.0)
        world.damping[:] = np.minimum(0.5 * (reach - world.stiffness).clip(0.0), 1.0)
        if trial % 2:
            world.change("law", LAW_HOOKE, slice(5))
            world.hooke_stiffness[:5] = generator.uniform(0.0, 1.0, 5) * reduced_masses(world)[:5] * 60.0**2
            world.hold(0, int(generator.integers(2, 12)), (9.0, 9.0))
        state = report(world)
        if state.within_limit:
            proven += 1
            assert spectral_radius(world) <= 1.0 + 1e-6
    assert proven >= 60


def test_mixed_coefficients_just_inside_the_proven_bound_stay_bounded_in_a_run():
    generator = np.random.default_rng(4)
    for _ in range(scaled(20, 3)):
        world = random_graph(generator, decades=2.0, pinned=2)
        allowed = 3.99 / np.maximum(effective_count(world), 1.0)
        world.stiffness[:] = np.minimum(allowed * generator.random(world.spring_count), 1.0)
        world.damping[:] = np.minimum(0.5 * (allowed - world.stiffness), 1.0)
        assert report(world).within_limit
        world.position[2:] += generator.uniform(-1e-9, 1e-9, (10, 2))
        before = np.max(np.abs(lengths(world) - world.rest_length))
        run(world, scaled(2000, 200))
        assert np.max(np.abs(lengths(world) - world.rest_length)) < 20.0 * before


def test_a_hand_on_a_mesh_at_the_article_s_limit_is_still_proven_stable():
    world = grid_with_diagonals(stiffness=1.0 / 9.0, damping=1.0 / 9.0)
    world.reserve_grabs()
    assert report(world).within_limit
    world.hold(0, 27, (3.0, 3.0))
    assert report(world).within_limit
    assert spectral_radius(world) <= 1.0 + 1e-9


def test_the_report_names_the_spring_that_decides_and_says_whether_it_is_within():
    world = rope(links=4, stiffness=0.3, damping=0.3)
    world.add_springs(["tie"], [1], [3], stiffness=0.9, damping=0.9)
    state = report(world)
    assert state.within_limit is False
    assert "past the proven limit" in state.text and "below 4" in state.text
    assert state.spring == "p:0" and state.n_eff == 3.0
    world.set_coefficients(0.3, 0.3, None)
    state = report(world)
    assert state.within_limit is True
    assert state.text == "proven stable: the springs' Cs + 2 Cd add up to 2.7 at p:0, and stay stable below 4"


def test_the_iterative_solver_is_reported_without_a_proven_limit():
    state = report(rope(solver="iterative"))
    assert state.within_limit is None
    assert state.text.startswith("the iterative solver has no proven limit")
    limits = coefficient_limits(rope(solver="iterative"))
    assert (limits.stiffness, limits.damping) == (None, None)
    assert limits.reason == "no proven limit for the iterative solver"


def test_a_world_whose_springs_do_nothing_cannot_blow_up():
    idle = rope(links=2)
    idle.cut([0, 1])
    for world in (World(), network([(0, 0)], []), network([(0, 0), (1, 0)], [(0, 1)], pinned=[0, 1]), idle):
        state = report(world)
        assert (state.spring, state.within_limit) in [(None, True)]
        assert largest_eigenvalue(world) == 0.0
        assert "nothing can blow up" in state.text
        world.settings = dataclasses.replace(world.settings, solver="single_pass")
        assert coefficient_limits(world).stiffness == 1.0


@pytest.mark.parametrize("substeps", [1, 4])
def test_the_marks_on_the_sliders_are_the_edge_of_what_is_proven(substeps):
    for world in (rope(substeps=substeps), girder(substeps=substeps), grid_with_diagonals(substeps=substeps)):
        world.set_coefficients(0.05, 0.05, None)
        limits = coefficient_limits(world)
        assert 0.05 < limits.stiffness <= 1.0 and 0.05 < limits.damping <= 1.0
        for name in ("stiffness", "damping"):
            limit = getattr(limits, name)
            arguments = {"stiffness": None, "damping": None, "material": None}
            world.set_coefficients(0.05, 0.05, None)
            world.set_coefficients(**{**arguments, name: 0.999 * limit})
            assert report(world).within_limit
            if limit < 1.0:
                world.set_coefficients(**{**arguments, name: min(1.0, 1.001 * limit)})
                assert not report(world).within_limit
        assert limits.reason.startswith("proven: Cs + 2 Cd of joined springs add up to less than 4, n_eff ")


def test_the_marks_are_for_the_chosen_material():
    world = World(dataclasses.replace(rope().settings), material_names=("rope", "mesh"))
    points = [(x, y) for y in range(3) for x in range(3)]
    world.add_particles([f"p.{k}" for k in range(9)], points)
    star = [(4, k) for k in range(9) if k != 4]
    world.add_springs([f"p:{k}" for k in range(8)], *np.transpose(star), stiffness=0.1, damping=0.1, material=1)
    world.add_particles(["q.0", "q.1"], [(9, 9), (10, 9)])
    world.add_springs(["q:0"], [9], [10], stiffness=0.1, damping=0.1, material=0)
    assert coefficient_limits(world, 0).stiffness == 1.0
    assert coefficient_limits(world, 0).damping == 1.0
    assert coefficient_limits(world, 1).stiffness == pytest.approx(4.0 / 4.5 - 0.2)
    assert coefficient_limits(world, 1).damping == pytest.approx((4.0 / 4.5 - 0.1) / 2.0)
    assert coefficient_limits(world, None).stiffness == coefficient_limits(world, 1).stiffness


def test_the_marks_leave_room_for_what_harder_springs_take_at_the_same_particle_and_hands_take_none():
    world = grid_with_diagonals(stiffness=0.05, damping=0.05)
    world.material_names = ("default", "tie")
    alone = coefficient_limits(world).damping
    # Eight springs at one particle: 8 (Cs + 2 Cd) < 4.
    assert alone == pytest.approx((4.0 / 8.0 - 0.05) / 2.0)
    world.reserve_grabs()
    world.hold(0, 27, (3.0, 3.0))
    assert coefficient_limits(world).damping == alone
    world.set_coefficients(None, 0.999 * alone, None)
    assert report(world).within_limit
    world.release(0)
    world.add_springs(["tie"], [27], [0], stiffness=0.5, damping=0.9, material=1)
    assert coefficient_limits(world, 0).damping < alone


def test_no_stiffness_is_proven_where_the_damping_alone_is_too_much():
    world = grid_with_diagonals(stiffness=0.1, damping=1.0)
    assert coefficient_limits(world).stiffness == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(
    ("name", "limit"), [("hooke_stiffness", 4.0 * 3.0 * 60.0**2), ("hooke_damping", 2.0 * 3.0 * 60.0)]
)
def test_a_mistuned_hooke_spring_is_reported_past_the_limit(name, limit):
    world = network([(0, 0), (1, 0)], [(0, 1)], masses=3.0, pinned=[0])
    world.change("law", LAW_HOOKE)
    getattr(world, name)[:] = 0.99 * limit
    assert report(world).within_limit
    getattr(world, name)[:] = 1.01 * limit
    assert not report(world).within_limit
    assert coefficient_limits(world).reason == "no spring of this material does anything"


@pytest.mark.parametrize("place", [np.nan, np.inf, 1e308])
def test_a_world_that_blew_up_can_still_be_reported(place):
    world = rope(links=3)
    world.position[2] = place
    assert report(world).n_eff == 2.0


def test_the_report_of_a_large_mesh_costs_no_more_than_the_sums_it_is_made_of():
    world = grid_with_diagonals(columns=60, rows=60)
    line = report(world)
    ends, weights = np.concatenate([world.particle_a, world.particle_b]), np.ones(2 * world.spring_count)
    began = time.process_time()
    for _ in range(3 * POWER_ITERATIONS):
        np.bincount(ends, weights, world.particle_count)
    sums = time.process_time() - began
    began = time.process_time()
    assert report(world) == line
    # Of all threads: a norm by the library of linear algebra wakes one for each core, at 10 times the cost in all.
    assert time.process_time() - began < 20.0 * sums
