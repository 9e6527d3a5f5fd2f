"""A level that can be won, in play: goal, score, the card at the end, checkpoints, the best run and its ghost."""

import json

import numpy as np
import pygame
import pytest

from sandbox.app.play.game import NOT_ENDED
from sandbox.app.play.score import Chip, chips_of, time_text
from sandbox.editor.storage.best_runs import best_recording, best_result
from sandbox.editor.storage.preferences import remember
from sandbox.level.reading.files import parse_level
from sandbox.session.commands import SetCoefficients, SetGravity
from sandbox.session.compare.comparison import verify
from sandbox.session.outcome import outcome
from sandbox.session.replay.reader import read_replay
from sandbox.session.session import Session
from tests.app.conftest import small_level

GOAL = "Let the ball fall into the basket"
# The ball falls 1.9 m: through the ring, and is in the basket after 0.6 s.
FALLING = {
    "goal": GOAL,
    "settings": {"solver": "direct"},
    "contacts": {},
    "bodies": [],
    "particles": [{"id": "ball", "position": [0, 3], "radius": 0.1, "mass": 1}],
    "terrain": [{"id": "floor", "polyline": [[-3, 0], [3, 0]]}],
    "zones": [{"id": "basket", "box": [-1, 0, 1, 1.2]}, {"id": "ring", "circle": [0, 2, 0.2]}],
    "counters": [{"id": "rings", "text": "Rings"}, {"id": "hidden"}],
}
IN_BASKET = {"metric": "inside", "particle": "ball", "zone": "basket"}
WIN = {"id": "goal", "when": IN_BASKET, "then": [{"win": "It is in!", "stars": {"second": 2, "third": 0.3}}]}
RING = {
    "id": "ring",
    "when": {"crosses": "ring", "particle": "ball"},
    "then": [{"count": "rings"}, {"say": "Through the ring!"}, {"sound": "bell"}, {"checkpoint": True}],
}
LATE = {"id": "late", "when": {"time": 0.9}, "then": [{"fail": "Too late"}]}
ROPE = {"type": "rope", "id": "rope", "start": [2, 2], "end": [2.5, 2], "segments": 2, "pin": ["start"],
        "material": "steel"}  # fmt: skip
SHIFT = pygame.KMOD_SHIFT
# In so many frames each of these runs has ended.
MOST_FRAMES = 180


def level(*rules, **changes):
    return small_level(**{**FALLING, "rules": list(rules), **changes})


@pytest.fixture
def falling(open_app):
    """A run that wins by itself within a second."""
    return open_app(level(RING, WIN))


@pytest.fixture
def losing(open_app):
    """A run that passes a checkpoint by itself, and is lost after 0.9 s."""
    return open_app(level(RING, LATE))


def game(driver):
    return driver.app.play.game


def play_to_the_end(driver):
    for _ in range(MOST_FRAMES):
        if game(driver).card is not None:
            break
        driver.pass_unseen()
    driver.frames(2)
    assert game(driver).card is not None


def heard(driver, monkeypatch):
    """The signals that the app is asked for, as they come."""
    kinds = []
    monkeypatch.setattr(driver.app.sounds, "signal", lambda kind, *_: kinds.append(kind))
    return kinds


def chips(driver):
    return chips_of(driver.playback.level, driver.playback.current, game(driver).result)


def test_a_win_pauses_where_it_happens_and_its_card_says_words_stars_and_time(falling, monkeypatch):
    kinds = heard(falling, monkeypatch)
    play_to_the_end(falling)
    result, card = outcome(falling.playback.level, falling.world), game(falling).card
    assert falling.playback.clock.paused and falling.playback.session.tick == result.tick
    assert card.ending.words == "It is in!" and result.stars == 2
    assert card.ending.times[0][0] == f"Time {time_text(result.tick / 60)}"
    assert list(card.buttons) == ["Again", "Send this", "Race your best", "Keep watching"]
    assert [words for words, _ in card.ending.lines[1]] == ["Rings 1"]
    assert card.ending.next_star == "3 stars: at most 0.3 s"
    assert kinds == ["bell", "won", "star", "star"]
    assert "Through the ring!" in falling.notices
    assert "won" in falling.app.play.states()


@pytest.mark.parametrize("size", [(1400, 900), (800, 600), (640, 440)])
def test_the_card_stands_beside_what_happened(falling, size):
    falling.app.display.window.size = size
    play_to_the_end(falling)
    card, stage = game(falling).card.panel.rect, falling.stage
    assert pygame.Rect(stage.camera.viewport).contains(card)
    assert not card.collidepoint(falling.pixel_of("ball"))
    places = [button.rect for button in game(falling).card.buttons.values()]
    assert all(card.contains(place) and place.collidelist(places[:k]) < 0 for k, place in enumerate(places))


def test_the_card_is_had_again_by_a_click_on_the_stars_or_a_key_after_it_was_closed(falling):
    falling.key(pygame.K_e, SHIFT)
    assert game(falling).card is None and NOT_ENDED in falling.notices
    play_to_the_end(falling)
    ending = game(falling).card.ending
    falling.click_widget(game(falling).card.buttons["Keep watching"])
    falling.frames(10)
    assert game(falling).card is None and not falling.playback.clock.paused
    falling.click(game(falling).score.end.center)
    assert game(falling).card.ending == ending and falling.playback.clock.paused
    falling.key(pygame.K_ESCAPE)
    falling.key(pygame.K_e, SHIFT)
    assert game(falling).card.ending == ending


def tuned(driver):
    """Cs of the material of a run's first spring."""
    return float(driver.world.stiffness[0])


def test_again_keeps_what_was_tuned_and_as_it_was_does_not(open_app):
    driver = open_app(level(WIN, bodies=[ROPE], materials={"steel": {"stiffness": 0.3, "damping": 0.3}}))
    own = tuned(driver)
    driver.playback.submit(SetCoefficients(stiffness=0.6, material=1))
    driver.playback.submit(SetCoefficients(stiffness=0.07, material=1))
    driver.playback.submit(SetGravity((1.0, -9.0)))
    play_to_the_end(driver)
    assert "As it was" in game(driver).card.buttons
    driver.click_widget(game(driver).card.buttons["Again"])
    assert tuned(driver) == 0.07 and driver.world.settings.gravity == (1.0, -9.0)
    assert driver.playback.session.tick < 10 and driver.playback.scene() is None
    for key in (pygame.K_r, pygame.K_r):
        driver.key(key, SHIFT)
    assert tuned(driver) == 0.07
    play_to_the_end(driver)
    driver.key(pygame.K_r, pygame.KMOD_CTRL | SHIFT)
    assert tuned(driver) == own and driver.world.settings.gravity != (1.0, -9.0)
    play_to_the_end(driver)
    assert "As it was" not in game(driver).card.buttons


def test_undo_after_again_brings_the_run_before_back_and_not_what_was_not_tuned(open_app):
    driver = open_app(level(WIN, bodies=[ROPE], materials={"steel": {"stiffness": 0.3, "damping": 0.3}}))
    driver.playback.submit(SetCoefficients(stiffness=0.07, material=1))
    driver.frames(20)
    tick = driver.playback.session.tick
    driver.key(pygame.K_r)
    assert tuned(driver) == 0.07
    driver.key(pygame.K_z, pygame.KMOD_CTRL)
    assert driver.playback.session.tick >= tick and tuned(driver) == 0.07


def test_without_a_goal_again_is_as_the_level_is(driver):
    own = tuned(driver)
    driver.playback.submit(SetCoefficients(stiffness=0.07))
    driver.frames(20)
    driver.key(pygame.K_r)
    assert tuned(driver) == own


def test_a_race_begins_again_with_the_ghost_which_no_other_level_has_then(falling, open_app):
    play_to_the_end(falling)
    while falling.app.best.moves:
        falling.pass_unseen()
    falling.click_widget(game(falling).card.buttons["Race your best"])
    falling.frames(2)
    assert game(falling).shows_ghost and falling.playback.session.tick < 10
    assert not game(open_app(level(RING, WIN))).shows_ghost


def test_a_fast_run_pauses_at_the_very_tick_too(falling):
    falling.playback.clock.speed = 8.0
    play_to_the_end(falling)
    assert falling.playback.session.tick == game(falling).result.tick


def test_a_lost_run_says_so_and_offers_the_checkpoint_and_the_beginning(losing, monkeypatch):
    kinds = heard(losing, monkeypatch)
    play_to_the_end(losing)
    assert game(losing).card.ending.words == "Too late" and not game(losing).result.is_won
    assert list(game(losing).card.buttons) == ["Checkpoint", "Beginning", "Keep watching"]
    assert kinds == ["bell", "lost"]


def test_chips_show_clock_counters_with_a_text_and_result_of_the_state_that_is_seen(falling):
    assert [chip.name for chip in chips(falling) if chip.name] == ["Rings"]
    start = chips(falling)
    play_to_the_end(falling)
    end = chips(falling)
    assert Chip(name="Rings", value="1") in end and Chip(name="Rings", value="0") in start
    assert end[-1].stars == 2 and all(chip.stars is None for chip in start)
    falling.playback.seek(1)
    falling.frames(2)
    assert chips(falling)[-1] == start[-1]


def test_scrubbing_before_a_win_and_undoing_what_won_take_the_card_away(open_app):
    driver = open_app(level(WIN, settings={"solver": "direct", "gravity": [0, 0]}))
    driver.playback.submit(SetGravity((0.0, -9.81)))
    play_to_the_end(driver)
    won_at = driver.playback.session.tick
    driver.playback.seek(won_at - 5)
    driver.frames(2)
    assert game(driver).card is None and game(driver).result is None
    driver.playback.seek(won_at)
    driver.frames(2)
    assert game(driver).result is not None and game(driver).card is None
    driver.app.act("undo")
    driver.frames(2)
    assert game(driver).result is None and chips(driver)[-1].stars is None
    driver.app.act("redo")
    driver.frames(2)
    assert game(driver).result.tick == won_at


def test_undo_with_the_card_open_closes_it(open_app):
    driver = open_app(level(WIN, settings={"solver": "direct", "gravity": [0, 0]}))
    driver.playback.submit(SetGravity((0.0, -9.81)))
    play_to_the_end(driver)
    driver.key(pygame.K_z, pygame.KMOD_CTRL)
    driver.frames(2)
    assert game(driver).card is None and game(driver).result is None
    assert not driver.playback.clock.paused


def test_who_scrubs_back_from_a_win_stays_there_and_a_restart_from_there_runs(falling):
    play_to_the_end(falling)
    falling.playback.seek(10)
    falling.frames(5)
    assert game(falling).card is None and falling.playback.clock.paused and falling.playback.session.tick == 10
    falling.key(pygame.K_r, pygame.KMOD_SHIFT)
    assert not falling.playback.clock.paused


@pytest.mark.parametrize("key", [pygame.K_ESCAPE, pygame.K_SPACE])
def test_escape_and_space_let_the_run_go_on_without_the_card(falling, key):
    play_to_the_end(falling)
    tick = falling.playback.session.tick
    falling.key(key)
    falling.frames(5)
    assert game(falling).card is None and not falling.playback.clock.paused
    assert falling.playback.session.tick > tick and game(falling).result is not None


def test_enter_presses_the_main_button_and_again_begins_anew_and_runs(falling):
    play_to_the_end(falling)
    falling.key(pygame.K_RETURN)
    assert game(falling).card is None and not falling.playback.clock.paused
    assert falling.playback.session.tick < 10
    play_to_the_end(falling)
    falling.click_widget(game(falling).card.buttons["Again"])
    assert falling.playback.session.tick < 10


def test_the_card_outlives_a_new_layout_with_all_its_stars(falling):
    play_to_the_end(falling)
    falling.frames(120)
    since = game(falling).card.since
    falling.app.rebuild()
    falling.frames(2)
    card = game(falling).card
    assert card.since >= since > 1.0 and card.face.visible and not card.moves


def test_stars_come_one_after_another_or_at_once_where_less_motion_is_wanted(falling):
    play_to_the_end(falling)
    assert game(falling).card.moves
    falling.app.chosen.choose("motion", "less")
    falling.frames(2)
    assert not game(falling).card.moves


def test_a_restart_goes_back_to_the_checkpoint_cuts_what_followed_and_a_second_one_goes_to_the_beginning(losing):
    play_to_the_end(losing)
    checkpoint = int(losing.world.rule_last[0])
    losing.key(pygame.K_r)
    session = losing.playback.session
    assert checkpoint <= session.tick < checkpoint + 10 and session.last_tick == session.tick
    assert not losing.playback.clock.paused and game(losing).card is None and game(losing).result is None
    losing.key(pygame.K_r)
    assert losing.playback.session.tick < 10


def test_from_a_checkpoint_the_run_is_lost_again_at_the_same_tick_and_its_recording_is_exact(losing, tmp_path):
    play_to_the_end(losing)
    first = losing.playback.session.tick
    losing.click_widget(game(losing).card.buttons["Checkpoint"])
    play_to_the_end(losing)
    assert losing.playback.session.tick == first
    losing.playback.save_to(tmp_path / "again.replay.jsonl")
    assert verify(read_replay(tmp_path / "again.replay.jsonl")) is None


def test_restart_with_shift_passes_checkpoints_over_and_without_one_r_is_as_ever(losing):
    losing.frames(45)
    assert losing.world.rule_last[0] > 0
    losing.key(pygame.K_r, pygame.KMOD_SHIFT)
    assert losing.playback.session.tick < 10
    losing.frames(3)
    losing.key(pygame.K_r)
    assert losing.playback.session.tick < 10


def test_the_goal_is_shown_at_the_start_and_again_while_the_run_is_paused(falling):
    def shows():
        surface = falling.app.display.surface
        falling.app._draw()
        room = pygame.Rect(falling.stage.camera.viewport)
        strip = pygame.Rect(room.left, room.top + 46, room.width, 30)
        return pygame.surfarray.array3d(surface.subsurface(strip)).astype(int)

    falling.playback.clock.paused = True
    falling.frames(2)
    shown = shows()
    game(falling)._goal_left = 0.0
    faded = shows()
    assert np.abs(shown - faded).max() > 60
    falling.frames(2)
    assert np.array_equal(shows(), shown)


def test_a_level_without_rules_shows_nothing_of_all_this(driver):
    assert chips(driver) == [] and game(driver).result is None and game(driver).height == 0.0
    assert "ghost" not in driver.app.play.toolbar.buttons and "ghost" not in driver.app.play.toolbar.left_out
    assert "zones" not in driver.panel.world.views.buttons
    driver.key(pygame.K_F10)
    assert driver.stage.renderer.overlays.shown == set() and "This level has no zones." in driver.notices
    assert driver.app.play._keys.shown() == []


def test_a_best_run_is_kept_with_a_recording_that_holds_and_only_a_better_one_takes_its_place(falling):
    play_to_the_end(falling)
    falling.frames(30)
    kept, path = best_result(falling.playback.level), best_recording(falling.playback.level)
    assert kept.stars == 2 and kept.ticks == game(falling).result.tick
    replay = read_replay(path)
    assert replay.ticks == kept.ticks and verify(replay) is None
    written = path.read_bytes()
    falling.key(pygame.K_r)
    play_to_the_end(falling)
    assert game(falling).card.ending.times[1][0] == f"Best {time_text(kept.seconds)}"
    falling.frames(30)
    assert path.read_bytes() == written
    falling.key(pygame.K_r)
    falling.playback.submit(SetGravity((0.0, -25.0)))
    play_to_the_end(falling)
    falling.frames(30)
    assert best_result(falling.playback.level).ticks < kept.ticks
    assert "Best so far" in [text for text, _ in game(falling).card.ending.times]
    assert path.read_bytes() != written


def test_what_is_recorded_as_the_app_closes_is_whole(falling):
    play_to_the_end(falling)
    falling.app.best.close()
    assert verify(read_replay(best_recording(falling.playback.level))) is None


def test_the_ghost_is_where_the_best_run_was_at_the_same_tick(falling):
    play_to_the_end(falling)
    falling.frames(30)
    assert "ghost" in falling.app.play.toolbar.buttons or "ghost" in falling.app.play.toolbar.left_out
    falling.key(pygame.K_r)
    falling.app.act("ghost")
    falling.playback.submit(SetGravity((0.0, 0.0)))
    falling.frames(20)
    twin = Session(falling.playback.level)
    while twin.tick < falling.playback.session.tick:
        twin.advance()
    there = falling.stage.earlier
    assert there.tick == falling.playback.session.tick
    assert np.array_equal(there.position, twin.world.position)
    assert not np.array_equal(there.position, falling.world.position)
    falling.playback.seek(5)
    falling.frames(2)
    assert falling.stage.earlier.tick == falling.playback.session.tick
    falling.app.act("ghost")
    falling.frames(2)
    assert falling.stage.earlier is None


def test_the_ghost_is_drawn_behind_the_things(falling):
    play_to_the_end(falling)
    falling.frames(30)
    falling.key(pygame.K_r)
    falling.playback.submit(SetGravity((0.0, 9.81)))
    falling.app.act("ghost")
    falling.frames(25)
    at = falling.stage.camera.to_pixels(tuple(falling.stage.earlier.position[0].tolist()))
    place = tuple(map(round, at))
    with_ghost = falling.app.display.surface.get_at(place)
    falling.playback.clock.paused = True
    falling.app.act("ghost")
    falling.frames(2)
    without = falling.app.display.surface.get_at(place)
    assert with_ghost.g - without.g > 15


def test_a_level_that_is_edited_keeps_no_best_run(open_app):
    driver = open_app(level(WIN), edit=True)
    driver.app.act("play")
    driver.frames(2)
    play_to_the_end(driver)
    assert list(game(driver).card.buttons) == ["Again", "Keep as solution", "Keep watching"]
    assert best_result(driver.playback.level) is None


def test_a_recording_that_is_watched_runs_on_past_its_win_without_a_card(open_app, tmp_path):
    session = Session(level(WIN))
    session.record_to(tmp_path / "win.replay.jsonl")
    for _ in range(90):
        session.advance()
    session.stop_recording()
    driver = open_app(replay=read_replay(tmp_path / "win.replay.jsonl"))
    driver.frames(75)
    assert driver.playback.session.tick > 60 and game(driver).result.is_won
    assert game(driver).card is None and not driver.playback.clock.paused


def test_next_level_is_the_next_file_of_the_folder_that_has_rules(open_app, tmp_path):
    data = {"format": "spring-sandbox/level", "version": 3, "view": [-3, -3, 7, 4], **FALLING, "rules": [WIN]}
    for name in ("01", "03", "04"):
        (tmp_path / f"{name}.json").write_text(json.dumps({**data, "name": name}))
    (tmp_path / "02.json").write_text(json.dumps({**data, "name": "02", "rules": []}))
    (tmp_path / "02b.json").write_text("no level")
    driver = open_app(level(WIN))
    assert driver.app.files.open_level(tmp_path / "01.json")
    play_to_the_end(driver)
    driver.click_widget(game(driver).card.buttons["Next level"])
    driver.frames(2)
    assert driver.playback.level.name == "03" and driver.app.play.source == tmp_path / "03.json"
    assert driver.app.files.open_level(tmp_path / "04.json")
    play_to_the_end(driver)
    assert "Next level" not in game(driver).card.buttons


def test_cards_of_the_gallery_show_stars_and_time(open_app, tmp_path):
    path = tmp_path / "mine.json"
    data = {"format": "spring-sandbox/level", "version": 3, "name": "Mine", "view": [-3, -3, 7, 4], **FALLING}
    path.write_text(json.dumps({**data, "rules": [WIN]}))
    driver = open_app(None)
    driver.app.files.open_level(path)
    play_to_the_end(driver)
    time = time_text(game(driver).result.tick / 60)
    remember(path)
    driver.app.open_gallery("mine")
    driver.frames(40)
    card = next(card for card in driver.app.gallery.cards if card.name == "Mine")
    assert card.won == (2, time)


def test_a_key_that_a_rule_asks_for_is_held_while_it_is_down_and_shown_as_a_cap(open_app):
    rule = {"id": "k", "when": {"key": "g"}, "then": [{"count": "rings"}]}
    driver = open_app(level(rule))
    assert driver.app.play._keys.shown() == [("g", False)]
    driver.post(pygame.KEYDOWN, key=ord("g"), mod=0, unicode="g")
    driver.frames(3)
    assert driver.world.key_down[0] and driver.app.play._keys.shown() == [("g", True)]
    assert driver.app.gallery is None
    driver.post(pygame.KEYUP, key=ord("g"), mod=0)
    driver.frames(3)
    assert not driver.world.key_down[0] and driver.world.counter[0] == 1.0
    driver.key(pygame.K_z, pygame.KMOD_CTRL)
    driver.frames(2)
    assert driver.world.counter[0] == 0.0


def test_zones_are_shown_by_a_key_and_a_button_with_their_names(falling):
    falling.playback.clock.paused = True
    falling.frames(2)
    x, y = map(round, falling.stage.camera.to_pixels((0.0, 1.2)))
    place = pygame.Rect(x - 25, y - 24, 50, 28)

    def seen():
        return pygame.surfarray.array3d(falling.app.display.surface.subsurface(place)).astype(int)

    before = seen()
    falling.key(pygame.K_F10)
    falling.frames(2)
    assert np.abs(seen() - before).max() > 60
    assert falling.panel.world.views.buttons["zones"].is_selected
    falling.key(pygame.K_F10)
    falling.frames(2)
    assert np.array_equal(seen(), before)


def test_two_runs_side_by_side_are_neither_won_nor_lost(falling):
    falling.app.act("compare")
    falling.frames(90)
    assert game(falling).card is None and not falling.playback.clock.paused


@pytest.mark.parametrize(("rules", "says"), [((WIN,), True), ((LATE,), True), ((RING,), False)])
def test_there_is_a_clock_where_time_matters(open_app, rules, says):
    assert any(chip.icon == "clock" for chip in chips(open_app(level(*rules)))) is says


def test_a_clock_counts_down_to_the_time_at_which_the_run_is_lost(losing):
    assert chips(losing)[1].value.startswith("0.8")


def test_times_are_told_to_the_hundredth_that_is_over():
    assert [time_text(value) for value in (0.0, 3.7, 59.999, 60.0, 125.25)] == [
        "0.00 s",
        "3.70 s",
        "59.99 s",
        "1:00.00",
        "2:05.25",
    ]


def test_a_goal_is_a_line_of_the_level():
    text = json.dumps({"format": "spring-sandbox/level", "version": 3, "name": "x", "goal": GOAL})
    assert parse_level(text.encode(), "x").goal == GOAL
