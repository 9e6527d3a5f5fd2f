"""Make things in play by mouse, keys and finger: draw, pull, the menu of a thing, undo, save, and restrictions."""

import math

import pygame
import pytest

from sandbox.app.play.allowed import refused_tools
from sandbox.app.play.thing_menu import COLOUR, HOLD, LET_GO, MOTOR, NO_MOTOR, TAKE_OUT
from sandbox.app.play.toolbar import NAMES
from sandbox.level.format.look import PALETTE
from sandbox.level.format.quantities import replaced
from sandbox.level.rules.player_limits import PlayerLimits
from sandbox.physics.meshing.fitting import CROSSES
from sandbox.physics.snapshot import state_hash
from sandbox.session.commands import AddBody, CutSprings, Pin, Remove, ScaleMass, SetFirmness
from sandbox.tools.drawing import REFUSALS
from tests.support.parts import furnished, room

MAKING = ("draw_jelly", "draw_wood", "draw_steel", "pull_rope", "pull_spring", "pull_rod", "axle")


@pytest.fixture
def player(open_app):
    return open_app(room())


def at(driver, x, y):
    return driver.stage.camera.to_pixels((x, y))


def stroke(driver, *points):
    """Press, draw along points [m] and let go."""
    driver.stroke(*points)
    driver.frames(2)


def ring(x, y, radius, count=30):
    turns = [2.0 * math.pi * k / count for k in range(count)]
    return [(x + radius * math.cos(turn), y + radius * math.sin(turn)) for turn in turns]


def commands(driver):
    return [entry.command for entry in driver.playback.session.history.timeline if entry.in_effect]


def rows(driver):
    return [row.text for row in driver.app.ui.focus.rows]


def open_menu(driver, x, y):
    driver.press(at(driver, x, y), 3)
    driver.release(at(driver, x, y), 3)


def take(driver, text):
    """Click an entry of the menu that is open."""
    menu = driver.app.ui.focus
    index = rows(driver).index(text)
    driver.click((menu.rect.left + 30, menu.rect.top + menu._tops[index] - menu._offset + 8))
    driver.frames(2)


def test_a_jelly_is_drawn_hung_by_a_rope_softened_and_cut_and_every_step_undone(player):
    player.key(pygame.K_SPACE)
    player.key(pygame.K_1, pygame.KMOD_SHIFT)
    assert player.stage.tool_name == "draw_jelly" and player.app.play.palette.buttons["draw_jelly"].is_selected
    stroke(player, *ring(0.0, 2.5, 0.6))
    player.key(pygame.K_4, pygame.KMOD_SHIFT)
    stroke(player, (0.0, 3.1), (0.0, 4.0), (0.0, 5.0))
    player.key(pygame.K_ESCAPE)
    open_menu(player, 0.0, 2.5)
    assert rows(player)[:5] == [f"Make it {word}" for word in ("jelly", "soft", "firm", "hard", "rigid")]
    take(player, "Make it soft")
    player.key(pygame.K_c)
    stroke(player, (-0.5, 4.0), (0.5, 4.01), (0.6, 4.0))
    kinds = [type(command).__name__ for command in commands(player)]
    assert kinds == ["AddBody", "AddBody", "AddSpring", "SetFirmness", "CutSprings"]
    for left in (4, 3, 1, 0):
        player.key(pygame.K_z, pygame.KMOD_CTRL)
        player.frames(2)
        assert len(commands(player)) == left
    assert not player.world.joined


def test_every_deed_of_the_menu_is_done_and_undone(player):
    player.key(pygame.K_SPACE)
    player.key(pygame.K_3, pygame.KMOD_SHIFT)
    stroke(player, *ring(0.0, 2.0, 0.5))
    before = state_hash(player.world)
    for text, kind in (
        ("Make it firm", SetFirmness), ("Twice as heavy", ScaleMass), ("Half as heavy", ScaleMass),
        ("Fix it here", Pin), ("Copy it", AddBody), ("Delete it, with what hangs on it", Remove),
    ):  # fmt: skip
        open_menu(player, 0.0, 2.0)
        take(player, text)
        assert isinstance(commands(player)[-1], kind), text
        assert state_hash(player.world) != before
        player.key(pygame.K_z, pygame.KMOD_CTRL)
        player.frames(2)
        assert state_hash(player.world) == before, text
    open_menu(player, 0.0, 2.0)
    take(player, "Fix it here")
    open_menu(player, 0.0, 2.0)
    assert "Let it move" in rows(player)
    take(player, "Let it move")
    assert state_hash(player.world) == before


def test_the_menu_of_an_axle_gives_a_motor_that_keys_drive_and_takes_it_out(player):
    player.key(pygame.K_SPACE)
    player.key(pygame.K_2, pygame.KMOD_SHIFT)
    stroke(player, *ring(0.0, 2.0, 0.5))
    player.key(pygame.K_7, pygame.KMOD_SHIFT)
    player.move(at(player, 0.1, 2.0))
    player.frames(2)
    assert player.stage.tool.hint == "wheel to the air" and player.stage.tool.ghost
    stroke(player, (0.1, 2.0))
    player.key(pygame.K_ESCAPE)
    states = []
    for text in (MOTOR, NO_MOTOR, LET_GO, HOLD, TAKE_OUT):
        states.append(state_hash(player.world))
        open_menu(player, 0.0, 2.0)
        assert len(rows(player)) == 3
        take(player, text)
        assert [name for name, _ in player.app.play.keys.shown()] == (["a", "d"] if text == MOTOR else []), text
    open_menu(player, 0.0, 2.0)
    assert "Make it jelly" in rows(player)
    player.key(pygame.K_ESCAPE)
    for state in reversed(states):
        player.key(pygame.K_z, pygame.KMOD_CTRL)
        player.frames(2)
        assert state_hash(player.world) == state


def test_what_was_made_is_painted_from_its_menu_and_the_level_itself_is_not(open_app):
    player = open_app(furnished())
    player.key(pygame.K_SPACE)
    x, y = player.world.position[player.world.particle_slot("cube.4")].tolist()
    open_menu(player, x, y)
    assert COLOUR not in rows(player)
    player.key(pygame.K_ESCAPE)
    player.key(pygame.K_2, pygame.KMOD_SHIFT)
    stroke(player, *ring(0.5, 2.5, 0.5))

    def picture():
        player.frames(2)
        left, top = at(player, 0.3, 2.7)
        return pygame.image.tobytes(player.app.display.surface.subsurface((left, top, 30, 30)), "RGB")

    before, state = picture(), state_hash(player.world)
    open_menu(player, 0.5, 2.5)
    take(player, COLOUR)
    assert rows(player) == [name.capitalize() for name in PALETTE]
    take(player, "Sky")
    player.move(at(player, -3.0, 5.0))
    pixels = picture()
    red, _, blue = (sum(pixels[k::3]) for k in range(3))
    assert blue > red and state_hash(player.world) == state
    scene = player.playback.present_scene().session()
    assert scene.world.joined[-1].level.bodies[0].look.colour == "sky"
    player.key(pygame.K_z, pygame.KMOD_CTRL)
    assert picture() == before


def test_no_menu_hangs_over_the_status_line(player):
    player.key(pygame.K_2, pygame.KMOD_SHIFT)
    stroke(player, *ring(0.0, 0.6, 0.5))
    open_menu(player, 0.0, 0.4)
    assert pygame.Rect(player.stage.camera.viewport).contains(player.app.ui.focus.rect)


def test_a_drawing_that_crosses_itself_stays_and_says_why_beside_the_pointer(player):
    player.key(pygame.K_2, pygame.KMOD_SHIFT)
    before = pygame.image.tobytes(player.app.display.surface, "RGB")
    stroke(player, (0, 1), (2, 3), (2, 1), (0, 3), (-0.5, 2))
    assert player.stage.tool.hint == REFUSALS[CROSSES] and not player.world.joined
    assert pygame.image.tobytes(player.app.display.surface, "RGB") != before
    player.key(pygame.K_ESCAPE)
    assert player.stage.tools["draw_wood"].hint == ""


def test_the_right_button_over_nothing_opens_nothing(player):
    open_menu(player, 0.0, 5.0)
    assert not player.app.ui.has_sheet


def finger(driver, kind, pixel):
    place = round(pixel[0]), round(pixel[1])
    driver.app.input.process([pygame.event.Event(kind, pos=place, button=1, touch=True, rel=(0, 0), buttons=(1, 0, 0))])


def test_a_finger_that_rests_on_a_thing_opens_its_menu_and_one_that_moves_drags_it(open_app, monkeypatch):
    player = open_app(furnished())
    player.frames(60)
    now = pygame.time.get_ticks()
    place = at(player, *player.world.position[player.world.particle_slot("ball")].tolist())
    monkeypatch.setattr(pygame.time, "get_ticks", lambda: now)
    finger(player, pygame.MOUSEBUTTONDOWN, place)
    assert player.stage.drag.holds
    monkeypatch.setattr(pygame.time, "get_ticks", lambda: now + 600)
    player.app.input.process([])
    assert not player.stage.drag.holds and "Copy it" in rows(player)
    player.key(pygame.K_ESCAPE)
    finger(player, pygame.MOUSEBUTTONDOWN, place)
    finger(player, pygame.MOUSEMOTION, (place[0] + 40, place[1] - 40))
    monkeypatch.setattr(pygame.time, "get_ticks", lambda: now + 2000)
    player.app.input.process([])
    assert player.stage.drag.holds and not player.app.ui.has_sheet


def test_where_hands_may_not_add_there_are_no_tools_and_the_menu_says_why(open_app):
    level = replaced(furnished(), hands=PlayerLimits(may=("grab", "firmness")))
    assert refused_tools(level) >= {*MAKING, "delete"}
    player = open_app(level)
    player.key(pygame.K_b)
    assert player.app.play.palette is None
    assert set(MAKING) <= set(NAMES)
    player.key(pygame.K_SPACE)
    x, y = player.world.position[player.world.particle_slot("cube.4")].tolist()
    before = len(commands(player))
    open_menu(player, x, y)
    take(player, "Copy it")
    assert len(commands(player)) == before
    assert any("in this level hands may not add parts" in notice for notice in player.notices)


def test_a_saved_scene_has_what_was_made_and_goes_on_from_there(player, tmp_path):
    player.key(pygame.K_1, pygame.KMOD_SHIFT)
    stroke(player, *ring(0.0, 2.5, 0.6))
    player.key(pygame.K_6, pygame.KMOD_SHIFT)
    stroke(player, (0.0, 2.5), (1.0, 4.0), (1.0, 5.0))
    player.frames(20)
    scene = player.playback.present_scene()
    again = scene.session()
    assert state_hash(again.world) == state_hash(player.world) and again.world.joined
    assert CutSprings not in map(type, commands(player)) and scene.actions == "2 things added"
