"""The equation, its coefficients and their two readings; claims of Nissen 2019 first."""

import math
import re

import numpy as np
import pytest

from sandbox.physics.equation import (
    HIGHEST_COEFFICIENT,
    at_other_step,
    coefficients_from_frequency,
    direction,
    frequency_from_coefficients,
    half_step,
    highest_frequency,
    implicit_masses,
    part_of_network,
    reduced_mass,
    spring_impulse,
)
from sandbox.physics.step import step
from tests.support.physics_scenes import network, scaled
from tests.support.wholes import part_and_whole

DIGITS = 2.2e-16


def random_coefficients(count):
    """Pairs anywhere in 0..1, equal pairs, tiny pairs and the corners."""
    generator = np.random.default_rng(3)
    pairs = [(1.0, 1.0), (0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (0.5, 0.0), (1e-5, 1e-5), (5e-324, 1.0)]
    for _ in range(count):
        one, other = generator.random(2)
        tiny = 10.0 ** generator.uniform(-17.0, 0.0)
        pairs += [(one, other), (one, one), (one, 0.0), (tiny * other, tiny), (one, 1.0)]
    return [(float(stiffness), float(damping)) for stiffness, damping in pairs]


def test_two_pinned_particles_have_no_reduced_mass():
    assert reduced_mass(0.0, 0.0) == 0.0
    assert reduced_mass(0.0, 0.5) == 2.0
    assert reduced_mass(1.0, 1.0) == 0.5


def test_the_impulse_opposes_stretch_and_separation():
    assert spring_impulse(0.5, 0.25, 0.1, 2.0, 3.0, 0.01) == pytest.approx(-(0.5 * 0.1 / 0.01 + 0.25 * 2.0) * 3.0)
    assert spring_impulse(1.0, 1.0, -0.1, 0.0, 1.0, 0.01) > 0.0


def test_coincident_particles_take_the_direction_in_which_they_separate():
    assert direction(3.0, 4.0, 9.0, 9.0) == (0.6, 0.8, 5.0)
    assert direction(0.0, 0.0, 0.0, -2.0) == (0.0, -1.0, 0.0)
    assert direction(0.0, 0.0, 0.0, 0.0) == (1.0, 0.0, 0.0)


def test_separations_whose_squares_underflow_still_give_a_unit_vector():
    for dx, dy in [(1e-160, 0.0), (5e-324, 5e-324), (1e-154, 1e-154), (0.0, 1e-149)]:
        nx, ny, length = direction(dx, dy, 0.0, 0.0)
        assert math.hypot(nx, ny) == pytest.approx(1.0, abs=1e-7)
        assert 0.0 <= length < 1e-140


def test_the_halving_map_stays_within_0_and_1_and_keeps_cs_at_most_cd():
    for stiffness, damping in random_coefficients(scaled(4000, 500)):
        half = half_step(stiffness, damping)
        assert 0.0 <= half[0] <= 1.0 and 0.0 <= half[1] <= 1.0
        if stiffness <= damping:
            assert half[0] <= half[1]


def test_the_halving_map_keeps_complete_rigidity_and_no_spring_at_all():
    assert half_step(1.0, 1.0) == (1.0, 1.0)
    assert half_step(0.0, 0.0) == (0.0, 0.0)


def test_two_half_steps_have_the_eigenvalues_of_the_whole_step():
    for stiffness, damping in random_coefficients(scaled(4000, 500)):
        half_stiffness, half_damping = half_step(stiffness, damping)
        trace, product = 2.0 - half_stiffness - half_damping, 1.0 - half_damping
        assert product * product == pytest.approx(1.0 - damping, abs=8.0 * DIGITS)
        assert trace * trace - 2.0 * product == pytest.approx(2.0 - stiffness - damping, abs=16.0 * DIGITS)


def test_the_halving_map_keeps_every_digit_of_small_coefficients():
    half_stiffness, half_damping = half_step(1e-12, 1e-12)
    assert half_stiffness == pytest.approx(0.25e-12, rel=1e-11)
    assert half_damping == pytest.approx(0.5e-12, rel=1e-11)


@pytest.mark.parametrize("parts", [2, 4, 8])
def test_parts_that_a_tick_chooses_keep_the_constant_of_a_spring_and_damp_no_less(parts):
    for stiffness, damping in random_coefficients(scaled(4000, 500)):
        part = part_of_network(stiffness, damping, 0.0, parts)
        whole = implicit_masses(stiffness, damping, 1.0)[1]
        assert 0.0 <= part[0] <= 1.0 and 0.0 <= part[1] <= 1.0
        assert implicit_masses(*part, 1.0)[1] * parts * parts == pytest.approx(whole, rel=1e-7)
        assert 1.0 - part[1] <= (1.0 - min(damping, HIGHEST_COEFFICIENT)) ** (1.0 / parts) * (1.0 + 1e-9)
        if stiffness <= damping:
            assert part[0] <= part[1]


def measured_period(frequency, damping_ratio, tick_rate, periods):
    """Period [s] of a mass on a pinned spring, from its own zero crossings."""
    stiffness, damping = coefficients_from_frequency(frequency, damping_ratio, 1.0 / tick_rate)
    world = network([(0, 0), (1, 0)], [(0, 1)], pinned=[0], stiffness=stiffness, damping=damping, tick_rate=tick_rate)
    world.position[1, 0] = 1.1
    crossings = []
    before = 0.1
    while len(crossings) <= periods:
        step(world)
        now = world.position[1, 0] - 1.0
        if before < 0.0 <= now:
            crossings.append((world.tick - now / (now - before)) / tick_rate)
        before = now
    return (crossings[-1] - crossings[0]) / periods


@pytest.mark.parametrize(("frequency", "damping_ratio"), [(2.0, 0.0), (2.0, 0.02), (0.5, 0.01), (5.0, 0.02)])
def test_the_same_frequency_gives_the_same_period_at_every_tick_rate_to_4_digits(frequency, damping_ratio):
    expected = 1.0 / (frequency * math.sqrt(1.0 - damping_ratio**2))
    for tick_rate in (60, 120, 240):
        assert measured_period(frequency, damping_ratio, tick_rate, 40) == pytest.approx(expected, rel=2e-5)


def test_the_same_coefficients_give_half_the_period_at_twice_the_tick_rate():
    frequencies = [frequency_from_coefficients(0.01, 0.01, 1.0 / rate)[0] for rate in (30, 60, 120)]
    ratio = [frequency_from_coefficients(0.01, 0.01, 1.0 / rate)[1] for rate in (30, 60, 120)]
    damped = [1.0 / (f * math.sqrt(1.0 - z * z)) for f, z in zip(frequencies, ratio, strict=True)]
    assert damped == pytest.approx([2.09, 1.05, 0.52], abs=0.006)


def test_an_overdamped_spring_falls_back_at_the_rate_asked_for():
    frequency, damping_ratio, tick_rate = 1.0, 2.0, 60
    stiffness, damping = coefficients_from_frequency(frequency, damping_ratio, 1.0 / tick_rate)
    world = network([(0, 0), (1, 0)], [(0, 1)], pinned=[0], stiffness=stiffness, damping=damping)
    world.position[1, 0] = 1.1
    omega = 2.0 * math.pi * frequency
    slow = -omega * (damping_ratio - math.sqrt(damping_ratio**2 - 1.0))
    for _ in range(60):
        step(world)
    before = world.position[1, 0] - 1.0
    for _ in range(60):
        step(world)
    assert (world.position[1, 0] - 1.0) / before == pytest.approx(math.exp(slow), rel=1e-9)


def test_the_article_s_20_hz_example_is_refused_with_the_highest_frequency_named():
    with pytest.raises(ValueError, match=r"20 Hz at damping ratio 0.1 needs Cs = 2.45, above 1; .* is 10.6 Hz"):
        coefficients_from_frequency(20.0, 0.1, 1.0 / 60.0)


@pytest.mark.parametrize("damping_ratio", [0.0, 0.05, 0.1, 0.5, 0.9, 0.99, 0.9999])
def test_the_highest_frequency_can_be_reached_and_nothing_above_it(damping_ratio):
    for h in (1.0 / 60.0, 1.0 / 240.0, 1.0):
        highest = highest_frequency(damping_ratio, h)
        stiffness, _ = coefficients_from_frequency(highest, damping_ratio, h)
        assert stiffness == pytest.approx(1.0, abs=1e-9)
        with pytest.raises(ValueError) as refusal:
            coefficients_from_frequency(highest * 1.0001, damping_ratio, h)
        named = float(re.search(r"is ([0-9.e+-]+) Hz", str(refusal.value)).group(1))
        assert 0.989 * highest <= named <= highest
        coefficients_from_frequency(named, damping_ratio, h)


def test_a_critically_damped_spring_has_no_highest_frequency():
    for damping_ratio in (1.0, 2.0, 50.0):
        assert highest_frequency(damping_ratio, 1.0 / 60.0) == math.inf
        stiffness, damping = coefficients_from_frequency(1e7, damping_ratio, 1.0 / 60.0)
        assert 0.0 <= stiffness <= 1.0 and 0.0 <= damping <= 1.0


@pytest.mark.parametrize("count", part_and_whole(200, 3000))
def test_coefficients_and_frequency_are_two_readings_of_one_spring(count):
    generator = np.random.default_rng(5)
    for _ in range(count):
        h = float(10.0 ** generator.uniform(-4.0, 0.0))
        damping_ratio = float(generator.choice([0.0, generator.uniform(0.0, 0.95), 1.0, generator.uniform(1.05, 3.0)]))
        frequency = float(generator.uniform(0.01, 0.95) * min(highest_frequency(damping_ratio, h), 0.3 / h))
        stiffness, damping = coefficients_from_frequency(frequency, damping_ratio, h)
        read = frequency_from_coefficients(stiffness, damping, h)
        assert read == pytest.approx((frequency, damping_ratio), rel=1e-5, abs=1e-7)


def test_the_frequency_of_every_pair_of_coefficients_is_a_number_of_0_or_more():
    for stiffness, damping in random_coefficients(scaled(2000, 2000)):
        frequency, damping_ratio = frequency_from_coefficients(stiffness, damping, 1.0 / 60.0)
        assert frequency >= 0.0 and damping_ratio >= 0.0
    assert frequency_from_coefficients(1.0, 1.0, 1.0 / 60.0) == (math.inf, math.inf)
    assert frequency_from_coefficients(0.0, 0.0, 1.0 / 60.0) == (0.0, 0.0)


@pytest.mark.parametrize(
    "asked", [(-1.0, 0.5, 0.1), (1.0, -0.5, 0.1), (1.0, 0.5, 0.0), (math.nan, 0.5, 0.1), (math.inf, 1.0, 0.1)]
)
def test_frequencies_and_ratios_that_mean_nothing_are_refused(asked):
    with pytest.raises(ValueError, match="finite numbers of 0 or more"):
        coefficients_from_frequency(*asked)


def test_at_twice_the_rate_a_spring_keeps_its_motion_as_half_a_step_does():
    for stiffness, damping in random_coefficients(60):
        halved = half_step(stiffness, damping)
        assert at_other_step(stiffness, damping, 0.5) == pytest.approx(halved, rel=1e-6, abs=1e-15)


@pytest.mark.parametrize("times", [0.1, 0.37, 1.0, 1.5])
def test_at_any_other_step_frequency_and_damping_ratio_stay(times):
    for stiffness, damping in [(0.3, 0.3), (0.02, 0.001), (0.01, 0.9), (1e-5, 1e-3)]:
        other = at_other_step(stiffness, damping, times)
        before, after = frequency_from_coefficients(stiffness, damping, 1.0), frequency_from_coefficients(*other, times)
        assert after == pytest.approx(before, rel=1e-6)
        assert at_other_step(*other, 1.0 / times) == pytest.approx((stiffness, damping), rel=1e-6)
    assert at_other_step(1.0, 1.0, times) == (1.0, 1.0) and at_other_step(0.0, 0.0, times) == (0.0, 0.0)


def test_a_swing_that_a_longer_step_cannot_follow_is_refused():
    with pytest.raises(ValueError, match="swing too fast"):
        at_other_step(0.5, 0.0, 2.0)
