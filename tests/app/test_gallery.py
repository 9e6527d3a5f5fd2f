"""The gallery: levels with pictures, saved replays, and opening them."""

import os

import numpy as np
import pygame
import pytest

from sandbox.app.base.desktop import chosen_path, free_path, plain_name
from sandbox.app.gallery.gallery import GO_ON, WIN, WIN_PLACE
from sandbox.app.run.playback import Playback
from sandbox.editor.storage.preferences import remember
from sandbox.level.document.canonical import level_text
from sandbox.level.reading.files import shipped_levels
from sandbox.session.commands import AddParticle
from sandbox.session.replay.reader import read_replay
from sandbox.session.scene import SceneTaker, scene_lines
from tests.app.conftest import Driver, small_level
from tests.support.hostile_scenes import bodies_far_out, resealed


def test_every_shipped_level_has_a_card_with_a_picture(open_app):
    driver = open_app()
    driver.frames(len(shipped_levels()) + 2)
    cards = [card for card in driver.app.gallery.cards if card in driver.app.gallery._paths]
    assert len(cards) == len(shipped_levels())
    for card in cards:
        pixels = pygame.surfarray.array3d(card.picture)
        assert len(np.unique(pixels.reshape(-1, 3), axis=0)) > 10, card.name


def test_a_click_on_a_card_opens_its_level(open_app):
    driver = open_app()
    card = driver.app.gallery.cards[2]
    driver.click_widget(card)
    assert driver.app.gallery is None
    assert driver.playback.level.name == card.name


def puzzles(driver):
    """The group of levels that can be won, and where it is seen [pixels]."""
    gallery = driver.app.gallery
    group = next(group for group in gallery.groups if group.title == "Puzzles")
    return group, group.top - gallery.area.offset


def test_a_card_among_the_first_leads_to_what_can_be_won_and_the_gallery_comes_back_where_it_was_left(open_app):
    driver = open_app()
    group, _ = puzzles(driver)
    driver.click_widget(driver.app.gallery.cards[WIN_PLACE])
    assert driver.app.gallery.cards[WIN_PLACE].name == WIN and puzzles(driver)[1] == 0
    driver.app.gallery.scroll(-1.0)
    where = puzzles(driver)[1]
    driver.click_widget(group.cards[3])
    assert driver.playback.level.rules
    driver.key(pygame.K_g)
    # A row of what was played lies above now.
    assert abs(puzzles(driver)[1] - where) <= 1 and driver.app.gallery.groups[0].cards


def test_runs_that_were_kept_stand_by_their_levels(open_app):
    driver = open_app(small_level(name="One"))
    for number, name in enumerate(("Two", "One", "Two")):
        driver.playback.submit(AddParticle((0.5 + number, 2.0), mass=2.0, radius=0.1))
        driver.frames(5)
        driver.app.start(Playback(small_level(name=name)))
    driver.app.open_gallery("mine")
    driver.frames(2)
    kept = {group.title: len(group.cards) for group in driver.app.gallery.groups if group.cards}
    assert kept == {"One": 2, "Two": 1}


def test_arrow_keys_and_enter_open_a_level_too(open_app):
    driver = open_app()
    driver.key(pygame.K_DOWN)
    driver.key(pygame.K_RIGHT)
    driver.key(pygame.K_RIGHT)
    name = driver.app.gallery.cards[2].name
    driver.key(pygame.K_RETURN)
    assert driver.playback.level.name == name


def test_the_wheel_scrolls_no_further_than_the_last_card(open_app):
    driver = open_app()
    gallery = driver.app.gallery
    top = gallery.cards[0].rect.top
    for _ in range(100):
        driver.post(pygame.MOUSEWHEEL, x=0, y=-1, precise_x=0.0, precise_y=-1.0, flipped=False)
        driver.frames()
    assert gallery.cards[0].rect.top < top
    assert gallery.cards[-1].rect.bottom <= driver.app.display.size[1]
    gallery.scroll(1000)
    assert gallery.cards[0].rect.top == top


def test_escape_goes_back_to_the_run_but_the_first_gallery_stays(driver: Driver):
    driver.key(pygame.K_g)
    assert driver.app.gallery is not None
    driver.key(pygame.K_ESCAPE)
    assert driver.app.gallery is None and driver.app.play is not None


def test_without_a_run_escape_leaves_the_gallery_open(open_app):
    driver = open_app()
    driver.key(pygame.K_ESCAPE)
    assert driver.app.gallery is not None


def test_saved_replays_are_listed_and_open(driver: Driver, documents):
    driver.frames(5)
    driver.key(pygame.K_s, pygame.KMOD_CTRL | pygame.KMOD_SHIFT)
    driver.key(pygame.K_RETURN)
    driver.key(pygame.K_l, pygame.KMOD_CTRL)
    (card,) = driver.app.gallery.cards
    assert card.name == next(documents.iterdir()).name
    driver.click_widget(card)
    assert driver.playback.watching


def test_a_replay_has_a_picture_its_level_and_its_length_and_a_broken_one_its_fault(driver: Driver, documents):
    driver.frames(30)
    driver.key(pygame.K_s, pygame.KMOD_CTRL | pygame.KMOD_SHIFT)
    driver.key(pygame.K_RETURN)
    (whole,) = documents.iterdir()
    ticks = read_replay(whole).ticks
    (documents / "cut.replay.jsonl").write_bytes(whole.read_bytes()[:-60])
    (documents / "broken.replay.jsonl").write_text("{}")
    driver.app.open_gallery("recordings")
    cards = {card.name: card for card in driver.app.gallery.cards}
    while not (cards[whole.name].picture and cards["cut.replay.jsonl"].picture and cards["broken.replay.jsonl"].broken):
        driver.frames()
    assert cards[whole.name].line.startswith(f"Small, {ticks / 60:.1f} s, ")
    assert ", cut off, " in cards["cut.replay.jsonl"].line
    assert "nothing was done" in cards[whole.name].text
    assert "no recording" in cards["broken.replay.jsonl"].text


def test_the_picture_of_a_replay_has_the_ground_of_its_level(open_app, documents):
    ground = [{"id": "ground", "polygon": [[-9, -9], [9, -9], [9, -3], [-9, -3]]}]
    pictures = []
    for name, terrain in (("bare", []), ("on ground", ground)):
        driver = open_app(small_level(view=[-4, -4, 4, 4], name=name, terrain=terrain))
        driver.frames(5)
        driver.key(pygame.K_s, pygame.KMOD_CTRL | pygame.KMOD_SHIFT)
        driver.key(pygame.K_RETURN)
        driver.app.open_gallery("recordings")
        card = next(card for card in driver.app.gallery.cards if card.name.startswith(name.split()[0]))
        while not card.picture:
            driver.frames()
        pictures.append(pygame.surfarray.array3d(card.picture).astype(int))
    assert (np.abs(pictures[0] - pictures[1]).max(axis=2) > 15)[:, -10:].mean() > 0.5


def test_opening_by_name_takes_a_shipped_level_and_says_what_is_wrong_with_others(driver: Driver):
    driver.key(pygame.K_o, pygame.KMOD_CTRL)
    driver.type("no such level")
    driver.key(pygame.K_RETURN)
    assert driver.app.ui.has_sheet
    driver.key(pygame.K_ESCAPE)
    driver.key(pygame.K_o, pygame.KMOD_CTRL)
    driver.type("spider_web")
    driver.key(pygame.K_RETURN)
    assert driver.playback.level.name == "Spider web"


def test_clicks_that_come_between_two_frames_are_carried_out_in_their_order(driver, tmp_path):
    path = tmp_path / "mine.json"
    path.write_text(level_text(small_level(name="Mine")))
    remember(path)
    driver.app.open_gallery("mine")
    card = driver.app.gallery.cards[0].rect.center
    driver.app.open_gallery("levels")
    driver.frames()
    (mine,) = [button.rect.center for button in driver.app.ui.buttons() if button.text == "My levels"]
    for pixel in (mine, card):
        driver.post(pygame.MOUSEMOTION, pos=pixel, rel=(0, 0), buttons=(0, 0, 0))
        driver.post(pygame.MOUSEBUTTONDOWN, pos=pixel, button=1)
        driver.post(pygame.MOUSEBUTTONUP, pos=pixel, button=1)
    driver.frames(2)
    assert driver.playback.level.name == "Mine"


def test_what_is_typed_and_entered_within_a_frame_opens_the_level_that_it_names(open_app):
    driver = open_app(None)
    for letter in "pinball":
        driver.post(pygame.KEYDOWN, key=ord(letter), mod=0, unicode=letter, scancode=0)
        driver.post(pygame.TEXTINPUT, text=letter)
        driver.post(pygame.KEYUP, key=ord(letter), mod=0, unicode=letter, scancode=0)
    driver.key(pygame.K_RETURN)
    assert driver.playback.level.name == "Pinball"


def test_names_of_recordings_are_safe_and_never_taken(tmp_path):
    assert plain_name("Rope, bridge & jelly!") == "rope-bridge-jelly"
    assert plain_name("../..") == plain_name("\U0001f388") == "run"
    names = {"Мост №2": "мост-2", "Été à Zürich": "été-à-zürich", "हिन्दी पुल": "हिन्दी-पुल", "橋": "橋", "a_b": "a-b"}
    assert {text: plain_name(text) for text in names} == names
    first = free_path(tmp_path, "run")
    first.touch()
    assert free_path(tmp_path, "run").name == "run-2.replay.jsonl"
    for typed in ("", "a/b", "..\\x", ".hidden", "x" * 200, "run", "run.replay.jsonl", "a:b"):
        try:
            chosen_path(tmp_path, typed)
        except ValueError as error:
            assert "\n" not in str(error)
        else:
            raise AssertionError(typed)


def test_files_whose_names_are_no_utf_8_have_cards_with_escapes(driver, documents, tmp_path):
    named = {name: tmp_path / os.fsdecode(name) for name in (b"well\xff.json", b"broken\xff.json")}
    try:
        named[b"well\xff.json"].write_text(level_text(small_level()))
    except OSError:
        pytest.skip("this file system takes UTF-8 names alone")
    named[b"broken\xff.json"].write_text("{")
    for path in named.values():
        remember(path)
    documents.mkdir(exist_ok=True)
    (documents / os.fsdecode(b"run\xff.replay.jsonl")).write_text("")
    driver.app.open_gallery("mine")
    driver.frames(3)
    assert [card.name for card in driver.app.gallery.cards] == ["broken\\udcff", "Small"]
    assert driver.app.gallery.cards[1].text.startswith("well\\udcff.json")
    driver.app.open_gallery("recordings")
    assert driver.app.gallery.cards[0].name == "run\\udcff.replay.jsonl"
    driver.click_widget(driver.app.gallery.cards[0])
    assert driver.app.ui.has_sheet


def test_enter_opens_the_first_hit_which_is_then_played_lately(open_app):
    driver = open_app()
    assert [card.name for card in driver.app.gallery.cards if card.badge] == ["Jelly pile"]
    driver.press_letters("girder")
    driver.key(pygame.K_RETURN)
    assert driver.playback.level.name == "Girder"
    driver.app.open_gallery()
    lately = next(group for group in driver.app.gallery.groups if group.title == GO_ON)
    assert [card.name for card in lately.cards] == ["Girder"] and lately.is_shortcut
    assert not any(card.badge for card in driver.app.gallery.cards)


def test_the_card_of_a_scene_that_asks_for_all_memory_says_that_it_is_damaged(driver: Driver, documents):
    path = documents / "hostile.scene.jsonl"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(b"".join(scene_lines(SceneTaker(driver.playback.session).take(), None)))
    resealed(path, bodies_far_out)
    driver.app.open_gallery("mine")
    card = next(card for card in driver.app.gallery.cards if card.name == "hostile")
    while not (card.broken or card.picture):
        driver.frames()
    assert card.broken and "beyond the arrays" in card.text
