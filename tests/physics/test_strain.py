"""Strain of springs."""

import numpy as np
import pytest

from sandbox.physics.analysis.query import load_bearing, strain
from sandbox.physics.snapshot import take
from sandbox.physics.world import World
from tests.support.physics_scenes import network


def chain():
    world = network([(0, 0), (1, 0), (3, 0), (3, 4)], [(0, 1), (1, 2), (2, 3)], pinned=[0, 1])
    world.position[2] = (2.0, 0.0)
    world.position[3] = (2.0, 6.0)
    return world


def test_strain_is_signed_and_relative_to_the_rest_length():
    for state in (chain(), take(chain())):
        assert strain(state) == pytest.approx([0.0, -0.5, 0.5])


def test_springs_without_rest_length_and_cut_springs_have_no_strain():
    world = chain()
    world.rest_length[1] = 0.0
    world.cut([2])
    assert np.array_equal(strain(world), [0.0, 0.0, 0.0])


def test_load_bears_on_active_springs_with_a_rest_length_and_a_free_end():
    world = chain()
    assert list(load_bearing(world)) == [False, True, True]
    world.rest_length[1] = 0.0
    world.cut([2])
    assert not load_bearing(take(world)).any()


def test_an_empty_world_has_no_strain():
    assert len(strain(World())) == len(load_bearing(World())) == 0


@pytest.mark.parametrize("place", [np.nan, np.inf, 1e308])
def test_the_strain_of_what_blew_up_is_no_finite_number_and_no_fault(place):
    world = chain()
    world.position[3] = place
    assert strain(world)[:2] == pytest.approx([0.0, -0.5])
    assert not np.isfinite(strain(world)[2])
