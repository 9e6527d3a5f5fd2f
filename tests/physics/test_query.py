"""Where things are, on worlds and on snapshots alike."""

import numpy as np
import pytest

from sandbox.physics.analysis.query import nearest_particle, nearest_spring, springs_crossing
from sandbox.physics.snapshot import take
from sandbox.physics.world import World
from tests.support.physics_scenes import network


def square():
    """A unit square of four springs, its particles without a radius."""
    world = network([(0, 0), (1, 0), (1, 1), (0, 1)], [(0, 1), (1, 2), (2, 3), (3, 0)])
    world.radius[:] = 0.0
    return world


def test_the_nearest_particle_is_found_within_reach_and_none_beyond():
    for state in (square(), take(square())):
        assert nearest_particle(state, (0.9, 0.2), 0.5) == 1
        assert nearest_particle(state, (1.25, 0.0), 0.25) == 1
        assert nearest_particle(state, (1.26, 0.0), 0.25) is None


def test_the_lowest_slot_wins_a_tie():
    assert nearest_particle(square(), (0.5, 0.5), 1.0) == 0
    assert nearest_particle(square(), (0.75, 0.5), 1.0) == 1
    assert nearest_spring(square(), (0.5, 0.5), 1.0) == 0
    assert nearest_spring(square(), (1.0, 1.0), 1.0) == 1


def test_distance_counts_from_the_edge_of_a_particle_s_disc():
    world = square()
    world.radius[2] = 0.4
    assert nearest_particle(world, (1.0, 0.55), 0.2) == 2
    assert nearest_particle(world, (1.0, 0.2), 0.2) == 1


def test_the_nearest_spring_counts_from_the_segment_and_not_from_its_line():
    world = square()
    assert nearest_spring(world, (0.5, 0.1), 0.2) == 0
    assert nearest_spring(world, (0.5, 0.3), 0.2) is None
    assert nearest_spring(world, (1.5, 0.0), 0.4) is None
    assert nearest_spring(world, (1.5, 0.5), 0.5) == 1


def test_a_spring_of_no_length_is_found_where_it_is():
    world = network([(0, 0), (0, 0)], [(0, 1)])
    assert nearest_spring(world, (0.0, 0.1), 0.2) == 0
    assert list(springs_crossing(world, (-1, 0), (1, 0))) == [0]
    assert list(springs_crossing(world, (-1, 1), (1, 1))) == []


def test_a_stroke_crosses_or_touches_springs_in_ascending_order():
    world = square()
    assert list(springs_crossing(world, (0.5, -1), (0.5, 2))) == [0, 2]
    assert list(springs_crossing(world, (0.5, -1), (0.5, 0.5))) == [0]
    assert list(springs_crossing(world, (0.5, -1), (0.5, 0.0))) == [0]
    assert list(springs_crossing(world, (-0.5, -0.5), (1.5, 1.5))) == [0, 1, 2, 3]
    assert list(springs_crossing(world, (0.2, 0.2), (0.8, 0.7))) == []


def test_a_stroke_along_a_spring_meets_it_only_where_they_overlap():
    world = square()
    assert list(springs_crossing(world, (0.2, 0.0), (0.8, 0.0))) == [0]
    assert list(springs_crossing(world, (0.2, 0.0), (5.0, 0.0))) == [0, 1]
    assert list(springs_crossing(world, (1.5, 0.0), (5.0, 0.0))) == []
    assert list(springs_crossing(world, (0.2, 1e-3), (0.8, 1e-3))) == []


def test_a_stroke_of_no_length_is_a_point():
    world = square()
    assert list(springs_crossing(world, (0.5, 0.0), (0.5, 0.0))) == [0]
    assert list(springs_crossing(world, (0.5, 0.5), (0.5, 0.5))) == []


def test_hands_and_inactive_slots_are_never_found():
    world = square()
    world.reserve_grabs()
    world.hold(0, 2, (3.0, 3.0))
    world.cut([1])
    for state in (world, take(world)):
        assert nearest_particle(state, (3.0, 3.0), 0.5) is None
        assert nearest_spring(state, (2.0, 2.0), 0.5) is None
        assert nearest_spring(state, (1.0, 0.5), 0.1) is None
        assert list(springs_crossing(state, (0.9, 0.5), (1.1, 0.5))) == []
        assert list(springs_crossing(state, (2.0, 1.0), (2.0, 3.0))) == []


@pytest.mark.parametrize("place", [np.nan, np.inf, -np.inf, 1e308])
def test_places_that_are_no_numbers_are_far_from_everything(place):
    world = square()
    world.position[0] = place
    for state in (world, take(world)):
        assert nearest_particle(state, (0.9, 0.0), 0.5) == 1
        assert nearest_particle(state, (0.0, 0.0), 0.5) is None
        assert nearest_spring(state, (0.9, 0.5), 0.2) == 1
        assert 2 in springs_crossing(state, (0.5, 0.5), (0.5, 1.5))


def test_an_empty_world_holds_nothing():
    for state in (World(), take(World())):
        assert nearest_particle(state, (0, 0), 1e9) is None
        assert nearest_spring(state, (0, 0), 1e9) is None
        assert len(springs_crossing(state, (0, 0), (1, 1))) == 0
