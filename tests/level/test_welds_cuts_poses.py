"""What a level changes of its bodies: pins, cuts and poses; and welds, which make particles one."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sandbox.level.assembly.build_world import build_world
from sandbox.level.document.canonical import level_text
from sandbox.level.document.model import ParticleDef
from sandbox.level.format.quantities import replaced
from sandbox.level.plan.plan import united
from sandbox.level.reading.files import LevelError, parse_level
from sandbox.physics.snapshot import state_hash
from sandbox.physics.step import step
from tests.support.malformed_levels import encoded


def level_of(*bodies, **keys):
    whole = {"format": "spring-sandbox/level", "version": 3, "name": "n", "bodies": list(bodies), **keys}
    return parse_level(encoded(whole), "x.json")


def world_of(*bodies, **keys):
    return build_world(level_of(*bodies, **keys))


def rope(**keys):
    return {"type": "rope", "id": "r", "start": [0, 1], "end": [3, 1], "segments": 3, **keys}


def second(**keys):
    return rope(**{"id": "s", "start": [3, 1], "end": [3, -1], "segments": 2, **keys})


def springs(world):
    ends = zip(world.particle_a.tolist(), world.particle_b.tolist(), strict=True)
    return list(ends)[: world.grab_spring]


def test_pins_by_number_come_beside_those_by_end():
    world = world_of(rope(pin=["start"], pinned=[2, 2], velocity=[1, 0]))
    assert np.flatnonzero(world.inverse_mass[:4] == 0.0).tolist() == [0, 2]
    assert world.velocity[:4, 0].tolist() == [0, 1, 0, 1]


def test_springs_that_are_cut_are_left_out_and_the_others_keep_their_names():
    world = world_of(rope(cut=[1, 1]), second())
    assert world.spring_names[:4] == ["r:0", "r:2", "s:0", "s:1"]
    assert springs(world) == [(0, 1), (2, 3), (4, 5), (5, 6)]


def test_a_body_may_lose_all_its_springs():
    assert world_of(rope(cut=[0, 1, 2])).grab_spring == 0


def test_a_pose_places_the_particles_and_leaves_the_rest_lengths():
    pose = [[0, 0], [0, 1], [0, 5], [0, 6]]
    world = world_of(rope(pose=pose))
    assert world.position[:4].tolist() == pose
    assert world.rest_length[:3].tolist() == [1.0, 1.0, 1.0]
    assert world_of(rope(pose=pose, rest_length=0.5)).rest_length[:3].tolist() == [0.5] * 3


def test_a_loose_spring_is_as_long_as_its_ends_are_posed_apart():
    pose = [[0, 0], [0, 1], [0, 2], [0, 7]]
    world = world_of(rope(pose=pose), particles=[{"id": "p"}], springs=[{"a": "p", "b": "r.end"}])
    assert world.rest_length[3] == 7.0


def test_a_pose_takes_no_negative_zero_into_the_world():
    world = world_of(rope(pose=[[-0.0, -0.0]] + [[1.0, 1.0]] * 3))
    assert not np.any(np.signbit(world.position))


def test_welded_particles_are_one_in_the_slot_and_place_of_the_first():
    world = world_of(rope(), second(start=[3.5, 1.25]), welds=[["s.start", "r.end"]])
    assert world.particle_names[:6] == ["r.0", "r.1", "r.2", "r.3", "s.1", "s.2"]
    assert world.position[3].tolist() == [3.0, 1.0]
    assert springs(world) == [(0, 1), (1, 2), (2, 3), (3, 4), (4, 5)]
    assert [world.particle_slot(name) for name in ("r.3", "r.end", "s.0", "s.start")] == [3] * 4
    assert world.particle_slot("s.end") == world.particle_slot("s.2") == 5


def test_rest_lengths_stay_those_of_the_form_where_a_weld_moves_an_end():
    apart = world_of(second(start=[3.5, 1.25]))
    world = world_of(rope(), second(start=[3.5, 1.25]), welds=[["s.start", "r.end"]])
    assert world.rest_length[3:5].tolist() == apart.rest_length[:2].tolist()


def test_masses_of_welded_particles_add_and_momentum_is_kept():
    moving = [rope(particle_mass=2.0, velocity=[1, 0]), second(particle_mass=6.0, velocity=[0, 2])]
    world = world_of(*moving, welds=[["r.end", "s.start"]])
    assert world.mass[3] == 8.0
    assert world.velocity[3].tolist() == [0.25, 1.5]
    assert world.inverse_mass[3] == 1.0 / 8.0


def test_a_union_is_held_where_one_of_it_is_and_as_large_as_its_largest():
    loose = [{"id": "p", "radius": 0.5, "velocity": [3, 0]}, {"id": "q", "radius": 0.2, "pinned": True}]
    world = world_of(rope(), particles=loose, welds=[["p", "r.end"], ["q", "p"]])
    assert (world.radius[3], world.inverse_mass[3], world.mass[3]) == (0.5, 0.0, 3.0)
    assert world.velocity[3].tolist() == [0.0, 0.0]
    assert world.grab_particle == 4


def test_chains_of_welds_are_one_union_in_any_order():
    bodies = [rope(), second(), rope(id="t")]
    welds = [["t.0", "s.0"], ["s.0", "r.3"], ["t.0", "r.3"]]
    first = world_of(*bodies, welds=welds)
    assert first.mass[3] == 3.0
    assert state_hash(first) == state_hash(world_of(*bodies, welds=[[b, a] for a, b in reversed(welds)]))


def test_a_level_without_welds_is_built_as_it_would_be_with_none():
    plain, bodies = world_of(rope(velocity=[0.1, 0.3])), [rope(velocity=[0.1, 0.3]), second()]
    welded = world_of(*bodies, welds=[["r.end", "s.start"]])
    assert plain.velocity[:3].tolist() == welded.velocity[:3].tolist()


def test_a_weld_carries_a_load_like_the_rope_in_one_piece():
    steel = {"materials": {"default": {"stiffness": 1.0, "damping": 1.0}}, "settings": {"gravity": [0, -10]}}
    whole = rope(start=[0, 0], end=[0, -4], segments=4, pin=["start"], end_mass=50.0)
    upper = rope(start=[0, 0], end=[0, -2], segments=2, pin=["start"])
    lower = {"type": "mesh", "id": "m", "particles": [[0, -2], [0, -3], [0, -4]], "springs": [[0, 1], [1, 2]]}
    parts = [{**upper, "end_mass": 0.25}, {**lower, "masses": [0.75, 1, 50]}]
    one, two = world_of(whole, **steel), world_of(*parts, welds=[["r.end", "m.0"]], **steel)
    for _ in range(60):
        step(one)
        step(two)
    assert two.position[:5].tolist() == one.position[:5].tolist()


def test_a_welded_level_runs_the_same_twice():
    level = level_of(rope(pin=["start"]), second(), welds=[["r.end", "s.start"]])
    worlds = [build_world(level), build_world(parse_level(level_text(level).encode(), "again"))]
    for world in worlds:
        for _ in range(100):
            step(world)
    assert state_hash(worlds[0]) == state_hash(worlds[1])


@pytest.mark.parametrize(
    ("keys", "fault"),
    [
        ({"welds": [["r.0", "s.1"], ["s.1", "r.1"]]}, "bodies.0: the welds make one particle of both ends of"),
        ({"welds": [["r.0", "s.0"]], "springs": [{"a": "s.0", "b": "r.0"}]}, "springs.0: the welds make one particle"),
        ({"welds": [["r.0", "s.0"]], "particles": [{"id": "r"}]}, 'particles.0.id: "r" is taken'),
    ],
)
def test_what_welds_make_impossible_is_refused(keys, fault):
    with pytest.raises(LevelError) as refused:
        level_of(rope(), second(), **keys)
    assert refused.value.faults[0].startswith("x.json: " + fault)


def test_a_spring_that_is_cut_is_no_hindrance_to_a_weld():
    world = world_of(rope(cut=[0]), welds=[["r.0", "r.1"]])
    assert springs(world) == [(0, 1), (1, 2)]


def test_no_union_is_heavier_than_a_particle_may_be():
    with pytest.raises(LevelError, match=r"welds\.0: makes a particle heavier than the limit 1000000000"):
        level_of(rope(particle_mass=6e8), second(particle_mass=6e8), welds=[["r.0", "s.0"]])


@given(st.lists(st.tuples(st.integers(0, 11), st.integers(0, 11)), max_size=20))
def test_a_union_is_what_welds_reach_and_goes_by_its_first(pairs):
    reached = [{slot} for slot in range(12)]
    for a, b in pairs:
        joined = reached[a] | reached[b]
        for slot in joined:
            reached[slot] = joined
    assert united(12, pairs).tolist() == [min(slots) for slots in reached]


def test_a_hundred_thousand_welds_in_a_chain_are_one_union():
    count = 100_000
    assert not np.any(united(count, [(slot, slot + 1) for slot in reversed(range(count - 1))]))


def test_a_replaced_description_is_one_that_was_made_so():
    particle = ParticleDef(id="p", position=(1.0, 2.0), mass=3.0)
    moved = replaced(particle, position=(5.0, 6.0))
    made = ParticleDef(id="p", position=(5.0, 6.0), mass=3.0)
    assert (moved, moved.model_dump()) == (made, made.model_dump())
    assert particle.position == (1.0, 2.0)
    assert moved.model_copy(update={"mass": 4.0}).mass == 4.0
