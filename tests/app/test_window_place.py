"""The window opens where it was closed, as large as it was."""

import pytest

from sandbox.app.base.display import KEPT, Display, keep_window, kept_window
from sandbox.editor.storage.preferences import set_preference


@pytest.fixture(autouse=True)
def _own_data(documents):
    """Preferences of this test alone."""


def opened(kept):
    display = Display(1.0, kept)
    size, asked = display.window.size, display._asked
    display.close()
    return size, asked


def test_size_and_place_are_remembered():
    keep_window([200, 150, 1000, 700])
    assert kept_window() == [200, 150, 1000, 700]
    assert opened(kept_window()) == ((1000, 700), (200, 150))


def test_a_window_that_fills_the_screen_leaves_what_was_remembered():
    keep_window([200, 150, 1000, 700])
    keep_window(None)
    assert kept_window() == [200, 150, 1000, 700]


@pytest.mark.parametrize(
    "kept", ["left", [1, 2, 3], [0, 0, 0, 400], [0.5, 0, 800, 600], {"x": 1}, [2**40, 0, 800, 600]]
)
def test_what_is_no_place_is_passed_over(kept):
    set_preference(KEPT, kept)
    assert kept_window() is None


@pytest.mark.parametrize("place", [(-5000, 100), (100, -50), (100, 5000), (50_000, 100)])
def test_a_place_that_no_desktop_has_is_left_to_the_system(place):
    size, asked = opened([*place, 1000, 700])
    assert asked is None and size == (1000, 700)


def test_a_window_larger_than_the_desktop_or_too_small_to_use_is_made_to_fit():
    (width, height), _ = opened([0, 0, 100_000, 10])
    assert width < 100_000 and height >= 440


def test_the_frame_that_a_window_manager_adds_is_not_added_at_each_start():
    display = Display(1.0, [200, 150, 1000, 700])
    display.window.position = (201, 170)
    display.settle()
    assert display.kept == [200, 150, 1000, 700]
    display.window.position = (301, 190)
    assert display.kept == [300, 170, 1000, 700]
    display.close()
