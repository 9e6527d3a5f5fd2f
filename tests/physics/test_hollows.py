"""Discs in hollows of short chords: nothing gains there, and corners take what an impact without a bounce takes."""

import math

import numpy as np
import pytest

from sandbox.physics.jit import COMPILED
from sandbox.physics.marks import LINE
from sandbox.physics.solvers import SOLVERS
from sandbox.physics.solvers.contact.free_constraints import small_steps
from sandbox.physics.step import step
from sandbox.physics.terrain import Chain
from tests.support.contact_scenes import ALL_GROUPS, BODIES, add_discs, world
from tests.support.physics_scenes import scaled

GRAVITY = 9.81


def arc(radius, chords, share=1.0):
    """The corners of a round bowl, whose lowest place is at 0; share: how much of a half circle."""
    half = 0.5 * math.pi * share
    angles = [-half + 2.0 * half * k / chords for k in range(chords + 1)]
    return np.array([(radius * math.sin(a), radius - radius * math.cos(a)) for a in angles])


def on_chord(corners, k, radius):
    """Where a disc lies on the middle of a chord, and its inner normal."""
    a, b = corners[k], corners[k + 1]
    along = (b - a) / math.hypot(*(b - a))
    return 0.5 * (a + b) + radius * np.array([-along[1], along[0]])


def energy(w, slot):
    """Energy [J] of a disc; symplectic Euler knows its height to within g h v/2."""
    v, spin = w.velocity[slot], w.radius[slot] * w.spin[slot]
    h = 1.0 / (w.settings.tick_rate * w.settings.substeps)
    late = 0.5 * GRAVITY * h / small_steps(h) * v[1]
    return w.mass[slot] * (0.5 * (v @ v) + 0.25 * spin * spin + GRAVITY * w.position[slot, 1] - late)


def kept(w, slot, seconds, lowest):
    """The largest energy and the last, by that at the start; lowest [m]: the height at which it has none."""
    begun = energy(w, slot) - w.mass[slot] * GRAVITY * lowest
    most = last = 0.0
    for _ in range(round(seconds * w.settings.tick_rate)):
        step(w)
        last = (energy(w, slot) - w.mass[slot] * GRAVITY * lowest) / begun
        most = max(most, last)
    return most, last


def in_bowl(radius, chords, disc, degrees, seconds, friction=0.5, rolls=True, **settings):
    corners = arc(radius, chords)
    w = world(Chain(corners, friction=friction), **settings)
    k = round(chords * (0.5 - degrees / 180.0))
    slot = add_discs(w, on_chord(corners, k, disc), radius=disc, friction=friction, rolling=0.0, rolls=rolls)
    return kept(w, slot, seconds, disc)


def after_plastic_corners(radius, chords, disc, degrees, seconds, inertia):
    """The share of its energy that a disc keeps which loses at each corner what an impact without a bounce takes."""
    turn = math.pi / chords
    inner = radius * math.cos(0.5 * turn) - disc
    length, middle = 2.0 * inner * math.tan(0.5 * turn), lambda k: turn * (k + 0.5) - 0.5 * math.pi
    k, s, v, t = round(chords * (0.5 - degrees / 180.0)), 0.0, 0.0, 0.0
    height = lambda: s * math.sin(middle(k)) - inner * math.cos(middle(k)) + inner  # noqa: E731
    begun = GRAVITY * height()
    while t < seconds:
        pull = -GRAVITY * math.sin(middle(k)) / (1.0 + inertia)
        ends = []
        for end in (-0.5 * length, 0.5 * length):
            inside = v * v + 2.0 * pull * (end - s)
            if inside >= 0.0:
                ends += [((sign * math.sqrt(inside) - v) / pull, end) for sign in (-1.0, 1.0)]
        wait, end = min(e for e in ends if e[0] > 1e-9)
        t, v = t + wait, (v + pull * wait) * (math.cos(turn) + inertia) / (1.0 + inertia)
        k, s = (k + 1, -end) if end > 0.0 else (k - 1, -end)
    return (0.5 * (1.0 + inertia) * v * v + GRAVITY * height()) / begun


BOWLS = [(2.4, 200, 0.15, 25.0), (1.1, 400, 0.2, 15.0), (4.0, 300, 0.3, 4.0), (0.8, 40, 0.1, 60.0)]


@pytest.mark.parametrize("rate, substeps", [(30, 1), (60, 1), (60, 4), (120, 2), (240, 1)])
@pytest.mark.parametrize("bowl", BOWLS)
def test_a_disc_in_a_bowl_gains_nothing_at_any_rate(bowl, rate, substeps):
    most, _ = in_bowl(*bowl, scaled(30, 1), tick_rate=rate, substeps=substeps)
    assert most <= 1.0 + 1e-6


@pytest.mark.parametrize("friction, rolls", [(0.0, True), (0.2, True), (1.0, True), (0.02, False)])
def test_a_disc_in_a_bowl_gains_nothing_with_any_friction(friction, rolls):
    most, _ = in_bowl(1.7, 300, 0.12, 30.0, scaled(30, 1), friction=friction, rolls=rolls)
    assert most <= 1.0 + 1e-6


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_disc_in_a_bowl_moves_the_same_in_every_solver(solver):
    found = in_bowl(1.4, 150, 0.1, 40.0, 3.0, solver=solver)
    assert found == in_bowl(1.4, 150, 0.1, 40.0, 3.0)


@pytest.mark.skipif(not COMPILED, reason="interpreted kernels take minutes")
@pytest.mark.parametrize("rate", [30, 60, 240])
@pytest.mark.parametrize("bowl", [(3.0, 256, 0.2, 20.0), (2.4, 200, 0.15, 25.0), (2.0, 64, 0.2, 30.0)])
def test_a_disc_in_a_bowl_keeps_nearly_what_plastic_corners_leave(bowl, rate):
    _, left = in_bowl(*bowl, 30.0, tick_rate=rate)
    assert left == pytest.approx(after_plastic_corners(*bowl, 30.0, 0.5), rel=0.08)


@pytest.mark.parametrize("rate", [30, 60])
@pytest.mark.parametrize("degrees", [1.5, 4.0, 9.0, 17.0])
def test_a_disc_in_a_valley_gains_nothing(degrees, rate):
    slope = math.tan(math.radians(degrees))
    w = world(Chain([(-9.0, 9.0 * slope), (0.0, 0.0), (9.0, 9.0 * slope)], friction=0.5), tick_rate=rate)
    across = np.array([math.sin(math.radians(degrees)), math.cos(math.radians(degrees))])
    slot = add_discs(w, np.array([-1.1, 1.1 * slope]) + 0.25 * across, radius=0.25, rolling=0.0)
    most, _ = kept(w, slot, scaled(30, 2), 0.25 / across[1])
    assert most <= 1.0 + 1e-6


@pytest.mark.parametrize("chords, speed", [(90, 1.0), (350, 2.5), (350, 7.0)])
def test_a_disc_in_a_round_hole_gains_nothing(chords, speed):
    turn = 2.0 * math.pi / chords
    corners = [(1.3 * math.sin(turn * (k - 0.5)), -1.3 * math.cos(turn * (k - 0.5))) for k in range(chords)]
    w = world(Chain(corners, "hollow"))
    lowest = 0.2 - 1.3 * math.cos(0.5 * turn)
    slot = add_discs(w, [(0.0, lowest)], radius=0.2, velocity=(speed, 0.0), friction=0.0)
    most, _ = kept(w, slot, scaled(20, 1), lowest)
    assert most <= 1.0 + 1e-6
    assert math.hypot(*w.position[slot]) <= 1.11, "it is still in there"


def test_a_bowl_of_separate_pieces_is_one_bowl():
    corners = arc(1.6, 160)
    pieces = world(*[Chain(corners[k : k + 2], friction=0.3) for k in range(160)])
    slot = add_discs(pieces, on_chord(corners, 50, 0.15), radius=0.15, friction=0.3, rolling=0.0)
    most, left = kept(pieces, slot, scaled(20, 1), 0.15)
    assert most <= 1.0 + 1e-6
    assert left == pytest.approx(in_bowl(1.6, 160, 0.15, 90.0 - 50 * 180.0 / 160, scaled(20, 1), 0.3)[1], rel=0.15)


def test_a_disc_in_the_hollow_of_a_pinned_body_gains_nothing():
    corners, w = arc(1.5, 120, 0.7), world()
    first = w.add_particles(
        [f"p{k}" for k in range(121)], corners, radius=0.03, owner=0, friction=0.5, group=BODIES, collides=ALL_GROUPS
    )
    ends = first + np.arange(120)
    w.add_springs([f"s{k}" for k in range(120)], ends, ends + 1, edge=LINE)
    for k in range(121):
        w.pin(first + k)
    slot = add_discs(w, on_chord(corners, 40, 0.23), radius=0.2, rolling=0.0)
    most, _ = kept(w, slot, scaled(30, 1), 0.23)
    assert most <= 1.0 + 1e-6


def test_a_disc_over_more_chords_than_it_looks_at_does_not_sink():
    corners = arc(1.2, 1500)
    w = world(Chain(corners, friction=0.5))
    slot = add_discs(w, on_chord(corners, 700, 0.5), radius=0.5, rolling=0.0)
    for _ in range(scaled(120, 20)):
        step(w)
        x, y = w.position[slot]
        assert math.hypot(x, 1.2 - y) == pytest.approx(0.7, abs=1e-3)
