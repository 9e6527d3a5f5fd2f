"""Tools that make things in a run: drawn bodies, ropes, springs, rods and axles, their undo and their recordings."""

import json
import math

import numpy as np
import pytest

from sandbox.editor.document import Document
from sandbox.editor.edits.bake import keep_added
from sandbox.editor.edits.joining import copying_commands
from sandbox.level.format.quantities import replaced
from sandbox.physics.meshing.fitting import CROSSES, TOO_SMALL
from sandbox.physics.snapshot import state_hash
from sandbox.session.commands import AddBody, AddParticle, AddSpring, CommandError
from sandbox.session.commands.records import from_record, to_record
from sandbox.session.compare.comparison import verify
from sandbox.session.replay.reader import read_replay
from sandbox.session.scene import SceneTaker
from sandbox.session.session import Session
from sandbox.tools.axle import NOTHING_THERE, TOO_FEW, AxleTool
from sandbox.tools.drawing import MATERIALS, NO_ROOM, REFUSALS, StrokeTool
from sandbox.tools.pulling import MAKERS, SAME, TOO_SHORT, PullTool
from tests.support.parts import room
from tests.tools.test_playing_with_parts import gesture


def around(x, y, wide, tall, count=40):
    """Points of an ellipse."""
    turns = [2.0 * math.pi * k / count for k in range(count)]
    return [(x + wide * math.cos(turn), y + tall * math.sin(turn)) for turn in turns]


def run(session, ticks):
    for _ in range(ticks):
        session.advance()
    return session.world


def slots_of(world, body):
    return [slot for slot, name in enumerate(world.particle_names) if name.startswith(f"{body}.")]


def drawn(session, stuff="jelly", points=None, touches=True):
    tool = StrokeTool(session.new_gesture, stuff)
    tool.touches = touches
    return tool, gesture(tool, session, *(points or around(0.0, 2.5, 0.6, 0.5)))


def pulled(session, kind, *points):
    tool = PullTool(session.new_gesture, kind)
    return tool, gesture(tool, session, *points)


@pytest.mark.parametrize("stuff", MATERIALS)
def test_a_stroke_becomes_a_body_of_its_stuff_that_falls_and_keeps_its_form(stuff):
    session = Session(room())
    _, (command,) = drawn(session, stuff)
    assert command.body["type"] == "mesh" and 20 <= len(command.body["particles"]) <= 70
    assert all(round(value, 3) == value for place in command.body["particles"] for value in place)
    slots = slots_of(session.world, "+1")
    mass = MATERIALS[stuff].density * math.pi * 0.6 * 0.5
    assert session.world.mass[slots].sum() == pytest.approx(mass, rel=0.05)
    world = run(session, 300)
    size = np.ptp(world.position[slots], axis=0)
    assert not session.messages and world.position[slots, 1].min() > -0.01
    assert size == pytest.approx((1.2, 1.0), rel=0.1)
    assert np.abs(world.velocity[slots]).max() < 0.3


def test_all_that_a_page_needs_to_add_it_stands_in_the_record():
    session, again = Session(room()), Session(room())
    _, (command,) = drawn(session)
    record = json.loads(json.dumps(to_record(command, session.world)))
    assert {"particles", "springs", "triangles", "masses"} <= record["body"].keys()
    assert record["materials"] == {"drawn jelly": {"stiffness": 0.75, "damping": 0.7}}
    again.submit(from_record(record, again.world))
    assert state_hash(run(session, 30)) == state_hash(run(again, 30))


def test_a_drawn_body_leaves_every_other_bit_as_it_was():
    level = room("direct", {"type": "jelly", "id": "far", "shape": {"box": [0.6, 0.6]}, "spacing": 0.2,
                            "position": [-3, 2]})  # fmt: skip
    alone, session = Session(level), Session(level)
    run(alone, 10)
    run(session, 10)
    drawn(session)
    run(alone, 60)
    run(session, 60)
    count = alone.world.particle_count - 10
    assert np.array_equal(alone.world.position[:count], session.world.position[:count])


def test_an_outline_that_cannot_be_a_body_stays_with_the_reason_and_adds_nothing():
    session = Session(room())
    before = state_hash(session.world)
    crossing = [(0.0, 1.0), (2.0, 3.0), (2.0, 1.0), (0.0, 3.0), (-0.5, 2.0)]
    for points, reason in (
        ([(0.0, 2.0), (0.01, 2.0), (0.0, 2.01)], REFUSALS[TOO_SMALL]),
        (crossing, REFUSALS[CROSSES]),
        (around(0.0, -20.0, 1, 1), NO_ROOM),
    ):
        tool, commands = drawn(session, points=points)
        assert commands == [] and tool.hint == reason and not tool.fits
    assert len(tool.ghost[0]) > 30
    gesture(tool, session, *around(0.0, 2.0, 0.5, 0.5))
    assert tool.fits and tool.ghost == [] and tool.hint == ""
    session.undo()
    session.apply_pending()
    assert not session.world.joined and session.tick == 0 and state_hash(session.world) == before


def test_a_body_drawn_into_the_ground_lies_on_it():
    session = Session(room())
    drawn(session, points=around(0.0, 0.3, 0.6, 0.5))
    slots = slots_of(session.world, "+1")
    assert session.world.position[slots, 1].min() > -0.02
    passing, lying = Session(replaced(room(), contacts=None, walls=None)), around(0.0, 0.0, 0.6, 0.5)
    drawn(passing, points=lying, touches=False)
    assert passing.world.position[slots_of(passing.world, "+1"), 1].min() == pytest.approx(-0.5, abs=0.01)


def hung(kind, solver="direct"):
    """A jelly, and what it hangs by from the air: the session, its slots, the place of the pin."""
    session = Session(room(solver))
    drawn(session)
    pulled(session, kind, (0.0, 3.0), (0.0, 4.0), (0.0, 5.0))
    return session, slots_of(session.world, "+1"), (0.0, 5.0)


@pytest.mark.parametrize("kind", MAKERS)
def test_a_body_hangs_by_a_rope_a_spring_or_a_rod_from_the_air(kind):
    session, slots, pin = hung(kind)
    world = run(session, 600)
    assert not session.messages
    middle = world.position[slots].mean(axis=0)
    drop = pin[1] - world.position[slots, 1].max()
    assert abs(middle[0] - pin[0]) < 0.05 and np.abs(world.velocity[slots]).max() < 0.3
    assert drop == pytest.approx({"rope": 2.0, "spring": 2.27, "rod": 2.0}[kind], abs=0.06)


def test_a_rope_hangs_straight_is_as_long_as_it_was_pulled_and_lets_go_where_it_is_cut():
    session, slots, pin = hung("rope")
    world = run(session, 600)
    rope = slots_of(world, "+2")
    assert len(rope) == 12
    assert np.abs(world.position[rope, 0] - pin[0]).max() < 0.03
    cut = world.spring_slot("+2:5")
    session.do("cut_springs", springs=["+2:5"])
    run(session, 90)
    assert not world.spring_active[cut]
    assert world.position[slots, 1].min() < 0.05 and world.position[rope, 1].min() > -0.06


def test_a_rope_between_two_things_holds_both_and_undo_takes_all_of_it_back():
    session = Session(room())
    drawn(session, "wood", around(-2.0, 3.0, 0.5, 0.3))
    drawn(session, "steel", around(2.0, 3.0, 0.4, 0.4))
    before = state_hash(session.world)
    tool, commands = pulled(session, "rope", (-2.0, 3.0), (0.0, 3.0), (2.0, 3.0))
    assert [type(command) for command in commands] == [AddBody, AddSpring, AddSpring]
    assert commands[0].body["pinned"] == [] and len(commands[0].body["particles"]) == 11 and tool.hint == ""
    session.undo()
    session.apply_pending()
    assert state_hash(session.world) == before
    session.redo()
    session.apply_pending()
    ends = [session.world.particle_b[slot] for slot, name in enumerate(session.world.spring_names) if name[:2] == "+:"]
    assert {session.world.particle_names[slot].partition(".")[0] for slot in ends} == {"+1", "+2"}


def test_what_is_pulled_from_the_air_to_the_air_has_two_pins_and_what_is_too_short_says_so():
    session = Session(room())
    _, commands = pulled(session, "rod", (-1.0, 3.0), (0.0, 3.0), (1.0, 3.0))
    assert [type(command) for command in commands] == [AddParticle, AddParticle, AddSpring]
    tool, nothing = pulled(session, "rope", (0.0, 4.0), (0.02, 4.0))
    assert nothing == [] and tool.hint == TOO_SHORT
    tool, nothing = pulled(session, "rope", (-1.0, 3.0), (0.0, 3.0), (-1.0, 3.02))
    assert nothing == [] and tool.hint == SAME


@pytest.mark.parametrize("rate", [30, 60, 240])
def test_a_spring_sags_alike_under_every_weight_and_at_every_tick_rate(rate):
    level = room()
    session = Session(replaced(level, settings=replaced(level.settings, tick_rate=rate)))
    for x, stuff in ((-2.0, "jelly"), (2.0, "steel")):
        drawn(session, stuff, around(x, 3.0, 0.4, 0.4))
        pulled(session, "spring", (x, 3.4), (x, 4.0), (x, 5.0))
    world = run(session, 12 * rate)
    tops = [world.position[slots_of(world, body), 1].max() for body in ("+1", "+2")]
    assert [5.0 - top for top in tops] == pytest.approx([1.87, 1.87], abs=0.06)


def test_a_body_turns_about_an_axle_and_two_that_lie_over_each_other_turn_about_theirs():
    session = Session(replaced(room(), contacts=None, walls=None))
    plank = [(0, 3), (1, 2.9), (2, 2.9), (2, 3.1), (1, 3.1), (0, 3.1)]
    drawn(session, "wood", plank, touches=False)
    axle = AxleTool(session.new_gesture)
    hub, *spokes = gesture(axle, session, (0.2, 3.0), (0.2, 3.0))
    assert hub.body["pin"] == ["hub"] and len(spokes) == 12 and axle.hint == ""
    drawn(session, "wood", [(x + 1.7, y) for x, y in plank], touches=False)
    hub, *spokes = gesture(axle, session, (1.85, 3.0), (1.85, 3.0))
    assert hub.body["pin"] == [] and len(spokes) == 15
    first, second, held, free = (slots_of(session.world, f"+{number}") for number in (1, 3, 2, 4))
    world = run(session, 60)
    assert np.array_equal(world.position[held[:1]], [[0.2, 3.0]]) and not session.messages
    for slots in (first, second):
        assert np.linalg.norm(world.position[slots] - world.position[free[0]], axis=1).min() < 0.4
    assert world.position[second, 1].min() < 1.5
    reach = np.linalg.norm(world.position[first] - (0.2, 3.0), axis=1)
    assert reach.min() < 0.3 and reach.max() == pytest.approx(1.8, abs=0.1)


def test_an_axle_through_nothing_and_through_a_ball_says_why_there_is_none():
    session = Session(room())
    axle = AxleTool(session.new_gesture)
    assert gesture(axle, session, (0.0, 3.0), (0.0, 3.0)) == [] and axle.hint == NOTHING_THERE
    session.do("add_particle", position=[0.0, 3.0], radius=0.3)
    assert gesture(axle, session, (0.0, 3.0), (0.0, 3.0)) == [] and axle.hint == TOO_FEW


def test_what_was_made_is_recorded_saved_and_goes_on_to_the_same_bits(tmp_path):
    session = Session(room())
    session.record_to(tmp_path / "run.replay.gz", 40)
    run(session, 5)
    drawn(session)
    pulled(session, "rope", (0.0, 3.0), (0.0, 4.0), (0.0, 5.0))
    run(session, 20)
    pulled(session, "spring", (0.0, 2.0), (1.0, 2.0), (2.0, 2.0))
    gesture(AxleTool(session.new_gesture), session, (0.0, 2.5), (0.0, 2.5))
    run(session, 40)
    session.do("scale_mass", particle="+1.0", factor=2.0)
    session.do("cut_springs", springs=["+2:3"])
    run(session, 20)
    standing = SceneTaker(session).take().session()
    assert state_hash(standing.world) == state_hash(session.world)
    assert standing.world.particle_names == session.world.particle_names
    assert state_hash(run(standing, 30)) == state_hash(run(session, 30))
    path = session.stop_recording()
    assert verify(read_replay(path)) is None
    session.seek(30)
    session.seek(115)
    assert state_hash(session.world) == state_hash(standing.world)


def test_a_body_twice_as_heavy_hangs_as_it_did_and_a_mass_beyond_the_limits_is_refused():
    session, slots, _ = hung("spring")
    mass = session.world.mass[slots].sum()
    session.do("scale_mass", particle="+1.0", factor=2.0)
    assert session.world.mass[slots].sum() == pytest.approx(2.0 * mass)
    world = run(session, 600)
    assert 5.0 - world.position[slots, 1].max() == pytest.approx(2.27, abs=0.06)
    session.do("pin", particle="+1.0")
    session.do("scale_mass", particle="+1.0", factor=0.5)
    assert session.world.inverse_mass[slots[0]] == 0.0
    session.do("unpin", particle="+1.0")
    assert np.allclose(session.world.mass[slots].sum(), mass)
    for _ in range(3):
        session.do("scale_mass", particle="+1.0", factor=1000.0)
    before = state_hash(session.world)
    with pytest.raises(CommandError, match=r"a mass is from 1e-09 to 1e\+09 kg"):
        session.do("scale_mass", particle="+1.0", factor=1000.0)
    assert before == state_hash(session.world)


def test_what_was_made_is_taken_over_into_the_level_with_what_joins_it():
    session, slots, _ = hung("rope")
    pulled(session, "spring", (0.0, 2.0), (1.0, 2.0), (2.0, 2.0))
    session.do("scale_mass", particle="+1.0", factor=2.0)
    run(session, 30)
    kept = keep_added(Document(session.level), session.world).level
    assert [body.id for body in kept.bodies] == ["jelly", "rope"]
    assert {tuple(sorted((each.a.partition(".")[0], each.b.partition(".")[0]))) for each in kept.springs} == {
        ("jelly", "rope"), ("ball", "jelly"),
    }  # fmt: skip
    assert [each.material for each in kept.springs] == ["drawn rope", "added coil"]
    there = Session(kept).world
    assert there.mass[: len(slots)].sum() == pytest.approx(session.world.mass[slots].sum())
    assert np.abs(there.position[: len(slots)] - session.world.position[slots]).max() < 1e-9


def test_a_copy_of_a_body_of_a_run_has_its_pose_mass_firmness_and_cuts():
    session, slots, _ = hung("rope")
    session.do("scale_mass", particle="+1.0", factor=2.0)
    session.do("set_firmness", body="+1", sag=0.2)
    run(session, 60)
    world = session.world
    for command in copying_commands(session.level, world, slots[3], (2.0, 0.5)):
        session.do(command)
    copy = slots_of(world, "+3")
    assert np.abs(world.position[copy] - world.position[slots] - (2.0, 0.5)).max() < 1e-9
    assert not world.velocity[copy].any() and np.allclose(world.mass[copy], world.mass[slots])
    stiffness = [world.stiffness[world.spring_slot(f"{body}:0")] for body in ("+1", "+3")]
    assert stiffness[0] == pytest.approx(stiffness[1], rel=1e-4)
    assert not session.messages and len(world.joined) == 3
