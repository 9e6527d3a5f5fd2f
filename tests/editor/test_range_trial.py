"""Trying several values of a number at once."""

import math

import pytest

from sandbox.editor.document import Document, EditError
from sandbox.editor.items import Item
from sandbox.editor.range_trial import MOST_VALUES, RangeTrial, between, numbers
from tests.app.conftest import small_level
from tests.support.zoo import zoo

STONE = Item("particle", "stone")


def thrown():
    stone = {"id": "stone", "position": [0, 5], "velocity": [3, 4], "mass": 1}
    check = {"name": "far", "metric": "x", "particle": "stone", "at_least": 7.9, "after": 2}
    level = small_level(particles=[stone], settings={"gravity": [0, -10], "tick_rate": 120}, checks=[check])
    return Document(level, frozenset([STONE]))


def number(document, title):
    return next(each for each in numbers(document) if each.title == title)


def done(trial):
    while not trial.is_done:
        trial.advance(1.0)
    return trial


def test_each_value_has_the_way_and_the_checks_that_it_makes():
    document = thrown()
    trial = done(RangeTrial(document, number(document, "Velocity x [m/s]"), between(2, 6, 5, whole=False)))
    assert [attempt.value for attempt in trial.attempts] == [2, 3, 4, 5, 6]
    for attempt in trial.attempts:
        (line,) = attempt.trail.lines(document.selection, 8)
        second = round(attempt.trail.per_second)
        assert line[second, 0] == pytest.approx(attempt.value, rel=1e-9)
        assert [result.passed for result in attempt.results.values()] == [2 * attempt.value >= 7.9]
    assert trial.document is document


def test_a_value_that_is_not_possible_says_why_and_the_others_are_tried():
    document = thrown()
    trial = done(RangeTrial(document, number(document, "Mass [kg]"), [-1.0, 2.0]))
    bad, good = trial.attempts
    assert bad.fault and bad.level is None and good.results and not good.fault


def test_the_numbers_of_a_body_are_its_fields_and_those_of_its_material():
    document = Document(small_level(), frozenset([Item("body", "rope")]))
    titles = [each.title for each in numbers(document)]
    assert {"Start x [m]", "Segments", "Cs  stiffness of steel", "Frequency of steel [Hz]"} <= set(titles)
    stiffer = number(document, "Cs  stiffness of steel").set(document, 0.5)
    assert stiffer.level.materials["steel"].stiffness == 0.5 and stiffer.level.materials["rubber"].stiffness == 0.02


def test_without_a_selection_the_numbers_are_the_levels():
    titles = {each.title for each in numbers(Document(small_level()))}
    assert {title.partition(" [")[0] for title in titles} >= {"Gravity x", "Gravity y", "Tick rate"}


def test_every_number_of_everything_takes_the_value_that_it_has():
    level = zoo()
    for body in level.bodies:
        document = Document(level, frozenset([Item("body", body.id)]))
        for each in numbers(document):
            before = each.value
            try:
                changed = each.set(document, before)
            except EditError:
                # A body without a firmness takes no frequency of its own.
                assert each.about.field.startswith("firmness")
                continue
            assert number(changed, each.title).value == pytest.approx(before, rel=1e-8), each.title


def test_angles_are_tried_in_degrees():
    level = zoo()
    jelly = next(body for body in level.bodies if body.type == "jelly")
    document = Document(level, frozenset([Item("body", jelly.id)]))
    turned = number(document, "Angle [°]").set(document, 30.0)
    body = next(body for body in turned.level.bodies if body.id == jelly.id)
    assert body.angle == pytest.approx(math.radians(30))


@pytest.mark.parametrize(
    ("low", "high", "count", "whole", "wanted"),
    [
        (0, 1, 3, False, [0, 0.5, 1]), (4, 1, 4, True, [4, 3, 2, 1]), (1, 3, 9, True, [1, 2, 3]),
        (0, 0.3, 4, False, [0, 0.1, 0.2, 0.3]),
    ],
)  # fmt: skip
def test_values_lie_evenly_between_the_ends(low, high, count, whole, wanted):
    assert between(low, high, count, whole=whole) == wanted


@pytest.mark.parametrize(("low", "high", "count"), [(1, 1, 5), (0, 1, 1), (0, 1, MOST_VALUES + 1)])
def test_a_range_that_is_none_is_refused(low, high, count):
    with pytest.raises(EditError):
        between(low, high, count, whole=False)
