"""Areas of jellies, rings and bending, as levels say them and as worlds have them."""

import json

import numpy as np
import pytest
from pydantic import ValidationError

from sandbox.level.assembly.build_world import build_world
from sandbox.level.format.level_error import LevelError
from sandbox.level.kinds.bodies import expansion
from sandbox.level.kinds.body_def import BendingDef
from sandbox.level.kinds.jelly import JellyDef
from sandbox.level.kinds.mesh import MeshDef
from sandbox.level.kinds.ring import RingDef
from sandbox.level.kinds.rope import RopeDef
from sandbox.level.reading.files import parse_level
from sandbox.physics.analysis.energy import measure_constraints
from sandbox.physics.constraints import AREA, BEND


def world_of(*bodies, **level):
    data = {"format": "spring-sandbox/level", "version": 3, "name": "Test", "bodies": bodies, **level}
    return build_world(parse_level(json.dumps(data).encode(), "test"))


def jelly(shape, **changes):
    return {"type": "jelly", "id": "j", "shape": shape, "spacing": 0.25, **changes}


SHAPES = [
    {"box": [2.0, 1.0]},
    {"circle": 1.0},
    {"polygon": [[0, 0], [2, 0], [2, 2], [1, 0.5], [0, 2]]},
    {"polygon": [[0, 2], [1, 0.5], [2, 2], [2, 0], [0, 0]]},
]


@pytest.mark.parametrize("shape", SHAPES)
def test_triangles_of_a_jelly_are_counter_clockwise_and_do_not_overlap(shape):
    body = JellyDef.model_validate_json(json.dumps(jelly(shape, angle=0.4)))
    world = world_of(jelly(shape, angle=0.4))
    triangles = expansion(body).polygons()
    assert len(triangles) == world.constraint_count
    assert np.all(world.constraint_kind == AREA)
    assert world.constraint_rest[:, 0] == pytest.approx(np.full(len(triangles), 0.25**2 / 2))
    # Every side belongs to two triangles at most, which walk along it in opposite directions.
    sides = [tuple(side) for t in triangles.tolist() for side in (t[:2], t[1:], [t[2], t[0]])]
    assert len(set(sides)) == len(sides)
    # Each particle with a cell beside it is held.
    assert set(world.corner_particle.tolist()) == set(range(world.grab_particle)) - _lonely(world, triangles)


def _lonely(world, triangles):
    return set(range(world.grab_particle)) - set(np.unique(triangles).tolist())


def test_areas_fill_a_box_and_can_be_switched_off():
    assert np.sum(world_of(jelly({"box": [2.0, 1.0]})).constraint_rest[:, 0]) == pytest.approx(2.0)
    assert world_of(jelly({"box": [2.0, 1.0]}, area=False)).constraint_count == 0
    hooke = {"stiff": {"law": "hooke"}}
    assert world_of(jelly({"box": [2.0, 1.0]}, material="stiff"), materials=hooke).constraint_count == 0


def test_areas_have_the_coefficients_of_the_material_and_go_with_its_springs():
    materials = {"soft": {"stiffness": 0.125, "damping": 0.25}}
    world = world_of(jelly({"box": [1.0, 1.0]}, material="soft"), materials=materials)
    assert set(world.constraint_stiffness) == {0.125} and set(world.constraint_damping) == {0.25}
    whole = world.constraint_count
    # The bottom left spring is a side of the triangle above it alone.
    assert world_of(jelly({"box": [1.0, 1.0]}, cut=[0])).constraint_count == whole - 1


def test_a_pose_leaves_areas_and_angles_as_the_form_has_them():
    pose = [[0, 0], [1, 0], [1, 1], [0, 1]]
    rope = {"type": "rope", "id": "r", "start": [0, 0], "end": [3, 0], "segments": 3, "pose": pose, "bending": {}}
    world = world_of(rope)
    assert world.constraint_rest.tolist() == [[1.0, 0.0], [1.0, 0.0]]
    assert np.all(measure_constraints(world)[0] > 1.0)


def test_a_ring_keeps_its_area_as_one_element_times_its_inflation():
    ring = {"type": "ring", "id": "balloon", "position": [3, 1], "radius": 2.0, "segments": 40, "inflation": 1.5}
    world = world_of(ring)
    assert (world.spring_count - 10, world.constraint_count, len(world.corner_particle)) == (40, 1, 40)
    own = 0.5 * 40 * 4.0 * np.sin(2 * np.pi / 40)
    assert world.constraint_rest[0] == pytest.approx([1.5 * own, own])
    assert world.particle_names[0] == "balloon.0"
    assert world.position[0].tolist() == [5.0, 1.0]
    assert world_of({**ring, "inflation": None}).constraint_count == 0
    assert world_of({**ring, "cut": [7]}).constraint_count == 0


@pytest.mark.parametrize("inflation", [-0.1, 101.0, "much", True])
def test_an_inflation_out_of_range_is_refused(inflation):
    ring = {"type": "ring", "id": "r", "radius": 1.0, "segments": 9, "inflation": inflation}
    with pytest.raises(LevelError, match=r"bodies\.0\.inflation"):
        world_of(ring)


def test_a_mesh_bends_where_just_two_springs_meet():
    springs = [[0, 1], [1, 2], [2, 3], [2, 4]]
    mesh = {
        "type": "mesh", "id": "m", "particles": [[0, 0], [1, 0], [2, 1], [3, 1], [2, 3]], "springs": springs,
        "bending": {"stiffness": 0.25, "damping": 0.5},
    }  # fmt: skip
    world = world_of(mesh)
    assert world.corner_particle.tolist() == [0, 1, 2]
    assert (world.constraint_kind[0], world.constraint_stiffness[0], world.constraint_damping[0]) == (BEND, 0.25, 0.5)
    assert world.constraint_rest[0] == pytest.approx([np.sqrt(0.5), np.sqrt(0.5)])


def test_two_corners_welded_into_one_keep_nothing():
    rope = {"type": "rope", "id": "r", "start": [0, 0], "end": [3, 0], "segments": 3, "bending": {}}
    assert world_of(rope, welds=[["r.0", "r.3"]]).constraint_count == 2
    assert world_of(rope, welds=[["r.0", "r.2"]]).constraint_count == 1


def test_particles_in_one_place_make_no_angle():
    mesh = {"type": "mesh", "id": "m", "particles": [[0, 0], [0, 0], [1, 0]], "springs": [[0, 1], [1, 2]]}
    assert world_of({**mesh, "bending": {}}).constraint_count == 0


@pytest.mark.parametrize("kind", [RopeDef, RingDef, MeshDef])
def test_bending_of_every_kind_has_the_same_defaults_and_ranges(kind):
    assert kind.model_fields["bending"].default is None
    assert (BendingDef().stiffness, BendingDef().damping) == (0.5, 0.9)
    with pytest.raises(ValidationError):
        BendingDef(stiffness=1.5)
