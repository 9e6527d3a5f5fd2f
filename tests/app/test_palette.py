"""Play with parts, by mouse and keys: the strip, ghosts, drops and throws, sizes, carts, deeds, undo, and keeping."""

import pygame
import pytest

from sandbox.app.base.shortcuts import tip_of
from sandbox.app.draw.colours import ACCENT
from sandbox.app.draw.picture import PartGhost
from sandbox.app.play.score import chips_of
from sandbox.app.play.stage import CATALOGUE
from sandbox.app.play.toolbar import _MORE, NAMES
from sandbox.physics.pipeline.block_owner import block_of
from sandbox.physics.snapshot import state_hash
from sandbox.session.commands import AddBody, AddParticle, Push, Remove, SetAir
from sandbox.tools.dropping import PARTS
from sandbox.tools.tool import DropPicture
from tests.app.conftest import small_level
from tests.support.parts import furnished

SHIFTED = {name: f"{number}" for number, name in enumerate(NAMES[6:13], 1)}
KEYS = dict(zip((name for name in NAMES if name not in SHIFTED), "4567890vxi", strict=True))


@pytest.fixture
def player(open_app):
    driver = open_app(furnished())
    driver.key(pygame.K_b)
    return driver


def at(driver, x, y):
    return driver.stage.camera.to_pixels((x, y))


def drop(driver, *points):
    driver.stroke(*points)
    driver.frames(1)


def commands(driver):
    return [entry.command for entry in driver.playback.session.history.timeline]


def test_the_strip_folds_out_and_every_part_and_deed_has_a_key_a_button_and_a_picture(player):
    palette = player.app.play.palette
    assert list(palette.buttons) == [*NAMES, CATALOGUE]
    for name, key in KEYS.items():
        player.key(ord(key))
        assert player.stage.tool_name == name
    player.key(pygame.K_ESCAPE)
    assert player.stage.tool_name == "drag"
    player.click_widget(palette.buttons["jelly"])
    assert player.stage.tool_name == "jelly"
    player.click_widget(palette.buttons["jelly"])
    assert player.stage.tool_name == "drag"
    player.key(pygame.K_b)
    assert player.app.play.palette is None
    player.key(pygame.K_6)
    assert player.app.play.palette is not None


def test_what_joins_has_its_ticks_laid_out_in_a_frame_before_the_first_and_that_changes_nothing(player):
    player.playback.submit(PARTS["jelly"].make(1.0, (0.0, 6.0), (0.0, 0.0), "sky"))
    tick = player.playback.session.tick
    player.frames(1)
    assert player.world.joined and player.playback.session.tick == tick
    before = state_hash(player.world)
    player.frames(1)
    assert player.playback.session.tick == tick and state_hash(player.world) == before
    pointer = block_of(player.world).pointer
    player.frames(1)
    assert player.playback.session.tick == tick + 1 and block_of(player.world).pointer is pointer


def test_a_ghost_goes_before_a_click_drops_and_the_run_goes_on(player):
    player.key(pygame.K_6)
    player.move(at(player, 0.0, 3.0))
    player.frames(1)
    (ghost,) = player.stage.tool.ghost
    x, y = at(player, *ghost[0])
    found = [
        player.app.display.surface.get_at((round(x) + i, round(y) + j))[:3] for i in (-1, 0, 1) for j in (-1, 0, 1)
    ]
    assert any(abs(colour[1] - ACCENT[1]) < 40 and colour[1] > colour[0] + 40 for colour in found)
    drop(player, (0.0, 3.0))
    tick = player.playback.session.tick
    assert [joined.names for joined in player.world.joined] == [("+1",)]
    player.frames(3)
    assert player.playback.session.tick > tick
    player.key(pygame.K_z, pygame.KMOD_CTRL)
    player.frames(1)
    assert not player.world.joined
    player.key(pygame.K_y, pygame.KMOD_CTRL)
    player.frames(1)
    assert player.world.joined


def test_a_ghost_is_a_pale_picture_of_the_part_as_large_as_it_and_an_outline_where_that_is_huge(player):
    player.key(pygame.K_5)
    player.stage.tool.size = 1.0
    place = at(player, 0.0, 3.0)
    player.frames(1)
    before = player.app.display.surface.get_at((round(place[0]), round(place[1])))[:3]
    player.move(place)
    player.frames(1)
    wood = player.app.display.surface.get_at((round(place[0]), round(place[1])))[:3]
    assert wood[0] > before[0] + 30 and wood[0] > wood[2] + 20
    ghost, renderer = PartGhost(), player.stage.renderer
    picture = ghost.picture(DropPicture("box", 1.0, "coral"), 50.0, renderer)
    assert picture.get_at(picture.get_rect().center).a > 100 and picture.get_at((0, 0)).a == 0
    assert ghost.picture(DropPicture("box", 1.0, "coral"), 50.0, renderer) is picture
    assert ghost.picture(DropPicture("box", 1000.0, "coral"), 50.0, renderer) is None


def test_the_wheel_and_keys_size_a_part_and_zoom_with_the_hand(player):
    player.key(pygame.K_4)
    size, zoom = player.stage.tool.size, player.stage.camera.zoom
    player.move(at(player, 0.0, 3.0))
    player.post(pygame.MOUSEWHEEL, x=0, y=2, precise_y=2.0, which=0, flipped=False)
    player.frames(1)
    assert player.stage.tool.size == pytest.approx(size * 1.21) and player.stage.camera.zoom == zoom
    player.key(pygame.K_MINUS)
    assert player.stage.tool.size == pytest.approx(size)
    drop(player, (0.0, 3.0))
    (ball,) = commands(player)
    assert isinstance(ball, AddParticle) and ball.radius == pytest.approx(size / 2)
    player.key(pygame.K_ESCAPE)
    player.post(pygame.MOUSEWHEEL, x=0, y=2, precise_y=2.0, which=0, flipped=False)
    player.frames(1)
    assert player.stage.camera.zoom > zoom


def test_a_dropped_cart_is_driven_by_its_keys_and_a_watched_run_is_taken_over(player):
    player.key(pygame.K_9)
    drop(player, (0.0, 1.0))
    player.key(pygame.K_ESCAPE)
    names = player.world.actuators.names
    assert names == ("mill", "+2", "+3")
    player.post(pygame.KEYDOWN, key=pygame.K_w, mod=0, unicode="w")
    player.frames(1)
    assert player.world.actuator_value.tolist() == [1.0, 1.0, 1.0]
    player.post(pygame.KEYUP, key=pygame.K_w, mod=0)
    player.frames(1)
    assert player.world.actuator_value.tolist() == [1.0, 0.0, 0.0]
    player.key(pygame.K_z, pygame.KMOD_CTRL)
    player.key(pygame.K_z, pygame.KMOD_CTRL)
    player.frames(1)
    assert player.world.actuators.names == ("mill",)


def test_push_wind_and_delete_by_mouse(player):
    player.key(pygame.K_0)
    drop(player, (-2.0, 0.5), (-2.0, 1.5))
    player.key(pygame.K_v)
    drop(player, (0.0, 3.0), (1.0, 3.0), (2.0, 3.0))
    player.key(pygame.K_x)
    x, y = player.world.position[player.world.particle_slot("ball")]
    drop(player, (x, y))
    made = commands(player)
    assert isinstance(made[0], Push) and made[0].impulse[1] > 0.0
    assert isinstance(made[1], SetAir) and made[-2] == SetAir((0.0, 0.0), 0.0)
    assert isinstance(made[-1], Remove)
    assert not player.world.particle_active[player.world.particle_slot("ball")]


def test_a_level_without_contacts_says_what_holds(open_app, driver):
    driver.key(pygame.K_4)
    assert any("Things pass through each other" in notice for notice in driver.notices)


def test_what_was_dropped_is_kept_in_the_document_and_undone_there(edit):
    driver = edit(furnished())
    driver.key(pygame.K_e)
    driver.frames(2)
    session = driver.playback.session
    for key, x in ((pygame.K_9, 0.0), (pygame.K_4, 1.5), (pygame.K_6, -0.5)):
        driver.key(key)
        drop(driver, (x, 4.0 if key == pygame.K_6 else 1.0))
    driver.key(pygame.K_ESCAPE)
    session.submit(Remove(body="+3"))
    driver.frames(2)
    driver.key(pygame.K_k, pygame.KMOD_CTRL)
    driver.choose("Added: what was dropped into it")
    kept = driver.editor.document.level
    assert [body.id for body in kept.bodies] == ["cube", "rope", "mill", "frame", "rear", "jelly"]
    assert [particle.id for particle in kept.particles] == ["ball", "ball 2"]
    assert kept.welds == (("frame.0", "rear.hub"),) and set(kept.materials) == {"dropped steel", "dropped tyre"}
    assert isinstance(AddBody, type) and kept.bodies[-1].position[1] == pytest.approx(4.0, abs=0.6)
    driver.key(pygame.K_e)
    driver.frames(1)
    driver.key(pygame.K_z, pygame.KMOD_CTRL)
    assert len(driver.editor.document.level.bodies) == 3


def test_a_drop_and_its_undo_may_come_within_one_frame(player):
    player.key(pygame.K_6)
    place = tuple(map(round, at(player, 0.0, 3.0)))
    player.move(place)
    # A busy machine hands all of it on at once.
    player.post(pygame.MOUSEBUTTONDOWN, pos=place, button=1)
    player.post(pygame.MOUSEBUTTONUP, pos=place, button=1)
    player.post(pygame.KEYDOWN, key=pygame.K_z, mod=pygame.KMOD_CTRL, unicode="", scancode=0)
    player.frames(2)
    assert player.playback.session.can_redo and not player.world.joined
    assert "There is nothing to undo." not in player.notices
    for key in (pygame.K_y, pygame.K_z, pygame.K_y):
        player.post(pygame.KEYDOWN, key=key, mod=pygame.KMOD_CTRL, unicode="", scancode=0)
    player.frames(2)
    assert len(player.world.joined) == 1 and "There is nothing to redo." not in player.notices


def test_what_has_no_room_beside_panel_and_graphs_is_in_a_menu(player):
    player.app.chosen.choose("scale", 2.0)
    player.app.display.window.size = (1280, 720)
    player.frames(2)
    if not player.app.play.show_panel:
        player.app.act("panel")
    for name in ("graphs", "timeline"):
        player.app.act(name)
    player.frames(2)
    palette = player.app.play.palette
    assert pygame.Rect(player.app.play.area).contains(palette.back.rect)
    assert list(palette.buttons) == [*(name for name in NAMES if name not in palette.left_out), _MORE]
    assert set(palette.left_out) | set(palette.buttons) == {*NAMES, CATALOGUE, _MORE}
    player.click_widget(palette.buttons[_MORE])
    hidden = palette.left_out[0]
    player.choose(tip_of(f"tool_{hidden}", "play"))
    assert player.stage.tool_name == hidden and palette.buttons[_MORE].is_selected


def test_tools_that_a_level_keeps_away_are_not_offered_and_parts_that_are_left_are_counted(open_app):
    level = small_level(hands={"may": ["add", "cut"], "at_most": {"add": 2}})
    driver = open_app(level)
    driver.key(pygame.K_b)
    play = driver.app.play
    assert {*NAMES, CATALOGUE} - set(play.palette.buttons) == {"push", "wind", "delete", "freeze"}
    offered = {*play.toolbar.buttons, *play.toolbar.left_out}
    assert {"tool_drag", "tool_pin", "tool_cut", "panel"} & offered == {"tool_cut"}

    def left():
        chips = chips_of(driver.playback.level, driver.playback.current, None)
        return [chip.value for chip in chips if chip.name == "Parts left"]

    assert left() == ["2 of 2"]
    driver.key(pygame.K_4)
    for x in (0.0, 2.0, 4.0):
        drop(driver, (x, 3.0))
    assert left() == ["0 of 2"]
    assert len(commands(driver)) == 2
