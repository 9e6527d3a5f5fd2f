"""Firmness: a body is as soft as it says, whatever its grid, size, mass, form and substeps."""

import math
import random
from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal, localcontext

import numpy as np
import pytest

from sandbox.physics.equation import of_body, of_springs
from sandbox.physics.geometry.elementary import (
    arc_cosine,
    cosine,
    exponential,
    logarithm,
    logarithm_beside_one,
    rounded,
    to_three_digits,
)
from sandbox.physics.jit import COMPILED
from sandbox.physics.keeping.equipment import Firmness, StiffForm
from sandbox.physics.settings import AUTO
from sandbox.physics.snapshot import state_hash
from sandbox.physics.softness.firmness import WORDS, FirmnessRange, OutOfReach, lowest_mode_of
from sandbox.physics.softness.kernels.reach import BY_SAG, least_ratio
from sandbox.physics.step import step
from tests.abuse import sag as table
from tests.support.wobbles import firm_world, height, measured_wobble, slowest_mode, standing_box

SLOW = pytest.mark.skipif(not COMPILED, reason="takes too long with interpreted kernels")
TICK = 1.0 / 60.0
BODIES = {
    "small box": {"shape": {"box": [0.5, 0.5]}, "spacing": 0.125},
    "fine box": {"shape": {"box": [1, 1]}, "spacing": 0.0625, "particle_mass": 1e-3},
    "large box": {"shape": {"box": [5, 5]}, "spacing": 0.625, "particle_mass": 1e4},
    "beam": {"shape": {"box": [6, 1]}, "spacing": 0.25},
    "disc": {"shape": {"circle": 1}, "spacing": 0.25},
    "L": {"shape": {"polygon": [[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]]}, "spacing": 0.25},
    "no areas": {"shape": {"box": [1, 1]}, "spacing": 0.25, "area": False},
    "wheel": {"type": "wheel", "radius": 0.5, "thickness": 0.125, "segments": 16, "hub_mass": 7.0},
    "girder": {"type": "girder", "start": [0, 0], "end": [4, 1], "segments": 6, "height": 0.5},
    "bridge": {"type": "bridge", "start": [0, 0], "end": [4, 0], "segments": 6, "height": 0.5},
    "stiff rope": {"type": "rope", "start": [0, 0], "end": [2, 0], "segments": 8, "bending": {}},
}


def test_shares_of_a_body_are_those_of_its_springs_and_back():
    generator = np.random.default_rng(1)
    for _ in range(2_000):
        mode = 10.0 ** generator.uniform(-5, 0.6)
        damping = generator.uniform(0.0, 1.0)
        stiffness = damping * generator.uniform(0.0, 1.0)
        shared = of_springs(stiffness, damping, mode)
        assert 0.0 <= shared[0] <= shared[1] <= 1.0
        assert of_body(*shared, mode) == pytest.approx((stiffness, damping), abs=1e-10)


@pytest.mark.parametrize("cells", [4, 8, 16])
def test_the_lowest_mode_of_a_square_falls_with_the_square_of_its_cells(cells):
    form = firm_world({"sag": 0.1}, shape={"box": [1, 1]}, spacing=1 / cells).forms[0].shape
    assert lowest_mode_of(form) == pytest.approx(4.95 / (cells + 1) ** 2, rel=0.022)


@pytest.mark.parametrize("name", BODIES)
def test_the_lowest_mode_is_the_lowest_eigenvalue_of_the_whole_matrix(name):
    world = firm_world({"hz": 1.0}, **BODIES[name])
    assert lowest_mode_of(world.forms[0].shape) == pytest.approx(slowest_mode(world)[0], rel=2e-4)


def test_the_lowest_mode_depends_on_neither_size_nor_mass():
    forms = [
        firm_world({"hz": 1.0}, shape={"circle": size / 2}, spacing=size / 9, particle_mass=mass).forms[0].shape
        for size in (0.01, 1.0, 100.0)
        for mass in (1e-6, 1.0, 1e6)
    ]
    modes = [lowest_mode_of(form) for form in forms]
    assert modes == pytest.approx([modes[0]] * len(modes), rel=1e-12)


@SLOW
@pytest.mark.parametrize("substeps", [1, 8])
@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.whole_world if name == "fine box" else ()) for name in BODIES]
)
def test_a_body_wobbles_at_the_frequency_and_damping_ratio_that_it_says(name, substeps):
    for hz, ratio in ((1.5, 0.1), (3.0, 0.3)):
        world = firm_world({"hz": hz, "ratio": ratio}, {"substeps": substeps}, **BODIES[name])
        assert measured_wobble(world) == pytest.approx((hz, ratio), rel=2e-3)


@SLOW
@pytest.mark.parametrize("size", [0.5, 5.0])
@pytest.mark.parametrize("cells", [4, 16])
def test_a_box_of_any_size_and_grid_sags_by_the_part_of_its_height_that_it_says(size, cells):
    heights = []
    for sag in (0.02, 0.1):
        world = standing_box(size, cells, {"sag": sag})
        for _ in range(240):
            step(world)
        heights.append(height(world) / size)
    assert heights == pytest.approx([0.98, 0.9], abs=0.02)


@SLOW
def test_a_sample_of_the_table_of_jellies_is_as_asked():
    jellies = [(size, cells) for size in table.SIZES for cells in (4, 8)]
    found = list(table.rows(random.Random(table.SEED).sample(jellies, 3)))
    assert table.faults(found) == []


@SLOW
def test_substeps_leave_a_body_as_high_as_it_was():
    heights = []
    for substeps in (1, 8, AUTO):
        world = standing_box(1.0, 8, {"sag": 0.1}, settings={"substeps": substeps})
        for _ in range(240):
            step(world)
        heights.append(height(world))
    assert heights == pytest.approx([heights[0]] * 3, abs=0.01)


def test_what_is_asked_is_refused_with_the_nearest_that_can_be_had():
    reach = FirmnessRange(0.06, 1.0, 9.81, TICK)
    for asked in (
        Firmness(hz=10.0, ratio=0.15), Firmness(hz=900.0, ratio=0.2), Firmness(sag=1e-9), Firmness(hz=500.0, ratio=1.0)
    ):  # fmt: skip
        with pytest.raises(OutOfReach, match="out of reach at 60 ticks a second; the nearest is") as refused:
            reach.coefficients(asked)
        nearest = refused.value.nearest
        stiffness, damping = reach.coefficients(nearest)
        assert stiffness <= damping
        assert reach.nearest(asked) == nearest
        assert reach.nearest(nearest) == nearest
    with pytest.raises(OutOfReach, match="no height"):
        FirmnessRange(0.06, 0.0, 9.81, TICK).coefficients(Firmness(sag=0.1))


@pytest.mark.parametrize(
    ("ratio", "highest"), [(0.05, 0.96), (0.1, 1.92), (0.2, 3.87), (0.3, 5.92), (0.5, 10.6), (0.7, 17.2)]
)
def test_the_least_damping_ratio_is_that_at_which_nothing_gains_energy(ratio, highest):
    assert least_ratio(0.99 * highest, TICK) <= ratio + 1e-3
    assert least_ratio(1.01 * highest, TICK) >= ratio
    assert least_ratio(2 * 0.99 * highest, TICK / 2) <= ratio + 1e-3


@pytest.mark.parametrize("hz", [0.3, 2.3, 12.0])
def test_the_reading_of_a_body_is_what_was_asked_of_it(hz):
    reach = FirmnessRange(0.01, 2.0, 9.81, TICK)
    asked = reach.nearest(Firmness(hz=hz, ratio=0.2))
    pair = reach.coefficients(asked)
    assert reach.reading(*pair) == pytest.approx((reach.sag_of(*pair), hz, asked.ratio), rel=1e-6)
    for sag in list(WORDS.values())[:-1]:
        assert reach.reading(*reach.coefficients(Firmness(sag=sag)))[0] == pytest.approx(sag, rel=1e-6)


def lowest_mode(points, pairs):
    """The lowest mode of particles of 1 kg at these points and springs of these pairs."""
    none = np.zeros((0, 3), dtype=np.int64)
    ends = np.array(pairs, dtype=np.int64).reshape(-1, 2)
    return lowest_mode_of(StiffForm(np.array(points, dtype=np.float64), np.ones(len(points)), ends, none, none))


def test_a_form_that_gives_way_or_falls_apart_has_no_mode():
    square, sides = [(0, 0), (1, 0), (1, 1), (0, 1)], [(0, 1), (1, 2), (2, 3), (3, 0)]
    assert lowest_mode(square, sides) == 0.0
    assert lowest_mode(square, [*sides, (0, 2)]) > 0.1
    assert lowest_mode(square, [(0, 1), (2, 3)]) == 0.0
    assert lowest_mode([(0, 0), (1, 0), (2, 0)], [(0, 1), (1, 2)]) == 0.0
    assert lowest_mode([(0, 0)] * 3, [(0, 1), (1, 2)]) == 0.0
    assert lowest_mode([(0, 0)], []) == 0.0


def test_the_exponential_and_the_cosine_are_the_nearest_numbers_and_what_is_rounded_is_as_decimals_are():
    generator = random.Random(1)
    for _ in range(300):
        power, angle = -(10.0 ** generator.uniform(-6, 2.8)), generator.uniform(0.0, math.pi)
        with localcontext(prec=60):
            series, term, square = Decimal(0), Decimal(1), Decimal(angle) ** 2
            for k in range(1, 80, 2):
                series, term = series + term, -term * square / (k * (k + 1))
            assert exponential(power) == float(Decimal(power).exp())
            assert cosine(angle) == float(series)
        value = generator.choice([generator.random(), generator.randrange(1 << 14) / (1 << 14)])
        assert rounded(value, 1e13) == round(value, 13)
        value = generator.choice([10.0 ** generator.uniform(-9, 5), round(generator.random(), 3), 1e-6, 0.15])
        for is_up, way in ((True, ROUND_CEILING), (False, ROUND_FLOOR)):
            assert to_three_digits(value, is_up) == float(Context(prec=3, rounding=way).create_decimal(value))
    assert (exponential(0.0), exponential(-1e9), exponential(-math.inf), cosine(0.0)) == (1.0, 0.0, 0.0, 1.0)


def test_logarithms_and_arc_cosines_are_those_of_a_good_library_but_for_last_bits():
    generator = random.Random(2)
    for _ in range(3000):
        value, small = 10.0 ** generator.uniform(-300, 300), 10.0 ** generator.uniform(-15, 0.5)
        angle = generator.uniform(0.0, math.pi)
        assert logarithm(value) == pytest.approx(math.log(value), rel=1e-15)
        assert logarithm_beside_one(small) == pytest.approx(math.log1p(small), rel=1e-15)
        assert logarithm_beside_one(-0.3 * small) == pytest.approx(math.log1p(-0.3 * small), rel=1e-15)
        assert arc_cosine(math.cos(angle)) == pytest.approx(math.acos(math.cos(angle)), rel=1e-15)
    assert (logarithm(1.0), logarithm_beside_one(0.0)) == (0.0, 0.0)
    assert (arc_cosine(1.0), arc_cosine(-1.0)) == (0.0, math.pi)


def test_numbers_that_are_no_body_are_refused_and_nothing_is_changed():
    world = firm_world({"sag": 0.1}, **BODIES["disc"])
    before, given = state_hash(world), {"way": BY_SAG, "value": 0.2, "second": 0.0, "gravity": (0.0, -9.81)}
    for body, is_whole in ((1, False), (1, True), (-1, False), (10**12, False)):
        with pytest.raises(IndexError, match=f"body {body}: there is none"):
            world.command("soften", body=body, whole=is_whole, **given)
    assert state_hash(world) == before
