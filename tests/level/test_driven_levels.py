"""Limits, muscles, hydraulics, motors, air and gravity scale in level files."""

import json

import numpy as np
import pytest

from sandbox.level.assembly.build_world import build_world
from sandbox.level.document.canonical import level_text
from sandbox.level.format.level_error import LevelError
from sandbox.level.format.limits import LIMITED_LIMIT, MOTOR_LIMIT
from sandbox.level.plan.actuators import actuators, driving_keys
from sandbox.level.reading.parse import parse_level
from sandbox.level.reading.salvage import salvage
from sandbox.physics.pipeline.block_owner import block_of

WHEEL = {"type": "wheel", "id": "w", "radius": 1, "thickness": 0.3, "segments": 6}
ROPE = {"type": "rope", "id": "r", "start": [0, 5], "end": [4, 5], "segments": 4}


def text(**parts):
    """A level file with these parts."""
    return json.dumps({"format": "spring-sandbox/level", "version": 3, "name": "Driven", **parts}).encode()


def level(**parts):
    """The level of that file."""
    return parse_level(text(**parts), "x")


def full():
    """A level with one of everything that is driven or has limits."""
    return level(
        settings={"wind": [2, -1], "drag": 0.25},
        materials={
            "glass": {"tension_limit": 0.01, "compression_limit": 0.02},
            "lead": {"law": "hooke", "yield_strain": 0.1, "yield_limit": 0.5},
        },
        bodies=[
            {**ROPE, "material": "glass", "gravity_scale": 0.5},
            {**ROPE, "id": "m", "drive": {"amplitude": 0.3, "period": 30, "phase": 0.25}},
            {**WHEEL, "motor": {"speed": 3, "torque": 40, "key": "d", "reverse_key": "a"}},
            {**WHEEL, "id": "v", "motor": {"speed": -3, "torque": 40}},
        ],
        particles=[{"id": "p", "gravity_scale": -2}, {"id": "q", "position": [1, 0], "mass": 3}],
        springs=[
            {"a": "p", "b": "q", "hydraulic": {"shortest": 0.5, "longest": 2, "rate": 1, "key": "d"}},
            {"a": "p", "b": "q", "rest_length": 2, "drive": {"amplitude": 0.1, "period": 8}},
            {"a": "p", "b": "q", "rest_length": 1.5, "hydraulic": {"shortest": 0.5, "longest": 2, "rate": 0.5}},
        ],
    )


def test_everything_arrives_in_the_world():
    world = build_world(full())
    assert world.settings.wind == (2.0, -1.0) and world.settings.drag == 0.25
    slot = world.particle_slot
    assert world.gravity_scale[[slot("r.0"), slot("m.0"), slot("p"), slot("q")]].tolist() == [0.5, 1.0, -2.0, 1.0]
    never = np.inf
    assert world.material_names == ("default", "glass", "lead")
    assert world.limits.tension.tolist() == [never, 0.01, never]
    assert world.limits.compression.tolist() == [never, 0.02, never]
    assert world.limits.yielding.tolist() == [never, never, 0.1]
    assert world.limits.yield_share.tolist() == [0.0, 0.0, 0.5]
    actuators = world.actuators
    assert actuators.names == ("w", "v", ":0", ":2")
    assert world.actuator_value.tolist() == [0.0, 1.0, 0.0, 0.0]
    assert [world.spring_names[s] for s in actuators.muscles.spring] == ["m:0", "m:1", "m:2", "m:3", ":1"]
    assert [world.spring_names[s] for s in actuators.hydraulics.spring] == [":0", ":2"]
    assert [world.particle_names[s] for s in actuators.motors.hub] == ["w.0", "v.0"]
    rim = actuators.motors.rim[actuators.motors.rim_start[1] : actuators.motors.rim_start[2]]
    assert [world.particle_names[s] for s in rim] == [f"v.{k}" for k in range(1, 13)]


def test_a_muscle_begins_with_the_length_of_tick_0_and_a_hydraulic_with_its_shortest_or_its_own():
    world = build_world(full())
    lengths = world.rest_length
    assert lengths[world.spring_slot("m:0")] == pytest.approx(1.3)
    assert lengths[world.spring_slot(":0")] == 0.5
    assert lengths[world.spring_slot(":2")] == 1.5
    assert world.natural_length[world.spring_slot("m:0")] == 1.0


def test_what_is_driven_survives_writing_and_reading():
    first = full()
    written = level_text(first)
    again = parse_level(written.encode(), "again")
    assert again == first
    assert level_text(again) == written
    assert "yield_limit" in written and "null" not in written


def test_a_welded_particle_is_pulled_as_both_were():
    world = build_world(
        level(
            bodies=[{**ROPE, "gravity_scale": 0.5, "end_mass": 3.0}],
            particles=[{"id": "p", "position": [4, 5], "gravity_scale": -1.5}],
            welds=[["r.end", "p"]],
        )
    )
    assert world.gravity_scale[world.particle_slot("p")] == 0.0


def test_keys_drive_parts_forward_and_backward():
    assert driving_keys(full()) == {"d": [(0, 1.0), (2, 1.0)], "a": [(0, -1.0)]}
    assert [actuator.name for actuator in actuators(full())] == ["w", "v", ":0", ":2"]


HYDRAULIC = {"shortest": 1, "longest": 2, "rate": 1}
ENDS = {"particles": [{"id": "p"}, {"id": "q", "position": [1, 0]}]}
FAULTS = [
    ({"materials": {"m": {"tension_limit": 0}}}, "materials.m.tension_limit: 0 is not above 0"),
    ({"materials": {"m": {"compression_limit": 1.5}}}, "materials.m.compression_limit: 1.5 is above the limit 1"),
    ({"materials": {"m": {"yield_strain": 0.9}}}, "materials.m.yield_strain: 0.9 is above the limit 0.5"),
    ({"settings": {"drag": -1}}, "settings.drag: -1 is below the limit 0"),
    ({"settings": {"wind": [1]}}, "settings.wind: needs 2 numbers, has 1"),
    ({"bodies": [{**ROPE, "gravity_scale": 1e4}]}, "bodies.0.gravity_scale: 10000.0 is above the limit 1000"),
    ({"bodies": [{**ROPE, "drive": {"amplitude": 0.2}}]}, "bodies.0.drive.period: is missing; it has no default"),
    (
        {"bodies": [{**ROPE, "drive": {"amplitude": 0.2, "period": 1.5}}]},
        "bodies.0.drive.period: 1.5 is not a whole number",
    ),
    (
        {"bodies": [{**ROPE, "drive": {"amplitude": 0.2, "period": 9, "fase": 0}}]},
        'bodies.0.drive.fase: unknown key; did you mean "phase"?',
    ),
    (
        {"bodies": [{**WHEEL, "motor": {"speed": 1, "torque": 1, "key": "Space"}}]},
        'bodies.0.motor.key: "Space" is no key; use a small letter, a digit, or one of left, right, up, down',
    ),
    ({"bodies": [{**WHEEL, "motor": {"speed": 1, "torque": 1, "key": "A"}}]}, 'bodies.0.motor.key: "A" is no key; use'),
    ({"bodies": [{**ROPE, "motor": {"speed": 1, "torque": 1}}]}, "bodies.0.motor: unknown key"),
    (
        {"bodies": [{**WHEEL, "motor": {"speed": 1, "torque": 1, "key": "a", "reverse_key": "a"}}]},
        'bodies.0.motor.reverse_key: "a" is the key as well; name another',
    ),
    (
        {**ENDS, "springs": [{"a": "p", "b": "q", "hydraulic": {**HYDRAULIC, "shortest": 3}}]},
        "springs.0.hydraulic.shortest: 3.0 is above longest, 2.0",
    ),
    (
        {**ENDS, "springs": [{"a": "p", "b": "q", "rest_length": 5, "hydraulic": HYDRAULIC}]},
        "springs.0.rest_length: 5.0 is not from 1.0 to 2.0, between which the hydraulic goes",
    ),
    (
        {**ENDS, "springs": [{"a": "p", "b": "q", "drive": {"amplitude": 0.1, "period": 9}, "hydraulic": HYDRAULIC}]},
        "springs.0.drive: is a muscle where a hydraulic is; keep one of them",
    ),
    (
        {"bodies": [{**WHEEL, "id": f"w{k}", "motor": {"speed": 1, "torque": 1}} for k in range(MOTOR_LIMIT + 1)]},
        f"bodies.{MOTOR_LIMIT}.motor: brings the level above {MOTOR_LIMIT} motors; take some out",
    ),
    (
        {"bodies": [{**ROPE, "drive": {"amplitude": 0.2, "period": 9, "force": 0}}]},
        "bodies.0.drive.force: 0 is not above 0",
    ),
    (
        {**ENDS, "springs": [{"a": "p", "b": "q", "hydraulic": {**HYDRAULIC, "force": "10 N"}}]},
        'springs.0.hydraulic.force: "10 N" is text, not a number',
    ),
    (
        {"bodies": [{**ROPE, "segments": LIMITED_LIMIT + 1, "drive": {"amplitude": 0.2, "period": 9, "force": 5}}]},
        f"bodies.0.drive.force: brings the level above {LIMITED_LIMIT:,} springs of limited force; take some out",
    ),
    (
        {
            "bodies": [
                {**ROPE, "segments": 1500, "drive": {"amplitude": 0.2, "period": 9, "force": 5}},
                {**ROPE, "id": "long", "segments": 18_498},
            ]
        },
        "bodies.0.drive.force: brings the level above 1,000 springs of limited force; take some out",
    ),
]  # fmt: skip


@pytest.mark.parametrize(("given", "line"), FAULTS, ids=[line[:50] for _, line in FAULTS])
def test_a_fault_is_told_in_one_line_and_the_rest_can_be_saved(given, line):
    with pytest.raises(LevelError) as raised:
        level(**given)
    assert len(raised.value.faults) == 1
    assert raised.value.faults[0].startswith(f"x: {line}")
    saved, lines = salvage(text(**given), "x")
    assert saved is not None and len(lines) == 1
    build_world(saved)


def test_a_level_of_before_reads_as_it_did():
    plain = level(bodies=[ROPE, WHEEL])
    world = build_world(plain)
    assert not world.limits.exist and world.actuators.names == ()
    assert np.all(world.gravity_scale[: world.grab_particle] == 1.0) and world.settings.drag == 0.0
    assert "drive" not in level_text(plain)


def test_the_force_of_a_muscle_is_that_of_each_of_its_springs_and_of_a_hydraulic_its_own():
    drive = {"amplitude": 0.2, "period": 9, "force": 5}
    springs = [{"a": "p", "b": "q", "hydraulic": {**HYDRAULIC, "force": 70}}, {"a": "p", "b": "q"}]
    built = build_world(level(bodies=[{**ROPE, "drive": drive}], **ENDS, springs=springs))
    limits = block_of(built).arrays.forces.limit[: built.grab_spring]
    assert limits.tolist() == [5.0] * (len(limits) - 2) + [70.0, np.inf]
