"""Stacks: soft boxes stand where a column of their kind in one piece stands, whatever they weigh, and land as set."""

import math

import numpy as np
import pytest

from sandbox.level.kinds.bodies import expansion
from sandbox.level.kinds.jelly import JellyDef
from sandbox.physics.analysis.energy import energy_tests, gravity_energy, kinetic_energy, spring_energy
from sandbox.physics.arrays import Floats
from sandbox.physics.jit import COMPILED
from sandbox.physics.marks import ALL_GROUPS
from sandbox.physics.step import step
from sandbox.physics.world import World
from tests.support.contact_scenes import BODIES, FLOOR, world
from tests.support.physics_scenes import run, scaled
from tests.support.situations import advance, session_of, slots_of

# Of a particle [m], so that boxes are this much apart twice where they touch.
RADIUS = 0.03
GRAVITY = 9.81

compiled = pytest.mark.skipif(not COMPILED, reason="interpreted kernels take minutes")


def _add_box(to: World, x: float, y: float, *, height=0.8, spacing=0.4, mass=1.0, stiffness=1.0, damping=1.0) -> None:
    """A box of jelly, 0.8 m wide, whose particles' discs begin at y; mass: of a particle [kg]."""
    body = JellyDef.model_validate({
        "type": "jelly", "id": "box", "shape": {"box": (0.8, height)}, "position": (x, y + RADIUS + 0.5 * height),
        "spacing": spacing, "mesh": "grid",
    })  # fmt: skip
    made = expansion(body)
    first = to.particle_count
    to.add_particles(
        [f"box.{first + k}" for k in range(len(made.form))], made.form, radius=RADIUS, mass=mass, friction=0.6,
        owner=first, group=BODIES, collides=ALL_GROUPS,
    )  # fmt: skip
    to.add_springs(
        [f"box:{to.spring_count + k}" for k in range(len(made.pairs))], made.pairs[:, 0] + first,
        made.pairs[:, 1] + first, stiffness=stiffness, damping=damping, edge=made.edges,
    )  # fmt: skip


def _stack(count: int, *, gap=0.0, **options) -> World:
    w = world(FLOOR)
    for k in range(count):
        _add_box(w, 0.0, gap + k * (0.8 + 2.0 * RADIUS + gap), **options)
    return w


def _centres(w: World) -> Floats:
    return np.array([w.position[w.owner == k].mean(axis=0) for k in np.unique(w.owner)])


def _energy(w: World) -> float:
    return kinetic_energy(w) + gravity_energy(w) + spring_energy(w)


def _sways(stiffness: float, damping: float, spacing: float, height: float) -> bool:
    """Whether a column in one piece goes on where it is pushed aside at 1 cm/s."""
    w = world(FLOOR)
    _add_box(w, 0.0, 0.0, height=height, spacing=spacing, stiffness=stiffness, damping=damping)
    top = w.position[:, 1] > w.position[:, 1].max() - 0.01
    w.velocity[w.position[:, 1] > 0.2, 0] = 0.01
    run(w, 900)
    return abs(float(w.position[top, 0].mean())) > 0.3


@compiled
@pytest.mark.parametrize(
    "stiffness,damping,spacing", [(0.9995, 0.9999, 0.4), (0.99, 0.998, 0.8), (0.95, 0.995, 0.4), (0.9, 0.98, 0.2)]
)
def test_jelly_boxes_stand_on_each_other_where_a_column_in_one_piece_stands(stiffness, damping, spacing):
    assert not _sways(stiffness, damping, spacing, 7 * (0.8 + 2.0 * RADIUS))
    w = _stack(7, gap=0.02, stiffness=stiffness, damping=damping, spacing=spacing)
    run(w, 600)
    settled = _centres(w)
    run(w, 900)
    assert np.hypot(*(_centres(w) - settled).T).max() < 1e-3
    assert np.abs(settled[:, 0]).max() < 0.05


@compiled
def test_a_column_too_high_for_what_it_is_made_of_sways_off_in_one_piece_as_it_does_in_boxes():
    # Higher than (7.84 E I / q)^(1/3).
    assert _sways(0.2, 0.8, 0.4, 7 * (0.8 + 2.0 * RADIUS))
    w = _stack(7, stiffness=0.2, damping=0.8)
    run(w, 900)
    assert np.abs(_centres(w)[:, 0]).max() > 0.3


@compiled
@pytest.mark.parametrize("across", [3, 5])
@pytest.mark.parametrize("order", ["heavy below", "heavy above", "by turns"])
def test_a_column_of_unlike_masses_stands_in_any_order(across, order):
    w = world(FLOOR)
    for k in range(6):
        heavy = {"heavy below": k < 3, "heavy above": k >= 3, "by turns": k % 2 == 1}[order]
        mass = (100.0 if heavy else 1.0) / across**2
        _add_box(w, 0.0, k * (0.8 + 2.0 * RADIUS), spacing=0.8 / (across - 1), mass=mass)
    set_up = _centres(w)
    run(w, 300)
    settled = _centres(w)
    # Contacts of a light box that carries 300 times its weight give way by 3 mm each.
    assert np.abs(settled[:, 0] - set_up[:, 0]).max() < 1e-3
    assert np.abs(settled[:, 1] - set_up[:, 1]).max() < 0.02 * set_up[-1, 1]
    run(w, 600)
    assert np.hypot(*(_centres(w) - settled).T).max() < 1e-3


@compiled
@pytest.mark.parametrize("count,across", [(16, 4), (24, 3), (18, 5)])
def test_a_high_tower_of_rigid_boxes_stands(count, across):
    w = _stack(count, spacing=0.8 / (across - 1))
    set_up = _centres(w)
    run(w, 300)
    settled = _centres(w)
    assert np.hypot(*(settled - set_up).T).max() < 5e-3
    run(w, 600)
    assert np.hypot(*(_centres(w) - settled).T).max() < 1e-3


def _pyramid(rows: int, gap: float) -> World:
    w = world(FLOOR)
    for k in range(rows):
        for i in range(rows - k):
            _add_box(w, (i - 0.5 * (rows - k - 1)) * 0.93, gap + k * (0.8 + 2.0 * RADIUS + gap), spacing=0.8)
    return w


@compiled
@pytest.mark.parametrize("gap", [0.0, 0.05])
def test_the_top_of_a_pyramid_is_where_addition_says_set_or_dropped(gap):
    rows = 13
    w = _pyramid(rows, gap)
    run(w, 480)
    centres = _centres(w)
    belongs = (rows - 0.5) * (0.8 + 2.0 * RADIUS)
    assert centres[-1, 1] == pytest.approx(belongs, rel=5e-4)
    run(w, 120)
    assert np.hypot(*(_centres(w) - centres).T).max() < 1e-3


@compiled
@pytest.mark.parametrize("speed", [2.0, 4.5])
def test_what_falls_on_another_that_falls_stops_on_it_not_in_it(speed):
    # The lower one is stopped within a step in which the upper one comes nearer by v h than it was.
    w = world(FLOOR)
    _add_box(w, 0.0, 0.4 * speed / 60.0, spacing=0.8)
    _add_box(w, 0.1, 0.8 + 2.0 * RADIUS + 0.6 * speed / 60.0, spacing=0.8)
    w.velocity[:, 1] = -speed
    lowest = math.inf
    for _ in range(30):
        step(w)
        below, above = (w.position[w.owner == k, 1] for k in np.unique(w.owner))
        lowest = min(lowest, above.min() - below.max() - 2.0 * RADIUS)
    assert lowest > -2e-3


@compiled
@pytest.mark.parametrize("every", [1.0, 1.02, 1.1])
@pytest.mark.parametrize("spacing", [0.25, 0.5])
@pytest.mark.parametrize("coefficients", [(1.0, 1.0), (0.99, 0.999), (0.5, 1.0)])
def test_boxes_that_are_placed_edge_to_edge_stand_as_those_with_gaps_do(coefficients, spacing, every):
    # Placed by a grid of 1 m they overlap by their radius, and rise as they come apart.
    boxes = [
        {
            "type": "jelly",
            "id": f"b{k}",
            "shape": {"box": [1.0, 1.0]},
            "spacing": spacing,
            "position": [0, 0.5 + every * k],
        }
        | {"material": "m"}
        for k in range(8)
    ]
    session = session_of(
        bodies=boxes, materials={"m": dict(zip(("stiffness", "damping"), coefficients, strict=True))},
        terrain=[{"id": "ground", "polyline": [[-50, 0], [50, 0]]}], contacts={},
    )  # fmt: skip
    world = advance(session, 1200).world
    centres = np.array([world.position[slots_of(session, f"b{k}")].mean(axis=0) for k in range(8)])
    assert np.abs(centres[:, 0]).max() < 0.1
    assert (np.diff(centres[:, 1]) > 0.95).all()
    assert np.abs(world.velocity).max() < 1e-3


def test_a_stack_that_settles_passes_nearly_all_its_energy_tests_and_gains_nothing():
    w = _stack(scaled(5, 2), gap=0.01, spacing=0.4, stiffness=0.9, damping=0.98)
    start = _energy(w)
    for _ in range(scaled(600, 12)):
        step(w)
        # What rises at v has its height to within h v / 2.
        rising = 0.5 / 60.0 * GRAVITY * float(np.sum(w.mass * np.maximum(0.0, w.velocity[:, 1])))
        assert _energy(w) <= start + rising + 1e-9 * abs(start)
    tests = energy_tests(w)
    assert tests.minimised + tests.slowed_down <= 0.005 * tests.passed


def test_what_was_lent_to_what_sinks_on_its_springs_is_paid_back():
    w = _stack(scaled(4, 2), stiffness=0.95, damping=0.97)
    most = 0.25 * (GRAVITY / 60.0) ** 2 * float(w.mass.sum())
    overdrawn = 0.0
    for _ in range(scaled(600, 20)):
        step(w)
        overdrawn = max(overdrawn, -float(np.minimum(w.parting_reserve, 0.0).sum()))
        assert overdrawn <= most
    if scaled(1, 0):
        assert overdrawn > 0.0
        assert w.parting_reserve.min() > -1e-3 * overdrawn
