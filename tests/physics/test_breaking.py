"""Breaking and yielding: by strain, at the end of a tick, in every solver, and never with a gain of energy."""

import numpy as np
import pytest

from sandbox.physics.analysis.energy import kinetic_energy, reduced_masses, spring_lengths
from sandbox.physics.analysis.query import load_bearing, strain
from sandbox.physics.breaking import NEVER, StrainLimits
from sandbox.physics.driving import Actuators, Muscles
from sandbox.physics.equation import implicit_spring_constant
from sandbox.physics.snapshot import restore, state_hash, take
from sandbox.physics.solvers import SOLVERS
from sandbox.physics.step import step
from sandbox.physics.substeps import substep_coefficients, substep_time
from sandbox.physics.world import World
from tests.support.physics_scenes import girder, network, random_graph, rope, run, scaled

FAST = {"single_pass": (0.2, 0.2), "iterative": (0.5, 0.9), "direct": (0.9, 0.95)}
# Strains that the solver lets a rope's link, and a girder's chord, reach under their own weight, and less.
WEAK_LINK = {"single_pass": 0.1, "iterative": 2e-4, "direct": 1e-3}
WEAK_CHORD = {"single_pass": 0.3, "iterative": 0.008, "direct": 0.006}


def limits(tension=NEVER, compression=NEVER, yielding=NEVER, share=0.0):
    """Limits of one material."""
    return StrainLimits(*(np.array([value], dtype=np.float64) for value in (tension, compression, yielding, share)))


def pair(length, **given):
    """Two pinned particles 1 m apart with a spring, moved to a length [m] before the next tick."""
    world = network([(0, 0), (1, 0)], [(0, 1)], pinned=(0, 1))
    world.limits = limits(**given)
    world.position[1, 0] = length
    return world


@pytest.mark.parametrize(("length", "breaks"), [(1.09, False), (1.11, True), (0.81, False), (0.79, True)])
def test_a_spring_breaks_beyond_either_limit_and_not_before(length, breaks):
    world = pair(length, tension=0.1, compression=0.2)
    step(world)
    assert world.broken.tolist() == ([0] if breaks else [])
    assert world.spring_active[0] != breaks
    step(world)
    assert not len(world.broken)


def test_springs_without_limits_hands_and_springs_of_no_length_never_break():
    world = network([(0, 0), (1, 0), (9, 9)], [(0, 1)], pinned=(0,))
    world.add_springs(["point"], [0], [1], rest_length=0.0)
    world.limits = limits(tension=0.5, compression=0.5)
    world.hold(0, 2, (0.0, 0.0))
    world.rest_length[0] = np.sqrt(0.5)
    run(world, 1)
    assert world.is_held(0) and world.spring_active[1]
    free = pair(50.0)
    run(free, 1)
    assert free.spring_active[0]


def test_rest_length_follows_beyond_the_yield_strain_up_to_the_limit():
    world = pair(1.21, yielding=0.1, share=0.3)
    step(world)
    assert world.rest_length[0] == pytest.approx(1.1)
    world.position[1, 0] = 1.0
    step(world)
    assert world.rest_length[0] == pytest.approx(1.1)
    world.position[1, 0] = 3.0
    step(world)
    assert world.rest_length[0] == pytest.approx(1.3)
    world.position[1, 0] = 0.1
    step(world)
    assert world.rest_length[0] == pytest.approx(0.7)


def test_what_yields_breaks_once_it_can_yield_no_further():
    world = pair(1.3, yielding=0.1, share=0.2, tension=0.15)
    step(world)
    assert world.spring_active[0] and world.rest_length[0] == pytest.approx(1.3 / 1.1)
    world.position[1, 0] = 1.4
    step(world)
    assert not world.spring_active[0]


def test_a_driven_spring_does_not_yield_but_breaks():
    world = pair(1.5, yielding=0.1, share=0.5)
    world.fit(Actuators((), Muscles(np.array([0]), np.array([0.0]), np.array([4]), np.array([0.0]))), [])
    step(world)
    assert world.rest_length[0] == 1.0
    world.limits = limits(tension=0.4)
    step(world)
    assert not world.spring_active[0]


@pytest.mark.parametrize("solver", list(SOLVERS))
def test_a_broken_rope_hangs(solver):
    stiffness, damping = FAST[solver]
    world = rope(10, solver=solver, gravity=(0.0, -9.81), stiffness=stiffness, damping=damping)
    world.position[:, 1], world.position[:, 0] = -world.position[:, 0].copy(), 0.0
    world.mass[6] = 5.0
    world.change("inverse_mass", 0.2, 6)
    # The link above the heavy particle alone is weak.
    world.material_names = ("strong", "weak")
    world.change("material", 0)
    world.change("material", 1, 5)
    world.limits = StrainLimits(np.array([NEVER, WEAK_LINK[solver]]), *np.full((2, 2), NEVER), np.zeros(2))
    run(world, 600)
    assert np.flatnonzero(~world.spring_active).tolist() == [5]
    # What is above hangs at rest, what is below has fallen as one.
    assert np.abs(world.velocity[:6]).max() < 0.2
    assert world.position[5, 1] == pytest.approx(-5.0, abs=1.5)
    assert world.position[6:, 1].max() < -100.0


@pytest.mark.parametrize("solver", list(SOLVERS))
def test_a_truss_that_breaks_at_its_root_falls(solver):
    stiffness, damping = FAST[solver]
    world = girder(6, solver=solver, gravity=(0.0, -9.81), stiffness=stiffness, damping=damping)
    world.limits = limits(tension=WEAK_CHORD[solver], compression=0.9)
    run(world, 240)
    broken = np.flatnonzero(~world.spring_active)
    assert len(broken) >= 1
    assert world.position[6, 1] < -20.0


@pytest.mark.parametrize("solver", list(SOLVERS))
def test_a_beam_that_has_yielded_stays_bent(solver):
    stiffness, damping = FAST[solver]
    ends = []
    for yielding in (NEVER, 0.004):
        pull = -0.5 if solver == "single_pass" else -9.81
        world = girder(5, solver=solver, gravity=(0.0, pull), stiffness=stiffness, damping=damping)
        world.limits = limits(yielding=yielding, share=0.05)
        run(world, 300)
        world.settings = type(world.settings)(solver=solver, gravity=(0.0, 0.0), drag=0.5)
        run(world, 1500)
        assert world.spring_active.all()
        ends.append(world.position[5, 1])
    assert ends[0] == pytest.approx(0.0, abs=5e-3)
    assert ends[1] < ends[0] - 0.01


def held(world):
    """Kinetic and spring energy [J] as the direct solver's test measures them, and what is saved in its banks."""
    h = substep_time(world.settings)
    constant = implicit_spring_constant(*substep_coefficients(world), reduced_masses(world), h)
    error = (spring_lengths(world) - world.rest_length) * world.spring_active
    return kinetic_energy(world) + 0.5 * np.sum(constant * error * error) + world.energy_bank.clip(min=0.0).sum()


@pytest.mark.parametrize("substeps", [1, 4, "auto"])
@pytest.mark.parametrize("yielding", [NEVER, 0.05])
def test_energy_and_banks_never_rise_in_the_direct_solver_while_springs_yield_and_break(yielding, substeps):
    generator = np.random.default_rng(7)
    left = 0
    for _ in range(scaled(12, 2)):
        world = random_graph(
            generator, decades=1.0, pinned=1, solver="direct", stiffness=0.6, damping=0.7, substeps=substeps
        )
        world.velocity[1:] = generator.normal(0.0, 20.0, (11, 2))
        world.limits = limits(tension=0.08, compression=0.08, yielding=yielding, share=0.02)
        step(world)
        before = held(world)
        for _ in range(scaled(200, 40)):
            step(world)
            after = held(world)
            assert after <= before * (1.0 + 1e-9)
            before = after
        left += np.count_nonzero(world.spring_active)
    assert left < scaled(12, 2) * 22


@pytest.mark.parametrize("solver", list(SOLVERS))
def test_momentum_is_kept_while_springs_yield_and_break(solver):
    generator = np.random.default_rng(3)
    stiffness, damping = (0.05, 0.1) if solver != "direct" else (0.3, 0.3)
    world = random_graph(generator, decades=1.0, solver=solver, stiffness=stiffness, damping=damping)
    world.velocity[:] = generator.normal(0.0, 50.0, world.velocity.shape)
    world.limits = limits(tension=0.05, compression=0.05, yielding=0.02, share=0.05)
    before, scale = world.mass @ world.velocity, np.abs(world.mass[:, None] * world.velocity).sum()
    run(world, 60)
    assert not world.spring_active.all()
    assert np.abs(world.mass @ world.velocity - before).max() <= 1e-12 * scale


@pytest.mark.parametrize("solver", list(SOLVERS))
def test_a_breaking_world_resumes_from_every_snapshot_bit_for_bit(solver):
    stiffness, damping = FAST[solver]
    world = girder(8, solver=solver, gravity=(0.0, -9.81), stiffness=stiffness, damping=damping)
    world.limits = limits(tension=WEAK_CHORD[solver], compression=0.5, yielding=0.005, share=0.01)
    snapshots, hashes = [], []
    for _ in range(90):
        snapshots.append(take(world))
        step(world)
        hashes.append(state_hash(world))
    assert not world.spring_active.all()
    for start in (0, 20, 45, 70):
        restore(world, snapshots[start])
        run(world, 90 - start)
        assert state_hash(world) == hashes[-1]


def test_a_piece_that_broke_off_and_is_joined_again_brings_no_old_bank():
    world = rope(6, solver="direct", stiffness=0.8, damping=0.9)
    world.velocity[1:, 1] = 4.0
    run(world, 20)
    world.energy_bank[4] = 100.0
    world.add_springs(["more"], [2], [5], stiffness=0.8, damping=0.9)
    run(world, 1)
    assert np.count_nonzero(world.energy_bank > 0.0) <= 1
    assert world.energy_bank.max() < 100.0


def chain():
    world = network([(0, 0), (1, 0), (3, 0), (3, 4)], [(0, 1), (1, 2), (2, 3)], pinned=[0, 1])
    world.position[2] = (2.0, 0.0)
    world.position[3] = (2.0, 6.0)
    return world


def test_strain_is_signed_and_relative_to_the_rest_length():
    for state in (chain(), take(chain())):
        assert strain(state) == pytest.approx([0.0, -0.5, 0.5])


def test_springs_without_rest_length_and_cut_springs_have_no_strain():
    world = chain()
    world.rest_length[1] = 0.0
    world.cut([2])
    assert np.array_equal(strain(world), [0.0, 0.0, 0.0])


def test_load_bears_on_active_springs_with_a_rest_length_and_a_free_end():
    world = chain()
    assert list(load_bearing(world)) == [False, True, True]
    world.rest_length[1] = 0.0
    world.cut([2])
    assert not load_bearing(take(world)).any()


def test_an_empty_world_has_no_strain():
    assert len(strain(World())) == len(load_bearing(World())) == 0


@pytest.mark.parametrize("place", [np.nan, np.inf, 1e308])
def test_the_strain_of_what_blew_up_is_no_finite_number_and_no_fault(place):
    world = chain()
    world.position[3] = place
    assert strain(world)[:2] == pytest.approx([0.0, -0.5])
    assert not np.isfinite(strain(world)[2])
