"""Python's search for garbage waits until nobody works."""

import gc
import weakref

import pytest

from sandbox.app.base.idle import _ENOUGH, REST, IdleCollector
from sandbox.app.draw.raster.painter import _scratch_for, _scratches
from sandbox.app.run.playback import Playback
from tests.app.conftest import small_level


@pytest.fixture
def collector():
    made = IdleCollector()
    yield made
    made.close()


def litter(count=_ENOUGH):
    """Make garbage that only a search can find."""
    for _ in range(count):
        ring = []
        ring.append(ring)


def test_nothing_is_searched_while_somebody_works_and_all_new_garbage_is_found_in_a_pause(collector):
    gc.collect()
    litter()
    for _ in range(100):
        collector.update(REST / 2, is_busy=True)
    assert gc.get_count()[0] >= _ENOUGH
    collector.update(REST / 2, is_busy=False)
    assert gc.get_count()[0] >= _ENOUGH
    collector.update(REST / 2, is_busy=False)
    assert gc.get_count()[0] < _ENOUGH


def test_a_pause_in_which_there_is_little_to_find_is_left_alone(collector):
    gc.collect()
    litter(10)
    before = gc.get_count()[0]
    collector.update(10 * REST, is_busy=False)
    assert gc.get_count()[0] >= before


def test_what_was_long_on_the_screen_is_found_in_the_first_pause_after_it_is_gone(collector):
    class Widget:
        pass

    widget = Widget()
    widget.itself, gone = widget, weakref.ref(widget)
    gc.collect()
    del widget
    collector.update(REST, is_busy=False)
    assert gone() is not None
    collector.expect_old_garbage()
    collector.update(REST / 2, is_busy=True)
    assert gone() is not None
    collector.update(REST, is_busy=False)
    assert gone() is None


def test_python_searches_by_itself_again_once_it_is_closed():
    assert gc.isenabled()
    made = IdleCollector()
    assert not gc.isenabled()
    made.close()
    assert gc.isenabled()


@pytest.mark.parametrize(
    "replace",
    [lambda app: app.documents.new(), lambda app: app.start(Playback(small_level())), lambda app: app.rebuild()],
    ids=["another level", "a run", "another layout"],
)
def test_what_filled_the_window_is_let_go_of_in_the_next_pause(edit, replace):
    driver = edit()
    # A run keeps the editor's window, to come back to.
    replace(driver.app)
    driver.frames(2)
    left = weakref.ref(driver.app.ui)
    replace(driver.app)
    driver.frames(2)
    driver.rest()
    assert left() is None


def test_a_layout_that_is_over_keeps_none_of_its_widgets_whoever_has_it_still(edit):
    driver = edit()
    driver.app.open_gallery()
    driver.frames(2)
    before, card = driver.app.ui, weakref.ref(driver.app.gallery.cards[0])
    picture = weakref.ref(card().image)
    driver.app.show_screen(driver.editor)
    driver.frames(2)
    gc.collect()
    assert before is not driver.app.ui
    assert card() is None and picture() is None


def test_an_editor_keeps_no_picture_of_its_canvas_and_panel_while_its_level_is_played(edit):
    driver = edit()
    driver.editor.side.choose("history")
    driver.frames(2)
    left = [weakref.ref(each) for each in (driver.editor.view, driver.editor.side, driver.editor.side.back)]
    driver.app.documents.play()
    driver.frames(2)
    gc.collect()
    assert [each() for each in left] == [None, None, None]
    driver.app.documents.back()
    driver.frames(2)
    assert driver.app.screen is driver.editor and driver.editor.side.tab == "history"


def test_painters_of_a_size_share_what_they_work_in_and_none_is_kept_for_a_size_that_nobody_draws(open_app):
    driver = open_app(small_level())
    driver.frames(2)
    driver.app.display.window.size = (700, 500)
    driver.frames(2)
    gc.collect()
    assert (1280, 720) not in _scratches
    first = _scratch_for((41, 30))
    assert _scratch_for((41, 30)) is first
    del first
    assert (41, 30) not in _scratches
