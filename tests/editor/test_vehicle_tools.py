"""The axle and the chassis tool: what a drag adds, what holds it, and that it drives, carries and turns."""

import json
import math

import numpy as np
import pytest

from sandbox.editor.document import Document, empty_level
from sandbox.editor.edits.additions import add_object
from sandbox.editor.items import Item
from sandbox.editor.scene import make_scene
from sandbox.editor.tools.palette import TOOLS
from sandbox.editor.tools.snap import snap
from sandbox.level.assembly.build_world import build_world
from sandbox.level.document.canonical import level_text
from sandbox.level.document.model import TerrainDef
from sandbox.level.format.quantities import replaced
from sandbox.level.kinds.bodies import expansion
from sandbox.level.plan.surfaces import mount_of
from sandbox.level.reading.parse import parse_level
from sandbox.physics.step import step

REACH = 0.1
FLOOR = TerrainDef(id="floor", polyline=((-50.0, 0.0), (50.0, 0.0)))


def tool(name, **options):
    drawing = TOOLS[name].drawing(reach=REACH)
    for option, value in options.items():
        drawing.set_option(option, value)
    return drawing


def drag(drawing, document, start, end):
    def at(point):
        return snap(make_scene(document.level), point, REACH)

    drawing.down(at(start))
    drawing.move(at(end))
    ghost = drawing.ghost(document)
    drawing.up(at(end))
    return ghost, drawing.done(document)


def drawn(name, document, start, end, **options):
    ghost, document = drag(tool(name, **options), document, start, end)
    assert ghost is not None and {part.type for part in ghost.level.bodies} == {document.level.bodies[-1].type}
    # What is drawn can be saved and read again.
    assert parse_level(level_text(document.level).encode(), "again") == document.level
    return document


@pytest.fixture
def empty():
    return Document(replaced(empty_level(), terrain=(FLOOR,)))


@pytest.fixture
def chassis(empty):
    return drawn("chassis", empty, (0.0, 0.55), (2.0, 0.55))


def run(level, ticks):
    world = build_world(level)
    for _ in range(ticks):
        step(world)
    return world


def test_a_drag_from_a_particle_makes_the_hub_one_with_it(chassis):
    document = drawn("axle", chassis, (0.0, 0.55), (0.0, 0.1))
    wheel = document.level.bodies[-1]
    assert document.level.welds == (("rear axle", "wheel.hub"),)
    # The wheel is in the group of what it is on, as is each thing of the chassis.
    assert {part.group for part in (*document.level.bodies, *document.level.particles)} == {wheel.group} != {None}
    assert wheel.segments == 16 and wheel.radius == 0.45 and not wheel.touches_mount
    assert (wheel.motor.speed, wheel.motor.key, wheel.motor.reverse_key) == (-8.0, "d", "a")
    assert {part.key for part in document.selection} == {"wheel"}


def test_a_drag_beside_a_body_hangs_the_hub_on_three_of_its_particles(empty):
    document = drawn("box", empty, (0.0, 1.0), (2.0, 1.5))
    document = drawn("axle", document, (0.5, 0.8), (0.5, 0.3))
    ends = [spring.b.partition(".")[0] for spring in document.level.springs]
    assert ends == ["jelly"] * 3 and {spring.a for spring in document.level.springs} == {"wheel.hub"}
    hub, places = np.array([0.5, 0.8]), make_scene(document.level)
    ways = [places.position[places.slot(spring.b)] - hub for spring in document.level.springs]
    # Two of them stand apart enough to hold it either way.
    assert max(abs(a[0] * b[1] - a[1] * b[0]) / math.hypot(*a) / math.hypot(*b) for a in ways for b in ways) > 0.3
    assert mount_of(document.level, 1) == {0}


def test_a_motor_that_a_wheel_is_given_later_carries_what_its_axle_is_loaded_with():
    wheel = {"type": "wheel", "id": "w", "position": [0, 0], "radius": 0.5, "thickness": 0.1, "segments": 20}
    loads = [{"id": "near", "position": [0, -0.2], "mass": 300.0}, {"id": "far", "position": [1, 0], "mass": 700.0}]
    springs = [{"a": "w.hub", "b": "near"}, {"a": "near", "b": "far"}]
    data = {"format": "spring-sandbox/level", "version": 3, "name": "cart", "bodies": [wheel], "particles": loads}
    level = parse_level(json.dumps({**data, "springs": springs}).encode(), "cart")
    driven = add_object(Document(level), [Item("body", "w")], "motor").level.bodies[0].motor
    assert driven.torque >= 2.0 * 1000.0 * 9.81 * 0.5 * math.sin(math.pi / 20)


def test_options_leave_out_motor_and_keys_and_ask_for_touch(chassis):
    wheel = drawn("axle", chassis, (0.0, 0.55), (0.0, 0.1), motor=False).level.bodies[-1]
    assert wheel.motor is None
    running = drawn("axle", chassis, (0.0, 0.55), (0.0, 0.1), keys=False, speed=3.0, torque=50.0, touches=True)
    wheel = running.level.bodies[-1]
    assert (wheel.motor.key, wheel.motor.speed, wheel.motor.torque, wheel.touches_mount) == (None, -3.0, 50.0, True)


def test_an_axle_in_empty_space_says_what_to_do(empty):
    drawing = tool("axle")
    ghost, document = None, None
    with pytest.raises(Exception, match="start on a body"):
        ghost, document = drag(drawing, empty, (5.0, 5.0), (5.0, 4.0))
    assert ghost is None and document is None


def test_a_chassis_is_a_group_of_a_frame_and_two_sprung_axles_and_brings_its_materials(empty):
    bare = Document(replaced(empty.level, materials={}))
    level = drawn("chassis", bare, (2.0, 1.0), (0.0, 1.0)).level
    assert set(level.materials) == {"steel", "shock"}
    assert [part.position for part in level.particles] == [(0.0, 1.0), (2.0, 1.0)]
    assert {part.group for part in (*level.bodies, *level.particles, *level.springs)} == {"vehicle"}
    assert sorted(spring.material for spring in level.springs) == ["shock"] * 4 + ["steel"] * 2
    assert min(y for _, y in level.bodies[0].particles) > 1.0
    second = drawn("chassis", Document(level), (4.0, 1.0), (6.0, 1.0)).level
    assert second.bodies[1].id == "chassis 2" and second.bodies[1].group != "vehicle"


def test_a_chassis_stands_on_its_wheels_and_its_suspension_gives_and_comes_back(chassis):
    document = drawn("axle", chassis, (0.0, 0.55), (0.0, 0.1), motor=False)
    document = drawn("axle", document, (2.0, 0.55), (2.0, 0.1), motor=False)
    light = run(document.level, 240)
    loaded = replaced(document.level.bodies[0], masses=(30.0,) * 8)
    heavy = run(replaced(document.level, bodies=(loaded, *document.level.bodies[1:])), 240)

    def ride(world):
        return world.position[world.particle_slot("chassis.5"), 1] - world.position[world.particle_slot("rear axle"), 1]

    free = 0.42 * 2.0
    assert 0.9 * free < ride(light) < free
    assert 0.5 * free < ride(heavy) < ride(light) - 0.01
    for world in (light, heavy):
        # It may roll on by itself: tops of wheels go twice as fast.
        assert np.abs(world.velocity).max() < 0.1
        assert world.position[world.particle_slot("rear axle"), 1] > 0.4


@pytest.mark.parametrize("substeps", [1, "auto"])
def test_a_wheel_as_the_axle_tool_draws_it_carries_ten_times_its_own_mass(chassis, substeps):
    level = drawn("axle", chassis, (0.0, 0.55), (0.0, 0.05), motor=False).level
    wheel = replaced(level.bodies[-1], position=(0.0, 0.65))
    own = float(expansion(wheel).mass.sum())
    wheel = replaced(wheel, hub_mass=1.0 + 10.0 * own)
    settings = replaced(level.settings, substeps=substeps)
    world = run(replaced(level, bodies=(wheel,), particles=(), springs=(), welds=(), settings=settings), 300)
    height = world.position[world.particle_slot("wheel.hub"), 1] - 0.05
    assert height > 0.9 * wheel.radius
    assert np.ptp(world.position[: world.grab_particle, 0]) < 1.05 * 2.0 * wheel.radius


def test_a_car_drives_at_the_speed_that_its_wheels_turn(chassis):
    document = drawn("axle", chassis, (0.0, 0.55), (0.0, 0.1), keys=False)
    document = drawn("axle", document, (2.0, 0.55), (2.0, 0.1), keys=False)
    world = build_world(document.level)
    front = world.particle_slot("front axle")
    for _ in range(120):
        step(world)
    before = world.position[front, 0]
    for _ in range(120):
        step(world)
    assert (world.position[front, 0] - before) / 2.0 > 0.93 * 8.0 * 0.45
    assert world.position[world.particle_slot("chassis.5"), 1] > 1.0
