"""Energy of what touches in the direct solver: it never rises, whatever coefficients, masses, overlaps and speeds."""

import numpy as np
import pytest

from sandbox.physics.analysis.energy import kinetic_energy, total_energy
from sandbox.physics.marks import LINE
from sandbox.physics.step import step
from sandbox.physics.terrain import Chain
from tests.support.closed_boxes import allowed, energy, outside, random_box
from tests.support.contact_scenes import FLOOR, add_discs, add_jelly, world
from tests.support.physics_scenes import run, scaled
from tests.support.wholes import some_and_whole

BIN = Chain(
    [(-3.0, -1.0), (3.0, -1.0), (3.0, 3.0), (2.0, 3.0), (1.5, 0.0), (-1.5, 0.0), (-2.0, 3.0), (-3.0, 3.0)], "solid"
)
# Of jellies: how many, their stiffness and damping.
HEAPS = [(6, 0.05, 0.1), (6, 0.06, 0.12), (7, 0.05, 0.1)]


@pytest.mark.parametrize("seed", range(8))
def test_a_closed_box_of_bodies_never_has_more_energy_than_at_its_start_and_nothing_leaves_it(seed):
    box = random_box(seed, most=scaled(12, 3))
    for _ in range(scaled(120, 6)):
        step(box.world)
        assert energy(box.world) <= allowed(box)
        assert outside(box.world) == 0


@pytest.mark.parametrize(("count", "stiffness", "damping"), some_and_whole(HEAPS[:1], HEAPS))
def test_soft_jellies_that_press_into_each_other_in_a_bin_stay_in_it_and_come_to_rest(count, stiffness, damping):
    w = world(BIN)
    for k in range(scaled(count, 3)):
        add_jelly(
            w, (-0.6 + 1.2 * (k % 2), 0.7 + 1.1 * (k // 2)), size=(0.9, 0.9), angle=0.4 * k, stiffness=stiffness,
            damping=damping,
        )  # fmt: skip
    peak = 0.0
    for _ in range(scaled(720, 12)):
        step(w)
        peak = max(peak, kinetic_energy(w))
        assert w.position[:, 1].min() > 0.0
    assert np.all(np.abs(w.position[:, 0]) < 2.0)
    if scaled(1, 0):
        assert kinetic_energy(w) < 1e-2 * peak


def test_a_ball_that_falls_on_a_jelly_gives_no_more_than_it_had():
    w = world(FLOOR)
    add_jelly(w, (0.0, 0.5), stiffness=0.2, damping=0.9)
    add_discs(w, [(0.1, 2.0)], radius=0.3, mass=100.0, velocity=[(0.0, -15.0)])
    start = total_energy(w)
    highest = 0.0
    for k in range(scaled(180, 30)):
        step(w)
        if k > 60:
            highest = max(highest, float(w.position[:, 1].max()))
        # A step of 1/60 s knows the height of what falls to within half of what it falls in the step.
        assert total_energy(w) <= start + 0.5 / 60.0 * 9.81 * float(np.sum(w.mass * np.abs(w.velocity[:, 1]))) + 1e-6
    assert highest < 5.0


def test_loose_ends_that_nothing_holds_are_not_flung_by_what_lies_on_them():
    w = world(FLOOR)
    first = add_discs(w, [(0.2 * k, 0.12) for k in range(8)], radius=0.06, owner=-500)
    a = first + np.arange(7)
    w.add_springs([f"limp:{k}" for k in range(7)], a, a + 1, stiffness=0.0, damping=0.0, edge=LINE)
    add_discs(w, [(0.35, 0.8), (0.9, 1.2)], radius=0.3, mass=20.0)
    for _ in range(scaled(240, 30)):
        step(w)
        assert np.abs(w.velocity).max() < 8.0
        assert w.position[:, 1].min() > 0.0


def test_what_rests_on_a_line_never_comes_through_it_however_it_is_pressed():
    w = world(FLOOR)
    add_discs(w, [(0.0, 0.001)], radius=0.001, mass=1e-2)
    add_jelly(w, (0.0, 0.6), stiffness=1.0, damping=1.0)
    add_discs(w, [(0.0, 1.6)], radius=0.4, mass=1e4)
    run(w, scaled(180, 20))
    assert w.position[:, 1].min() > 0.0
