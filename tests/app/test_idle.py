"""Python's search for garbage waits until nobody works."""

import gc

import pytest

from sandbox.app.idle import ENOUGH, REST, IdleCollector


@pytest.fixture
def collector():
    made = IdleCollector()
    yield made
    made.close()


def litter(count=ENOUGH):
    """Make garbage that only a search can find."""
    for _ in range(count):
        ring = []
        ring.append(ring)


def test_nothing_is_searched_while_somebody_works_and_all_new_garbage_is_found_in_a_pause(collector):
    gc.collect()
    litter()
    for _ in range(100):
        collector.update(REST / 2, is_busy=True)
    assert gc.get_count()[0] >= ENOUGH
    collector.update(REST / 2, is_busy=False)
    assert gc.get_count()[0] >= ENOUGH
    collector.update(REST / 2, is_busy=False)
    assert gc.get_count()[0] < ENOUGH


def test_a_pause_in_which_there_is_little_to_find_is_left_alone(collector):
    gc.collect()
    litter(10)
    before = gc.get_count()[0]
    collector.update(10 * REST, is_busy=False)
    assert gc.get_count()[0] >= before


def test_python_searches_by_itself_again_once_it_is_closed():
    assert gc.isenabled()
    made = IdleCollector()
    assert not gc.isenabled()
    made.close()
    assert gc.isenabled()
