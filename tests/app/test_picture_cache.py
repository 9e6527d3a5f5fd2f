"""Pictures of levels: shipped ones are those of the levels as they are, others are drawn once."""

import os

import pygame
import pytest

from sandbox.app.base.recent_pictures import RecentPictures
from sandbox.app.draw import picture_cache
from sandbox.app.draw.colours import THEME_NAMES
from sandbox.app.draw.picture_cache import kept_picture, picture_key, read_picture, shipped_picture, stale_pictures
from sandbox.app.gallery import gallery
from sandbox.editor.storage.preferences import remember
from sandbox.level.document.canonical import level_text
from sandbox.level.reading.files import shipped_levels
from tests.app.conftest import small_level


@pytest.fixture
def drawn(monkeypatch):
    """The names of the levels that are drawn from now on."""
    names, draw = [], gallery.draw_in_slices

    def note(level, theme, seconds):
        names.append(level.name)
        return draw(level, theme, 0.0)

    monkeypatch.setattr(gallery, "draw_in_slices", note)
    return names


def own_level(folder, name="Mine", **changes):
    path = folder / f"{name}.json"
    path.write_text(level_text(small_level(name=name, **changes)))
    remember(path)
    return path


def test_every_shipped_picture_is_of_its_level_as_it_is_now():
    missing, unused = stale_pictures()
    assert ([path.name for path in missing], [path.name for path in unused]) == ([], []), "`make pictures` draws them"


def test_a_changed_level_has_no_shipped_picture_but_line_ends_change_nothing():
    path = shipped_levels()[0]
    content = path.read_bytes()
    for theme in THEME_NAMES:
        assert shipped_picture(path, picture_key(content), theme).is_file()
        assert not shipped_picture(path, picture_key(content + b" "), theme).is_file()
    assert picture_key(content.replace(b"\n", b"\r\n")) == picture_key(content)


def test_the_gallery_of_shipped_levels_draws_nothing_however_often_and_large_it_is_opened(open_app, drawn):
    driver = open_app()
    for act in ("open", "resize"):
        if act == "resize":
            driver.app.display.window.size = (900, 700)
        else:
            driver.app.open_gallery()
        while driver.app.gallery._unfilled:
            driver.frames()
        assert all(card.picture is not None for card in driver.app.gallery.cards)
    assert drawn == []


def test_a_level_of_ones_own_is_drawn_once_and_again_after_a_change(open_app, drawn, tmp_path, monkeypatch):
    path = own_level(tmp_path)
    driver = open_app(small_level())
    for times, act in ((1, "open"), (1, "again"), (2, "change"), (2, "again")):
        if act == "change":
            path.write_text(level_text(small_level(name="Mine, changed")))
        monkeypatch.setattr(picture_cache, "_held", RecentPictures(picture_cache.HELD))
        driver.app.open_gallery("mine")
        while driver.app.gallery._unfilled:
            driver.frames()
        (card,) = driver.app.gallery.cards
        assert card.picture is not None
        assert len(drawn) == times, act
    assert card.name == "Mine, changed"


def test_a_damaged_picture_is_drawn_anew(open_app, drawn, tmp_path):
    kept = kept_picture(picture_key(own_level(tmp_path).read_bytes()), "dark")
    kept.parent.mkdir(parents=True)
    kept.write_bytes(b"\x89PNG\r\n\x1a\n, and no more")
    driver = open_app(small_level())
    driver.app.open_gallery("mine")
    while driver.app.gallery._unfilled:
        driver.frames()
    assert drawn == ["Mine"]
    assert pygame.image.load(kept).get_size() == picture_cache.SIZE


def test_where_pictures_cannot_be_kept_they_are_shown_all_the_same(open_app, drawn, tmp_path, monkeypatch):
    own_level(tmp_path)
    blocked = tmp_path / "cache"
    blocked.write_text("a file where the folder should be")
    driver = open_app(small_level())
    driver.app.open_gallery("mine")
    while driver.app.gallery._unfilled:
        driver.frames()
    assert driver.app.gallery.cards[0].picture is not None


def test_keys_are_answered_while_a_picture_takes_long(open_app, monkeypatch, tmp_path):
    def endless(level, theme, seconds):
        while True:
            yield True

    monkeypatch.setattr(gallery, "draw_in_slices", endless)
    own_level(tmp_path, "First")
    own_level(tmp_path, "Second")
    driver = open_app(small_level())
    driver.app.open_gallery("mine")
    driver.key(pygame.K_RIGHT)
    assert driver.app.ui.focus is driver.app.gallery.cards[0]
    driver.key(pygame.K_RETURN)
    assert driver.playback.level.name == driver.app.play.source.stem


def test_old_pictures_are_removed_and_those_used_last_stay(tmp_path, monkeypatch):
    monkeypatch.setattr(picture_cache, "KEPT", 2)
    for age, name in enumerate(("old", "older", "oldest")):
        (tmp_path / f"{name}.jpg").touch()

        os.utime(tmp_path / f"{name}.jpg", (10_000 - age, 10_000 - age))
    picture_cache.forget_old_pictures(tmp_path)
    assert sorted(path.stem for path in tmp_path.iterdir()) == ["old", "older"]


def test_a_picture_is_held_in_the_size_that_was_asked_for_last(open_app, monkeypatch):
    open_app()
    held = RecentPictures(1_000_000)
    monkeypatch.setattr(picture_cache, "_held", held)
    level = shipped_levels()[0]
    path = shipped_picture(level, picture_key(level.read_bytes()), "dark")
    for size in ((80, 45), (160, 90), (80, 45)):
        picture = read_picture(path, size)
        assert picture.get_size() == size and held.bytes == 4 * size[0] * size[1]
        assert read_picture(path, size) is picture


def test_a_picture_that_is_written_anew_is_read_anew_and_no_other(open_app, tmp_path):
    open_app()
    one, other = tmp_path / "one.jpg", tmp_path / "other.jpg"
    for path, colour in ((one, "red"), (other, "red"), (one, "blue")):
        picture = pygame.Surface((80, 45), 0, 32)
        picture.fill(colour)
        before = read_picture(other, (80, 45)) if other.exists() else None
        picture_cache.keep_picture(picture, path)
        assert read_picture(path, (80, 45)).get_at((40, 20)).b == pytest.approx(255 * (colour == "blue"), abs=4)
    assert read_picture(other, (80, 45)) is before
