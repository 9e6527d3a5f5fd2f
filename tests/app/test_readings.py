"""Numbers and lengths as a person says them."""

import math

import pytest

from sandbox.app.panel.readings import motion_words, number, per_cent, sag_words, seconds, with_unit
from sandbox.physics.softness.body_motion import motion_of
from sandbox.physics.softness.settling import Support


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.0, "0"), (3200.0, "3200"), (3217.0, "3220"), (0.00017, "0.00017"), (1.7e-7, "0.00000017"), (0.5, "0.5"),
     (-12.345, "-12.3"), (math.inf, "\u221e"), (1e-15, "0"), (99.96, "100"), (math.nan, "?")],
)  # fmt: skip
def test_numbers_have_no_exponents(value, text):
    assert number(value) == text


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.0, "0 J"), (1.724e-7, "172 nJ"), (0.0021, "2.1 mJ"), (12.0, "12 J"), (9.0e4, "90 kJ"), (999.9, "1 kJ"),
     (3e7, "30 MJ"), (1e-20, "0 J"), (5e17, "500000 TJ"), (math.inf, "\u221e J")],
)  # fmt: skip
def test_energies_have_units_of_their_size(value, text):
    assert with_unit(value, "J") == text


def test_times_and_shares():
    assert [seconds(value) for value in (0.0333, 0.45, 12.0, 250.0, 1e6)] == [
        "0.033 s",
        "0.45 s",
        "12 s",
        "4.2 min",
        "hours",
    ]
    assert [per_cent(value) for value in (0.0, 1e-6, 0.0031, 0.163)] == ["0 %", "0 %", "0.31 %", "16 %"]


@pytest.mark.parametrize(
    ("pair", "words"),
    [((0.4, 0.6), "swings, at rest after 0.12 s"), ((0.001, 1.0), "creeps back, half in 12 s"),
     ((0.0, 0.5), "does not come back"), ((0.3, 0.0), "swings on and on"), ((1.0, 1.0), "is back at once")],
)  # fmt: skip
def test_motions_are_said_by_what_is_seen(pair, words):
    assert motion_words(motion_of(*pair, 1.0 / 60.0)) == words


def test_sags_of_one_and_of_several():
    floor = {Support.FLOOR}
    assert sag_words(0.02, 0.02, "jelly", floor) == "The jelly sags by 2 % of its height"
    assert sag_words(0.7, 0.7, "cube 1", floor) == "Cube 1 lies flat under its own weight"
    assert sag_words(0.25, 0.25, "girder", {Support.ARM}) == "The girder's end drops by 25 % of its length"
    assert sag_words(0.1, 0.1, "bed", {Support.SPANNED}) == "The bed's middle drops by 10 % of its length"
    assert sag_words(0.6, 0.6, "cloth", {Support.HANGING}) == "The cloth stretches by more than half its height"
    assert sag_words(0.003, 0.2, None, floor) == "They sag by 0.3 % to 20 % of their heights"
    assert sag_words(0.003, 3.0, None, floor) == "They sag by 0.3 % to more than half of their heights"
    assert sag_words(0.003, 0.2, None, {Support.FLOOR, Support.ARM}) == "They sag by 0.3 % to 20 % of their size"
    assert sag_words(0.7, 3.0, None, floor) == "They lie flat under their own weight"
