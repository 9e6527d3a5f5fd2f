"""A run of tests says what was not there, and how many tests were skipped for want of it."""

pytest_plugins = ["pytester"]

SOME = """
import pytest
from tests.support.wants import needs, skip_without

@needs("a left hand", False)
@pytest.mark.parametrize("number", range(3))
def test_by_mark(number): ...

@needs("a right hand", True)
def test_of_what_is_there(): ...

@pytest.fixture
def tail():
    skip_without("a tail")

def test_by_fixture(tail): ...

def test_of_another_reason():
    pytest.skip("not today")
"""
SAID = ["skipped for want of a left hand: 3", "skipped for want of a tail: 1"]


def test_a_run_says_at_its_end_how_many_tests_were_skipped_for_want_of_what(pytester):
    pytester.makepyfile(SOME)
    run = pytester.runpytest_inprocess("-q", "-p", "tests.support.wants")
    run.assert_outcomes(passed=1, skipped=5)
    assert [line for line in run.outlines if line.startswith("skipped for want of")] == SAID
