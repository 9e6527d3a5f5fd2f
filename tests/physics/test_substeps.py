"""Substeps that every tick chooses for itself."""

from dataclasses import replace

import numpy as np
import pytest

from sandbox.physics.analysis import energy
from sandbox.physics.analysis.stability import report
from sandbox.physics.jit import COMPILED
from sandbox.physics.settings import AUTO, WorldSettings
from sandbox.physics.snapshot import restore, state_hash, take
from sandbox.physics.solvers import SOLVERS
from sandbox.physics.step import step
from sandbox.physics.substeps import MOST_AUTO
from sandbox.physics.world import World
from tests.bench import energy_gate, scenes
from tests.physics.test_direct import run, single_springs
from tests.support.tick_parts import parts_of_next_tick, parts_taken, set_parts
from tests.support.wholes import part_and_whole

DIRECTIONS = 20.0 * np.array([(-1, 0), (1, 0), (0, 1), (0, -1)])


def vary_parts(monkeypatch: pytest.MonkeyPatch, seed: int) -> None:
    """Let every tick take 1, 2, 4 or 8 parts at random: the worst that a choice could do."""
    generator = np.random.default_rng(seed)
    set_parts(monkeypatch, lambda: int(generator.choice([1, 2, 4, MOST_AUTO])))


@pytest.mark.parametrize(
    ("speed", "parts"), [(0.0, 1), (2.9, 1), (3.1, 2), (5.9, 2), (6.1, 4), (11.9, 4), (12.1, 8), (1e17, 8)]
)
def test_parts_are_the_fewest_in_which_no_spring_moves_half_its_length(speed, parts):
    world = scenes.rope(10).world(substeps=AUTO)
    world.velocity[10] = (0.0, speed)
    assert parts_of_next_tick(world) == parts


def test_only_ends_that_move_against_each_other_count():
    world = scenes.rope(10).world(substeps=AUTO)
    world.unpin(0)
    world.velocity[:] = (1000.0, 0.0)
    assert parts_of_next_tick(world) == 1
    world.cut([9])
    world.velocity[10] = 0.0
    assert parts_of_next_tick(world) == 1
    world.settings = replace(world.settings, substeps=16)
    assert parts_of_next_tick(world) == 16


def test_a_moving_hand_counts_by_the_shortest_spring_at_what_it_holds():
    world = scenes.rope(10).world(substeps=AUTO)
    world.hold(0, 10, (1.0, 0.0))
    assert parts_of_next_tick(world) == 1
    world.move_grab(0, (1.0, 0.06))
    assert parts_of_next_tick(world) == 2
    world.rest_length[9] = 0.01
    assert parts_of_next_tick(world) == 8


def test_one_spring_moves_from_tick_to_tick_as_its_coefficients_say_where_a_tick_takes_one_part():
    world, _, rest = single_springs(np.random.default_rng(2), 400 if COMPILED else 20, (0.1, 0.95), 15)
    world.settings = replace(world.settings, substeps=AUTO)
    world.velocity *= 0.02
    errors = []
    for _ in range(15):
        assert parts_of_next_tick(world) == 1
        errors.append(energy.spring_lengths(run(world, 1)) - rest)
    for before, now, after in zip(errors, errors[1:], errors[2:], strict=False):
        foreseen = (2.0 - world.stiffness - world.damping) * now - (1.0 - world.damping) * before
        assert np.max(np.abs(after - foreseen) / rest) < 1e-12


@pytest.mark.parametrize(("stiffness", "damping"), [(0.1, 0.5), (0.9, 0.99), (0.5, 0.5)])
@pytest.mark.parametrize("parts", [2, 4, 8])
def test_a_network_hangs_as_low_in_ticks_of_many_parts_as_of_one(parts, stiffness, damping, monkeypatch):
    world = scenes.rope(4, vertical=True).world(
        substeps=AUTO, stiffness=stiffness, damping=damping, gravity=(0.0, -0.1)
    )
    hanging = run(world, 2000).position[:, 1].copy()
    assert hanging[4] < -0.4 - 1e-6
    set_parts(monkeypatch, lambda: parts)
    for _ in range(100):
        assert run(world, 1).position[:, 1] == pytest.approx(hanging, abs=1e-9)


def test_a_rigid_spring_has_its_length_after_one_tick_and_rests_after_two_whatever_parts_they_have(monkeypatch):
    vary_parts(monkeypatch, 1)
    world = World(WorldSettings(gravity=(0.0, 0.0), solver="direct", substeps=AUTO))
    world.add_particles(["a", "b"], [(0.0, 0.0), (1.0, 0.0)], velocity=[(0.0, 0.0), (9.0, 0.0)], mass=[1.0, 7.0])
    world.add_springs(["s"], [0], [1], rest_length=0.9, stiffness=1.0, damping=1.0)
    for _ in range(8):
        run(world, 2)
        assert energy.spring_lengths(world)[0] == pytest.approx(0.9, abs=1e-5)


@pytest.mark.parametrize("size", part_and_whole((5, 200), (20, 400)), ids="{0[0]} graphs".format)
@pytest.mark.parametrize("kind", energy_gate.BOUNDS)
@pytest.mark.parametrize("span", energy_gate.MASS_SPANS)
def test_energy_of_violent_random_graphs_stays_bounded_however_the_parts_change(kind, span, size, monkeypatch):
    vary_parts(monkeypatch, 3)
    count, steps = size if COMPILED else (2, 10)
    graphs = energy_gate.random_graphs(kind, span, count, seed=8, substeps=AUTO)
    assert energy_gate.highest_energies(graphs, count, steps).max() <= energy_gate.BOUNDS[kind]


@pytest.mark.parametrize("solver", ["direct", "iterative"])
def test_what_a_solver_keeps_of_its_impulses_fits_the_next_tick_whatever_its_parts(solver, monkeypatch):
    world = run(scenes.rope(4, vertical=True).world(substeps=AUTO, solver=solver, stiffness=0.9, damping=0.9), 400)
    kept, impulses = take(world), []
    for parts in (1, 8, 2):
        restore(world, kept)
        set_parts(monkeypatch, lambda parts=parts: parts)
        run(world, 200)
        impulses.append(world.tension.copy() if solver == "direct" else np.abs(world.impulse[:, 1]))
    assert np.all(impulses[0] > 0.0)
    if solver == "direct":
        assert impulses[1] == pytest.approx(impulses[0], rel=1e-6)
    assert impulses[1] == pytest.approx(impulses[2], rel=1e-6 if solver == "direct" else 0.5)


def test_switching_to_auto_and_back_rescales_impulses_and_begins_banks_anew():
    world = run(scenes.rope(6).world(substeps=4), 20)
    pulled = world.tension.copy()
    world.settings = replace(world.settings, substeps=AUTO)
    assert np.array_equal(world.tension, 4.0 * pulled)
    assert np.all(world.energy_bank == -1.0)
    world.settings = replace(world.settings, substeps=4)
    assert np.array_equal(world.tension, pulled)


def drag(world: World, held: int) -> tuple[float, float]:
    """RMS stretch while a hand drags a particle for 3 s at 20 m/s with reversals, and 1 s after its release."""
    target, squares = world.position[held].copy(), []
    world.hold(0, held, tuple(target))
    for tick in range(180):
        target += DIRECTIONS[tick // 15 % 4] / world.settings.tick_rate
        world.move_grab(0, tuple(target))
        squares.append(scenes.square_strains(run(world, 1)))
    world.release(0)
    return np.sqrt(np.mean(squares)), np.sqrt(np.mean(scenes.square_strains(run(world, 60))))


@pytest.mark.skipif(not COMPILED, reason="interpreted kernels take minutes")
@pytest.mark.parametrize("anchored", [True, False])
def test_a_rope_dragged_by_a_hand_at_twenty_metres_a_second_stays_short(anchored):
    world = scenes.rope(100).world(substeps=AUTO)
    if not anchored:
        world.unpin(0)
    dragged, released = drag(world, 100 if anchored else 0)
    assert dragged <= 1e-2
    # It whirls on, and nothing but its springs damps that: 2.3e-4 where it is anchored.
    assert released <= 3e-4


@pytest.mark.skipif(not COMPILED, reason="interpreted kernels take minutes")
def test_a_rope_dragged_by_a_moved_pin_stays_short():
    world, squares = scenes.rope(100).world(substeps=AUTO), []
    for tick in range(180):
        world.velocity[0] = -DIRECTIONS[tick // 15 % 4]
        squares.append(scenes.square_strains(run(world, 1)))
    assert np.sqrt(np.mean(squares)) <= 1e-2
    world.velocity[0] = 0.0
    # It whirls on with 80 m/s at its tip: the load, and not the turn, stretches it.
    assert np.sqrt(np.mean(scenes.square_strains(run(world, 60)))) <= 3e-4


@pytest.mark.skipif(not COMPILED, reason="interpreted kernels take minutes")
@pytest.mark.parametrize(
    ("scene", "seconds", "loss"),
    [(scenes.rope(100), 2, 0.06), (scenes.rope(50, 1000.0), 7, 0.04), (scenes.rope(1000), 7, 0.03)],
    ids=lambda value: getattr(value, "name", None),
)
def test_swinging_ropes_keep_their_energy_at_auto_in_hardly_more_steps(scene, seconds, loss):
    world, parts = scene.world(substeps=AUTO), 0
    start = scenes.total_energy(world)
    for _ in range(60 * seconds):
        step(world)
        parts += parts_taken(world)
    assert abs(start - scenes.total_energy(world)) <= loss * scenes.swing_energy(scene)
    assert parts <= 1.1 * 60 * seconds


@pytest.mark.parametrize("solver", SOLVERS)
def test_every_solver_takes_the_parts_and_repeats_every_bit_from_a_snapshot(solver):
    world = scenes.rope(8).world(substeps=AUTO, solver=solver, stiffness=0.2, damping=0.3)
    world.velocity[8] = (0.0, 9.0)
    assert parts_of_next_tick(world) == 4
    run(world, 3)
    kept, hashes = take(world), []
    for _ in range(2):
        restore(world, kept)
        hashes.append(state_hash(run(world, 20)))
    assert hashes[0] == hashes[1]
    assert np.isfinite(world.position).all()


def test_limits_are_those_of_a_tick_in_one_part():
    texts = []
    for substeps in (AUTO, 1):
        world = scenes.rope(8).world(substeps=substeps, solver="single_pass")
        texts.append(report(world))
    assert texts[0] == texts[1]
    assert WorldSettings(substeps=AUTO).fewest_substeps == 1
