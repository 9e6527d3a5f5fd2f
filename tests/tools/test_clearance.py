"""Parts that are dropped stand on what is below the pointer, or are refused where there is no room for them."""

import pytest

from sandbox.editor.document import new_level
from sandbox.session.session import Session
from sandbox.tools.clearance import lift
from sandbox.tools.dropping import NO_ROOM, PARTS, DropTool
from sandbox.tools.tool import PointerEvent

SOLID = [name for name, part in PARTS.items() if part.solid]


def square(x, y, size=1.0):
    half = size / 2
    corners = [(x - half, y - half), (x + half, y - half), (x + half, y + half), (x - half, y + half)]
    return [[*corners, corners[0]]]


def click(tool, session, place):
    snapshot = session.snapshot()
    for kind in ("down", "up"):
        answer = tool.handle(PointerEvent(kind, place, 0.1, 1, False, False, 0.0, True), snapshot)
    for command, gesture in answer.submissions:
        session.submit(command, gesture)
    session.apply_pending()
    return answer.message


@pytest.fixture
def session():
    return Session(new_level())


@pytest.fixture
def tool(session):
    made = DropTool(session.new_gesture, "box")
    made.touches = True
    return made


@pytest.mark.parametrize("x", [-3.0, 0.0, 2.5])
def test_what_is_clear_is_not_lifted_and_what_is_in_the_ground_stands_on_it(session, x):
    assert lift(square(x, 2.0), session.snapshot()) == 0.0
    assert lift(square(x, 0.2), session.snapshot()) == pytest.approx(0.3, abs=0.03)


@pytest.mark.parametrize("place", [(0.0, -2.5), (30.0, 5.0), (8.0, 3.0), (0.0, 11.0)])
def test_deep_in_the_ground_in_a_wall_and_outside_of_the_walls_there_is_no_room(session, place):
    assert lift(square(*place), session.snapshot()) is None


@pytest.mark.parametrize("name", SOLID)
def test_every_part_that_is_dropped_into_the_ground_is_above_it_and_in_no_other(session, name):
    tool = DropTool(session.new_gesture, name)
    tool.touches = True
    for _ in range(2):
        assert not click(tool, session, (0.0, 0.0))
    world = session.world
    half = world.particle_count // 2
    assert world.position[:, 1].min() > -0.05
    assert world.position[half:, 1].min() >= world.position[:half, 1].mean()


def test_a_part_stands_on_a_part_that_was_dropped_before(session, tool):
    click(tool, session, (0.0, 0.5))
    lower = session.world.position[:, 1].max()
    click(tool, session, (0.0, 0.9))
    upper = session.world.position[session.world.particle_count // 2 :, 1].min()
    assert upper == pytest.approx(lower, abs=0.15)


def test_where_there_is_no_room_a_click_says_so_adds_nothing_and_the_ghost_is_told_apart(session, tool):
    tool.reconcile(session.snapshot())
    tool.hover((0.0, -2.5))
    assert not tool.fits and tool.ghost
    assert click(tool, session, (0.0, -2.5)) == NO_ROOM
    assert session.world.particle_count == 0
    tool.hover((0.0, 3.0))
    assert tool.fits


def test_where_things_pass_through_each_other_every_place_has_room(session, tool):
    tool.touches = False
    assert not click(tool, session, (0.0, -2.5)) and session.world.particle_count > 0
