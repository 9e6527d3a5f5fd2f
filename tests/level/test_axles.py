"""Wheels and what they are mounted on: what they touch, and what they pass through because they say so."""

import json

import numpy as np
import pytest

from sandbox.level.assembly.build_world import build_world
from sandbox.level.document.canonical import level_text
from sandbox.level.format.level_error import LevelError
from sandbox.level.format.limits import COLLISION_GROUP_LIMIT
from sandbox.level.plan.surfaces import mount_of
from sandbox.level.reading.parse import parse_level
from sandbox.physics.step import step

WHEEL = {"type": "wheel", "id": "w", "radius": 0.5, "thickness": 0.15, "segments": 16}
# A plank through the wheel, joined to its hub by a weld.
PLANK = {"type": "jelly", "id": "plank", "shape": {"box": [4.0, 0.2]}, "spacing": 0.2}


def level(**parts):
    data = {"format": "spring-sandbox/level", "version": 3, "name": "test", "contacts": {}, **parts}
    return parse_level(json.dumps(data | {"settings": {"gravity": [0.0, 0.0]}}).encode(), "test")


def touch(world, a, b):
    """Whether two particles, by name, may touch."""
    a, b = world.particle_slot(a), world.particle_slot(b)
    return bool(world.group[a] & world.collides[b] and world.group[b] & world.collides[a])


def vehicle(**wheel):
    return level(
        bodies=[PLANK, WHEEL | wheel, WHEEL | {"id": "other", "position": [0, 5]}],
        particles=[{"id": "load", "position": [0, 1]}, {"id": "stone", "position": [0, 9]}],
        springs=[{"a": "plank.3", "b": "load"}],
        welds=[["plank.10", "w.hub"]],
    )


def test_a_wheel_touches_all_but_its_mount_where_it_says_so():
    free, usual = build_world(vehicle(touches_mount=False)), build_world(vehicle())
    for name in ("plank.0", "load"):
        assert touch(usual, "w.20", name) and not touch(free, "w.20", name)
    for name in ("other.20", "stone", "w.24"):
        assert touch(usual, "w.20", name) and touch(free, "w.20", name)
    assert touch(free, "plank.0", "load") and touch(free, "plank.0", "other.20")


def test_a_level_that_says_nothing_of_it_has_the_groups_that_it_had():
    world = build_world(vehicle())
    assert set(world.group[: world.grab_particle].tolist()) == {2}
    assert "touches_mount" not in level_text(vehicle())
    assert parse_level(level_text(vehicle(touches_mount=False)).encode(), "again") == vehicle(touches_mount=False)


def test_a_wheel_that_touches_nothing_of_its_group_s_list_stays_so():
    only = level(
        bodies=[PLANK | {"collides": ["terrain"]}, WHEEL | {"touches_mount": False, "collision_group": "car"}],
        particles=[
            {"id": "a", "position": [5, 0], "collides": ["car"]},
            {"id": "b", "position": [6, 0], "collides": ["default"]},
        ],
        welds=[["plank.10", "w.hub"]],
    )
    world = build_world(only)
    assert touch(world, "w.20", "a") and not touch(world, "w.20", "b") and not touch(world, "w.20", "plank.0")


def test_a_mount_is_what_hangs_together_with_the_hub_and_not_what_is_tied_to_the_rim():
    parts = level(
        bodies=[WHEEL, WHEEL | {"id": "v", "position": [3, 0]}, PLANK | {"position": [9, 0]}],
        particles=[{"id": "a", "position": [0, 2]}, {"id": "b", "position": [0, 3]}, {"id": "c", "position": [0, 4]}],
        springs=[{"a": "w.hub", "b": "a"}, {"a": "b", "b": "a"}, {"a": "w.20", "b": "c"}, {"a": "c", "b": "plank.0"}],
        welds=[["b", "v.0"]],
    )
    assert mount_of(parts, 0) == {1, 3, 4}
    assert mount_of(parts, 1) == {0, 3, 4, 5, 2}


@pytest.mark.parametrize("solver", ["direct", "iterative"])
def test_a_free_wheel_turns_inside_its_mount(solver):
    parts = vehicle(touches_mount=False, motor={"speed": 3.0, "torque": 500.0})
    world = build_world(parts.model_copy(update={"settings": parts.settings.model_copy(update={"solver": solver})}))
    rim = world.particle_slot("w.17")
    angles = []
    for _ in range(40):
        step(world)
        x, y = world.position[rim] - world.position[world.particle_slot("w.hub")]
        angles.append(np.arctan2(y, x))
    assert np.unwrap(angles)[-1] - angles[0] > 0.8


def test_more_free_wheels_than_there_are_groups_are_refused():
    with pytest.raises(LevelError) as refused:
        level(bodies=[WHEEL | {"id": f"w{k}", "position": [k, 0], "touches_mount": False} for k in range(59)])
    most = COLLISION_GROUP_LIMIT - 2
    told = f"have 59 wheels that do not touch their mounts; at most {most} may beside the groups"
    assert refused.value.faults == [f"test: bodies: {told}"]
    with pytest.raises(LevelError, match=r"bodies.0.touches_mount: 1 is not true or false"):
        level(bodies=[WHEEL | {"touches_mount": 1}])
