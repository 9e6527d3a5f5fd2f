"""Parts of the catalogue in a run, by mouse and keyboard: one's own and ready ones are chosen, dropped and thrown."""

import pygame
import pytest

from sandbox.app.parts.part_page import SMALL_TEXT
from sandbox.app.play.stage import CATALOGUE
from sandbox.editor.storage.level_file import keep_part
from sandbox.session.compare.comparison import verify
from sandbox.session.replay.reader import read_replay
from sandbox.session.session import Session
from tests.app.test_palette import at, commands, drop
from tests.editor.test_joining import BAR, part
from tests.support.parts import SKIN, furnished

PAIR = part(
    name="Pair", description="A bar and a ball.", materials=SKIN, bodies=[BAR],
    particles=[{"id": "ball", "position": [0.5, 0.8], "radius": 0.2}],
)  # fmt: skip


@pytest.fixture
def player(open_app):
    keep_part(PAIR)
    keep_part(part(name="Hill", terrain=[{"id": "hill", "polyline": [[0, 0], [1, 0]]}]))
    driver = open_app(furnished())
    driver.key(pygame.K_u)
    driver.pass_unseen(40)
    return driver


def page(driver):
    return driver.app.play.part_page


def card(driver, name):
    return next(card for card in page(driver).cards if card.part.name == name)


def take(driver, name):
    driver.click_widget(card(driver, name))
    driver.frames(2)


def test_what_a_click_drops_is_one_gesture_and_its_recording_verifies(player, tmp_path):
    assert [each.part.name for each in page(player).cards][:3] == ["Hill", "Pair", "Car"]
    tick = player.playback.session.tick
    player.frames(5)
    assert player.playback.session.tick == tick
    take(player, "Pair")
    assert not player.app.ui.has_sheet and player.stage.tool_name == CATALOGUE
    session, before = player.playback.session, player.world.particle_count
    path = player.playback.record_to(tmp_path / "own.replay.jsonl")
    drop(player, (0.0, 3.0))
    assert [command.type for command in commands(player)] == ["add_body", "add_particle"]
    new = player.world.position[before : before + 3]
    # The pointer has the middle of the part, and it has fallen for a frame or two.
    assert (new.min(axis=0) + new.max(axis=0)) / 2 == pytest.approx((0.0, 3.0), abs=0.2)
    player.key(pygame.K_z, pygame.KMOD_CTRL)
    assert not player.world.joined and session.can_redo
    player.key(pygame.K_y, pygame.KMOD_CTRL)
    player.frames(10)
    player.playback.stop_recording()
    replay = read_replay(path)
    assert verify(replay) is None
    again = Session(replay.level, replay.script)
    while again.tick < replay.ticks:
        again.advance()
    assert again.world.joined and len(again.gestures) == len(session.gestures)


def test_the_wheel_sizes_it_as_it_does_ready_parts_and_the_recording_verifies(player, tmp_path):
    take(player, "Pair")
    tool, zoom, before = player.stage.tool, player.stage.camera.zoom, player.world.particle_count
    path = player.playback.record_to(tmp_path / "large.replay.jsonl")
    player.move(at(player, 0.0, 3.0))
    kept = player.stage.tool.ghost[0]
    for _ in range(6):
        player.post(pygame.MOUSEWHEEL, x=0, y=1, precise_x=0.0, precise_y=1.0, flipped=False)
    player.frames(2)
    assert tool.times == pytest.approx(1.1**6, rel=1e-3) and player.stage.camera.zoom == zoom
    wide = [max(x for x, _ in loop) - min(x for x, _ in loop) for loop in (kept, tool.ghost[0])]
    assert wide[1] == pytest.approx(tool.times * wide[0])
    landing = tool.landing
    drop(player, (0.0, 3.0))
    ball = commands(player)[-1]
    assert ball.radius == pytest.approx(0.2 * tool.times) and ball.mass == pytest.approx(tool.times**2)
    new = player.world.position[before : before + 3]
    assert (new.min(axis=0) + new.max(axis=0)) / 2 == pytest.approx(landing, abs=0.2)
    player.key(pygame.K_z, pygame.KMOD_CTRL)
    assert not player.world.joined
    player.key(pygame.K_y, pygame.KMOD_CTRL)
    player.frames(10)
    player.playback.stop_recording()
    assert player.world.joined and verify(read_replay(path)) is None
    player.stage.resize(-6)
    assert tool.times == 1.0
    drop(player, (1.0, 3.0))
    assert commands(player)[-1].radius == 0.2


def test_a_part_is_thrown_stays_in_hand_and_escape_ends_it(player, monkeypatch):
    take(player, "Pair")
    now = pygame.time.get_ticks()
    for kind, x in (("down", -1.0), ("move", 0.0), ("up", 1.0)):
        now += 20
        monkeypatch.setattr(pygame.time, "get_ticks", lambda now=now: now)
        player.stage.point(kind, at(player, x, 3.0), 0)
    player.frames(1)
    (body, ball) = commands(player)
    assert body.body["velocity"] == [25.0, 0.0] and ball.velocity == pytest.approx(tuple(body.body["velocity"]))
    drop(player, (0.0, 4.0))
    assert len(player.world.joined) == 2
    player.key(pygame.K_r)
    drop(player, (0.0, 4.0))
    assert len(player.world.joined) == 1
    player.key(pygame.K_ESCAPE)
    assert player.stage.tool_name == "drag"


def test_a_low_window_shows_two_whole_rows_of_small_cards_with_all_their_names(player):
    player.app.display.window.size = (1280, 720)
    player.app.chosen.choose("scale", 2.0)
    player.pass_unseen(40)
    player.frames(1)
    shown = page(player)
    whole = [card for card in shown.cards if shown.area.view.rect.contains(card.rect)]
    assert len({card.rect.top for card in whole}) >= 2 and len(whole) >= shown._columns + 2
    font = player.app.ui.font(SMALL_TEXT)
    assert all(font.size(card.part.name)[0] <= card.rect.width - player.app.ui.px(12) for card in shown.cards)


def test_what_cannot_join_is_pale_says_why_and_is_not_taken(player):
    hill = card(player, "Hill")
    assert hill.refusal and not card(player, "Pair").refusal
    take(player, "Hill")
    assert player.app.ui.has_sheet and player.stage.tool_name == "drag"
    assert page(player)._note.text == '"Hill" has terrain, which cannot join a run; build it into a level.'
    player.move(card(player, "Pair").rect.center)
    player.frames(2)
    assert page(player)._note.text == "Pair. A bar and a ball."


def test_the_keyboard_chooses_a_part_and_drops_it_and_a_new_layout_keeps_the_page(player):
    first = page(player)
    player.app.rebuild()
    player.frames(2)
    assert page(player) is not first and player.app.ui.has_sheet
    player.pass_unseen(40)
    assert player.app.ui.focus is card(player, "Pair"), "the hill before it cannot be had"
    for key in (pygame.K_RIGHT, pygame.K_LEFT, pygame.K_RETURN):
        player.key(key)
    assert not player.app.ui.has_sheet and player.stage.tool.place is not None
    player.key(pygame.K_RETURN)
    player.key(pygame.K_RETURN)
    player.frames(1)
    assert [joined.names for joined in player.world.joined] == [("+1",)]


def test_the_page_has_the_part_ready_for_enter_that_was_had_last(player):
    take(player, "Tower")
    player.key(pygame.K_u)
    player.pass_unseen(2)
    assert player.app.ui.focus is card(player, "Tower")
    assert page(player).area.view.rect.contains(card(player, "Tower").rect)


def test_a_ghost_is_the_part_itself_and_its_outline_where_that_is_huge(player):
    take(player, "Pair")
    x, y = at(player, 1.0, 3.0)
    player.move((x, y))
    player.frames(2)
    ghost, renderer = player.stage._ghost, player.stage.renderer
    picture = ghost.picture(player.stage.tool.preview, player.stage.camera.zoom, renderer)
    # The ball is in the middle of the upper half.
    wide, high = picture.get_size()
    assert picture.get_at((wide // 2, high // 3)).a > 60 and picture.get_at((0, 0)).a == 0
    assert ghost.picture(player.stage.tool.preview, 10_000.0, renderer) is None
    (outline,) = player.stage.tool.ghost
    assert outline[0] == outline[-1] and len(outline) == 5


def test_a_part_that_has_become_too_much_is_refused_in_a_line_and_the_run_goes_on(player, monkeypatch):
    take(player, "Pair")
    monkeypatch.setattr("sandbox.level.assembly.kits.PARTICLE_LIMIT", 1)
    drop(player, (0.0, 3.0))
    assert not player.world.joined and any("a world holds at most 1 particles" in line for line in player.notices)
    assert not player.playback.outcome
