"""Nothing made in play is lost: what stood on the screen is brought back by undo, or by three clicks."""

import pygame
import pytest

from sandbox.editor.storage.scene_shelf import kept_scenes
from sandbox.level.reading.files import load_level
from sandbox.physics.snapshot import state_hash
from sandbox.session.scene import read_scene
from tests.app.conftest import Driver
from tests.support.scene_player import ScenePlayer, first_level, unreachable
from tests.support.wholes import some_and_whole

CTRL, SHIFT = pygame.KMOD_CTRL, pygame.KMOD_SHIFT
RUNS = 40
DEEDS = 16


def drop(driver, key=pygame.K_4, at=(0.5, 0.4)):
    """Drop a part in the middle of the world."""
    left, top, width, height = driver.app.play.viewport
    driver.key(key)
    driver.click((left + width * at[0], top + height * at[1]))
    driver.key(pygame.K_ESCAPE)


def hash_of(driver):
    return state_hash(driver.world)


@pytest.fixture
def toy(open_app):
    driver = open_app(load_level("desk_toy"))
    driver.key(pygame.K_SPACE)
    return driver


@pytest.mark.parametrize("seed", some_and_whole(range(2), range(RUNS)))
def test_all_that_stood_on_the_screen_can_be_had_back(seed, documents):
    player = ScenePlayer(Driver(first_level(seed)), seed)
    player.go_on(DEEDS)
    (player.be_killed if seed % 2 else player.close)()
    assert player.stood, "nothing was made"
    assert unreachable(player.stood, documents) == []


def test_undo_after_a_restart_brings_back_what_was_there_and_redo_the_restart(toy):
    drop(toy)
    stood = hash_of(toy)
    toy.key(pygame.K_r)
    assert hash_of(toy) != stood and toy.playback.session.gestures == ()
    assert any("Ctrl+Z brings back" in line for line in toy.notices)
    toy.key(pygame.K_z, CTRL)
    assert hash_of(toy) == stood and len(toy.playback.session.gestures) == 1
    toy.key(pygame.K_y, CTRL)
    assert toy.playback.session.gestures == ()
    toy.key(pygame.K_z, CTRL)
    assert hash_of(toy) == stood
    toy.key(pygame.K_z, CTRL)
    assert toy.playback.session.gestures == ()


def test_undo_brings_back_a_run_that_was_left_for_the_editor(toy):
    drop(toy)
    stood = hash_of(toy)
    toy.key(pygame.K_e)
    assert toy.app.mode == "edit"
    toy.key(pygame.K_e)
    assert toy.app.mode == "play" and hash_of(toy) != stood
    toy.key(pygame.K_SPACE)
    toy.key(pygame.K_z, CTRL)
    assert hash_of(toy) == stood


def test_what_was_left_for_another_level_is_had_back_by_three_clicks(toy):
    drop(toy)
    drop(toy, at=(0.4, 0.3))
    stood = hash_of(toy)
    toy.key(pygame.K_g)
    toy.app.files.open_level("levels/rope.json", shipped=True)
    toy.frames(2)
    toy.app.scenes.shelf.settle()
    toy.click_widget(toy.app.play.toolbar.buttons["gallery"])
    toy.frames(3)
    mine = next(button for button in toy.app.ui.buttons() if button.text == "My levels")
    toy.click_widget(mine)
    toy.frames(40)
    card = toy.app.gallery.cards[0]
    assert card.name == "Desk toy" and "2 things added" in card.line and card.picture is not None
    toy.click_widget(card)
    assert toy.app.gallery is None and hash_of(toy) == stood and toy.playback.clock.paused


def test_the_first_page_offers_the_last_runs_at_the_next_start(toy, documents):
    drop(toy)
    toy.frames(40)
    toy.app.scenes.shelf.settle()
    stood = hash_of(toy)
    again = Driver()
    again.frames(40)
    group = next(group for group in again.app.gallery.groups if group.title == "Go on where you were")
    assert len(group.cards) == 1 and "1 thing added" in group.cards[0].name
    again.click_widget(group.cards[0])
    assert hash_of(again) == stood
    again.app.close()


def test_a_run_in_which_nothing_was_done_is_not_kept(open_app):
    driver = open_app(load_level("desk_toy"))
    driver.frames(200)
    driver.key(pygame.K_r)
    driver.app.scenes.shelf.settle()
    assert kept_scenes() == []


def test_a_scene_that_is_looked_at_alone_is_not_kept_a_second_time(toy, open_app):
    drop(toy)
    toy.key(pygame.K_r)
    toy.app.scenes.shelf.settle()
    (path,) = kept_scenes()
    again = open_app()
    again.app.files.open_scene(path)
    again.key(pygame.K_SPACE)
    again.frames(200)
    again.key(pygame.K_g)
    again.app.files.open_level("levels/rope.json", shipped=True)
    again.app.scenes.shelf.settle()
    assert kept_scenes() == [path]


def test_ctrl_s_saves_the_scene_in_my_levels_under_a_proposed_name_that_can_be_changed(toy, documents):
    drop(toy)
    stood = hash_of(toy)
    toy.key(pygame.K_s, CTRL)
    assert [path.name for path in documents.iterdir()] == ["Desk toy.scene.jsonl"]
    toy.type("My heap")
    toy.key(pygame.K_RETURN)
    assert [path.name for path in documents.iterdir()] == ["My heap.scene.jsonl"]
    assert state_hash(read_scene(documents / "My heap.scene.jsonl")[0].state) == stood


def test_what_is_saved_is_not_among_what_was_not_and_is_again_once_more_is_done_or_it_is_discarded(toy):
    def kept():
        toy.frames(40)
        toy.app.scenes.shelf.settle()
        return len(kept_scenes())

    drop(toy)
    assert kept() == 1
    toy.key(pygame.K_s, CTRL)
    assert kept_scenes() == []
    toy.choose("Save")
    toy.key(pygame.K_SPACE)
    assert kept() == 0
    drop(toy)
    assert kept() == 1
    toy.app.play.saved = None
    toy.key(pygame.K_s, CTRL)
    assert kept_scenes() == []
    toy.choose("Discard")
    assert kept() == 1


def test_saving_again_goes_on_in_the_same_file_only_while_it_is_the_same_run(toy, documents):
    drop(toy)
    toy.key(pygame.K_s, CTRL)
    toy.key(pygame.K_RETURN)
    drop(toy, at=(0.4, 0.3))
    toy.key(pygame.K_s, CTRL)
    assert not toy.app.ui.has_sheet
    assert [path.name for path in documents.iterdir()] == ["Desk toy.scene.jsonl"]
    toy.key(pygame.K_r)
    toy.key(pygame.K_s, CTRL)
    toy.key(pygame.K_RETURN)
    assert sorted(path.name for path in documents.iterdir()) == ["Desk toy-2.scene.jsonl", "Desk toy.scene.jsonl"]
    assert read_scene(documents / "Desk toy.scene.jsonl")[0].actions == "2 things added"


def test_a_saved_scene_can_be_discarded_at_once(toy, documents):
    drop(toy)
    toy.key(pygame.K_s, CTRL)
    toy.choose("Discard")
    assert list(documents.iterdir()) == [] and toy.app.play.saved is None


def test_a_run_is_taken_to_the_sheet_from_any_level_in_its_looks_and_as_it_stands(open_app):
    driver = open_app(load_level("desk_toy"))
    for key, at in ((pygame.K_4, (0.3, 0.3)), (pygame.K_6, (0.7, 0.3))):
        drop(driver, key, at)
    driver.frames(60)
    driver.key(pygame.K_SPACE)
    drawn = driver.playback.current.position.copy()
    driver.key(pygame.K_k, CTRL)
    driver.choose("All of it")
    driver.frames(2)
    assert driver.app.mode == "edit"
    level = driver.editor.document.level
    ball, jelly = level.particles[-1], level.bodies[-1]
    assert (ball.look.ball, ball.look.colour) == ("stripe", "raspberry")
    assert jelly.look.skin == "jelly" and jelly.pose is not None
    lowest = min(y for _, y in jelly.pose)
    assert any(abs(lowest - y) < 1e-9 for y in drawn[:, 1].tolist())
    driver.key(pygame.K_z, CTRL)
    assert driver.editor.document.level == load_level("desk_toy")


def test_a_file_that_is_no_scene_any_more_is_refused_in_one_line_and_nothing_changes(toy, documents):
    drop(toy)
    toy.key(pygame.K_s, CTRL)
    toy.key(pygame.K_RETURN)
    (path,) = documents.iterdir()
    path.write_bytes(path.read_bytes()[:-200])
    playback = toy.playback
    assert not toy.app.files.open_path(path)
    assert toy.playback is playback and toy.app.ui.has_sheet


def test_where_runs_cannot_be_kept_one_line_says_so(toy, tmp_path, monkeypatch):
    (tmp_path / "file").write_bytes(b"")
    toy.app.scenes.shelf.folder = tmp_path / "file" / "scenes"
    toy.app.scenes.shelf.present = toy.app.scenes.shelf._new_path()
    drop(toy)
    toy.frames(60)
    toy.app.scenes.shelf.settle()
    toy.frames(60)
    assert sum("cannot be kept" in line for line in toy.notices) == 1
