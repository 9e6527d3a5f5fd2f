"""The lesson: both begin as the same spring; made stiffer, Hooke's explodes and the article's never does."""

from dataclasses import replace

import numpy as np
import pygame
import pytest

from sandbox.app.compare.compare_screen import CompareScreen
from sandbox.app.compare.hooke_lesson import MASSES, RATES, SPRINGS, HookeLesson, has_exploded
from sandbox.app.compare.hooke_level import CD, MOST_DOUBLINGS, SpringTrial, lesson_level, words
from sandbox.app.draw.colours import LINE
from sandbox.session.session import Session

TRIALS = [
    SpringTrial(mass=mass, rate=rate, springs=springs) for mass in MASSES for rate in RATES for springs in SPRINGS
]


def run(trial, is_hooke, ticks):
    session = Session(lesson_level(trial, is_hooke))
    with np.errstate(over="ignore", invalid="ignore"):
        for _ in range(ticks):
            session.advance()
            if has_exploded(session.world):
                return session.tick
    return None


@pytest.fixture
def lesson(open_app):
    driver = open_app()
    card = next(card for card in driver.app.gallery.cards if "explodes" in card.name)
    card.press()
    driver.frames(2)
    assert isinstance(driver.app.play, HookeLesson)
    return driver


def test_both_sides_are_one_spring_until_cs_is_1():
    for doublings in range(5):
        trial = SpringTrial(doublings)
        assert trial.are_equal
        ends = []
        for is_hooke in (True, False):
            session = Session(lesson_level(trial, is_hooke))
            for _ in range(60):
                session.advance()
            ends.append(session.world.position[1])
        # They hang apart by Cd m g / k.
        assert np.abs(ends[0] - ends[1]).max() < 2.0 * CD * 9.81 / trial.k
    assert not SpringTrial(5).are_equal and SpringTrial(5).cs == 1.0


@pytest.mark.parametrize("trial", TRIALS, ids=str)
def test_hooke_s_spring_explodes_beyond_the_limit_that_is_named_and_not_below(trial):
    stiff = [replace(trial, doublings=doublings) for doublings in range(MOST_DOUBLINGS + 1)]
    below = [each for each in stiff if each.k < 0.95 * each.highest_k]
    beyond = next((each for each in stiff if each.k > 4.5 * each.highest_k), None)
    if below:
        assert run(below[-1], True, 240) is None
    assert beyond is None or run(beyond, True, 400) is not None
    assert run(stiff[-1], False, 240) is None


def test_stiffer_again_and_again_ends_in_words_and_a_button_and_harms_nothing(lesson):
    screen = lesson.app.play
    before = words(screen.trial, None)
    for _ in range(8):
        lesson.click_widget(screen.panel.stiffer)
    lesson.frames(60)
    assert screen.exploded_at is not None and screen.restart_button.visible
    assert "exploded after" in screen.panel.text.text != before
    assert np.abs(screen.other.session.world.position).max() < 3.0
    lesson.app.display.window.size = (640, 480)
    lesson.frames(30)
    assert "exploded" in lesson.app.play.states()
    lesson.click_widget(screen.restart_button)
    lesson.frames(1)
    assert screen.playback.session.tick < 9
    screen.try_out(SpringTrial())
    lesson.frames(30)
    assert screen.exploded_at is None and not screen.restart_button.visible


def test_a_button_that_can_do_no_more_is_not_offered(lesson):
    panel = lesson.app.play.panel
    assert panel.stiffer.is_enabled and not panel.softer.is_enabled
    lesson.click_widget(panel.stiffer)
    assert panel.softer.is_enabled
    lesson.click_widget(panel.softer)
    assert not panel.softer.is_enabled and lesson.app.play.trial.doublings == 0
    lesson.app.play.try_out(SpringTrial(MOST_DOUBLINGS))
    assert not panel.stiffer.is_enabled and panel.softer.is_enabled


def test_another_weight_or_rate_begins_anew_with_another_limit(lesson):
    panel = lesson.app.play.panel
    limit = lesson.app.play.trial.highest_k
    lesson.click_widget(panel.masses.buttons["10"])
    assert lesson.app.play.trial.highest_k == pytest.approx(10.0 * limit, rel=0.1)
    lesson.click_widget(panel.rates.buttons["240"])
    assert lesson.world.settings.tick_rate == 240 == lesson.app.play.other.session.world.settings.tick_rate
    lesson.key(pygame.K_F9)
    lesson.frames(1)
    assert not isinstance(lesson.app.play, HookeLesson) and lesson.app.play is not None


def test_a_drag_moves_the_weights_of_both(lesson):
    lesson.frames(30)
    at = lesson.pixel_of("weight 1")
    lesson.press(at)
    lesson.move((at[0] + 60, at[1] - 30))
    lesson.frames(5)
    screen = lesson.app.play
    assert screen.playback.session.world.any_held() and screen.other.session.world.any_held()
    lesson.release((at[0] + 60, at[1] - 30))
    one, other = screen.playback.session.world.position[1], screen.other.session.world.position[1]
    assert one == pytest.approx(other, abs=0.004) and one[0] > 0.1


def test_the_gallery_offers_two_settings_of_a_shipped_level(open_app):
    driver = open_app()
    next(card for card in driver.app.gallery.cards if card.name == "Two settings at once").press()
    driver.frames(2)
    screen = driver.app.play
    assert isinstance(screen, CompareScreen) and screen.panel.by_pad


def test_every_trial_has_words_that_fit():
    for trial in TRIALS:
        for doublings in range(MOST_DOUBLINGS + 1):
            each = replace(trial, doublings=doublings)
            assert 20 < len(words(each, None)) < 330
            assert len(words(each, 12)) < 480


def test_what_is_shared_of_it_has_both_formulas_with_their_numbers(lesson):
    lesson.frames(20)
    film = lesson.app.play.film(10.0)
    (hooke, _), (article, _) = film.parts
    assert hooke.startswith("A   Hooke: F = -k x - c v   k = 225 N/m")
    assert article.startswith("B   The article") and "Cs = 0.0625" in article
    # Neither reaches into the other half.
    for size in ((640, 360), (380, 214)):
        picture = next(filter(None, film.pictures(0.0, 0.0, 20.0, size)))
        assert {tuple(picture.get_at((size[0] // 2, y))[:3]) for y in range(0, size[1], 3)} == {tuple(LINE)}
