"""The direct solver: the article's spring in a network of any size, with energy that stays bounded."""

import os
import subprocess
import sys

import numpy as np
import pytest

from sandbox.physics.analysis.energy import kinetic_energy, spring_energy
from sandbox.physics.analysis.stability import coefficient_limits, report
from sandbox.physics.jit import COMPILED
from sandbox.physics.marks import LAW_HOOKE
from sandbox.physics.pipeline.block_owner import block_of
from sandbox.physics.settings import AUTO, WorldSettings
from sandbox.physics.snapshot import restore, state_hash, take
from sandbox.physics.solvers.linear import sparse_ldl
from sandbox.physics.step import step
from sandbox.physics.world import World
from tests.bench import energy_gate, scenes
from tests.support.physics_scenes import run
from tests.support.wholes import part_and_whole


def single_springs(generator: np.random.Generator, count: int, damping_range, steps: int):
    """Random springs moving along their lines, none through zero length, as a world each for two solvers."""
    rate = round(10.0 ** generator.uniform(1.0, 3.0))
    stiffness, damping = generator.uniform(0.0, 1.0, count), generator.uniform(*damping_range, count)
    masses = 10.0 ** generator.uniform(-6.0, 6.0, (2, count))
    rest = 10.0 ** generator.uniform(-2.0, 2.0, count)
    length = rest * generator.uniform(0.5, 1.5, count)
    speed = length * rate * generator.uniform(-0.9, 0.9, count)
    error, change, shortest = length - rest, speed / rate, length.copy()
    for _ in range(steps):
        change = (1.0 - damping) * change - stiffness * error
        error = error + change
        shortest = np.minimum(shortest, rest + error)
    kept = np.flatnonzero(shortest > 0.05 * rest)
    angle = generator.uniform(0.0, 2.0 * np.pi, len(kept))
    along = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    share = masses[1, kept] / masses[:, kept].sum(axis=0)
    worlds = []
    for solver in ("direct", "single_pass"):
        world = World(WorldSettings(solver=solver, tick_rate=rate, gravity=(0.0, 0.0)))
        ends = np.arange(len(kept))
        world.add_particles(
            [f"a.{k}" for k in ends],
            np.zeros((len(kept), 2)),
            velocity=-along * (speed[kept] * share)[:, None],
            mass=masses[0, kept],
        )
        world.add_particles(
            [f"b.{k}" for k in ends],
            along * length[kept, None],
            velocity=along * (speed[kept] * (1.0 - share))[:, None],
            mass=masses[1, kept],
        )
        world.add_springs(
            [f"s:{k}" for k in ends], ends, ends + len(kept), rest_length=rest[kept], stiffness=stiffness[kept],
            damping=damping[kept],
        )  # fmt: skip
        worlds.append(world)
    return *worlds, rest[kept]


@pytest.mark.parametrize("damping_range", [(0.0, 1.0), (0.0, 0.0), (0.99, 1.0 - 1e-6), (1.0 - 1e-5, 1.0 - 1e-6)])
def test_one_spring_along_its_line_moves_as_the_article_says(damping_range):
    generator, compared, worst, steps = np.random.default_rng(1), 0, 0.0, 15
    while compared < (2000 if COMPILED else 40):
        direct, article, rest = single_springs(generator, 200 if COMPILED else 40, damping_range, steps)
        compared += len(rest)
        for _ in range(steps):
            step(direct)
            step(article)
            gap = np.abs(direct.position - article.position).reshape(2, -1, 2).max(axis=(0, 2))
            worst = max(worst, float(np.max(gap / rest)))
    assert worst < 1e-12


@pytest.mark.slow
@pytest.mark.parametrize("size", part_and_whole((10, 500), (20, 2000)), ids="{0[0]} graphs".format)
@pytest.mark.parametrize("kind", energy_gate.BOUNDS)
@pytest.mark.parametrize("span", energy_gate.MASS_SPANS)
def test_energy_of_violent_random_graphs_stays_bounded(kind, span, size):
    count, steps = size if COMPILED else (2, 20)
    graphs = energy_gate.random_graphs(kind, span, count, seed=7)
    assert energy_gate.highest_energies(graphs, count, steps).max() <= energy_gate.BOUNDS[kind]


@pytest.mark.slow
@pytest.mark.parametrize("size", part_and_whole((3, 150), (10, 300)), ids="{0[0]} graphs".format)
@pytest.mark.parametrize("kind", energy_gate.BOUNDS)
@pytest.mark.parametrize("substeps", [1, AUTO])
def test_energy_of_violent_random_graphs_with_areas_and_bends_stays_bounded(kind, substeps, size):
    count, steps = size if COMPILED else (2, 5)
    graphs = energy_gate.random_graphs(kind, 1e6, count, seed=8, substeps=substeps, elements=True)
    assert energy_gate.highest_energies(graphs, count, steps).max() <= energy_gate.BOUNDS[kind]


FIGURES = [
    # scene, RMS stretch in seconds 5..7, seconds, largest share of the swing's energy lost by then
    (scenes.rope(100), 5e-5, 2, 0.06),
    (scenes.rope(50, 1000.0), 5e-5, 7, 0.04),
    (scenes.bridge(), 1e-6, 7, 1e-4),
    (scenes.rope(1000), 2e-5, 7, 0.03),
    (scenes.lattice(32), 1e-5, 7, 0.01),
]


@pytest.mark.skipif(not COMPILED, reason="interpreted kernels take minutes for seven seconds")
@pytest.mark.parametrize(("scene", "stretch", "seconds", "loss"), FIGURES, ids=[row[0].name for row in FIGURES])
def test_bodies_at_full_stiffness_barely_stretch_and_keep_swinging(scene, stretch, seconds, loss):
    world = scene.world()
    start = scenes.total_energy(world)
    run(world, 60 * seconds)
    assert abs(start - scenes.total_energy(world)) <= loss * scenes.swing_energy(scene)
    run(world, 300 - 60 * seconds)
    squares = [scenes.square_strains(run(world, 1)) for _ in range(120)]
    assert np.sqrt(np.mean(squares)) <= stretch


@pytest.mark.skipif(not COMPILED, reason="interpreted kernels take minutes for seven seconds")
@pytest.mark.parametrize(
    ("scene", "substeps", "stretch"),
    [
        (scenes.rope(100), 4, 5e-6),
        (scenes.rope(50, 1000.0), 4, 5e-6),
        (scenes.rope(100), 32, 2.1e-8),
        (scenes.rope(50, 1000.0), 32, 7.8e-8),
    ],
    ids=lambda value: getattr(value, "name", value),
)
def test_substeps_leave_swinging_ropes_next_to_no_stretch(scene, substeps, stretch):
    world = run(scene.world(substeps=substeps), 300)
    squares = [scenes.square_strains(run(world, 1)) for _ in range(120)]
    assert np.sqrt(np.mean(squares)) <= stretch


@pytest.mark.skipif(not COMPILED, reason="interpreted kernels take minutes")
@pytest.mark.parametrize("substeps", [8, AUTO])
def test_a_rope_dragged_to_and_fro_at_twenty_metres_a_second_stays_short(substeps):
    world = scenes.rope(100).world(substeps=substeps)
    squares = []
    for tick in range(180):
        world.velocity[0] = 20.0 * np.array([(1, 0), (-1, 0), (0, 1), (0, -1)][tick // 15 % 4])
        squares.append(scenes.square_strains(run(world, 1)))
    assert np.sqrt(np.mean(squares)) <= 1e-2
    world.velocity[0] = 0.0
    assert np.sqrt(np.mean(scenes.square_strains(run(world, 60)))) <= 1e-4


@pytest.mark.skipif(not COMPILED, reason="interpreted kernels take minutes")
@pytest.mark.parametrize("vertical", [False, True])
def test_a_rope_carries_fifty_thousand_times_its_links(vertical):
    world = run(scenes.rope(100, 5e4, vertical=vertical).world(), 60)
    squares = [scenes.square_strains(run(world, 1)) for _ in range(240)]
    assert np.sqrt(np.max(squares)) <= 0.01


def tangle(**settings) -> World:
    """A small world with everything: a rope, a bouncy block, a Hooke spring, a zero-length one, hands, pins."""
    world = scenes.rope(12, 100.0).world(**settings)
    block = scenes.lattice(3, hung=False)
    generator = np.random.default_rng(3)
    first = world.add_particles(
        [f"j.{k}" for k in range(9)],
        block.position + np.array([2.0, 1.0]),
        velocity=generator.uniform(-3.0, 3.0, (9, 2)),
    )
    world.add_springs(
        [f"j:{k}" for k in range(len(block.links))], first + block.links[:, 0], first + block.links[:, 1],
        stiffness=0.8, damping=0.3,
    )  # fmt: skip
    world.add_springs(["zero"], [first], [first + 8], rest_length=0.0, stiffness=0.01, damping=0.5)
    world.add_springs(["hooke"], [3], [first], law=LAW_HOOKE, hooke_stiffness=20.0, hooke_damping=0.1)
    world.reserve_grabs()
    return world


def play(world: World, ticks: int) -> World:
    """Step to a tick, with a drag, a cut, a pin and a change of coefficients on the way."""
    for tick in range(world.tick, ticks):
        if tick == 5:
            world.hold(0, 6, (0.6, 0.1))
        if 5 < tick < 15:
            world.move_grab(0, (0.6 + 0.1 * tick, 0.1 * (tick % 4)))
        if tick == 15:
            world.release(0)
        if tick == 18:
            world.cut([9])
        if tick == 20:
            world.pin(16)
        if tick == 25:
            world.unpin(16)
            world.set_coefficients(0.9, 0.2, None)
        step(world)
    return world


def test_a_run_continues_from_a_snapshot_with_the_same_bits():
    world = play(tangle(), 12)
    kept = take(world)
    ends = []
    for other in (world, tangle(), play(tangle(), 30)):
        restore(other, kept)
        ends.append(state_hash(play(other, 40)))
    assert len(set(ends)) == 1


@pytest.mark.parametrize("way", ["library", "interpreted"])
def test_a_fresh_process_computes_the_same_bits_compiled_or_interpreted(way):
    code = "from tests.physics.test_direct import *; print(state_hash(play(tangle(substeps=2), 40)))"
    environment = {**os.environ, "SANDBOX_KERNELS": way, "PYTHONPATH": os.pathsep.join(sys.path)}
    fresh = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True)
    assert fresh.stdout.strip() == state_hash(play(tangle(substeps=2), 40))


def test_a_body_moves_the_same_alone_or_among_others():
    alone = scenes.rope(12, 100.0).world()
    among = scenes.rope(12, 100.0).world()
    first = among.add_particles(["b.0", "b.1"], [(0.0, 1.0), (1.0, 1.0)], velocity=[(5.0, 0.0), (0.0, 7.0)])
    among.add_springs(["b:0"], [first], [first + 1], stiffness=0.3, damping=0.1)
    for _ in range(60):
        step(alone)
        step(among)
        assert np.array_equal(alone.position, among.position[:13])


def test_a_free_body_keeps_its_momentum():
    graphs = energy_gate.random_graphs("any Cs, Cd", 1.0, 1, seed=11)
    world = graphs.world
    for pinned in np.flatnonzero(world.inverse_mass == 0.0):
        world.unpin(pinned)
    before = (world.mass[:, None] * world.velocity).sum(axis=0)
    scale = np.abs(world.mass[:, None] * world.velocity).sum()
    for _ in range(50):
        # Braking, the last resort, would not keep it.
        step(world)
        after = (world.mass[:, None] * world.velocity).sum(axis=0)
        assert np.abs(after - before).max() <= 1e-9 * scale


def test_pinned_particles_never_move_and_springs_between_them_do_nothing():
    world = scenes.bridge(6, 10.0).world()
    pinned = np.flatnonzero(world.inverse_mass == 0.0)
    world.add_springs(["between"], [pinned[0]], [pinned[1]], rest_length=9.0)
    placed = world.position[pinned].copy()
    run(world, 60)
    assert np.array_equal(world.position[pinned], placed)
    assert np.isfinite(world.position).all()


def test_a_spring_of_no_length_draws_its_ends_together():
    world = World(WorldSettings(solver="direct", gravity=(0.0, 0.0)))
    world.add_particles(["a", "b", "c"], [(0.0, 0.0), (1.0, 0.5), (1.0, 0.5)])
    world.add_springs(["s", "t"], [0, 1], [1, 2], rest_length=0.0, stiffness=0.5, damping=1.0)
    run(world, 60)
    # Nearer than this the spin that rounding has given it, which it keeps, holds them apart.
    assert np.abs(world.position - world.position[0]).max() < 1e-8


def test_a_hand_lifts_a_heavy_rope_as_readily_as_a_light_one():
    heights = []
    for mass in (1.0, 2.0**20):
        world = scenes.rope(10).world()
        world.mass[:] = mass
        world.unpin(0)
        world.change("inverse_mass", 1.0 / mass)
        world.hold(0, 5, (0.5, 1.0))
        run(world, 120)
        heights.append(world.position[5, 1])
    assert heights[1] == heights[0]
    assert heights[0] == pytest.approx(1.0, abs=0.2)


def energy(world: World) -> float:
    """Kinetic energy and that of springs [J]."""
    return kinetic_energy(world) + spring_energy(world)


def right_after_impulses(world: World, places: np.ndarray, h: float) -> np.ndarray:
    """Velocities (n, 2) right after the impulses of a step that began at these places (n, 2).

    A step goes along a chord. Where it begins, what turns has the velocity of its arc, farther out by (1 - cos) r / h.
    """
    free = world.inverse_mass > 0.0
    mass, chords = (world.mass * free)[:, None], (world.position - places) / h
    total = np.sum(mass)

    def about_centre(vectors: np.ndarray) -> np.ndarray:
        return vectors - np.sum(mass * vectors, axis=0) / total

    begin, end, turning = about_centre(places), about_centre(world.position), about_centre(chords)
    spin = np.sum(mass[:, 0] * (begin[:, 0] * turning[:, 1] - begin[:, 1] * turning[:, 0]))
    sine = h * spin / np.sum(mass * end**2)
    return chords + (1.0 - np.sqrt(1.0 - sine * sine)) / h * begin


@pytest.mark.parametrize(("stiffness", "damping", "bound"), [(1.0, 1.0, 1.0), (0.3, 0.4, 1.0), (0.9, 0.1, 4.0)])
@pytest.mark.parametrize("radius", [0.0, 5.0])
def test_a_dragged_body_gains_at_most_the_work_that_hand_and_gravity_do(stiffness, damping, bound, radius):
    world = scenes.lattice(4, hung=False).world(stiffness=stiffness, damping=damping, substeps=1)
    world.reserve_grabs()
    generator = np.random.default_rng(4)
    world.hold(0, 5, (0.2, 0.2), radius=radius)
    free, h = np.flatnonzero(world.inverse_mass > 0.0), 1.0 / world.settings.tick_rate
    allowed = energy(world)
    for _ in range(300):
        world.move_grab(0, tuple(world.position[world.grab_particle] + generator.uniform(-0.3, 0.3, 2)))
        before, places = world.velocity.copy(), world.position.copy()
        step(world)
        mean = 0.5 * (before + world.velocity)
        work = h * np.sum(world.mass[free, None] * mean[free] * world.settings.gravity)
        mean = 0.5 * (before + right_after_impulses(world, places, h))
        rows = block_of(world).arrays.joints.rows
        for row in range(2):
            entries = slice(rows.first[row], rows.first[row + 1])
            work += rows.impulse[row] * np.sum(rows.gradient[entries] * mean[rows.particle[entries]])
        # Where energy may swing beyond the work, only work that adds to it counts.
        allowed += work if bound == 1.0 else max(0.0, work)
        assert energy(world) <= bound * allowed * (1.0 + 1e-9) + 1e-9


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf, 1e308, -1e308, 1e200])
@pytest.mark.parametrize("array", ["position", "velocity", "mass", "rest_length", "stiffness", "damping", "tension"])
def test_an_absurd_value_neither_hangs_nor_leaves_its_body(array, value):
    sound, world = tangle(), tangle()
    with np.errstate(all="ignore"):
        getattr(world, array).flat[4] = value
        for _ in range(5):
            step(world)
            step(sound)
    # The rope holds slot 4 of every array; the block of nine hangs on it by the Hooke spring alone, so that goes.
    others = slice(14, 22)
    if array in ("mass", "stiffness", "damping", "tension"):
        assert np.isfinite(world.position[others]).all()


def test_cutting_adding_and_pinning_while_it_runs_change_the_matrix():
    world = scenes.lattice(4).world()
    world.reserve_grabs()
    run(world, 5)
    world.cut(range(world.grab_spring))
    height = world.position[0, 1]
    run(world, 30)
    # Cut loose, it falls freely.
    assert world.position[0, 1] == pytest.approx(
        height + 30 * world.velocity[0, 1] / 60.0 + 9.81 * 435 / 3600, rel=1e-9
    )
    world.add_springs(["new"], [12], [0], stiffness=1.0, damping=1.0)
    run(world, 240)
    distance = np.sqrt(np.sum((world.position[0] - world.position[12]) ** 2))
    assert distance == pytest.approx(world.rest_length[-1], rel=1e-4)


@pytest.mark.parametrize("solver", ["single_pass", "iterative"])
def test_the_slow_velocity_begins_anew_with_the_solver(solver):
    world = scenes.rope(5).world()
    run(world, 20)
    world.settings = WorldSettings(solver=solver)
    assert np.array_equal(world.slow_velocity, world.velocity)
    assert (world.energy_bank < 0.0).all()


def test_the_stability_report_says_what_the_energy_test_proves():
    world = scenes.rope(5).world(stiffness=0.9, damping=0.9)
    assert report(world).within_limit is True
    assert coefficient_limits(world).stiffness == coefficient_limits(world).damping == 1.0
    assert "never exceeds the start" in report(world).text
    world.set_coefficients(0.9, 0.1, None)
    assert "four times the start" in report(world).text
    assert "p:0" in coefficient_limits(world).reason


def test_a_matrix_too_large_for_its_table_of_updates_gives_the_same_bits(monkeypatch):
    ends = []
    for largest in (sparse_ldl.LARGEST_TABLE, 1):
        monkeypatch.setattr(sparse_ldl, "LARGEST_TABLE", largest)
        ends.append(state_hash(run(scenes.lattice(6).world(), 10)))
    assert ends[0] == ends[1]


def test_the_factor_solves_what_a_dense_solver_solves():
    world = energy_gate.random_graphs("any Cs, Cd", 1.0, 3, seed=5).world
    run(world, 1)
    made = block_of(world).arrays.system
    matrix, rows, springs, bodies = made.matrix, made.rows, made.springs, made.bodies
    assert sorted(rows.particle.tolist()) == sorted(set(world.particle_a.tolist()) | set(world.particle_b.tolist()))
    count = len(matrix.diagonal)
    # L and D of the last step, put together again, are the matrix of the springs as they were linearised then.
    factor, middle = np.eye(2 * count), np.zeros(2 * count)
    for j in range(count):
        middle[2 * j : 2 * j + 2] = 1.0 / matrix.diagonal[j, [0, 2]]
        factor[2 * j + 1, 2 * j] = matrix.diagonal[j, 1]
        for at in range(matrix.column_start[j], matrix.column_start[j + 1]):
            i = matrix.row[at]
            factor[2 * i : 2 * i + 2, 2 * j : 2 * j + 2] = matrix.lower[at].reshape(2, 2)
    dense = np.diag(np.repeat(rows.mass[:count], 2))
    for k in range(bodies.spring_start[-1]):
        normal, transverse = springs.normal[k], springs.transverse[k]
        block = transverse * np.eye(2) + (springs.K[k] - transverse) * np.outer(normal, normal)
        ends = [2 * r for r in (springs.row_a[k], springs.row_b[k]) if r < count]
        for one in ends:
            for other in ends:
                dense[one : one + 2, other : other + 2] += block if one == other else -block
    # Columns of two scalars are stored after the elimination of the first from the second.
    assert np.allclose(factor * middle @ factor.T, dense, rtol=1e-9, atol=1e-9 * np.abs(dense).max())
