"""Large bodies under the direct solver: nested dissection and dense fronts."""

import os
import subprocess
import sys

import numpy as np
import pytest

from sandbox.physics.jit import COMPILED
from sandbox.physics.pipeline.block_owner import block_of
from sandbox.physics.settings import WorldSettings
from sandbox.physics.snapshot import restore, state_hash, take
from sandbox.physics.solvers.linear import elimination, fronts
from sandbox.physics.step import step
from sandbox.physics.world import World
from tests.bench import energy_gate, scenes
from tests.support.physics_scenes import run
from tests.support.wholes import part_and_whole


def by_fronts(world: World) -> bool:
    return len(block_of(world).arrays.system.fronts.first) > 0


def mesh(seed: int, count: int = 500) -> World:
    """An irregular mesh in the plane, unequal masses, some pins, two springs between some pairs, a rope hanging on."""
    generator = np.random.default_rng(seed)
    position = generator.uniform(0.0, 1.0, (count, 2))
    world = World(WorldSettings(solver="direct"))
    pinned = np.arange(count) < 3
    world.add_particles(
        [f"m.{k}" for k in range(count)], position, mass=10.0 ** generator.uniform(-2.0, 2.0, count), pinned=pinned
    )
    distance = np.sum((position[:, None] - position[None]) ** 2, axis=2)
    near = np.argsort(distance, axis=1, kind="stable")[:, 1:9]
    a, b = np.repeat(np.arange(count), 8), near.ravel()
    world.add_springs([f"m:{k}" for k in range(len(a))], a, b, stiffness=0.6, damping=0.8)
    first = world.add_particles(["r.0", "r.1"], [(1.1, 0.5), (1.2, 0.5)])
    world.add_springs(["r:0", "r:1"], [count - 1, first], [first, first + 1], stiffness=1.0, damping=1.0)
    world.reserve_grabs()
    return world


def play(world: World, ticks: int) -> World:
    """Ticks with a hand, a cut, a pin and a slider in them."""
    for _ in range(ticks):
        if world.tick == 2:
            world.hold(0, 40, (0.3, 0.4))
        if 2 < world.tick < 6:
            world.move_grab(0, (0.3 + 0.02 * world.tick, 0.5))
        if world.tick == 4:
            world.cut([10, 200, 333])
        if world.tick == 6:
            world.release(0)
            world.pin(50)
        if world.tick == 7:
            world.set_coefficients(0.9, 0.95, None)
        step(world)
    return world


@pytest.mark.parametrize("seed", [1, 2])
def test_every_front_holds_all_that_its_rows_are_joined_to(seed):
    world = mesh(seed)
    system = block_of(world).arrays.system
    fronts, springs = system.fronts, system.springs
    borders = np.split(fronts.border, fronts.border_start[1:-1])
    own = [list(range(first, last)) for first, last in zip(fronts.first, fronts.last, strict=True)]
    rows = [[*eliminated, *border.tolist()] for eliminated, border in zip(own, borders, strict=True)]
    assert sorted(row for eliminated in own for row in eliminated) == np.flatnonzero(fronts.of_row >= 0).tolist()
    for front, held in enumerate(rows):
        assert held == sorted(set(held))
        for below in fronts.child[front]:
            if below >= 0:
                outside = rows[below][fronts.last[below] - fronts.first[below] :]
                places = fronts.to_parent[fronts.border_start[below] : fronts.border_start[below + 1]]
                assert [held[place] for place in places] == outside
    inside = (springs.row_a < len(fronts.of_row)) & (springs.row_b < len(fronts.of_row))
    for a, b in zip(springs.row_a[inside], springs.row_b[inside], strict=True):
        assert max(a, b) in rows[fronts.of_row[min(a, b)]]


def test_the_order_follows_from_springs_pins_and_creation_alone():
    played, built = play(mesh(3), 12), mesh(3)
    for particle in (50,):
        built.pin(particle)
    built.cut([333, 10, 200])
    assert np.array_equal(block_of(played).arrays.system.rows.particle, block_of(built).arrays.system.rows.particle)
    assert not np.array_equal(played.position, built.position)


@pytest.mark.parametrize("seed", [4, 5])
def test_fronts_and_the_sparse_factorisation_agree(seed, monkeypatch):
    ends = []
    for smallest in (400, 10**9):
        monkeypatch.setattr(elimination, "SMALLEST_BODY", smallest)
        world = mesh(seed)
        assert by_fronts(world) == (smallest == 400)
        ends.append(play(world, 8).position)
    assert np.abs(ends[0] - ends[1]).max() < 1e-9
    assert not np.array_equal(ends[0], ends[1])


def test_particles_created_at_one_point_are_dissected_all_the_same(monkeypatch):
    ends = []
    for smallest in (400, 10**9):
        monkeypatch.setattr(elimination, "SMALLEST_BODY", smallest)
        world = mesh(6)
        world.change("origin", 0.5)
        ends.append(run(world, 3).position)
    assert np.abs(ends[0] - ends[1]).max() < 1e-9


def test_narrow_and_small_bodies_stay_with_the_sparse_factorisation():
    for scene in (scenes.rope(1000), scenes.bridge(400), scenes.lattice(16), scenes.blocks(40)):
        assert not by_fronts(scene.world())
    assert by_fronts(scenes.lattice(32).world())


def test_large_bodies_move_the_same_alone_or_among_others():
    alone, among = scenes.lattice(24).world(), scenes.lattice(24).world()
    second, rope = scenes.lattice(22), scenes.rope(12)
    for scene, shift in ((rope, 3.0), (second, 7.0)):
        first = among.add_particles(
            [f"{shift}.{k}" for k in range(len(scene.mass))], scene.position + shift, pinned=scene.pinned
        )
        names = [f"{shift}:{k}" for k in range(len(scene.links))]
        among.add_springs(names, *(first + scene.links.T), stiffness=1.0, damping=1.0)
    for _ in range(20 if COMPILED else 2):
        step(alone)
        step(among)
    assert np.array_equal(alone.position, among.position[: len(alone.mass)])


def test_a_run_of_a_large_body_continues_from_a_snapshot_with_the_same_bits():
    ticks = 30 if COMPILED else 3
    world = play(mesh(7), 5)
    kept = take(world)
    ends = []
    for other in (world, mesh(7), play(mesh(7), 9)):
        restore(other, kept)
        ends.append(state_hash(play(other, ticks)))
    assert len(set(ends)) == 1


@pytest.mark.slow
@pytest.mark.parametrize("way", part_and_whole("library", "interpreted"))
def test_a_fresh_process_computes_the_same_bits_of_a_large_body(way):
    code = "from tests.physics.test_large import *; print(state_hash(play(mesh(8), 8)))"
    environment = {**os.environ, "SANDBOX_KERNELS": way, "PYTHONPATH": os.pathsep.join(sys.path)}
    fresh = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True)
    assert fresh.stdout.strip() == state_hash(play(mesh(8), 8))


@pytest.mark.skipif(not COMPILED, reason="interpreted kernels take hours")
@pytest.mark.parametrize(("side", "ticks"), [(64, 180), (100, 60)])
def test_large_lattices_hung_by_a_corner_barely_stretch(side, ticks):
    scene = scenes.lattice(side)
    world = scene.world()
    start = scenes.total_energy(world)
    run(world, ticks)
    assert np.sqrt(np.mean(scenes.square_strains(world))) <= 1e-5
    assert abs(start - scenes.total_energy(world)) <= 0.01 * scenes.swing_energy(scene)


@pytest.mark.skipif(not COMPILED, reason="interpreted kernels take minutes")
def test_a_large_lattice_that_is_dragged_about_keeps_its_shape():
    world = scenes.lattice(48).world()
    world.reserve_grabs()
    held = 47
    world.hold(0, held, tuple(world.position[held]))
    speeds = np.array([0.1, -0.2, 0.25, -0.1])
    for tick in range(120):
        world.move_grab(0, tuple(world.position[world.grab_particle] + [speeds[tick // 30], 0.5 * speeds[tick % 4]]))
        step(world)
        assert np.sqrt(np.mean(scenes.square_strains(world))) <= 1e-2
    world.release(0)
    run(world, 60)
    assert np.sqrt(np.mean(scenes.square_strains(world))) <= 1e-4


@pytest.mark.parametrize("size", part_and_whole((5, 300), (10, 1000)), ids="{0[0]} graphs".format)
@pytest.mark.parametrize("kind", energy_gate.BOUNDS)
def test_energy_of_violent_random_graphs_stays_bounded_under_fronts(kind, size, monkeypatch):
    monkeypatch.setattr(elimination, "SMALLEST_BODY", 1)
    monkeypatch.setattr(elimination, "NARROWEST_BORDER", 0.0)
    monkeypatch.setattr(fronts, "WORTH_DIVIDING", 1)
    count, steps = size if COMPILED else (2, 20)
    for span in energy_gate.MASS_SPANS:
        graphs = energy_gate.random_graphs(kind, span, count, seed=17)
        assert by_fronts(graphs.world)
        assert energy_gate.highest_energies(graphs, count, steps).max() <= energy_gate.BOUNDS[kind]


@pytest.mark.parametrize("value", [np.nan, np.inf, 1e308])
@pytest.mark.parametrize("array", ["position", "velocity", "mass", "rest_length", "stiffness", "damping", "tension"])
def test_an_absurd_value_in_a_large_body_neither_hangs_nor_leaves_it(array, value, monkeypatch):
    world = mesh(9)
    first = world.add_particles(["o.0", "o.1"], [(5.0, 0.0), (6.0, 0.0)])
    world.add_springs(["o:0"], [first], [first + 1], stiffness=0.5, damping=0.9)
    monkeypatch.setattr(fronts, "WORTH_DIVIDING", 1)
    with np.errstate(all="ignore"):
        getattr(world, array).flat[400] = value
        run(world, 3 if COMPILED else 1)
    assert np.isfinite(world.position[first:]).all()


def test_a_large_body_cut_loose_falls_freely():
    world = scenes.lattice(24).world()
    pin = int(np.flatnonzero(world.inverse_mass == 0.0)[0])
    world.cut(np.flatnonzero((world.particle_a == pin) | (world.particle_b == pin)).tolist())
    start = world.position.copy()
    ticks = 30 if COMPILED else 2
    run(world, ticks)
    fallen = np.array([0.0, -9.81 * ticks * ticks / 2 / 3600])
    others = np.arange(len(world.mass)) != pin
    assert np.abs(world.position - start - fallen)[others].max() < 1e-9
