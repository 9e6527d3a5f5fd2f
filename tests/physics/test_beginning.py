"""What the beginning of a run shows: floats or sinks as it is said, as deep; overlaps with their depths."""

import json

import numpy as np
import pytest

from sandbox.level.assembly.build_world import build_world
from sandbox.level.reading.parse import parse_level
from sandbox.physics.analysis.beginning import draught_of, overlap_text, overlaps, sinking, sinking_text
from sandbox.physics.analysis.energy import discs_in_water
from sandbox.physics.step import step
from tests.support.pools import after, free, pool

GROUND = {"id": "ground", "polyline": [[-9, 0], [9, 0]]}


def world_of(**parts):
    head = {"format": "spring-sandbox/level", "version": 4, "name": "Beginning"}
    return build_world(parse_level(json.dumps(head | parts).encode(), "beginning"))


def box(name, y, x=0.0, **fields):
    return {"type": "jelly", "id": name, "shape": {"box": [1, 1]}, "position": [x, y], "spacing": 0.25} | fields


def boxes(step, count=4):
    return world_of(contacts={}, terrain=[GROUND], bodies=[box(f"b{k}", 0.55 + step * k) for k in range(count)])


def overlapping(world):
    step(world)
    return overlaps(world)


def of_kind(kind, size, mass):
    """A world of one thing of that size [m] above water, each particle of that mass."""
    firm = {"id": "it", "firmness": {"sag": 0.0}, "particle_mass": mass}
    place = {"position": [0, 0.3 + size]}
    if kind == "ball":
        parts = {"particles": [{"id": "it", "radius": size, "mass": mass, **place}]}
    elif kind == "wheel":
        parts = {"bodies": [{"type": "wheel", "radius": size, "thickness": size / 2, "segments": 10, **place, **firm}]}
    else:
        shape = {"circle": size} if kind == "circle" else {"box": [3 * size, size]}
        mesh = {"mesh": "fitted" if kind == "circle" else "grid", "spacing": size / 3}
        parts = {"bodies": [{"type": "jelly", "shape": shape, **mesh, **place, **firm}]}
    return world_of(zones=[pool()], **parts)


@pytest.mark.parametrize("kind", ["ball", "wheel", "circle", "box"])
@pytest.mark.parametrize("share", [0.3, 0.8, 1.15])
def test_what_is_said_to_float_floats_as_deep_within_a_fiftieth_and_what_is_said_to_sink_sinks(kind, share):
    first = of_kind(kind, 0.7, 1.0)
    borne = draught_of(first, np.flatnonzero(free(first))).borne
    world = of_kind(kind, 0.7, borne * share)
    slots = np.flatnonzero(free(world))
    said = draught_of(world, slots)
    assert said.borne == pytest.approx(1.0 / share)
    after(world, 20)
    reach = np.where(np.isin(slots, discs_in_water(world)), world.radius[slots], 0.0)
    deep = -float((world.position[slots, 1] - reach).min())
    assert deep > 5.0 if said.depth is None else deep == pytest.approx(said.depth, rel=0.02)
    assert (said.depth is None) == (share > 1.0)


def test_what_water_holds_no_longer_what_a_pin_holds_and_what_lies_beside_has_no_draught_and_nothing_moves():
    world = world_of(zones=[pool()], bodies=[box("held", 1, pinned=[0]), box("beside", 1, x=30), box("over", 1, x=9)])
    before = world.position.copy()
    held, beside, over = (draught_of(world, np.flatnonzero(world.owner[:75] == owner)) for owner in range(3))
    assert held is None and beside is None and over is not None
    assert np.array_equal(before, world.position)


def test_what_sinks_is_named_unless_ground_lies_between_and_a_raft_bears_what_is_joined_to_it():
    heavy = {"id": "heavy", "position": [0, 1], "radius": 0.1, "mass": 5.0}
    raft = box("raft", 1.5, shape={"box": [4, 0.5]}, particle_mass=0.05)

    def sunk(**parts):
        world = world_of(zones=[pool()], **parts)
        return [sinking_text(world, *each, "pool") for each in sinking(world) if each is not None]

    (line,) = sunk(particles=[heavy])
    assert line == '"heavy" would sink in "pool": its water bears 6% of the weight'
    assert sunk(particles=[heavy], terrain=[{"id": "shore", "polyline": [[-9, 0.5], [9, 0.5]]}]) == []
    assert sunk(bodies=[raft], particles=[heavy], springs=[{"a": "heavy", "b": "raft.0"}]) == []


@pytest.mark.parametrize(("step", "depth"), [(1.1, None), (1.05, 0.05), (1.0, 0.1)])
def test_boxes_on_each_other_overlap_by_what_their_radii_need(step, depth):
    world = boxes(step)
    found = overlapping(world)
    assert [round(each.depth, 6) for each in found] == ([] if depth is None else [depth] * 3)
    if depth is not None:
        text = overlap_text(world, found)
        assert text.startswith(f"3 pairs of bodies overlap at the start, by up to {depth:g} m (b")
        assert text.endswith("): they come apart as the run begins")


def test_outlines_that_cross_are_told_apart_and_one_pair_is_named():
    world = boxes(0.6, count=2)
    found = overlapping(world)
    assert [each.depth for each in found] == [np.inf]
    assert overlap_text(world, found).startswith('"b0" and "b1" overlap at the start, so far that their outlines cross')


def test_a_rope_does_not_overlap_the_ball_that_it_hangs_on_whether_joined_or_pinned_in_the_same_place():
    rope = {"type": "rope", "id": "rope", "start": [0, 3], "end": [2, 3], "segments": 8, "pin": ["start"]}
    ball = {"id": "ball", "position": [2, 3], "radius": 0.4}
    rim = {"id": "rim", "position": [0, 3], "radius": 0.15, "pinned": True}
    parts = {"contacts": {}, "bodies": [rope], "particles": [ball, rim]}
    assert overlapping(world_of(**parts, welds=[["rope.end", "ball"]])) == []
    assert [round(each.depth, 2) > 0.2 for each in overlapping(world_of(**parts))] == [True]
