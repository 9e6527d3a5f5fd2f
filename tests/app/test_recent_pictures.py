import pygame

from sandbox.app.base.recent_pictures import RecentPictures

BYTES = 4 * 20 * 10


def picture(width=20):
    return pygame.Surface((width, 10), pygame.SRCALPHA)


def test_those_used_last_stay_in_so_many_bytes():
    recent = RecentPictures(3 * BYTES)
    pictures = {name: picture() for name in "abcd"}
    for name in "abc":
        recent.keep(name, pictures[name])
    assert recent.find("a") is pictures["a"]
    recent.keep("d", pictures["d"])
    assert recent.bytes == 3 * BYTES
    assert [recent.find(name) for name in "abcd"] == [pictures["a"], None, pictures["c"], pictures["d"]]


def test_what_comes_last_stays_however_large_it_is_and_goes_with_the_next():
    recent = RecentPictures(3 * BYTES)
    recent.keep("small", picture())
    recent.keep("large", picture(80))
    assert recent.bytes == 4 * BYTES and recent.find("small") is None and recent.find("large") is not None
    recent.keep("small", picture())
    assert recent.bytes == BYTES and recent.find("large") is None


def test_a_picture_takes_the_place_of_that_of_its_name_and_can_be_forgotten():
    recent = RecentPictures(3 * BYTES)
    recent.keep("a", picture(40))
    other = picture()
    recent.keep("a", other)
    assert recent.bytes == BYTES and recent.find("a") is other
    recent.forget("a")
    recent.forget("a")
    assert recent.bytes == 0 and recent.find("a") is None
