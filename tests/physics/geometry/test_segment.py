"""Segments against brute force, and the parts of kernels against their twins for arrays."""

import math

import numpy as np
import pytest

from sandbox.physics.geometry.segment import (
    closest_on_segment,
    difference,
    distances_from_segments,
    doubled_area,
    doubled_area_of,
    doubled_areas,
    lengths,
    nearest_on_segments,
    nearest_share,
    segment_of,
    segments_cross,
    squared_distance,
    unit,
)

PLACES = np.random.default_rng(5).uniform(-1.0, 1.0, (3, 200, 2))


def brute_distance(p, a, b):
    along = np.linspace(0.0, 1.0, 20001)[:, None]
    return np.min(np.linalg.norm(a + along * (b - a) - p, axis=1))


@pytest.mark.parametrize("k", range(40))
def test_no_place_of_a_segment_is_nearer_than_the_closest(k):
    p, a, b = PLACES[:, k]
    share, distance, signed, region = closest_on_segment(2, 0, 1, np.array([a, b, p]))
    assert distance == pytest.approx(brute_distance(p, a, b), abs=1e-7)
    assert np.linalg.norm(a + share * (b - a) - p) == pytest.approx(distance, rel=1e-12)
    # On the right of the way from a to b: (b - a) turned clockwise.
    right = np.array([b[1] - a[1], a[0] - b[0]]) / np.linalg.norm(b - a)
    assert signed == pytest.approx(float(np.dot(p - a, right)), abs=1e-12)
    assert region == {0.0: -1, 1.0: 1}.get(share, 0)


def test_a_segment_of_no_length_is_its_own_closest_place():
    position = np.array([[1.0, 1.0], [1.0, 1.0], [4.0, 5.0]])
    assert closest_on_segment(2, 0, 1, position) == (0.0, 5.0, 5.0, -1)
    assert nearest_share(3.0, 4.0, 0.0, 0.0) == 0.0
    assert distances_from_segments(position[2], position[:1], position[1:2]) == 5.0


def test_arrays_get_the_bits_of_kernels():
    p, a, b = PLACES
    share, way = nearest_on_segments(p, a, b)
    distance = distances_from_segments(p, a, b)
    area = doubled_areas(a, b, p)
    for k in range(len(p)):
        position = np.array([a[k], b[k], p[k]])
        assert closest_on_segment(2, 0, 1, position)[:2] == (share[k], distance[k])
        assert nearest_share(*(p[k] - a[k]), *(b[k] - a[k])) == share[k]
        assert math.sqrt(squared_distance(*p[k], *a[k], *b[k])) == distance[k]
        assert doubled_area(*a[k], *b[k], *p[k]) == doubled_area_of(0, 1, 2, position) == area[k]
    assert np.array_equal(distance, lengths(way))
    assert np.allclose(a + share[:, None] * (b - a) + way, p, atol=1e-12)


def test_each_place_is_measured_from_each_segment():
    p, a, b = PLACES[:, :30]
    found = distances_from_segments(p[:, None], a, b)
    assert np.array_equal(found, [distances_from_segments(each, a, b) for each in p])


def test_an_area_is_above_0_on_the_left_and_half_of_base_times_height():
    assert doubled_area(0.0, 0.0, 4.0, 0.0, 1.0, 3.0) == 12.0
    assert doubled_area(0.0, 0.0, 4.0, 0.0, 1.0, -3.0) == -12.0


def test_segments_cross_where_a_common_place_lies_inside_of_both():
    a, b = PLACES[:2, :100]
    c, d = PLACES[:2, 100:]
    matrix = np.stack([b - a, c - d], axis=2)
    shares = np.linalg.solve(matrix, (c - a)[..., None])[..., 0]
    found = [segments_cross(*ends) for ends in np.concatenate([a, b, c, d], axis=1)]
    assert np.array_equal(found, np.all((shares > 0.0) & (shares < 1.0), axis=1))


def test_a_segment_has_a_start_and_a_way():
    rows = PLACES[0]
    assert segment_of(3, 8, rows) == (*rows[3], *(rows[8] - rows[3]))
    assert difference(3, 8, rows) == tuple(rows[8] - rows[3])


def test_a_unit_vector_has_the_same_direction_and_looks_upward_where_there_is_none():
    assert unit(3.0, -4.0) == pytest.approx((0.6, -0.8), rel=1e-15)
    assert unit(0.0, 0.0) == (0.0, 1.0)
