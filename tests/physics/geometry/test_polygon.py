"""Areas and winding numbers of polygons, against angles and triangles."""

import math

import numpy as np
import pytest

from sandbox.physics.geometry.segment import doubled_area, polygon_area, signed_area, winding_number, winding_of_side

# A ring that is gone round twice, with a bulge, and one that runs clockwise.
TWICE = np.array([[(1.0 + 0.3 * (k % 3)) * f(0.7 * k * math.pi) for f in (math.cos, math.sin)] for k in range(20)])
CLOCKWISE = np.array([[0.0, 0.0], [0.0, 2.0], [1.0, 2.5], [2.0, 2.0], [2.0, 0.0]])


def turns(place, corners):
    """The winding number by the angles under which sides are seen."""
    seen = np.arctan2(*(corners - place).T[::-1])
    step = np.roll(seen, -1) - seen
    return round(float(np.sum((step + math.pi) % math.tau - math.pi)) / math.tau)


@pytest.mark.parametrize("corners", [TWICE, CLOCKWISE], ids=["twice", "clockwise"])
def test_sides_run_round_a_place_as_often_as_they_are_seen_to_turn(corners):
    after = np.roll(corners, -1, axis=0)
    found = set()
    for place in np.random.default_rng(3).uniform(-1.5, 2.5, (300, 2)):
        number = winding_number(place, corners, after)
        assert number == turns(place, corners)
        sides = zip(corners.tolist(), after.tolist(), strict=True)
        x, y = place
        assert number == sum(
            winding_of_side(a[1] <= y, b[1] <= y, doubled_area(*a, *b, x, y)) for a, b in sides
        )  # fmt: skip
        found.add(number)
    assert len(found) > 1


def test_a_place_level_with_corners_is_counted_once():
    square = np.array([[-1.0, 0.0], [0.0, -1.0], [1.0, 0.0], [0.0, 1.0]])
    after = np.roll(square, -1, axis=0)
    assert winding_number(np.zeros(2), square, after) == 1
    assert winding_number(np.array([-2.0, 0.0]), square, after) == 0
    assert winding_number(np.array([2.0, 0.0]), square, after) == 0


def test_an_area_is_counter_clockwise_above_0_and_the_same_in_both_forms():
    after = np.roll(CLOCKWISE, -1, axis=0)
    assert signed_area(CLOCKWISE, after) == -4.5
    assert signed_area(after, CLOCKWISE) == 4.5
    assert polygon_area(np.concatenate([TWICE, CLOCKWISE]), len(TWICE), len(TWICE) + len(CLOCKWISE)) == -4.5
