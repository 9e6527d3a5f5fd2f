"""Going back and forth in the time of a run, by keys and on the bar under it, and what becomes of what followed."""

import pygame
import pytest

from sandbox.app.base.loop import BACKWARD_SPEEDS, TickClock
from sandbox.physics.snapshot import state_hash
from sandbox.session.commands import Grab, Pin, SetGravity
from sandbox.session.compare.comparison import verify
from sandbox.session.replay.reader import read_replay
from tests.app.conftest import small_level

SHIFT, CTRL = pygame.KMOD_SHIFT, pygame.KMOD_CTRL


@pytest.fixture
def timeline(driver):
    """A run of 90 ticks with a pin at tick 30, with its bar."""
    driver.key(pygame.K_y)
    while driver.playback.session.tick < 30:
        driver.pass_unseen()
    driver.playback.submit(Pin(1))
    while driver.playback.session.tick < 90:
        driver.pass_unseen()
    driver.playback.clock.paused = True
    driver.frames()
    return driver


def track(driver):
    return driver.app.play.time.track


def on_track(driver, tick):
    return track(driver).pixel_of(tick), track(driver).rect.centery


def test_a_clock_counts_back_as_far_as_forth():
    clock = TickClock()
    forth = sum(clock.ticks(1 / 60, 60) for _ in range(60))
    clock.next_speed(BACKWARD_SPEEDS)
    assert sum(clock.ticks(1 / 60, 60) for _ in range(60)) == pytest.approx(-forth, abs=1)
    clock.next_speed(BACKWARD_SPEEDS)
    assert clock.ticks(0.1, 60) == -12


def test_the_knob_is_dragged_back_and_the_same_run_follows(timeline):
    playback = timeline.playback
    end = state_hash(playback.session.world)
    last = playback.session.last_tick
    timeline.press(on_track(timeline, last))
    timeline.move(on_track(timeline, 45))
    timeline.release(on_track(timeline, 45))
    assert abs(playback.session.tick - 45) <= 1 and playback.session.last_tick == last
    assert playback.current.tick == playback.session.tick
    timeline.press(on_track(timeline, last))
    timeline.release(on_track(timeline, last))
    assert state_hash(playback.session.world) == end


def test_a_bookmark_that_a_run_begun_again_has_not_come_to_is_not_on_the_track(timeline):
    timeline.key(pygame.K_b, SHIFT)
    marked = timeline.playback.session.tick
    timeline.key(pygame.K_r)
    timeline.frames(2)
    assert not track(timeline).marks
    timeline.key(pygame.K_PERIOD, SHIFT)
    assert timeline.notices[-1] == "There is no mark after this."
    timeline.key(pygame.K_SPACE)
    while timeline.playback.session.tick <= marked:
        timeline.frames()
    assert [mark.tick for mark in track(timeline).marks] == [marked]


def test_a_press_near_a_mark_goes_to_it_and_keys_go_from_mark_to_mark(timeline):
    session = timeline.playback.session
    x, y = on_track(timeline, 30)
    timeline.press((x + 2, y))
    timeline.release((x + 2, y))
    assert session.tick == 30
    timeline.key(pygame.K_b, SHIFT)
    for _ in range(3):
        timeline.key(pygame.K_PERIOD)
    timeline.key(pygame.K_b, SHIFT)
    assert timeline.playback.travel.bookmarks == [30, 33]
    timeline.key(pygame.K_COMMA, SHIFT)
    assert session.tick == 30
    timeline.key(pygame.K_PERIOD, SHIFT)
    assert session.tick == 33
    timeline.key(pygame.K_PERIOD, SHIFT)
    assert session.tick == 33 and "There is no mark after this." in timeline.notices


def test_one_tick_back_and_playing_backwards_to_the_beginning(timeline):
    playback = timeline.playback
    last = playback.session.tick
    timeline.key(pygame.K_COMMA)
    assert playback.session.tick == last - 1 and playback.clock.paused
    timeline.key(pygame.K_a)
    timeline.key(pygame.K_a)
    timeline.key(pygame.K_a)
    assert playback.clock.speed == -4.0
    before = playback.session.tick
    timeline.frames(3)
    assert playback.session.tick < before - 4
    timeline.frames(60)
    assert playback.session.tick == 0 and playback.clock.paused and playback.clock.speed == 1.0


def test_a_range_is_chosen_with_shift_played_over_and_over_and_shared(timeline):
    playback = timeline.playback
    timeline.app.ui.blur()
    pygame.key.set_mods(SHIFT)
    timeline.press(on_track(timeline, 20))
    timeline.move(on_track(timeline, 40))
    timeline.release(on_track(timeline, 40))
    pygame.key.set_mods(0)
    first, last = playback.travel.span
    assert abs(first - 20) <= 1 and abs(last - 40) <= 1
    assert playback.session.tick >= 90
    timeline.key(pygame.K_l, SHIFT)
    seen = []
    for _ in range(60):
        timeline.frames()
        seen.append(playback.session.tick)
    assert min(seen) >= first and max(seen) <= last + 1 and seen != sorted(seen)
    film = timeline.app.play.film(10.0)
    # What is shared so is not what happened last, and is not called so.
    assert film.seconds == pytest.approx((last - first) / 60) and not film.is_latest


def test_what_is_changed_in_the_past_lets_go_of_what_was_held_and_keeps_what_followed(timeline):
    playback = timeline.playback
    session = playback.session
    playback.submit(Grab(0, 2, (1.0, 1.0)))
    timeline.frames(2)
    playback.clock.paused = False
    timeline.frames(40)
    end, last = state_hash(session.world), session.last_tick
    playback.seek(last - 25)
    assert session.world.is_held(0)
    timeline.key(pygame.K_p)
    timeline.click(timeline.pixel_of("rope.3"))
    assert not session.world.is_held(0)
    timeline.key(pygame.K_y, SHIFT)
    (back,) = [button for button in timeline.app.ui.buttons() if button.text.startswith("From")]
    timeline.click_widget(back)
    playback.clock.paused = True
    assert session.last_tick == last
    playback.seek(last)
    assert state_hash(session.world) == end


def test_while_it_is_recorded_the_run_stays_where_it_is(timeline, documents):
    timeline.key(pygame.K_r, CTRL)
    tick = timeline.playback.session.tick
    timeline.key(pygame.K_COMMA)
    assert timeline.playback.session.tick == tick
    assert "Stop the recording before you go back in time." in timeline.notices


def test_a_replay_hurries_ahead_is_taken_over_there_and_the_new_run_is_saved(timeline, documents, open_app):
    timeline.key(pygame.K_s, CTRL | pygame.KMOD_SHIFT)
    timeline.key(pygame.K_RETURN)
    (path,) = documents.iterdir()
    replay = read_replay(path)
    watching = open_app(replay=replay)
    playback = watching.playback
    assert watching.app.play.time.is_shown and playback.length == replay.ticks
    watching.press(on_track(watching, 60))
    watching.release(on_track(watching, 60))
    while playback.travel.target is not None:
        watching.frames()
    assert abs(playback.session.tick - 60) <= 3
    watching.press(on_track(watching, 45))
    watching.release(on_track(watching, 45))
    watching.key(pygame.K_k)
    playback.submit(Pin(2))
    watching.frames(20)
    assert "took over" in playback.verdict and len(playback.session.branches) == 1
    watching.key(pygame.K_s, CTRL | pygame.KMOD_SHIFT)
    watching.key(pygame.K_RETURN)
    (new,) = [each for each in documents.iterdir() if each != path]
    assert verify(read_replay(new)) is None


def test_a_replay_that_was_watched_to_its_end_can_be_gone_back_in_and_ends_there_again(timeline, documents, open_app):
    timeline.key(pygame.K_s, CTRL | pygame.KMOD_SHIFT)
    timeline.key(pygame.K_RETURN)
    (path,) = documents.iterdir()
    watching = open_app(replay=read_replay(path))
    playback = watching.playback
    playback.seek(playback.length)
    while not playback.verdict:
        watching.frames()
    assert "verified" in " ".join(watching.app.play.states())
    playback.seek(20)
    assert watching.app.play.states()[-1] == "watching"
    playback.clock.paused = False
    watching.frames(playback.length + 30)
    assert playback.session.tick == playback.length and playback.watching
    watching.key(pygame.K_k)
    watching.frames(10)
    assert playback.session.tick > playback.replay.ticks and not playback.watching


@pytest.mark.parametrize("size", [(640, 480), (1280, 720)])
def test_the_bar_lies_under_the_world_whole_and_gives_its_room_back(driver, size):
    driver.app.display.window.size = size
    driver.frames(2)
    before = driver.app.play.viewport
    driver.key(pygame.K_y)
    left, top, width, height = driver.app.play.viewport
    bar = driver.app.play.time
    rects = [track(driver).rect, *(button.rect for button in bar.buttons.values())]
    area = pygame.Rect(left, top + height, width, before[3] - height)
    assert all(area.contains(rect) for rect in rects)
    assert all(rect.collidelist(rects[:index]) < 0 for index, rect in enumerate(rects))
    assert rects[0].width > 100
    driver.key(pygame.K_y)
    assert driver.app.play.viewport == before


def test_runs_that_break_have_marks_where_they_broke(open_app):
    weak = {"stiffness": 0.9, "damping": 0.95, "tension_limit": 1e-6}
    body = {"type": "rope", "id": "rope", "start": [0, 0], "end": [4, 0], "segments": 4, "material": "weak"}
    driver = open_app(small_level(materials={"weak": weak}, bodies=[{**body, "pin": ["start", "end"]}], settings={}))
    driver.frames(20)
    marks = driver.playback.travel.marks()
    assert marks and {mark.kind for mark in marks} == {"break"}
    assert all("rope" in mark.label and mark.label.endswith("broke") for mark in marks)
    driver.key(pygame.K_COMMA, SHIFT)
    assert driver.playback.session.tick == marks[-1].tick


def test_what_broke_breaks_again_where_a_run_is_wound_back_and_played_on(open_app):
    weak = {"stiffness": 0.9, "damping": 0.95, "tension_limit": 1e-6}
    body = {"type": "rope", "id": "rope", "start": [0, 0], "end": [4, 0], "segments": 4, "material": "weak"}
    driver = open_app(small_level(materials={"weak": weak}, bodies=[{**body, "pin": ["start", "end"]}], settings={}))
    driver.frames(20)
    playback, told = driver.playback, driver.playback.breaks.text
    assert told
    playback.seek(0)
    playback.clock.paused = False
    driver.frames(10)
    assert 0 < playback.session.tick <= playback.session.last_tick
    assert playback.breaks.text == told


def test_what_is_saved_in_the_past_leaves_the_run_and_what_follows_as_they_are(timeline, documents):
    playback = timeline.playback
    end, last = state_hash(playback.session.world), playback.session.last_tick
    playback.seek(45)
    timeline.key(pygame.K_s, CTRL | pygame.KMOD_SHIFT)
    timeline.key(pygame.K_RETURN)
    (path,) = documents.iterdir()
    saved = read_replay(path)
    assert saved.ticks == 45 and verify(saved) is None
    assert playback.session.last_tick == last and not playback.session.branches
    playback.seek(last)
    assert state_hash(playback.session.world) == end


def test_a_recording_begun_in_a_replays_past_ends_the_watching_of_it(timeline, documents, open_app):
    timeline.key(pygame.K_s, CTRL | pygame.KMOD_SHIFT)
    timeline.key(pygame.K_RETURN)
    (path,) = documents.iterdir()
    watching = open_app(replay=read_replay(path))
    watching.frames(60)
    watching.playback.seek(20)
    watching.key(pygame.K_r, CTRL)
    assert not watching.playback.watching and len(watching.playback.session.branches) == 1


@pytest.mark.parametrize("before", [0, 20])
def test_a_replay_is_taken_over_in_the_middle_of_a_drag_and_the_hand_is_free(driver, documents, open_app, before):
    driver.press(driver.pixel_of("rope.4"))
    driver.move(driver.stage.camera.to_pixels((4.0, 1.0)))
    driver.frames(60)
    driver.key(pygame.K_s, CTRL | pygame.KMOD_SHIFT)
    driver.key(pygame.K_RETURN)
    (path,) = documents.iterdir()
    watching = open_app(replay=read_replay(path))
    watching.frames(40)
    playback = watching.playback
    assert playback.watching and playback.session.world.any_held()
    playback.seek(playback.session.tick - before)
    watching.press(watching.pixel_of("pair.1"))
    watching.move(watching.stage.camera.to_pixels((2.0, 2.5)))
    watching.frames(2)
    assert "took over" in playback.verdict and not any("holds" in text for text in watching.notices)
    assert list(watching.stage.drag.holds) == [0] and len(playback.session.going()) == 1


def test_commands_and_goals_have_marks_in_words(open_app):
    rules = [{"id": "late", "when": {"time": 0.2}, "then": [{"win": "Done"}]}]
    driver = open_app(small_level(rules=rules, settings={}))
    driver.playback.submit(SetGravity((0.0, -3.0)))
    driver.frames(30)
    assert [(mark.kind, mark.label) for mark in driver.playback.travel.marks()] == [
        ("command", "gravity was set"),
        ("goal", "won: Done"),
    ]
    driver.playback.seek(3)
    assert driver.playback.travel.marks()[-1].kind == "goal"
