"""The loop goes slowly while nothing moves: it says so by itself of every screen, and an event wakes it at once."""

import time
from types import SimpleNamespace

import pygame
import pytest

from sandbox.app.base import idle
from sandbox.app.base.display import Display, StartRequest
from sandbox.app.base.idle import IDLE_AFTER, IDLE_RATE, RESTING_RATE, IdleTimer
from sandbox.app.base.loop import FRAME_RATE, Profile
from sandbox.app.play.stage import AT_REST_AFTER
from sandbox.app.window.app import App, run_app
from sandbox.physics.snapshot import state_hash
from sandbox.session.commands import Grab, Push
from sandbox.session.session import Session
from tests.app.conftest import FRAME, small_level


class FakeTime:
    """A clock that goes on only while somebody waits; `on_nap` is called at every nap."""

    def __init__(self):
        self.now = 0.0
        self.on_nap = lambda: None

    def perf_counter(self):
        return self.now

    def sleep(self, seconds):
        self.now += seconds
        self.on_nap()

    thread_time = staticmethod(time.thread_time)


@pytest.fixture
def fake_time(monkeypatch):
    made = FakeTime()
    monkeypatch.setattr("sandbox.app.window.app.time", made)
    monkeypatch.setattr(idle, "time", made)
    return made


def key_event(kind, key):
    return pygame.event.Event(kind, key=key, mod=0, unicode="", scancode=0)


def let_calm_come(driver):
    """Do nothing for long enough; whether the loop may go slowly then."""
    driver.app.status.notices.clear()
    driver.pass_unseen(round((AT_REST_AFTER + 1.6 * IDLE_AFTER) / FRAME))
    return driver.app.idle.has_come


def test_calm_comes_after_a_while_in_which_nothing_happens_and_goes_at_once():
    followed = IdleTimer()
    followed.follow(0.9 * IDLE_AFTER, is_busy=False)
    assert not followed.has_come
    followed.follow(0.2 * IDLE_AFTER, is_busy=False)
    assert followed.has_come
    followed.follow(FRAME, is_busy=True)
    assert not followed.has_come


def test_waiting_ends_at_an_event_which_stays_in_the_queue_in_its_order(driver, fake_time):
    pygame.event.clear()
    assert not idle.wait_for_event(0.1) and fake_time.now == pytest.approx(0.1)

    def type_two():
        if fake_time.now > 0.15:
            fake_time.on_nap = lambda: None
            for key in (pygame.K_a, pygame.K_b):
                pygame.event.post(key_event(pygame.KEYDOWN, key))

    fake_time.on_nap = type_two
    assert idle.wait_for_event(10.0) and fake_time.now < 0.15 + 2 * idle._NAP
    assert idle.wait_for_event(10.0) and fake_time.now < 0.15 + 2 * idle._NAP
    assert [event.key for event in pygame.event.get(pygame.KEYDOWN)] == [pygame.K_a, pygame.K_b]


@pytest.fixture
def swinging(open_app):
    """The app on the small level with gravity, in which the rope swings and the pair falls."""
    return open_app(small_level(settings={"solver": "single_pass"}))


def ball(**more):
    """A level of a ball on a floor."""
    floor = {"id": "floor", "polyline": [[-9, 0], [9, 0]]}
    place = {"id": "ball", "position": [0, 0.5], "radius": 0.5, "restitution": 0.0}
    return small_level(
        settings={"solver": "direct"}, contacts={}, terrain=[floor], particles=[place | more], bodies=[], materials={}
    )


def pull_up(driver):
    driver.playback.submit(Push((0.0, 0.5), 2.0, (0.0, 6.0)))


def test_a_run_in_which_nothing_moves_is_calm_goes_on_tick_by_tick_and_wakes_at_once(open_app):
    driver = open_app(ball())
    assert let_calm_come(driver) and driver.app.idle_rate == RESTING_RATE
    assert driver.app.play.rests and driver.app.play.runs
    before = driver.playback.session.tick
    for _ in range(10):
        driver.app.frame(1.0 / RESTING_RATE)
    assert driver.playback.session.tick == before + 10 * 60 // RESTING_RATE
    assert driver.app.idle.has_come and driver.stage.detail.level == 0
    pull_up(driver)
    driver.app.frame(1.0 / RESTING_RATE)
    driver.app.frame(1.0 / RESTING_RATE)
    assert not driver.app.idle.has_come and not driver.app.play.rests
    driver.app.act("pause")
    assert let_calm_come(driver) and driver.app.idle_rate == IDLE_RATE


def test_what_comes_to_rest_at_a_low_rate_of_frames_has_the_bits_of_every_other_run(open_app):
    driver = open_app(ball(position=[0, 0.8], spin=3.0))
    for frame_time in (*[FRAME] * 200, *[1.0 / RESTING_RATE] * 20):
        driver.app.frame(frame_time)
    session = Session(driver.playback.level)
    while session.tick < driver.playback.session.tick:
        session.advance()
    assert state_hash(session.world) == state_hash(driver.world)


@pytest.mark.parametrize("what", ["spins", "slides", "is held", "is graphed"])
def test_a_run_that_spins_slides_or_is_held_is_not_at_rest(open_app, what):
    more = {"spins": {"position": [0, 5], "spin": 2.0, "gravity_scale": 0.0},
            "slides": {"position": [0, 5], "velocity": [0.2, 0.0], "gravity_scale": 0.0}}  # fmt: skip
    driver = open_app(ball(**more.get(what, {})))
    if what == "is held":
        driver.playback.submit(Grab(0, 0, (0.0, 0.5)))
    if what == "is graphed":
        driver.app.act("graphs")
    assert not let_calm_come(driver)


def test_both_halves_of_a_comparison_come_to_rest(open_app):
    driver = open_app(ball())
    driver.app.act("compare")
    assert let_calm_come(driver)
    driver.app.play.other.submit(Push((0.0, 0.5), 2.0, (0.0, 6.0)))
    driver.pass_unseen(4)
    assert not driver.app.idle.has_come


def test_a_run_moves_until_it_is_paused_and_a_page_over_it_stops_it(swinging):
    driver = swinging
    assert not let_calm_come(driver)
    driver.app.act("pause")
    assert let_calm_come(driver)
    driver.key(pygame.K_PERIOD)
    assert not driver.app.idle.has_come
    driver.app.act("pause")
    assert not let_calm_come(driver)
    driver.app.act("help")
    assert let_calm_come(driver)


def test_notices_wake_it_to_fade_and_pictures_stay_as_detailed_as_they_were(driver):
    driver.app.act("pause")
    assert let_calm_come(driver)
    driver.app.say("A line.")
    driver.app.frame(0.1)
    assert driver.app.idle.has_come
    driver.app.status.notices[0].left = 0.65
    driver.app.frame(0.1)
    assert not driver.app.idle.has_come
    for _ in range(60):
        driver.app.frame(0.1)
    assert not driver.app.status.notices
    assert driver.stage.detail.level == 0


def test_a_button_that_is_held_keeps_it_awake(driver, monkeypatch):
    driver.app.act("pause")
    monkeypatch.setattr(pygame.mouse, "get_pressed", lambda: (True, False, False))
    assert not let_calm_come(driver)


def test_an_editor_that_has_said_what_it_found_rests_until_the_level_is_another(edit):
    driver = edit(small_level())
    assert let_calm_come(driver)
    driver.editor.watch.toggle_forecast()
    driver.app.frame(0.1)
    assert not driver.app.idle.has_come
    assert let_calm_come(driver)
    assert driver.editor.watch.hanging is not None
    driver.editor.show((0.0, 0.0))
    driver.app.frame(0.1)
    assert not driver.app.idle.has_come
    driver.editor.show_parts()
    assert let_calm_come(driver) and len(driver.editor.side.page._unfilled) == 0


def test_the_tour_pulses_until_it_is_over(edit):
    driver = edit()
    driver.app.guide.begin()
    assert not let_calm_come(driver)
    driver.app.guide.skip()
    assert let_calm_come(driver)


def test_the_gallery_rests_once_its_cards_are_filled_and_none_plays(driver, fake_time):
    driver.app.open_gallery()
    gallery = driver.app.gallery
    assert gallery.moves
    gallery._unfilled._works.clear()
    assert let_calm_come(driver)
    card = next(card for card in gallery.cards if card in gallery._paths)
    driver.app.ui.focus_on(card)
    assert not let_calm_come(driver)
    # One that cannot be played is as still as its picture.
    gallery._preview[1]._session, gallery._preview[1]._steps = None, iter(())
    assert let_calm_come(driver)


def test_the_loop_slows_down_wakes_at_a_key_and_makes_up_for_no_time_that_it_slept(documents, fake_time, monkeypatch):
    times, ticks, asked = [], [], []
    frame = App.frame

    def noted_frame(app, frame_time):
        times.append(frame_time)
        app._draw = lambda: None
        app.status.notices.clear()
        if len(times) == 2:
            app.act("pause")
        before = app.play.playback.session.tick
        frame(app, frame_time)
        ticks.append(app.play.playback.session.tick - before)
        if asked and not app.play.playback.clock.paused:
            app.running = False

    def press_space():
        if fake_time.now > 3.06:
            fake_time.on_nap = lambda: None
            asked.append(fake_time.now)
            pygame.event.post(key_event(pygame.KEYDOWN, pygame.K_SPACE))
            pygame.event.post(key_event(pygame.KEYUP, pygame.K_SPACE))

    monkeypatch.setattr(App, "frame", noted_frame)
    clock = SimpleNamespace(tick=lambda rate: fake_time.sleep(1.0 / rate))
    monkeypatch.setattr(pygame.time, "Clock", lambda: clock)
    fake_time.on_nap = press_space
    profile = Profile()
    run_app(Display(1.0), StartRequest(small_level()), profile, 20.0, {})
    slow = [each for each in times if each > 1.5 / FRAME_RATE]
    assert slow == pytest.approx([1.0 / IDLE_RATE] * len(slow)) and 17 <= len(slow) <= 20
    assert fake_time.now - asked[0] < 2 * idle._NAP
    assert times[-1] <= 1.0 / FRAME_RATE + 1e-9 and ticks[-1] <= 1
    assert profile.frames == len(times)


def test_a_frame_that_was_late_on_purpose_is_no_stop():
    profile = Profile()
    profile.shown()
    profile.rested()
    profile.shown()
    assert profile.longest_stop == (0.0, 0.0)
    profile.shown()
    assert profile.longest_stop > (0.0, 0.0)
