"""Kernels that mesh: exact decisions against whole numbers without bounds, nets against Delaunay's own definition."""

import itertools
import random

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sandbox.physics.arena import answer_of
from sandbox.physics.jit import kernel_of
from sandbox.physics.meshing import fitting, triangulation
from tests.support.strokes import rough_stroke

# Coordinates with the frame's.
FAR = 64 * int(triangulation.FARTHEST)
far = st.integers(-FAR, FAR)
near = st.integers(-3, 3)
STROKES = 40


def turn(a, b, c):
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def circle(a, b, c, d):
    (ax, ay), (bx, by), (cx, cy) = ((p[0] - d[0], p[1] - d[1]) for p in (a, b, c))
    return (
        (ax * ax + ay * ay) * (bx * cy - by * cx)
        - (bx * bx + by * by) * (ax * cy - ay * cx)
        + (cx * cx + cy * cy) * (ax * by - ay * bx)
    )


def sites(*places):
    return memoryview(np.array(places, dtype=np.int64))


def sign(value):
    return (value > 0) - (value < 0)


def scratch():
    return memoryview(np.zeros(triangulation.SCRATCH, np.int64))


@given(st.tuples(far, far), st.tuples(far, far), st.integers(-(2**20), 2**20), near, near)
def test_three_places_turn_as_whole_numbers_without_bounds_say(a, b, times, x, y):
    # Almost on the line, as far away as may be.
    c = max(-FAR, min(FAR, a[0] + (b[0] - a[0]) * times // 2**20 + x)), max(-FAR, min(FAR, a[1] + y))
    for places in itertools.permutations((a, b, c)):
        assert triangulation.turn_of(0, 1, 2, sites(*places)) == sign(turn(*places))


@given(st.tuples(far, far), st.integers(0, FAR // 2), st.integers(0, FAR // 2), near, near)
def test_a_circle_holds_what_whole_numbers_without_bounds_say(centre, across, up, x, y):
    # Corners of a box lie on one circle; the last one is moved a little, or not at all.
    cx, cy = centre[0] // 2, centre[1] // 2
    a, b, c, d = (cx - across, cy - up), (cx + across, cy - up), (cx + across, cy + up), (cx - across + x, cy + up + y)
    assert triangulation.circle_holds(0, 1, 2, 3, sites(a, b, c, d), scratch()) == (circle(a, b, c, d) > 0)


@given(*(st.tuples(far, far) for _ in range(4)))
def test_a_circle_of_any_places_holds_what_whole_numbers_without_bounds_say(a, b, c, d):
    assert triangulation.circle_holds(0, 1, 2, 3, sites(a, b, c, d), scratch()) == (circle(a, b, c, d) > 0)


@pytest.mark.parametrize("spacing", [0.3, 1.2345, 0.00012345, 77.77, 4321.0])
def test_a_finer_spacing_has_three_digits_and_is_the_nearest_to_its_share(spacing):
    for tries in range(1, fitting.TRIES):
        assert fitting.finer_spacing(spacing, tries) == float(f"{spacing * fitting.FINER**tries:.3g}")
    assert fitting.finer_spacing(spacing, 0) == spacing


def test_interpreted_kernels_mesh_strokes_to_the_bits_of_compiled_ones():
    generator = random.Random(4)
    for _ in range(STROKES):
        numbers = np.array(rough_stroke(generator))
        made = [
            answer_of(kernel, fitting.USUAL_ARENA, given_)
            for kernel, given_ in ((fitting.fill_stroke, numbers), (_interpreted, numbers))
        ]
        (code, arena), (other_code, other_arena) = made
        assert code == other_code
        for one, other in zip(fitting.found_in(arena), fitting.found_in(other_arena), strict=True):
            assert code != fitting.FITS or np.array_equal(one, other)


def _interpreted(arena, numbers):
    return kernel_of(fitting.fill_stroke).function(memoryview(arena), memoryview(numbers))


def test_a_stroke_that_crosses_itself_or_is_a_dot_or_has_no_end_of_needles_is_told_from_one_that_fits():
    turns = np.linspace(0.0, 2.0 * np.pi, 60, endpoint=False)
    ring, eight = np.stack([np.cos(turns), np.sin(turns)], 1), np.stack([np.sin(turns), np.sin(2.0 * turns)], 1)
    needles = ring * np.where(np.arange(60) % 2, 1.0, 0.05)[:, None]
    for places, code in (
        (ring, fitting.FITS),
        (eight, fitting.CROSSES),
        (0.01 * ring, fitting.TOO_SMALL),
        (ring[:2], fitting.TOO_SMALL),
        (needles, fitting.TOO_FINE),
    ):
        numbers = np.array([0.001, 0.1, *places.reshape(-1)])
        assert answer_of(fitting.fill_stroke, fitting.USUAL_ARENA, numbers)[0] == code


def test_a_mesh_finds_room_in_an_arena_that_was_too_small():
    numbers = np.array(rough_stroke(random.Random(1)))
    small, large = (answer_of(fitting.fill_stroke, words, numbers) for words in (64, 1 << 20))
    assert small[0] == large[0] == fitting.FITS
    assert np.array_equal(fitting.found_in(small[1]).places, fitting.found_in(large[1]).places)


def test_an_outline_beyond_exact_decisions_is_too_fine():
    box, start = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]), np.array([0, 4])
    for away, code in ((1e4, fitting.FITS), (1e6, fitting.FITS), (1e8, fitting.TOO_FINE)):
        assert answer_of(fitting.mesh_loops, fitting.USUAL_ARENA, away + box, start, 0.2, True)[0] == code
