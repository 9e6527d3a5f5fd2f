"""The row of firmness says what it sets, in levels of every solver, and of whom it speaks; the pad too."""

import pytest

from sandbox.level.reading.files import load_level
from sandbox.physics.jit import COMPILED

pytestmark = pytest.mark.skipif(not COMPILED, reason="interpreted kernels take minutes")


def settled(driver):
    """The rows, once what was asked is set and nothing is measured any more."""
    driver.measure()
    return driver.panel.firmness


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("jelly_cube", "The cube stretches by {} % of its height"),
        ("jelly_wheel", "The wheel's rim drops by {} % of its height"),
        ("spider_web", "The web's middle drops by {} % of its length"),
        ("trampoline", "The bed's middle drops by {} % of its length"),
        pytest.param("quad_mesh", "The cloth stretches by {} % of its height", marks=pytest.mark.whole_world),
    ],
)
def test_a_word_lights_up_and_its_sag_is_said_of_the_body_by_its_name(open_app, name, says):
    driver = open_app(load_level(name))
    settled(driver)
    for word, sag in (("soft", "10"), ("jelly", "25"), ("firm", "2")):
        driver.click_widget(driver.panel.firmness.words.buttons[word])
        rows = settled(driver)
        assert (rows.words.chosen, rows.sag.text) == (word, sag)
        assert rows.text.text.startswith(says.format(sag))


def test_a_beam_and_its_jellies_are_spoken_of_each_by_its_own_measure(open_app):
    driver = open_app(load_level("girder"))
    settled(driver)
    driver.panel.choose_body("girder")
    driver.click_widget(driver.panel.firmness.words.buttons["jelly"])
    assert settled(driver).text.text.startswith("The girder's end drops by 25 % of its length")
    driver.panel.choose_body("jelly 1")
    assert settled(driver).text.text.startswith("Jelly 1 sags by 2.7 % of its height")


def test_what_cannot_sag_so_far_is_left_as_it_is_and_that_is_said(open_app):
    # Iterations take the weight of a small brick off its own springs, where it stands.
    driver = open_app(load_level("wrecking_ball"))
    settled(driver)
    driver.panel.choose_body("brick 3")
    before = driver.world.stiffness.copy()
    driver.click_widget(driver.panel.firmness.words.buttons["jelly"])
    settled(driver)
    assert (driver.world.stiffness == before).all()
    assert any(text.startswith("Brick 3: a sag of 25 % is far out of reach here") for text in driver.notices)


def test_what_takes_too_long_is_said_not_to_be_measured(open_app, monkeypatch):
    monkeypatch.setattr("sandbox.physics.softness.sag_meter.PATIENCE", 0.0)
    monkeypatch.setattr("sandbox.physics.softness.sag_meter.MOST_OF_CURVE", 0.0)
    driver = open_app(load_level("quad_mesh"))
    driver.frames(30)
    assert driver.panel.firmness.text.text.startswith("How far it sags cannot be measured here")
