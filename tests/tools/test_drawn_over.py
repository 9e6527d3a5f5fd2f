"""Draw things over each other: they stay there and pass each other, and turn on axles with and without motors."""

import math

import numpy as np
import pytest

from sandbox.app.share.runs_for_pages import run_for_pages
from sandbox.editor.document import Document
from sandbox.editor.edits.bake import keep_added
from sandbox.level.document.canonical import level_text
from sandbox.level.format.look import PALETTE
from sandbox.level.format.slices import at_once
from sandbox.level.reading.parse import parse_level
from sandbox.physics.snapshot import state_hash
from sandbox.replay import read_replay, verify
from sandbox.session.commands import AddBody, CommandError
from sandbox.session.commands.records import script_of
from sandbox.session.scene import SceneTaker
from sandbox.session.session import Session
from sandbox.tools.axle import NOTHING_THERE, AxleTool, axle_at, taken_out
from sandbox.tools.drawing import StrokeTool
from sandbox.tools.tool import PointerEvent
from tests.support.made_in_play import cross, ring, slab
from tests.support.parts import room

REACH = 0.15
PLANK, REAR, FRONT = slab(-4.0, 0.8, 2.4, 0.24), (-4.8, 0.6), (-3.2, 0.6)


def wide(*bodies, **changes):
    return Session(room("direct", *bodies, walls={"box": [-10, 0, 10, 8]}, **changes))


def submit(session, commands):
    gesture = session.new_gesture()
    for command in commands:
        session.submit(command, gesture)
    session.apply_pending()
    return commands


def draw(session, points, stuff="wood"):
    """Draw a thing; its name, or what the tool says."""
    tool = StrokeTool(session.new_gesture, stuff)
    tool.touches = session.level.has_contacts
    snapshot, found = session.snapshot(), []
    for k, point in enumerate([*points, points[-1]]):
        kind = "down" if k == 0 else "up" if k == len(points) else "move"
        found += [each.command for each in tool.handle(PointerEvent(kind, point, REACH), snapshot).submissions]
    submit(session, found)
    return session.world.joined[-1].names[0] if found else tool.hint


def axle(session, place):
    """Click with the axle tool; what it said before."""
    tool, snapshot = AxleTool(session.new_gesture), session.snapshot()
    tool.target(place, REACH, snapshot)
    said = tool.hint
    submit(session, [each.command for each in tool.handle(PointerEvent("down", place, REACH), snapshot).submissions])
    return said


def middle(session, name):
    world = session.world
    slots = [slot for slot, each in enumerate(world.particle_names) if each.startswith(f"{name}.")]
    return world.position[slots].mean(axis=0)


def run(session, ticks):
    for _ in range(ticks):
        session.advance()
    assert not session.messages
    return session.world


def cart(session, stuff="wood"):
    names = draw(session, PLANK), *(draw(session, ring(*place, 0.35), stuff) for place in (REAR, FRONT))
    said = [axle(session, place) for place in (REAR, FRONT)]
    return names, said


def test_a_thing_drawn_over_another_stays_and_passes_it_and_touches_all_else():
    session = wide()
    plank, wheel = draw(session, PLANK), draw(session, ring(*REAR, 0.35))
    assert np.abs(middle(session, wheel) - REAR).max() < 0.03
    draw(session, slab(-4.0, 1.6, 0.5, 0.5))
    run(session, 120)
    # It has fallen to the ground through the plank, on which the box stands.
    assert middle(session, plank)[1] < 0.2 and middle(session, wheel)[1] == pytest.approx(0.36, abs=0.03)
    assert middle(session, "+3")[1] == pytest.approx(0.55, abs=0.05)


def test_a_stroke_that_runs_over_a_little_does_not_pass():
    session = wide()
    plank = draw(session, slab(0.0, 1.12, 3.0, 0.24))
    box = draw(session, slab(0.0, 0.5, 1.0, 1.04))
    run(session, 180)
    assert session.world.joined[-1].definition["passes"] == ()
    assert middle(session, plank)[1] > 1.0 and middle(session, box)[1] == pytest.approx(0.52, abs=0.05)


def test_what_is_drawn_into_the_ground_comes_out_of_it_and_what_cannot_be_passed_lifts_it():
    girder = {"type": "girder", "id": "beam", "start": [-3, 1], "end": [3, 1], "segments": 6, "height": 0.5}
    session = wide(girder | {"pin": ["start", "end"]})
    low = draw(session, ring(-6.0, 0.2, 0.35))
    assert middle(session, low)[1] == pytest.approx(0.36, abs=0.03)
    over = draw(session, ring(0.0, 1.0, 0.35))
    assert middle(session, over)[1] > 1.3 and session.world.joined[-1].definition["passes"] == ()


def test_groups_are_used_again_and_things_still_touch_where_there_are_none_left():
    session = wide()
    for k in range(70):
        x, y = -8.0 + 0.45 * (k % 35), 1.0 + 0.8 * (k // 35)
        submit(session, [AddBody({"type": "mesh", "particles": [[x, y], [x + 0.2, y], [x, y + 0.2]],
                                  "springs": [[0, 1], [1, 2], [2, 0]]}, passes=())])  # fmt: skip
    world, default = session.world, session.world.surface.group
    groups = [int(world.group[each.first_particle]) for each in world.joined]
    assert len(set(groups[:60])) == 60 and set(groups[60:]) == {default}
    assert draw(session, slab(0.0, 3.0, 1.0, 0.2)) == "+71"
    session.do("remove", body="+5")
    draw(session, slab(2.0, 3.0, 1.0, 0.2))
    assert int(world.group[world.joined[-1].first_particle]) == groups[4]


@pytest.mark.parametrize("stuff", ["wood", "jelly"])
def test_a_cart_of_drawn_things_drives_both_ways_and_rolls_when_its_motor_is_out(stuff):
    session = wide()
    (plank, *wheels), said = cart(session, stuff)
    assert said == ["wheel to plank"] * 2
    assert axle(session, REAR) == "Click: a motor (A, D)"
    run(session, 90)
    start = middle(session, plank)[0]
    (part,) = session.world.actuators.names
    session.do("set_drive", part=part, value=1.0)
    run(session, 150)
    there = middle(session, plank)
    assert there[0] > start + 2.0 and there[1] > 0.3
    session.do("set_drive", part=part, value=-1.0)
    run(session, 300)
    assert middle(session, plank)[0] < there[0] - 1.0
    # Both wheels are where they were drawn on the plank.
    for wheel, side in zip(wheels, (-0.8, 0.8), strict=True):
        assert middle(session, wheel)[0] - middle(session, plank)[0] == pytest.approx(side, abs=0.1)


def test_an_axle_snaps_to_the_middle_and_says_before_what_it_joins():
    session = wide()
    draw(session, PLANK)
    draw(session, ring(*REAR, 0.35))
    draw(session, cross(2.0, 2.0, 0.9, 0.12))
    tool, snapshot = AxleTool(session.new_gesture), session.snapshot()
    said = {}
    for place in ((-4.65, 0.7), (-3.4, 0.8), (2.05, 1.95), (5.0, 5.0)):
        tool.target(place, REACH, snapshot)
        said[place] = tool.hint
    assert list(said.values()) == ["wheel to plank", "plank to the air", "thing to the air", ""]
    assert tool.handle(PointerEvent("down", (5.0, 5.0), REACH), snapshot).submissions == ()
    assert (tool.hint, tool.is_refused) == (NOTHING_THERE, True)
    tool.target((-4.65, 0.7), REACH, snapshot)
    assert not tool.is_refused and np.abs(np.mean(tool.ghost[0][:-1], axis=0) - REAR).max() < 0.03
    axle(session, (-4.65, 0.7))
    hub = axle_at(session.snapshot(), REAR, REACH).slots[0]
    assert np.abs(session.snapshot().position[hub] - REAR).max() < 0.03


def test_what_was_not_drawn_over_but_moved_there_says_that_it_rubs():
    session = wide()
    draw(session, PLANK)
    draw(session, ring(-4.8, 2.0, 0.35))
    session.do("move_body", particle="+2.0", by=[0.0, -1.4])
    assert axle(session, (-4.8, 0.6)).startswith("wheel to plank. They rub")


def test_an_axle_takes_a_motor_loses_it_and_is_taken_out_and_each_is_undone():
    session = wide()
    cart(session)
    states = [state_hash(session.world)]
    axle(session, REAR)
    states.append(state_hash(session.world))
    assert axle_at(session.snapshot(), REAR, REACH).has_motor
    assert axle(session, REAR) == "Click: loose"
    states.append(state_hash(session.world))
    found = axle_at(session.snapshot(), REAR, REACH)
    assert not found.has_motor and len(found.owners) == 2
    submit(session, taken_out(found))
    assert axle_at(session.snapshot(), REAR, REACH) is None
    for state in reversed(states):
        session.undo()
        session.apply_pending()
        assert state_hash(session.world) == state
    session.redo()
    session.apply_pending()
    assert state_hash(session.world) == states[1]


def test_an_axle_is_no_thing_to_the_next_axle_nor_in_the_way_of_a_drawing():
    session = wide()
    draw(session, slab(0.0, 3.0, 3.0, 0.8))
    axle(session, (0.0, 3.0))
    tool = AxleTool(session.new_gesture)
    tool.target((0.2, 3.0), REACH, session.snapshot())
    assert tool.hint == "plank to the air"
    wheel = draw(session, ring(0.0, 3.0, 0.6))
    assert np.abs(middle(session, wheel) - (0.0, 3.0)).max() < 0.03
    assert [session.world.particle_names[slot] for slot in session.world.joined[-1].definition["passes"]] == ["+1.0"]


def test_three_things_turn_about_one_axle_and_a_motor_that_is_held_in_the_air_stays():
    session = wide()
    for points in (slab(0.0, 3.0, 0.3, 3.0), slab(0.0, 3.0, 3.0, 0.3), ring(0.0, 3.0, 0.5)):
        draw(session, points)
    assert axle(session, (0.0, 3.0)) == "wheel to plank and plank"
    hub = int(axle_at(session.snapshot(), (0.0, 3.0), REACH).slots[0])
    session.do("pin", particle=session.world.particle_names[hub])
    axle(session, (0.0, 3.0))
    found = axle_at(session.snapshot(), (0.0, 3.0), REACH)
    assert found.is_pinned and found.has_motor and len(found.owners) == 3
    session.do("set_drive", part=session.world.actuators.names[0], value=1.0)
    before = session.world.position[found.slots[0]].copy()
    world = run(session, 200)
    assert np.array_equal(world.position[found.slots[0]], before)
    assert all(np.linalg.norm(middle(session, f"+{k}") - (0.0, 3.0)) < 0.1 for k in (1, 2, 3))


def test_carts_are_recorded_kept_as_scenes_and_as_levels_to_the_same_bits(tmp_path):
    session = wide()
    session.record_to(tmp_path / "run.replay.gz", 40)
    cart(session)
    axle(session, REAR)
    run(session, 60)
    standing = SceneTaker(session).take().session()
    assert state_hash(run(standing, 30)) == state_hash(run(session, 30))
    assert verify(read_replay(session.stop_recording())) is None
    kept = keep_added(Document(session.level), session.world).level
    again = Session(parse_level(level_text(kept).encode(), "kept"))
    bodies = {body.id: body for body in kept.bodies}
    assert bodies["wood"].collision_group == "wood" and "wood" not in bodies["wood 2"].collides, list(bodies)
    run(again, 60)
    start = again.world.position.copy()
    again.do("set_drive", part=again.world.actuators.names[0], value=1.0)
    run(again, 120)
    moved = (again.world.position - start)[again.world.particle_slot("wood.0")]
    assert moved[0] > 1.5 and math.isfinite(moved[1])
    assert middle(again, "wood")[1] > 0.4


def test_a_page_has_a_cart_with_its_groups_and_colours_to_the_same_bits():
    session = wide()
    cart(session)
    axle(session, REAR)
    session.do("set_colour", particle="+2.0", colour="sky")
    run(session, 30)
    script = script_of([entry for entry in session.history.timeline if entry.in_effect], session.world)
    assert any(line.record["type"] == "set_colour" for line in script)
    made = at_once(run_for_pages(session.level, script, 30))
    kinds = [line.record["type"] for line in made.script]
    assert "set_colour" not in kinds and all(
        "kit" in line.record for line in made.script if line.record["type"] == "add_body"
    )
    wheel = made.script[1].record["kit"]
    assert wheel["look"]["bodies"][0]["colour"] == f"#{PALETTE['sky']:06x}"
    assert state_hash(made.world) == state_hash(session.world)
    # The kits join a world as the definitions did.
    again = Session(session.level, made.script)
    assert state_hash(run(again, 30)) == state_hash(session.world)


def test_what_is_of_the_level_is_not_painted():
    session = wide({"type": "rope", "id": "rope", "start": [0, 3], "end": [2, 3], "segments": 4})
    with pytest.raises(CommandError, match=r"rope\.1 is of the level"):
        session.do("set_colour", particle="rope.1", colour="sky")
    with pytest.raises(CommandError):
        session.do("set_colour", particle="rope.1", colour="no colour")
