"""Tools: plain pointer events over a snapshot become commands."""

import json
from itertools import count

import numpy as np
import pytest

from sandbox.level.document.model import Level
from sandbox.level.reading.parse import parse_level
from sandbox.session.commands import CutSprings, Grab, MoveGrab, Pin, Release, Unpin
from sandbox.session.session import Session
from sandbox.tools.click import PinTool
from sandbox.tools.cut import CutTool
from sandbox.tools.drag import DragTool
from sandbox.tools.tool import PointerEvent, Response

REACH = 0.1


def row_of_particles(particle_count=12):
    """Particles at (0, 0), (1, 0), ... joined in a row; the first is pinned."""
    return Session(
        Level.model_validate(
            {
                "format": "spring-sandbox/level",
                "version": 4,
                "name": "row",
                "settings": {"solver": "iterative", "gravity": (0.0, 0.0)},
                "bodies": (
                    {
                        "type": "rope",
                        "id": "row",
                        "start": (0.0, 0.0),
                        "end": (particle_count - 1.0, 0.0),
                        "segments": particle_count - 1,
                        "pin": ("start",),
                    },
                ),
            }
        )
    )


@pytest.fixture
def session():
    return row_of_particles()


def down(x, y=0.0, **more):
    return PointerEvent("down", (x, y), REACH, **more)


def move(x, y=0.0, **more):
    return PointerEvent("move", (x, y), REACH, **more)


def up(x, y=0.0, **more):
    return PointerEvent("up", (x, y), REACH, **more)


def commands(response: Response):
    return [submission.command for submission in response.submissions]


def gestures(*responses: Response):
    return {submission.gesture for response in responses for submission in response.submissions}


def perform(session, tool, event):
    """Let a tool answer an event and the session apply the answer at once."""
    response = tool.handle(event, session.snapshot())
    for command, gesture in response.submissions:
        session.submit(command, gesture)
    session.apply_pending()
    tool.reconcile(session.snapshot())
    return response


def test_a_drag_is_grab_moves_and_release_in_one_gesture(session):
    tool = DragTool(session.new_gesture)
    snapshot = session.snapshot()
    answers = [tool.handle(event, snapshot) for event in (down(3.02), move(3.0, 1.0), move(4.0, 1.0), up(4.0, 1.0))]
    assert [commands(answer) for answer in answers] == [
        [Grab(0, 3, (3.02, 0.0))],
        [MoveGrab(0, (3.0, 1.0))],
        [MoveGrab(0, (4.0, 1.0))],
        [Release(0)],
    ]
    assert len(gestures(*answers)) == 1
    assert not tool.holds


def test_two_drags_are_two_gestures(session):
    tool = DragTool(session.new_gesture)
    snapshot = session.snapshot()
    first = [tool.handle(event, snapshot) for event in (down(3), up(3))]
    second = [tool.handle(event, snapshot) for event in (down(3), up(3))]
    assert gestures(*first).isdisjoint(gestures(*second))


def test_a_press_on_nothing_and_moves_without_a_press_do_nothing(session):
    tool = DragTool(session.new_gesture)
    for event in (down(3.5, 2.0), move(3.0), up(3.0), down(3.0, button=3)):
        assert tool.handle(event, session.snapshot()) == Response()


def test_shift_keeps_hold_of_several_particles_and_cancel_lets_go_of_all(session):
    tool = DragTool(session.new_gesture)
    for x in (2.0, 5.0):
        perform(session, tool, down(x, shift=True))
        perform(session, tool, up(x, shift=True))
    assert {hand: hold.particle for hand, hold in tool.holds.items()} == {0: 2, 1: 5}
    assert commands(tool.cancel()) == [Release(0), Release(1)]
    assert not tool.holds


def test_a_click_on_a_held_particle_lets_go_but_a_drag_of_it_keeps_hold(session):
    tool = DragTool(session.new_gesture)
    perform(session, tool, down(2.0, shift=True))
    perform(session, tool, up(2.0, shift=True))
    dragged = [perform(session, tool, event) for event in (down(2.0), move(2.5, 1.0), up(2.5, 1.0))]
    assert [commands(answer) for answer in dragged] == [[], [MoveGrab(0, (2.5, 1.0))], []]
    assert 0 in tool.holds
    perform(session, tool, down(2.0))
    assert commands(perform(session, tool, up(2.0))) == [Release(0)]


def test_a_pinned_particle_is_not_grabbed_and_the_person_is_told_why(session):
    response = DragTool(session.new_gesture).handle(down(0.0), session.snapshot())
    assert not response.submissions
    assert "pinned" in response.message


def test_the_eleventh_hand_is_refused_with_a_message(session):
    tool = DragTool(session.new_gesture)
    for x in range(1, 11):
        perform(session, tool, down(float(x), shift=True))
        perform(session, tool, up(float(x), shift=True))
    assert sorted(tool.holds) == list(range(10))
    response = tool.handle(down(11.0), session.snapshot())
    assert not response.submissions
    assert "10 hands" in response.message


def test_a_hand_that_undo_emptied_is_forgotten_and_later_moves_do_nothing(session):
    tool = DragTool(session.new_gesture)
    perform(session, tool, down(3.0))
    session.advance()
    session.undo()
    session.apply_pending()
    tool.reconcile(session.snapshot())
    assert not tool.holds
    assert tool.handle(move(3.0, 1.0), session.snapshot()) == Response()
    assert tool.handle(up(3.0, 1.0), session.snapshot()) == Response()
    assert not session.messages


def test_pin_tool_pins_a_free_particle_and_unpins_a_pinned_one(session):
    tool = PinTool(session.new_gesture)
    assert commands(perform(session, tool, down(4.0))) == [Pin(4)]
    assert commands(perform(session, tool, down(4.0))) == [Unpin(4)]
    assert commands(perform(session, tool, down(0.0))) == [Unpin(0)]
    assert perform(session, tool, down(0.5, 3.0)) == Response()


def test_a_stroke_cuts_every_spring_that_it_crosses_once_and_in_one_gesture(session):
    tool = CutTool(session.new_gesture)
    events = (down(2.5, 1.0), move(2.5, -1.0), move(3.5, -1.0), move(3.5, 1.0), up(3.5, 1.0))
    answers = [tool.handle(event, session.snapshot()) for event in events]
    cut = [command for answer in answers for command in commands(answer)]
    assert cut == [CutSprings((2,)), CutSprings((3,))]
    assert len(gestures(*answers)) == 1
    assert not tool.trail


def test_a_fast_stroke_between_two_events_misses_nothing(session):
    tool = CutTool(session.new_gesture)
    tool.handle(down(0.5, 1.0), session.snapshot())
    answer = tool.handle(move(8.5, -1.0), session.snapshot())
    assert commands(answer) == [CutSprings((4,))]


def test_a_click_cuts_the_spring_under_it(session):
    tool = CutTool(session.new_gesture)
    assert commands(tool.handle(down(6.4, 0.01), session.snapshot())) == [CutSprings((6,))]
    assert commands(tool.handle(up(6.4, 0.01), session.snapshot())) == []


def test_a_stroke_over_nothing_and_one_after_cancel_cut_nothing(session):
    tool = CutTool(session.new_gesture)
    answers = [tool.handle(event, session.snapshot()) for event in (down(1.5, 2.0), move(1.5, 1.0))]
    tool.cancel()
    answers.append(tool.handle(move(1.5, -1.0), session.snapshot()))
    assert all(answer == Response() for answer in answers)


def test_tools_leave_the_snapshot_and_the_session_alone(session):
    before = session.snapshot()
    numbers = count(1)
    for tool in (DragTool(lambda: next(numbers)), PinTool(lambda: next(numbers)), CutTool(lambda: next(numbers))):
        for event in (down(4.0), move(4.0, 2.0), up(4.0, 2.0)):
            tool.handle(event, before)
    assert (before.position == session.snapshot().position).all()
    assert session.tick == 0


JELLY = {
    "type": "jelly", "id": "it", "shape": {"box": [1.6, 1.6]}, "position": [0.0, 0.0], "spacing": 0.4,
    "material": "soft",
}  # fmt: skip


@pytest.fixture
def jelly():
    level = {
        "format": "spring-sandbox/level", "version": 3, "name": "one jelly", "contacts": {}, "bodies": [JELLY],
        "materials": {"soft": {"stiffness": 0.2, "damping": 0.4}}, "settings": {"gravity": [0.0, 0.0]},
    }  # fmt: skip
    return Session(parse_level(json.dumps(level).encode(), "one jelly"))


def answers_of(session, tool, *events):
    return [tool.handle(event, session.snapshot()) for event in events]


def test_a_stroke_through_a_jelly_parts_it_once_it_has_left_it(jelly):
    tool = CutTool(jelly.new_gesture)
    steps = [move(0.1, y) for y in (0.9, 0.5, 0.1, -0.3, -0.7)]
    answers = answers_of(jelly, tool, down(0.1, 1.2), *steps, move(0.1, -1.2), up(0.1, -1.2))
    assert [len(commands(answer)) for answer in answers] == [0] * 6 + [1, 0]
    (command,) = commands(answers[6])
    world = jelly.world
    a, b = (world.position[ends[list(command.springs)]] for ends in (world.particle_a, world.particle_b))
    share = np.array(command.at)[:, None]
    np.testing.assert_allclose(((1.0 - share) * a + share * b)[:, 0], 0.1, atol=1e-5)
    jelly.submit(command)
    jelly.apply_pending()
    assert len(np.unique(world.owner[world.particle_active])) == 2


def test_a_stroke_that_ends_in_a_jelly_and_one_that_begins_there_cut_as_far_as_they_go(jelly):
    tool = CutTool(jelly.new_gesture)
    for events in ((down(0.1, 1.2), move(0.1, 0.3), up(0.1, 0.3)), (down(0.1, 0.3), move(0.1, 1.2), up(0.1, 1.2))):
        cuts = [command for answer in answers_of(jelly, tool, *events) for command in commands(answer)]
        assert len(cuts) == 1 and len(cuts[0].at) == len(cuts[0].springs) > 1


def test_a_click_in_a_jelly_cuts_the_spring_under_it_when_it_is_let_go(jelly):
    tool = CutTool(jelly.new_gesture)
    answers = answers_of(jelly, tool, down(0.2, 0.01), up(0.2, 0.01))
    assert commands(answers[0]) == [] and [len(each.springs) for each in commands(answers[1])] == [1]
    assert commands(answers[1])[0].at == ()
