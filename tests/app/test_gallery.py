"""The gallery: levels with pictures, saved replays, and opening them."""

import os

import numpy as np
import pygame
import pytest

from sandbox.app.gallery.sections import FIRST, SECTIONS, in_sections
from sandbox.app.recordings import chosen_path, free_path, plain_name
from sandbox.editor.storage.recent import remember
from sandbox.level.format.canonical import level_text
from sandbox.level.format.files import shipped_levels
from tests.app.conftest import Driver, small_level


def test_every_shipped_level_has_a_card_with_a_picture(open_app):
    driver = open_app()
    driver.app.preparation.finish(contacts=True)
    driver.frames(len(shipped_levels()) + 2)
    cards = driver.app.gallery.cards
    assert len(cards) == len(shipped_levels())
    for card in cards:
        pixels = pygame.surfarray.array3d(card.picture)
        assert len(np.unique(pixels.reshape(-1, 3), axis=0)) > 10, card.name


def test_a_click_on_a_card_opens_its_level(open_app):
    driver = open_app()
    card = driver.app.gallery.cards[1]
    driver.click_widget(card)
    assert driver.app.gallery is None
    assert driver.playback.level.name == card.name


def test_arrow_keys_and_enter_open_a_level_too(open_app):
    driver = open_app()
    driver.key(pygame.K_DOWN)
    driver.key(pygame.K_RIGHT)
    name = driver.app.gallery.cards[1].name
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
    driver.key(pygame.K_s, pygame.KMOD_CTRL)
    driver.key(pygame.K_RETURN)
    driver.key(pygame.K_l, pygame.KMOD_CTRL)
    (card,) = driver.app.gallery.cards
    assert card.name == next(documents.iterdir()).name
    driver.click_widget(card)
    assert driver.playback.watching


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


def test_names_of_recordings_are_safe_and_never_taken(tmp_path):
    assert plain_name("Rope, bridge & jelly!") == "rope-bridge-jelly"
    assert plain_name("../..") == "run"
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


# Sections, search, whole texts, pictures that move.


@pytest.fixture(scope="module")
def gallery_driver(tmp_path_factory):
    """The app on its gallery, shared by what only looks."""
    with pytest.MonkeyPatch.context() as patch:
        folder = tmp_path_factory.mktemp("gallery")
        patch.setattr("sandbox.editor.storage.level_file.platformdirs.user_data_dir", lambda *_, **__: str(folder))
        driver = Driver()
        yield driver
        driver.app.close()


@pytest.fixture
def page(gallery_driver):
    """The gallery, with nothing searched."""
    gallery_driver.app.open_gallery()
    gallery_driver.frames(2)
    return gallery_driver


def shown(driver):
    return [card for card in driver.app.gallery.cards if card.visible]


def type_letters(driver, text):
    """Press keys of letters, as a keyboard does: the key first, then what it types."""
    for letter in text:
        driver.post(pygame.KEYDOWN, key=ord(letter), mod=0, unicode=letter, scancode=0)
        driver.post(pygame.TEXTINPUT, text=letter)
        driver.post(pygame.KEYUP, key=ord(letter), mod=0, unicode=letter, scancode=0)
    driver.frames(2)


def test_every_shipped_level_stands_in_exactly_one_section_and_ten_toys_come_first():
    named = [name for section in SECTIONS for name in section.levels]
    assert sorted(named) == sorted(path.stem for path in shipped_levels())
    assert len(SECTIONS[0].levels) == 10 and FIRST in SECTIONS[0].levels
    assert [section.title for section, _ in in_sections(shipped_levels())] == [each.title for each in SECTIONS]


def test_a_level_that_no_section_names_comes_last(tmp_path):
    found = in_sections([tmp_path / "new.json", *shipped_levels()])
    assert [path.stem for path in found[-1][1]] == ["new"]


def test_typing_anywhere_searches_names_and_tags_and_escape_shows_all_again(page):
    type_letters(page, "wheel mot")
    names = [card.name for card in shown(page)]
    assert "Ferris wheel" in names and "Tumble drum" in names and "Jelly cube" not in names
    page.key(pygame.K_ESCAPE)
    assert len(shown(page)) == len(shipped_levels()) and page.app.gallery is not None


def test_a_search_without_a_hit_says_so(page):
    type_letters(page, "xyzzy")
    assert shown(page) == []
    assert "xyzzy" in page.app.gallery._nothing.text
    page.key(pygame.K_ESCAPE)


def test_from_the_search_down_goes_to_the_first_hit_and_a_new_layout_keeps_what_is_searched(page):
    type_letters(page, "girder")
    page.app.rebuild()
    page.frames(2)
    assert [card.name for card in shown(page)] == ["Girder"]
    page.app.ui.focus_on(page.app.gallery.header.search.entry)
    page.key(pygame.K_DOWN)
    assert page.app.ui.focus is shown(page)[0]
    page.key(pygame.K_ESCAPE)


def test_enter_opens_the_first_hit_which_is_then_played_lately(open_app):
    driver = open_app()
    assert [card.name for card in driver.app.gallery.cards if card.badge] == ["Jelly pile"]
    type_letters(driver, "girder")
    driver.key(pygame.K_RETURN)
    assert driver.playback.level.name == "Girder"
    driver.app.open_gallery()
    lately = driver.app.gallery.groups[0]
    assert [card.name for card in lately.cards] == ["Girder"] and lately.is_shortcut
    assert not any(card.badge for card in driver.app.gallery.cards)


def test_a_press_of_a_section_brings_it_to_the_top(page):
    page.choose("Machines")
    page.frames(2)
    first = next(card for card in shown(page) if card.name == "Tumble drum")
    assert abs(first.rect.top - page.app.gallery.area.view.rect.top) < page.app.ui.px(60)
    page.app.gallery.scroll(1000)


def test_the_whole_text_is_there_for_the_card_that_is_pointed_at_by_mouse_or_keyboard(page):
    card = shown(page)[1]
    width = card.rect.width
    whole = " ".join(line for line, _ in card._all_lines(width))
    assert card.text in whole and all(tag in whole for tag in card.tags)
    before = page.app.display.surface.copy()
    page.app.ui.focus_on(card)
    page.frames(2)
    below = pygame.Rect(card.rect.left, card.rect.bottom + 2, width, page.app.ui.px(12))
    assert differ(before, page.app.display.surface, below)
    page.app.ui.blur()


def differ(before, after, place):
    """Whether two pictures differ in a place."""
    first, second = (pygame.surfarray.array3d(each.subsurface(place)) for each in (before, after))
    return bool((first != second).any())


def played_for(page, name, frames=40):
    """The still picture of a card, and what it shows after the mouse has been on it for some frames."""
    gallery = page.app.gallery
    while gallery._unfilled:
        page.frames()
    card = next(card for card in shown(page) if card.name == name)
    gallery.area.scroll_to(card.relative_rect.top - 20)
    still = card.picture
    page.move(card.rect.center)
    page.app.preparation.finish(contacts=True)
    page.frames(frames)
    return card, still


def test_a_picture_moves_while_it_is_pointed_at_and_stands_still_afterwards(page):
    card, still = played_for(page, "Rope")
    first = card.picture.copy()
    assert card.picture is not still
    page.frames(10)
    assert differ(first, card.picture, first.get_rect())
    page.move((5, 5))
    page.frames(2)
    assert card.picture is still


def test_with_reduced_motion_pictures_stand_still(page):
    page.app.chosen.choose("motion", "less")
    card, still = played_for(page, "Rope")
    assert card.picture is still
    page.app.chosen.choose("motion", None)
    page.move((5, 5))


@pytest.mark.parametrize("size", [(640, 480), (1280, 720), (2560, 1440)])
def test_all_of_the_header_and_two_cards_fit_into_every_window(page, size):
    before = page.app.display.size
    page.app.display.window.size = size
    page.frames(2)
    window = pygame.Rect((0, 0), size)
    for button in page.app.ui.buttons():
        assert window.contains(button.rect), button.text
    for card in shown(page)[:2]:
        assert window.contains(card.rect)
    page.app.display.window.size = before
    page.frames(2)
