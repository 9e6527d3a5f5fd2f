"""The page of the gallery: sections, search, whole texts, pictures that move; on one window, which only looks."""

import pygame
import pytest

from sandbox.app.gallery.sections import FIRST, SECTIONS, in_sections
from sandbox.level.reading.files import shipped_levels
from tests.app.conftest import Driver


@pytest.fixture(scope="module")
def gallery_driver(tmp_path_factory):
    """The app on its gallery, shared by what only looks."""
    with pytest.MonkeyPatch.context() as patch:
        folder = tmp_path_factory.mktemp("gallery")
        patch.setattr("sandbox.editor.storage.preferences.platformdirs.user_data_dir", lambda *_, **__: str(folder))
        driver = Driver()
        with pytest.MonkeyPatch.context() as windows:
            # Others come and go meanwhile: quitting the display would leave this window invalid.
            windows.setattr(pygame.display, "quit", pygame.event.clear)
            yield driver
        driver.app.close()


@pytest.fixture
def page(gallery_driver):
    """The gallery, with nothing searched."""
    gallery_driver.app.open_gallery()
    gallery_driver.rest()
    return gallery_driver


def shown(driver):
    return [card for card in driver.app.gallery.cards if card.visible]


def test_every_shipped_level_stands_in_exactly_one_section_and_nine_toys_come_first():
    named = [name for section in SECTIONS for name in section.levels]
    assert sorted(named) == sorted(path.stem for path in shipped_levels())
    assert len(SECTIONS[0].levels) == 9 and FIRST in SECTIONS[0].levels
    assert [section.title for section, _ in in_sections(shipped_levels())] == [each.title for each in SECTIONS]


def test_a_level_that_no_section_names_comes_last(tmp_path):
    found = in_sections([tmp_path / "new.json", *shipped_levels()])
    assert [path.stem for path in found[-1][1]] == ["new"]


def test_typing_anywhere_searches_names_and_tags_and_escape_shows_all_again(page):
    page.press_letters("wheel mot")
    names = [card.name for card in shown(page)]
    assert "Ferris wheel" in names and "Tumble drum" in names and "Jelly cube" not in names
    page.key(pygame.K_ESCAPE)
    assert len(shown(page)) == len(page.app.gallery.cards) > len(shipped_levels())


def test_a_search_without_a_hit_says_so(page):
    page.press_letters("xyzzy")
    assert shown(page) == []
    assert "xyzzy" in page.app.gallery._nothing.text
    page.key(pygame.K_ESCAPE)


def test_from_the_search_down_goes_to_the_first_hit_and_a_new_layout_keeps_what_is_searched(page):
    page.press_letters("girder")
    page.app.rebuild()
    page.frames(2)
    assert [card.name for card in shown(page)] == ["Girder"]
    page.app.ui.focus_on(page.app.gallery.header.search)
    page.key(pygame.K_DOWN)
    assert page.app.ui.focus is shown(page)[0]
    page.key(pygame.K_ESCAPE)


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
    gallery.area.scroll_to(card.place.top - 20)
    still = card.picture
    page.move(card.rect.center)
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


@pytest.mark.parametrize("size", [(640, 480), (1280, 720), (1920, 1080)])
def test_all_of_the_header_and_two_cards_fit_into_every_window(page, size):
    before = page.app.display.size
    page.app.display.window.size = size
    page.frames(2)
    page.app.gallery.area.scroll_to(0.0)
    window = pygame.Rect((0, 0), size)
    for button in page.app.ui.buttons():
        assert window.contains(button.rect), button.text
    for card in shown(page)[:2]:
        assert window.contains(card.rect)
    page.app.display.window.size = before
    page.frames(2)


def test_a_large_window_has_larger_cards_five_side_by_side(page):
    before = page.app.display.size
    page.app.display.window.size = (1920, 1080)
    page.frames(2)
    toys = next(group for group in page.app.gallery.groups if group.title == "Toys")
    assert toys.columns == 5 and toys.width > 340
    page.app.display.window.size = before
    page.frames(2)


CTRL = pygame.KMOD_CTRL


@pytest.mark.parametrize("section", ["levels", "mine", "recordings"])
@pytest.mark.parametrize(("key", "mod", "opened"), [
    (pygame.K_l, CTRL, "Replays"), (pygame.K_o, CTRL, "Open"), (pygame.K_F1, 0, "Take the tour"),
    (pygame.K_COMMA, CTRL, "General"),
])  # fmt: skip
def test_keys_that_open_something_else_do_so_from_the_gallery_too(page, section, key, mod, opened):
    page.app.open_gallery(section)
    page.frames(2)
    gallery = page.app.gallery
    page.key(key, mod)
    assert page.app.gallery is not gallery or not gallery.is_on_top
    assert opened in [button.text for button in page.app.ui.buttons()]
    # What lies over the gallery has the keyboard to itself.
    if page.app.gallery is gallery:
        page.key(pygame.K_l, CTRL)
        assert page.app.gallery is gallery
        page.key(pygame.K_ESCAPE)
        assert gallery.is_on_top


def test_the_keys_of_the_editor_work_in_its_gallery(edit):
    driver = edit()
    driver.key(pygame.K_o, CTRL)
    assert driver.app.gallery.section == "levels"
    driver.key(pygame.K_l, CTRL)
    assert driver.app.gallery.section == "mine"
    driver.key(pygame.K_n, CTRL)
    assert driver.app.gallery is None and driver.app.mode == "edit"
