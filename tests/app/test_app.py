"""The app end to end: what a person does changes the world, and what it cannot do it says."""

import errno
import json
import os
import subprocess
import sys

import numpy as np
import pygame
import pytest

from sandbox.app.base.display import StartRequest, has_display
from sandbox.app.base.shortcuts import action_of, hint, shortcuts
from sandbox.app.contracts.screen import Figures
from sandbox.app.widgets.scroll import BAR_WIDTH
from sandbox.app.window.opening import open_app
from sandbox.editor.storage.preferences import preference
from sandbox.level.reading.files import shipped_levels
from sandbox.session.compare.comparison import verify
from sandbox.session.replay.reader import read_replay
from tests.app.conftest import small_level

DISPLAY_NAMES = ("DISPLAY", "WAYLAND_DISPLAY", "SDL_VIDEODRIVER")
CTRL = pygame.KMOD_CTRL


def test_dragging_a_particle_with_the_mouse_moves_it_in_the_world(driver):
    start = driver.pixel_of("rope.4")
    driver.press(start)
    target = (start[0] - 60, start[1] - 120)
    for share in np.linspace(0, 1, 20):
        driver.move((start[0] - 60 * share, start[1] - 120 * share))
    driver.frames(120)
    wanted = driver.stage.camera.to_world(target)
    held = driver.world.position[driver.world.particle_slot("rope.4")]
    assert np.linalg.norm(held - wanted) < 0.2
    assert driver.world.is_held(0)
    driver.release(target)
    assert not driver.world.is_held(0)


def test_shift_click_keeps_hold_and_escape_lets_go(driver):
    for name in ("rope.2", "rope.4"):
        pygame.key.set_mods(pygame.KMOD_SHIFT)
        driver.click(driver.pixel_of(name))
    pygame.key.set_mods(0)
    assert driver.world.is_held(0) and driver.world.is_held(1)
    driver.key(pygame.K_ESCAPE)
    assert not driver.world.is_held(0) and not driver.world.is_held(1)


def test_undo_takes_a_whole_drag_back_and_redo_makes_it_again(driver):
    session = driver.playback.session
    start = driver.pixel_of("rope.4")
    driver.press(start)
    for step in range(10):
        driver.move((start[0], start[1] - 10 * step))
    driver.release((start[0], start[1] - 90))
    moved = driver.world.position.copy()
    assert np.abs(moved[4] - (4.0, 0.0)).max() > 0.1
    driver.app.act("pause")
    driver.key(pygame.K_z, CTRL)
    assert np.allclose(driver.world.position[4], (4.0, 0.0), atol=1e-12)
    assert not session.can_undo and session.can_redo
    driver.key(pygame.K_y, CTRL)
    assert session.can_undo and np.abs(driver.world.position[4] - (4.0, 0.0)).max() > 0.1


def test_the_pin_and_cut_tools_work_by_key_and_click(driver):
    driver.key(pygame.K_p)
    driver.click(driver.pixel_of("rope.4"))
    assert driver.world.inverse_mass[4] == 0.0
    driver.key(pygame.K_c)
    x, y = driver.stage.camera.to_pixels((2.5, 1.0))
    driver.press((x, y))
    driver.move((x, y + 60))
    driver.move((x, y + 180))
    driver.release((x, y + 180))
    assert not driver.world.spring_active[driver.world.spring_slot("rope:2")]
    assert driver.world.spring_active[driver.world.spring_slot("rope:1")]


def test_space_pauses_a_full_stop_steps_and_r_goes_back_to_the_beginning(driver):
    driver.frames(10)
    driver.key(pygame.K_SPACE)
    tick = driver.playback.session.tick
    driver.frames(20)
    assert driver.playback.session.tick == tick and driver.playback.clock.paused
    driver.key(pygame.K_PERIOD)
    assert driver.playback.session.tick == tick + 1
    driver.key(pygame.K_r)
    assert driver.playback.session.tick == 0 and driver.playback.clock.paused


def test_slow_motion_makes_an_eighth_of_the_ticks(driver):
    for _ in range(3):
        driver.key(pygame.K_s)
    start = driver.playback.session.tick
    driver.frames(160)
    assert driver.playback.session.tick - start == pytest.approx(20, abs=1)


def test_the_wheel_zooms_about_the_pointer_and_f_fits_again(driver):
    camera = driver.stage.camera
    pixel = (300.0, 400.0)
    driver.move(pixel)
    before, zoom = camera.to_world(pixel), camera.zoom
    driver.stage.camera.turn_wheel(pixel, 3)
    assert camera.zoom > zoom
    assert camera.to_world(pixel) == pytest.approx(before, abs=1e-9)
    driver.key(pygame.K_f)
    assert camera.zoom == pytest.approx(zoom)


def test_a_middle_drag_pans_and_the_world_stays_as_it_is(driver):
    driver.app.act("pause")
    driver.frames()
    before, position = driver.stage.camera.to_world((400, 400)), driver.world.position.copy()
    driver.press((400, 400), button=2)
    driver.move((450, 380))
    driver.release((450, 380), button=2)
    assert driver.stage.camera.to_world((450, 380)) == pytest.approx(before, abs=1e-9)
    assert (driver.world.position == position).all()


def test_space_and_a_drag_pan_and_do_not_pause(driver):
    before = driver.stage.camera.to_world((400, 400))
    driver.post(pygame.KEYDOWN, key=pygame.K_SPACE, mod=0, unicode=" ", scancode=0)
    driver.press((400, 400))
    driver.move((430, 420))
    driver.release((430, 420))
    driver.post(pygame.KEYUP, key=pygame.K_SPACE, mod=0, unicode=" ", scancode=0)
    driver.frames(2)
    assert driver.stage.camera.to_world((430, 420)) == pytest.approx(before, abs=1e-9)
    assert not driver.playback.clock.paused


def test_the_keyboard_alone_drags_a_particle(driver):
    driver.key(pygame.K_n)
    for _ in range(4):
        driver.key(pygame.K_n)
    driver.key(pygame.K_RETURN)
    assert driver.world.is_held(0)
    for _ in range(10):
        driver.key(pygame.K_UP, pygame.KMOD_SHIFT)
    driver.frames(90)
    driver.key(pygame.K_RETURN)
    assert not driver.world.is_held(0)
    assert driver.world.position[4][1] > 0.5


def test_a_recording_on_a_full_disk_is_refused_in_plain_words_and_leaves_no_file(driver, documents, monkeypatch):
    def full(recorder, world):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr("sandbox.session.replay.recording.Recorder.write_tick", full)
    for key, mods in ((pygame.K_r, CTRL), (pygame.K_s, CTRL | pygame.KMOD_SHIFT)):
        driver.key(key, mods)
        path = documents / "small.replay.jsonl"
        assert driver.notices == [f"The recording cannot be written to {path}: No space left on device."]
        assert driver.playback.session.recording is None and not list(documents.iterdir())


def test_record_drag_slide_and_save_gives_a_replay_that_verifies(driver, documents):
    driver.key(pygame.K_r, CTRL)
    start = driver.pixel_of("rope.3")
    driver.press(start)
    for step in range(10):
        driver.move((start[0], start[1] - 8 * step))
    driver.release((start[0], start[1] - 72))
    driver.fill(driver.panel.form.fields["stiffness"][0], "0.11")
    driver.key(pygame.K_r, CTRL)
    driver.type("my run")
    driver.key(pygame.K_RETURN)
    assert [path.name for path in documents.iterdir()] == ["my run.replay.jsonl"]
    replay = read_replay(documents / "my run.replay.jsonl")
    assert verify(replay) is None
    assert {line.record["type"] for line in replay.script} >= {"grab", "move_grab", "release", "set_coefficients"}
    assert not driver.app.ui.has_sheet


def test_a_recording_holds_what_was_done_before_it_ended_though_no_frame_came_between(driver, documents):
    driver.key(pygame.K_r, CTRL)
    start = driver.pixel_of("rope.3")
    driver.press(start)
    driver.frames(5)
    driver.post(pygame.MOUSEBUTTONUP, pos=tuple(map(round, start)), button=1)
    driver.key(pygame.K_r, CTRL)
    driver.key(pygame.K_RETURN)
    replay = read_replay(next(documents.iterdir()))
    assert {line.record["type"] for line in replay.script} >= {"grab", "release"}
    assert verify(replay) is None


def test_a_replays_name_that_exists_is_refused_and_nothing_is_overwritten(driver, documents):
    documents.mkdir()
    (documents / "taken.replay.jsonl").write_text("mine")
    driver.key(pygame.K_s, CTRL | pygame.KMOD_SHIFT)
    driver.type("taken")
    driver.key(pygame.K_RETURN)
    assert driver.app.ui.has_sheet
    assert (documents / "taken.replay.jsonl").read_text() == "mine"
    driver.key(pygame.K_ESCAPE)
    driver.key(pygame.K_s, CTRL | pygame.KMOD_SHIFT)
    driver.key(pygame.K_ESCAPE)
    assert len(list(documents.iterdir())) == 3


def test_a_saved_run_can_be_discarded_and_escape_keeps_it(driver, documents):
    driver.key(pygame.K_s, CTRL | pygame.KMOD_SHIFT)
    for _ in range(2):
        driver.key(pygame.K_TAB)
    driver.key(pygame.K_RETURN)
    assert not driver.app.ui.has_sheet and list(documents.iterdir()) == []
    driver.key(pygame.K_s, CTRL | pygame.KMOD_SHIFT)
    driver.key(pygame.K_ESCAPE)
    assert [path.name for path in documents.iterdir()] == ["small.replay.jsonl"]


def recording(driver, documents):
    driver.fill(driver.panel.form.fields["damping"][0], "0.2")
    driver.frames(30)
    driver.key(pygame.K_s, CTRL | pygame.KMOD_SHIFT)
    driver.key(pygame.K_RETURN)
    (path,) = documents.iterdir()
    return path


def test_a_replay_is_watched_to_its_end_and_said_to_be_equal(driver, documents):
    path = recording(driver, documents)
    assert driver.app.files.open_path(path)
    ticks = driver.playback.replay.ticks
    driver.frames(ticks + 10)
    assert driver.playback.session.tick == ticks
    assert "verified" in driver.playback.verdict
    assert driver.playback.clock.paused
    assert driver.world.damping[0] == 0.2


def test_touching_a_replay_takes_it_over(driver, documents):
    driver.app.files.open_path(recording(driver, documents))
    driver.frames(3)
    driver.fill(driver.panel.form.fields["stiffness"][0], "0.25")
    driver.frames(100)
    assert "took over" in driver.playback.verdict
    assert driver.world.stiffness[0] == 0.25
    assert driver.playback.session.tick > 60


def test_a_bad_level_and_a_bad_replay_are_shown_as_lines_and_the_run_goes_on(driver, tmp_path):
    bad_level, bad_replay = tmp_path / "bad.json", tmp_path / "bad.jsonl"
    bad_level.write_text('{"format": "spring-sandbox/level", "version": 3, "name": 3}')
    bad_replay.write_text('{"format": "spring-sandbox/replay", "version": 99}\n')
    before = driver.playback
    for path in (bad_level, bad_replay, tmp_path / "missing.json", tmp_path):
        driver.post(pygame.DROPFILE, file=str(path))
        driver.frames(2)
        assert driver.app.ui.has_sheet, path
        driver.key(pygame.K_RETURN)
        assert not driver.app.ui.has_sheet
    assert driver.playback is before


def test_dropping_a_level_file_opens_it(driver, tmp_path):
    path = next(path for path in shipped_levels() if path.stem == "rope")
    driver.post(pygame.DROPFILE, file=str(path))
    driver.frames(2)
    assert driver.playback.level.name == json.loads(path.read_text())["name"]


def test_f1_lists_the_shortcuts_and_escape_closes_the_page(driver):
    driver.key(pygame.K_F1)
    assert driver.app.ui.has_sheet
    tick = driver.playback.session.tick
    driver.frames(5)
    assert driver.playback.session.tick == tick
    driver.key(pygame.K_ESCAPE)
    assert not driver.app.ui.has_sheet


def test_a_drag_that_a_page_interrupts_ends_with_the_button(driver):
    start = driver.pixel_of("rope.4")
    driver.press(start)
    driver.key(pygame.K_F1)
    driver.release(start)
    driver.key(pygame.K_ESCAPE)
    assert not driver.world.is_held(0)
    driver.move((start[0] + 50, start[1]))
    assert not driver.stage.drag.holds


def test_a_key_that_is_held_down_pauses_once_but_steps_on(driver):
    for _ in range(5):
        driver.post(pygame.KEYDOWN, key=pygame.K_k, mod=0, unicode="k", scancode=0)
        driver.frames()
    assert driver.playback.clock.paused
    tick = driver.playback.session.tick
    for _ in range(5):
        driver.post(pygame.KEYDOWN, key=pygame.K_PERIOD, mod=0, unicode=".", scancode=0)
        driver.frames()
    assert driver.playback.session.tick == tick + 5


def test_fit_asked_for_again_shows_particles_that_left_the_view(driver):
    driver.world.position[4] = (200.0, 50.0)
    driver.playback.current = driver.playback.previous = driver.playback.session.snapshot()
    driver.app.act("pause")
    driver.app.act("fit")
    assert driver.stage.contains(driver.stage.camera.to_pixels((200.0, 50.0)))


def test_fit_shows_the_first_view_where_particles_are_farther_than_any_zoom_shows(open_app):
    driver = open_app(small_level(view=None))
    first = driver.stage.camera.centre, driver.stage.camera.zoom
    driver.world.position[4] = (1e12, 0.0)
    driver.playback.current = driver.playback.previous = driver.playback.session.snapshot()
    driver.app.act("pause")
    driver.app.act("fit")
    assert (driver.stage.camera.centre, driver.stage.camera.zoom) == first
    driver.frames()
    assert any("too far away" in notice for notice in driver.notices)


def test_the_description_of_a_level_gives_way_to_that_of_the_next(driver):
    driver.app.files.open_path(next(path for path in shipped_levels() if path.stem == "girder"))
    girder = hint(driver.playback.level.description)
    assert girder in driver.notices
    driver.app.files.open_path(next(path for path in shipped_levels() if path.stem == "mast"))
    assert girder not in driver.notices
    assert hint(driver.playback.level.description) in driver.notices
    driver.key(pygame.K_g)
    assert not driver.notices


def test_the_description_of_a_level_does_not_stay_over_the_editor(driver):
    driver.app.files.open_level(shipped_levels()[0], shipped=True)
    driver.frames(2)
    told = hint(driver.playback.level.description)
    assert told in driver.notices
    driver.app.documents.new()
    driver.frames(2)
    assert driver.app.mode == "edit" and told not in driver.notices


def test_every_action_of_the_shortcut_table_exists_and_every_action_is_in_the_table(driver):
    named = {entry.action for entry in shortcuts("play") if entry.action}
    assert named == set(driver.app.actions)


@pytest.mark.parametrize("mode", ["play", "edit"])
def test_no_two_actions_share_a_key(mode):
    keys = [key for entry in shortcuts(mode) if entry.action for key in entry.keys]
    assert len(keys) == len(set(keys))


def test_keys_with_ctrl_and_shift_are_told_apart():
    assert action_of(pygame.K_z, CTRL) == "undo"
    assert action_of(pygame.K_z, CTRL | pygame.KMOD_SHIFT) == "redo"
    assert action_of(pygame.K_z, 0) == "melt"
    assert action_of(pygame.K_s, 0) == "slow"
    assert action_of(pygame.K_s, pygame.KMOD_META) == "save"
    assert action_of(pygame.K_s, pygame.KMOD_ALT) is None
    assert action_of(pygame.K_EQUALS, pygame.KMOD_SHIFT) == "zoom_in"


def test_the_title_says_level_tick_and_state(driver):
    driver.app.act("pause")
    driver.frames()
    assert driver.app.title() == "Small - Spring Sandbox"
    driver.app.says_states = True
    assert driver.app.title() == f"Small - tick {driver.playback.session.tick} - paused - Spring Sandbox"


def test_the_window_can_be_resized_and_rescaled(driver):
    driver.app.display.window.size = (900, 600)
    driver.frames(2)
    assert driver.stage.camera.viewport[2] < 900
    assert driver.panel.area.view.rect.right + driver.app.ui.px(BAR_WIDTH) == 900
    driver.key(pygame.K_EQUALS, CTRL)
    assert driver.app.ui.scale == pytest.approx(1.125)
    driver.app.act("panel")
    assert driver.panel is None
    assert driver.stage.camera.viewport[2] == 900


@pytest.mark.parametrize("shown", ["gallery", "tour", "properties", "parts"])
def test_a_window_that_holds_next_to_nothing_is_laid_out_smaller_and_cut_off(open_app, shown):
    driver = open_app(small_level() if shown == "properties" else None, edit=shown != "gallery")
    if shown == "parts":
        driver.editor.show_parts()
    if shown == "properties":
        driver.key(pygame.K_a, CTRL)
    window = driver.app.display.window
    window.minimum_size = (1, 1)
    for size, chosen, scale in (((640, 440), 4.0, 440 / 360), ((300, 225), 1.0, 0.625), ((1, 1), 1.0, 0.5)):
        driver.app.scale, window.size = chosen, size
        driver.app.rebuild()
        driver.frames(2)
        assert driver.app.ui.scale == pytest.approx(scale) and min(driver.app.ui.units) >= 359.9
    # One press of the key makes things smaller, however large they were asked for.
    driver.app.scale, window.size = 4.0, (640, 440)
    driver.frames(2)
    driver.key(pygame.K_MINUS, CTRL)
    assert driver.app.ui.scale == pytest.approx(440 / 360 / 1.125)


def test_a_key_makes_widgets_as_large_as_they_are_by_themselves(driver):
    own = driver.app.ui.scale
    for key in (pygame.K_MINUS, pygame.K_MINUS):
        driver.key(key, CTRL)
    assert driver.app.ui.scale < own and preference("scale") is not None
    driver.key(pygame.K_0, CTRL)
    assert driver.app.ui.scale == own and preference("scale") is None


def test_a_window_made_smaller_and_larger_again_shows_what_it_showed(driver):
    size = driver.app.display.size
    driver.stage.camera.turn_wheel((300.0, 300.0), 2)
    camera = driver.stage.camera
    centre, zoom = camera.centre, camera.zoom
    for other in ((900, 600), (900, 700), (700, 500), size):
        driver.app.display.window.size = other
        driver.frames(2)
    assert (camera.centre, camera.zoom) == (centre, pytest.approx(zoom))


def test_a_long_run_played_again_shows_how_far_it_is(driver, monkeypatch):
    now, shown = [0.0], []
    monkeypatch.setattr("sandbox.app.play.status.time.perf_counter", lambda: now[0])
    monkeypatch.setattr("sandbox.app.play.status.draw_work", lambda surface, ui, share, *_: shown.append(share))
    for done in range(0, 1000, 100):
        now[0] += 0.06
        driver.playback.session.progress(done, 1000)
    assert shown == sorted(shown) and 0.3 < shown[0] < shown[-1] <= 1.0


def test_keys_pressed_while_a_run_is_played_again_are_not_typed_into_what_comes_after_it(driver, monkeypatch):
    now, actions = [0.0], driver.app.screen.actions
    monkeypatch.setattr("sandbox.app.play.status.time.perf_counter", lambda: now[0])

    def played_again(key):
        for done in range(0, 1000, 100):
            now[0] += 0.06
            driver.playback.session.progress(done, 1000)
        pygame.event.post(pygame.event.Event(pygame.KEYDOWN, key=key, mod=0, unicode="", scancode=0))

    driver.frames(2)
    before = driver.stage.tool_name
    reset = actions["reset"]
    actions["reset"] = lambda: played_again(pygame.K_c)
    driver.key(pygame.K_r)
    driver.frames(2)
    assert driver.stage.tool_name == before
    actions["reset"] = reset
    driver.key(pygame.K_c)
    assert driver.stage.tool_name == "cut"


def test_there_is_no_display_where_none_is_named_or_none_answers(monkeypatch):
    command = [sys.executable, "-c", "from sandbox.app.base.display import has_display; print(has_display())"]
    for names in ({}, {"DISPLAY": ":4321"}):
        environment = {key: value for key, value in os.environ.items() if key not in DISPLAY_NAMES} | names
        run = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
        assert run.stdout.strip() == ("False" if sys.platform == "linux" else "True")
    assert has_display()


def test_particles_that_are_no_longer_finite_are_left_out_and_counted(driver):
    driver.app.act("pause")
    driver.frames()
    driver.world.position[2] = (np.nan, np.inf)
    driver.playback.current = driver.playback.previous = driver.playback.session.snapshot()
    driver.frames()
    assert driver.stage.renderer.non_finite == 1
    assert any("left the world" in text for text, _ in driver.app.screen.status(Figures()))


def test_the_app_closes_after_the_given_time_and_prints_where_the_time_went(capsys, documents):
    assert open_app(StartRequest, profile=True, seconds=0.2) == 0
    printed = capsys.readouterr().out
    parts = ("events", "ui", "flip", "frames a second", "without a new picture", "words in the window", "first page")
    assert all(part in printed for part in parts)
