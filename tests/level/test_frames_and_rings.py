"""Girders, webs and wheels: where their particles stand, what joins them, and what holds them."""

import math
from collections import Counter

import numpy as np
import pytest

from sandbox.level.assembly.build_world import build_world
from sandbox.level.reading.files import parse_level
from sandbox.physics.step import step
from tests.support.malformed_levels import encoded


def world_of(body, **keys):
    whole = {"format": "spring-sandbox/level", "version": 3, "name": "n", "bodies": [body], **keys}
    return build_world(parse_level(encoded(whole), "x.json"))


def places(world):
    return world.position[: world.grab_particle]


def springs(world):
    ends = zip(world.particle_a.tolist(), world.particle_b.tolist(), strict=True)
    return list(ends)[: world.grab_spring]


def held(world):
    return np.flatnonzero(world.inverse_mass[: world.grab_particle] == 0.0).tolist()


def girder(**keys):
    return {"type": "girder", "id": "g", "start": [0, 2], "end": [6, 2], "segments": 3, "height": 0.5, **keys}


def web(**keys):
    return {"type": "web", "id": "w", "radius": 3.0, "spokes": 4, "rings": 2, **keys}


def wheel(**keys):
    return {"type": "wheel", "id": "w", "radius": 2.0, "thickness": 0.5, "segments": 4, **keys}


def test_a_girder_is_a_row_and_a_second_one_half_a_cell_further_below_it():
    world = world_of(girder())
    assert places(world).tolist() == [[0, 2], [2, 2], [4, 2], [6, 2], [1, 1.5], [3, 1.5], [5, 1.5]]


def test_the_springs_of_a_girder_are_both_chords_then_the_zigzag_cell_by_cell():
    chords = [(0, 1), (1, 2), (2, 3), (4, 5), (5, 6)]
    assert springs(world_of(girder())) == [*chords, (0, 4), (4, 1), (1, 5), (5, 2), (2, 6), (6, 3)]


def test_a_girder_of_one_cell_is_a_triangle():
    assert springs(world_of(girder(segments=1))) == [(0, 1), (0, 2), (2, 1)]


@pytest.mark.parametrize(("end", "second"), [([0, 8], [0.5, 3]), ([-6, 2], [-1, 2.5]), ([0, -4], [-0.5, 1])])
def test_the_second_row_of_a_girder_is_on_the_right_of_its_way(end, second):
    assert places(world_of(girder(end=end)))[4].tolist() == second


@pytest.mark.parametrize("angle", [0.3, 1.0, 2.5, -1.2])
def test_a_girder_keeps_its_form_at_any_angle(angle):
    lengths = world_of(girder()).rest_length[:11]
    turned = world_of(girder(end=[6 * math.cos(angle), 2 + 6 * math.sin(angle)])).rest_length[:11]
    assert turned == pytest.approx(lengths, rel=1e-12)


@pytest.mark.parametrize(("pin", "particles"), [([], []), (["end"], [3]), (["start", "end"], [0, 3])])
def test_the_pins_of_a_girder_hold_the_ends_of_its_first_row(pin, particles):
    assert held(world_of(girder(pin=pin))) == particles


def test_a_pinned_girder_is_stiff_enough_to_keep_its_form():
    body = girder(pin=["start", "end"], material="steel")
    world = world_of(body, materials={"steel": {"stiffness": 1.0, "damping": 1.0}})
    before = places(world).copy()
    for _ in range(120):
        step(world)
    assert np.abs(places(world) - before).max() < 1e-3


def test_a_web_is_its_centre_then_ring_by_ring_from_inside_counter_clockwise():
    inner, outer = [[1.5, 0], [0, 1.5], [-1.5, 0], [0, -1.5]], [[3, 0], [0, 3], [-3, 0], [0, -3]]
    world = world_of(web(position=[10, 20]))
    assert places(world).tolist() == [[10 + x, 20 + y] for x, y in [[0, 0], *inner, *outer]]


def test_the_springs_of_a_web_are_the_spokes_then_the_rings():
    spokes = [(0, 1), (0, 2), (0, 3), (0, 4), (1, 5), (2, 6), (3, 7), (4, 8)]
    rings = [(1, 2), (2, 3), (3, 4), (4, 1), (5, 6), (6, 7), (7, 8), (8, 5)]
    assert springs(world_of(web())) == spokes + rings


def test_the_angle_of_a_ring_turns_its_first_spoke_counter_clockwise():
    assert places(world_of(web(angle=math.pi / 2)))[5].tolist() == [0, 3]
    x, y = places(world_of(wheel(angle=1.0)))[5].tolist()
    assert [x, y] == [2.0 * round(math.cos(1.0), 12), 2.0 * round(math.sin(1.0), 12)]


def test_the_rim_of_a_web_is_its_outermost_ring():
    assert held(world_of(web(pin=["rim"]))) == [5, 6, 7, 8]


def test_a_wheel_is_its_hub_then_the_inner_and_the_outer_ring():
    inner, outer = [[1.5, 0], [0, 1.5], [-1.5, 0], [0, -1.5]], [[2, 0], [0, 2], [-2, 0], [0, -2]]
    world = world_of(wheel(position=[1, 1]))
    assert places(world).tolist() == [[1 + x, 1 + y] for x, y in [[0, 0], *inner, *outer]]


def test_the_springs_of_a_wheel_are_spokes_then_rings_then_braces():
    spokes, inner = [(0, 1), (0, 2), (0, 3), (0, 4)], [(1, 2), (2, 3), (3, 4), (4, 1)]
    outer, radial = [(5, 6), (6, 7), (7, 8), (8, 5)], [(1, 5), (2, 6), (3, 7), (4, 8)]
    diagonals = [(1, 6), (5, 2), (2, 7), (6, 3), (3, 8), (7, 4), (4, 5), (8, 1)]
    assert springs(world_of(wheel())) == spokes + inner + outer + radial + diagonals


def test_no_two_springs_of_a_ring_join_the_same_particles():
    for body in (web(spokes=3), wheel(segments=3)):
        assert max(Counter(tuple(sorted(pair)) for pair in springs(world_of(body))).values()) == 1


def test_the_hub_of_a_wheel_has_a_mass_of_its_own_and_can_be_held():
    world = world_of(wheel(particle_mass=2.0, hub_mass=30.0, pin=["hub"]))
    assert world.mass[:9].tolist() == [30.0] + [2.0] * 8
    assert held(world) == [0]
    assert world_of(wheel(particle_mass=2.0)).mass[0] == 2.0


@pytest.mark.parametrize(
    ("body", "name", "slot"),
    [(girder(), "g.start", 0), (girder(), "g.end", 3), (web(), "w.centre", 0), (wheel(), "w.hub", 0)],
)
def test_particles_with_a_place_of_honour_have_a_name(body, name, slot):
    world = world_of(body, particles=[{"id": "p", "position": [9, 9]}], springs=[{"a": "p", "b": name}])
    assert world.particle_slot(name) == slot
    assert springs(world)[-1][1] == slot
