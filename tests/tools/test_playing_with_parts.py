"""The tools of the palette: what pointer gestures become, for the part, the push, the wind and what is taken out."""

import numpy as np
import pytest

from sandbox.editor.document import new_level
from sandbox.level.format.quantities import replaced
from sandbox.physics.equation import frequency_from_coefficients
from sandbox.session.commands import AddBody, AddParticle, Pin, Push, Remove, SetAir, Unpin
from sandbox.session.session import Session
from sandbox.tools.clearance import lift
from sandbox.tools.click import DeleteTool, FreezeTool
from sandbox.tools.dropping import FASTEST_THROW, NO_ROOM, PARTS, DropTool
from sandbox.tools.push_wind import PushTool, WindTool
from sandbox.tools.tool import PointerEvent
from tests.support.parts import furnished, room


def gesture(tool, session, *points, seconds=0.02):
    """Press, move and release along points; the commands of the gesture."""
    kinds = ["down", *["move"] * (len(points) - 2), "up"]
    found = []
    for k, (kind, point) in enumerate(zip(kinds, points, strict=True)):
        event = PointerEvent(kind, point, 0.1, seconds=k * seconds)
        response = tool.handle(event, session.snapshot())
        for command, number in response.submissions:
            session.submit(command, number)
            found.append(command)
        session.apply_pending()
    return found


@pytest.fixture(params=PARTS)
def part(request):
    return request.param


def test_every_part_drops_where_it_is_clicked_settles_and_flies_where_it_is_thrown(part):
    session = Session(room())
    drop = DropTool(session.new_gesture, part)
    gesture(drop, session, (0.0, 2.0), (0.0, 2.0))
    world = session.world
    new = world.particle_active.copy()
    assert np.abs(world.position[new].mean(axis=0) - (0.0, 2.0)).max() < 0.3
    assert not world.velocity[new].any()
    for _ in range(90):
        session.advance()
    assert not session.messages
    speed = np.linalg.norm(world.velocity[new], axis=1)
    assert speed.max() < 5.0 and world.position[new, 1].min() > 0.0
    before = world.particle_count
    (thrown,) = gesture(drop, session, (-2.0, 3.0), (-1.9, 3.0), (-1.8, 3.1), (-1.7, 3.2))
    velocity = world.velocity[before:][world.inverse_mass[before:] > 0.0]
    assert isinstance(thrown, AddBody | AddParticle)
    assert velocity == pytest.approx(np.broadcast_to((5.0, 10.0 / 3.0), velocity.shape))
    for _ in range(30):
        session.advance()
    assert np.isfinite(world.position).all()


@pytest.mark.parametrize("rate", [60, 240])
def test_what_is_dropped_moves_per_second_alike_at_every_tick_rate(rate):
    level = room()
    session = Session(replaced(level, settings=replaced(level.settings, tick_rate=rate)))
    (rope,) = gesture(DropTool(session.new_gesture, "rope"), session, (0.0, 2.0), (0.0, 2.0))
    (material,) = rope.materials.values()
    reading = frequency_from_coefficients(material["stiffness"], material["damping"], 1.0 / rate)
    assert reading == pytest.approx(frequency_from_coefficients(0.9, 0.95, 1.0 / 60), rel=1e-4)
    assert not session.messages and session.world.joined


def test_throws_have_a_limit_and_the_wheel_makes_parts_larger():
    session = Session(room())
    drop = DropTool(session.new_gesture, "ball")
    drop.resize(3)
    (ball,) = gesture(drop, session, (-3.0, 3.0), (3.0, 3.0))
    assert ball.velocity == pytest.approx((FASTEST_THROW, 0.0)) and ball.radius == pytest.approx(0.5 * 1.1**3)
    assert len(drop.ghost) == 1 and drop.ghost[0][0] == drop.ghost[0][-1]
    drop.cancel()
    assert drop.ghost == []


def test_a_click_bursts_an_arrow_pushes_and_where_nothing_is_nothing_happens():
    session = Session(furnished())
    push = PushTool(session.new_gesture)
    (burst,) = gesture(push, session, (-2.0, 0.5), (-2.0, 0.5))
    assert isinstance(burst, Push) and burst.outward > 0.0 and burst.impulse == (0.0, 0.0)
    (pushed,) = gesture(push, session, (-2.0, 0.5), (-2.0, 1.0), (-2.0, 1.5))
    assert pushed.impulse[0] == 0.0 and pushed.impulse[1] > 0.0 and pushed.position == (-2.0, 0.5)
    assert gesture(push, session, (0.0, 20.0), (0.0, 20.0)) == []


def test_the_wind_blows_while_it_is_held_and_undo_takes_it_back_whole():
    session = Session(furnished())
    wind = WindTool(session.new_gesture)
    before = session.world.settings
    commands = gesture(wind, session, (0.0, 0.0), (1.0, 0.5), (2.0, 0.0))
    assert [type(command) for command in commands] == [SetAir] * 3
    assert commands[1].wind == (4.0, 2.0) and commands[1].drag > 0.0
    assert session.world.settings == before
    session.undo()
    session.apply_pending()
    assert not session.can_undo


def test_a_click_takes_out_or_freezes_what_is_under_it_and_thaws_it_again():
    session = Session(furnished())
    world = session.world
    freeze, delete = FreezeTool(session.new_gesture), DeleteTool(session.new_gesture)
    cube = [world.particle_slot(f"cube.{k}") for k in range(9)]
    commands = gesture(freeze, session, (-2.0, 0.5), (-2.0, 0.5))
    assert [type(command) for command in commands] == [Pin] * 9 and not world.inverse_mass[cube].any()
    commands = gesture(freeze, session, (-2.0, 0.5), (-2.0, 0.5))
    assert [type(command) for command in commands] == [Unpin] * 9
    (removed,) = gesture(delete, session, (-2.0, 0.5), (-2.0, 0.5))
    assert isinstance(removed, Remove) and not world.particle_active[cube].any()
    assert gesture(delete, session, (0.0, 2.0), (0.0, 2.0)) == []


SOLID = [name for name, part in PARTS.items() if part.solid]


def square(x, y, size=1.0):
    half = size / 2
    corners = [(x - half, y - half), (x + half, y - half), (x + half, y + half), (x - half, y + half)]
    return [[*corners, corners[0]]]


def click(box, session, place):
    snapshot = session.snapshot()
    for kind in ("down", "up"):
        answer = box.handle(PointerEvent(kind, place, 0.1, 1, False, False, 0.0, True), snapshot)
    for command, gesture in answer.submissions:
        session.submit(command, gesture)
    session.apply_pending()
    return answer.message


@pytest.fixture
def session():
    return Session(new_level())


@pytest.fixture
def box(session):
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
    box = DropTool(session.new_gesture, name)
    box.touches = True
    for _ in range(2):
        assert not click(box, session, (0.0, 0.0))
    world = session.world
    half = world.particle_count // 2
    assert world.position[:, 1].min() > -0.05
    assert world.position[half:, 1].min() >= world.position[:half, 1].mean()


def test_a_part_stands_on_a_part_that_was_dropped_before(session, box):
    click(box, session, (0.0, 0.5))
    lower = session.world.position[:, 1].max()
    click(box, session, (0.0, 0.9))
    upper = session.world.position[session.world.particle_count // 2 :, 1].min()
    assert upper == pytest.approx(lower, abs=0.15)


def test_where_there_is_no_room_a_click_says_so_adds_nothing_and_the_ghost_is_told_apart(session, box):
    box.reconcile(session.snapshot())
    box.hover((0.0, -2.5))
    assert not box.fits and box.ghost
    assert click(box, session, (0.0, -2.5)) == NO_ROOM
    assert session.world.particle_count == 0
    box.hover((0.0, 3.0))
    assert box.fits


def test_where_things_pass_through_each_other_every_place_has_room(session, box):
    box.touches = False
    assert not click(box, session, (0.0, -2.5)) and session.world.particle_count > 0
