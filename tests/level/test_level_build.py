"""Expansion: counts, places, order and names of what bodies become."""

import math

import numpy as np
import pytest

from sandbox.level.assembly.build_world import build_world
from sandbox.level.document.model import Level
from sandbox.level.format.level_error import LevelError
from sandbox.level.format.quantities import replaced
from sandbox.level.kinds.bodies import expansion
from sandbox.level.kinds.geometry import polygon_grid
from sandbox.level.plan.plan import kept_plan
from sandbox.level.reading.files import parse_level
from sandbox.physics.marks import GRAB_COUNT, LAW_HOOKE, LAW_NISSEN
from sandbox.physics.snapshot import state_hash
from sandbox.physics.step import step
from tests.support.malformed_levels import GOOD, encoded


def level_of(*bodies, **keys):
    whole = {"format": "spring-sandbox/level", "version": 4, "name": "n", "bodies": list(bodies), **keys}
    return parse_level(encoded(whole), "x.json")


def world_of(*bodies, **keys):
    return build_world(level_of(*bodies, **keys))


def places(world):
    return world.position[: world.grab_particle].tolist()


def springs(world):
    ends = zip(world.particle_a.tolist(), world.particle_b.tolist(), strict=True)
    return list(ends)[: world.grab_spring]


def rope(**keys):
    return {"type": "rope", "id": "r", "start": [0, 1], "end": [3, 1], "segments": 3, **keys}


def bridge(**keys):
    return {"type": "bridge", "id": "b", "start": [0, 2], "end": [2, 2], "segments": 2, "height": 0.5, **keys}


def jelly(shape, **keys):
    return {"type": "jelly", "id": "j", "shape": shape, "spacing": 1.0, **keys}


def test_a_rope_is_particles_placed_evenly_and_a_spring_between_neighbours():
    world = world_of(rope())
    assert places(world) == [[0, 1], [1, 1], [2, 1], [3, 1]]
    assert springs(world) == [(0, 1), (1, 2), (2, 3)]
    assert world.rest_length[:3].tolist() == [1.0, 1.0, 1.0]


def test_a_rope_stands_evenly_whatever_its_rest_length():
    world = world_of(rope(rest_length=0.25))
    assert places(world) == [[0, 1], [1, 1], [2, 1], [3, 1]]
    assert world.rest_length[:3].tolist() == [0.25] * 3


def test_a_rope_ends_exactly_where_the_level_says():
    world = world_of(rope(start=[0.1, 0.7], end=[0.3, -0.1], segments=7))
    assert places(world)[0] == [0.1, 0.7]
    assert places(world)[-1] == [0.3, -0.1]


def test_as_placed_is_the_square_root_of_the_sum_of_squares():
    world = world_of(rope(end=[3, 2.7]))
    dx, dy = np.diff(world.position[:4], axis=0).T.tolist()
    assert world.rest_length[:3].tolist() == [math.sqrt(x * x + y * y) for x, y in zip(dx, dy, strict=True)]


def test_the_end_mass_is_the_last_particle_s_alone():
    assert world_of(rope(particle_mass=2.0, end_mass=1000.0)).mass[:4].tolist() == [2.0, 2.0, 2.0, 1000.0]
    assert world_of(rope(particle_mass=2.0)).mass[:4].tolist() == [2.0] * 4


@pytest.mark.parametrize(("pin", "held"), [([], []), (["start"], [0]), (["end"], [3]), (["end", "start"], [0, 3])])
def test_the_pins_of_a_rope_hold_its_ends(pin, held):
    world = world_of(rope(pin=pin, velocity=[1, 2]))
    assert np.flatnonzero(world.inverse_mass[:4] == 0.0).tolist() == held
    assert [world.velocity[p].tolist() for p in range(4)] == [[0, 0] if p in held else [1, 2] for p in range(4)]


def test_a_bridge_is_a_top_row_then_a_bottom_row_straight_below():
    assert places(world_of(bridge())) == [[0, 2], [1, 2], [2, 2], [0, 1.5], [1, 1.5], [2, 1.5]]
    assert places(world_of(bridge(start=[2, 2], end=[0, 3])))[3:] == [[2, 1.5], [1, 2.0], [0, 2.5]]


def test_the_springs_of_a_bridge_are_chords_then_verticals_then_crossed_diagonals():
    top, bottom, verticals = [(0, 1), (1, 2)], [(3, 4), (4, 5)], [(0, 3), (1, 4), (2, 5)]
    diagonals = [(0, 4), (3, 1), (1, 5), (4, 2)]
    assert springs(world_of(bridge())) == top + bottom + verticals + diagonals


def test_the_pins_of_a_bridge_hold_both_rows():
    world = world_of(bridge(pin=["end"]))
    assert np.flatnonzero(world.inverse_mass[:6] == 0.0).tolist() == [2, 5]


def test_a_box_of_jelly_goes_row_by_row_from_the_bottom_left():
    world = world_of(jelly({"box": [2, 1]}, position=[10, 20]))
    assert places(world) == [[9, 19.5], [10, 19.5], [11, 19.5], [9, 20.5], [10, 20.5], [11, 20.5]]
    right, up = [(0, 1), (1, 2), (3, 4), (4, 5)], [(0, 3), (1, 4), (2, 5)]
    assert springs(world) == right + up + [(0, 4), (1, 3), (1, 5), (2, 4)]


def test_a_box_of_jelly_is_stretched_to_its_size():
    world = world_of(jelly({"box": [2.2, 0.9]}))
    assert sorted({x for x, _ in places(world)}) == pytest.approx([-1.1, 0.0, 1.1])
    assert sorted({y for _, y in places(world)}) == pytest.approx([-0.45, 0.45])


def test_a_box_thinner_than_its_spacing_is_one_row_in_the_middle():
    world = world_of(jelly({"box": [2, 0.3]}))
    assert places(world) == [[-1, 0], [0, 0], [1, 0]]
    assert springs(world) == [(0, 1), (1, 2)]


def test_a_jelly_turns_counter_clockwise_about_its_centre():
    world = world_of(jelly({"box": [2, 1]}, position=[10, 20], angle=math.pi / 2))
    assert places(world)[0] == [10.5, 19.0]
    assert places(world)[2] == [10.5, 21.0]


def test_trigonometry_is_rounded_before_it_places_anything():
    (turned,) = level_of(jelly({"box": [2, 2]}, angle=1.0)).bodies
    corner = expansion(turned).form[0].tolist()
    cosine, sine = round(math.cos(1.0), 12), round(math.sin(1.0), 12)
    assert corner == [-cosine + sine, -sine - cosine]


def test_a_circle_takes_the_grid_points_inside_and_on_its_border():
    world = world_of(jelly({"circle": 0.5}, spacing=0.1))
    expected = [(i, j) for j in range(-5, 6) for i in range(-5, 6) if i * i + j * j <= 25]
    assert np.allclose(places(world), np.array(expected) * 0.1)
    assert (3, 4) in expected


def test_a_circle_is_symmetric_about_its_centre():
    points = {(round(x, 9), round(y, 9)) for x, y in places(world_of(jelly({"circle": 2.3}, spacing=0.3)))}
    assert {(-x, y) for x, y in points} == points == {(x, -y) for x, y in points} == {(y, x) for x, y in points}


def test_a_polygon_takes_the_grid_points_inside_and_on_its_border():
    world = world_of(jelly({"polygon": [[0, 0], [0.3, 0], [0, 0.3]]}, spacing=0.1, position=[5, 5]))
    expected = [(i, j) for j in range(4) for i in range(4) if i + j <= 3]
    assert np.allclose(places(world), 5 + np.array(expected) * 0.1)


@pytest.mark.parametrize("turned", [False, True])
def test_a_polygon_with_notches_is_hollow_there(turned):
    comb = [[0, 0], [6, 0], [6, 3], [4, 3], [4, 1], [2, 1], [2, 3], [0, 3]]
    world = world_of(jelly({"polygon": comb[::-1] if turned else comb}))
    expected = [[x, y] for y in range(4) for x in range(7) if not (x == 3 and y > 1)]
    assert places(world) == expected


def test_the_springs_of_a_round_jelly_join_neighbours_that_exist():
    world = world_of(jelly({"circle": 1.0}))
    assert places(world) == [[0, -1], [-1, 0], [0, 0], [1, 0], [0, 1]]
    right, up, diagonals = [(1, 2), (2, 3)], [(0, 2), (2, 4)], [(0, 1), (0, 3), (1, 4), (3, 4)]
    assert springs(world) == right + up + diagonals


def test_a_mesh_is_what_it_lists():
    mesh = GOOD["bodies"][5]
    world = world_of({**mesh, "velocity": [1, 1]}, materials={"steel": {}})
    assert places(world) == [[0, 0], [1, 0]]
    assert world.mass[:2].tolist() == [1.0, 2.0]
    assert world.velocity[:2].tolist() == [[0, 0], [1, 2]]
    assert world.inverse_mass[:2].tolist() == [0.0, 0.5]
    assert springs(world) == [(0, 1)]


def test_slots_go_bodies_first_then_loose_ones_then_hands():
    loose = [{"id": "p", "position": [9, 9], "radius": 0.5}, {"id": "q"}]
    world = world_of(rope(), bridge(), particles=loose, springs=[{"a": "q", "b": "r.end"}, {"a": "p", "b": "b.start"}])
    assert world.particle_names[:4] == ["r.0", "r.1", "r.2", "r.3"]
    assert world.particle_names[9:13] == ["b.5", "p", "q", "+hand.0"]
    assert world.spring_names[:3] == ["r:0", "r:1", "r:2"]
    assert world.spring_names[13:17] == ["b:10", ":0", ":1", "+hand.0"]
    assert springs(world)[-2:] == [(11, 3), (10, 4)]
    assert world.radius[9:12].tolist() == [0.05, 0.5, 0.05]
    assert len(world.particle_names) == 12 + GRAB_COUNT


@pytest.mark.parametrize(
    ("reference", "slot"),
    [("p", 10), ("r.start", 0), ("r.end", 3), ("r.2", 2), ("b.start", 4), ("b.end", 6), ("b.5", 9)],
)
def test_references_find_particles_by_index_end_and_id(reference, slot):
    world = world_of(rope(), bridge(), particles=[{"id": "p"}, {"id": "q"}], springs=[{"a": "q", "b": reference}])
    assert springs(world)[-1] == (11, slot)


def test_materials_are_default_first_then_those_of_the_file_in_its_order():
    materials = {"z": {"stiffness": 0.25, "damping": 0.75}, "a": {"law": "hooke", "k": 70, "c": 3}}
    world = world_of(rope(material="z"), bridge(material="a"), rope(id="s"), materials=materials)
    assert world.material_names == ("default", "z", "a")
    assert world.material[[0, 3, 14]].tolist() == [1, 2, 0]
    assert world.law[[0, 3, 14]].tolist() == [LAW_NISSEN, LAW_HOOKE, LAW_NISSEN]
    assert world.stiffness[[0, 14]].tolist() == [0.25, 0.5]
    assert world.damping[[0, 14]].tolist() == [0.75, 0.9]
    assert (world.hooke_stiffness[3], world.hooke_damping[3]) == (70.0, 3.0)


def test_a_level_may_say_what_default_is():
    world = world_of(rope(), materials={"x": {}, "default": {"stiffness": 0.125}})
    assert world.material_names == ("default", "x")
    assert world.stiffness[0] == 0.125


def test_the_settings_of_the_level_are_the_world_s():
    settings = {"gravity": [1, -2], "tick_rate": 120, "substeps": 4, "solver": "single_pass"}
    settings |= {"iterations": 7, "warm_start": 0.25}
    world = world_of(rope(), settings=settings)
    made = world.settings
    assert (made.gravity, made.tick_rate, made.substeps) == ((1.0, -2.0), 120, 4)
    assert (made.solver, made.iterations, made.warm_start) == ("single_pass", 7, 0.25)


def test_an_empty_level_builds_and_steps():
    world = world_of()
    step(world)
    assert (world.particle_count, world.tick) == (0, 1)


def test_the_same_level_builds_the_same_bits():
    level = parse_level(encoded(GOOD), "x.json")
    assert state_hash(build_world(level)) == state_hash(build_world(level))


def test_negative_zeros_do_not_reach_the_world():
    world = world_of(rope(start=[-0.0, 0.0], velocity=[-0.0, -0.0]), particles=[{"id": "p", "position": [-0.0, -0.0]}])
    for array in (world.position, world.velocity, world.radius, world.rest_length):
        assert not np.any(np.signbit(array))


@pytest.mark.parametrize("index", range(len(GOOD["bodies"])))
def test_what_is_counted_before_is_what_is_built(index):
    body = parse_level(encoded(GOOD), "x.json").bodies[index]
    built = expansion(body)
    assert built.form_count == (len(built.form), len(built.form_pairs))
    assert built.count == (len(built.mass), len(built.pairs))


@pytest.mark.slow
@pytest.mark.parametrize(
    "body",
    [
        rope(segments=99_989),
        bridge(segments=49_998),
        {"type": "girder", "id": "g", "start": [0, 0], "end": [9, 1], "segments": 49_994},
        {"type": "web", "id": "w", "radius": 9, "spokes": 99_998, "rings": 1},
        {"type": "web", "id": "w", "radius": 9, "spokes": 3, "rings": 33_330},
        {"type": "wheel", "id": "w", "radius": 9, "thickness": 1, "segments": 49_994},
        jelly({"box": [315, 315]}),
        pytest.param(jelly({"circle": 177}), marks=pytest.mark.whole_world),
        pytest.param(jelly({"polygon": [[0, 0], [440, 0], [0, 440]]}), marks=pytest.mark.whole_world),
    ],
)
def test_a_hundred_thousand_particles_are_built(body):
    world = world_of(body)
    assert 95_000 < world.particle_count - GRAB_COUNT <= 100_000


def test_a_level_made_in_python_is_checked_before_it_is_built():
    level = level_of(rope())
    broken = level.model_copy(update={"bodies": (level.bodies[0].model_copy(update={"segments": 10**12}),)})
    with pytest.raises(LevelError, match=r'level "n": bodies\.0\.segments: brings the level above 100,000 particles'):
        build_world(broken)


def test_a_level_that_is_read_and_built_fills_its_polygons_once(monkeypatch):
    filled = []

    def counted(*given):
        filled.append(given)
        return polygon_grid(*given)

    monkeypatch.setattr("sandbox.level.kinds.jelly.polygon_grid", counted)
    level = level_of(jelly({"polygon": [[0, 0], [4, 0], [0, 4]]}), contacts={})
    world = build_world(level)
    assert (world.particle_slot("j.14"), len(filled)) == (14, 1)


def test_the_plan_of_a_level_is_no_part_of_what_it_says():
    level = parse_level(encoded(GOOD), "x.json")
    assert level == Level.model_validate_json(encoded(GOOD))
    assert kept_plan(level) is not None
    assert kept_plan(level.model_copy()) is None
    assert kept_plan(replaced(level, name="another")) is None
