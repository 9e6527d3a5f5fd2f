"""Polygons of jelly against exact arithmetic: which grid points they hold, and whether they are simple."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sandbox.level.kinds.geometry import grid_bounds, is_simple, largest_part, polygon_grid, simplified

eighths = st.integers(-40, 40)
corners = st.lists(st.tuples(eighths, eighths), min_size=3, max_size=7)


def sides(polygon):
    return list(zip(polygon, polygon[1:] + polygon[:1], strict=True))


def side_of(p, q, r):
    return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])


def on(p, q, r):
    inside = all(min(p[k], q[k]) <= r[k] <= max(p[k], q[k]) for k in (0, 1))
    return inside and side_of(p, q, r) == 0


def touch(p, q, r, s):
    if any((on(p, q, r), on(p, q, s), on(r, s, p), on(r, s, q))):
        return True
    return side_of(p, q, r) * side_of(p, q, s) < 0 and side_of(r, s, p) * side_of(r, s, q) < 0


def exactly_simple(polygon):
    every = sides(polygon)
    if len(set(polygon)) < len(polygon):
        return False
    for first, (p, q) in enumerate(every):
        for second in range(first + 1, len(every)):
            r, s = every[second]
            if q == r or s == p:
                apart = (p, s) if q == r else (q, r)
                if on(r, s, apart[0]) or on(p, q, apart[1]):
                    return False
            elif touch(p, q, r, s):
                return False
    return True


def exactly_inside(polygon, point):
    if any(on(p, q, point) for p, q in sides(polygon)):
        return True
    crossings = 0
    for p, q in sides(polygon):
        low, high = sorted((p, q), key=lambda corner: corner[1])
        if low[1] <= point[1] < high[1]:
            x = low[0] + Fraction(high[0] - low[0]) * (point[1] - low[1]) / (high[1] - low[1])
            crossings += x > point[0]
    return crossings % 2 == 1


@given(corners)
def test_a_polygon_is_simple_where_exact_arithmetic_says_so(polygon):
    assert is_simple([(x / 8, y / 8) for x, y in polygon]) == exactly_simple(polygon)


@given(corners.filter(exactly_simple))
def test_a_simple_polygon_holds_the_grid_points_that_exact_arithmetic_finds(polygon):
    spacing = 4  # half a metre, in eighths
    left, bottom, cells = polygon_grid([(x / 8, y / 8) for x, y in polygon], spacing / 8)
    rows, columns = cells.shape
    found = [[bool(cells[row, column]) for column in range(columns)] for row in range(rows)]
    assert found == [
        [exactly_inside(polygon, ((left + column) * spacing, (bottom + row) * spacing)) for column in range(columns)]
        for row in range(rows)
    ]


def test_the_grid_s_bounds_count_points_on_the_border_in_spite_of_rounding():
    corners = [(0.0, 0.0), (0.3, 0.0), (0.3, 0.7), (0.0, 0.7)]
    assert grid_bounds(corners, 0.1) == (0, 0, 4, 8)
    assert polygon_grid(corners, 0.1)[2].all()


@pytest.mark.parametrize("tilt", [0.0, 1e-12, -1e-12, 1e-10])
def test_a_side_that_is_almost_level_neither_leaks_nor_floods(tilt):
    _, _, cells = polygon_grid([(0.0, 0.0), (4.0, tilt), (4.0, 3.0), (2.0, 3.0 + tilt), (0.0, 3.0)], 1.0)
    assert cells.shape == (4, 5)
    assert cells.all()


def test_a_polygon_between_the_points_of_its_grid_holds_none():
    assert polygon_grid([(0.1, 0.1), (0.2, 0.1), (0.1, 0.2)], 1.0)[2].size == 0


def test_a_line_drawn_by_hand_keeps_the_corners_that_it_needs_and_loses_the_rest():
    square = [(x / 10, 0.0) for x in range(30)] + [(3.0, y / 10) for y in range(30)]
    square += [(3.0 - x / 10, 3.0) for x in range(30)] + [(0.0, 3.0 - y / 10) for y in range(30)]
    assert simplified(square, 0.01) == [(0.0, 0.0), (3.0, 0.0), (3.0, 3.0), (0.0, 3.0)]


@given(st.lists(st.tuples(st.floats(-5, 5), st.floats(-5, 5)), min_size=3, max_size=40), st.floats(0.0, 2.0))
def test_no_corner_that_is_left_out_is_farther_than_the_tolerance_from_what_is_kept(corners, tolerance):
    kept = simplified(corners, tolerance)
    assert kept == [corner for corner in kept if corner in corners]
    if len(kept) < 2:
        assert len({*corners}) < 3
        return
    outline = np.array([*kept, kept[0]])
    for corner in corners:
        distance = min(segment_distance(outline[k], outline[k + 1], np.array(corner)) for k in range(len(kept)))
        assert distance <= tolerance + 1e-9


def segment_distance(a, b, point):
    along = b - a
    squared = float(along @ along)
    share = min(max(float((point - a) @ along) / squared, 0.0), 1.0) if squared > 0.0 else 0.0
    return float(np.linalg.norm(point - a - share * along))


def test_of_a_grid_that_holds_by_corners_alone_the_largest_part_stays():
    rows = [
        "o......",
        ".##....",
        ".###.oo",
        "..##.oo",
        "....o..",
    ]  # fmt: skip
    points = np.array([[mark != "." for mark in row] for row in rows])
    assert np.array_equal(largest_part(points), np.array([[mark == "#" for mark in row] for row in rows]))


def test_a_grid_of_a_single_row_stays_as_it_is():
    points = np.array([[True, True, False, True]])
    assert np.array_equal(largest_part(points), points)
