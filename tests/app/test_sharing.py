"""Sharing the last seconds of a run, by the page: what is kept, what is left untouched, what is said."""

import errno
import gc
import json
import os
import re
import stat
import subprocess
import weakref
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace

import imageio_ffmpeg
import numpy as np
import pygame
import pytest
from PIL import Image, ImageSequence

from sandbox.app.base import desktop
from sandbox.app.film.film import film_of_view
from sandbox.app.run.playback import Playback
from sandbox.app.share.export import Excerpt, Export, MovieWriter
from sandbox.app.share.gif import GifWriter
from sandbox.app.share.sharing import Sharing
from sandbox.physics.snapshot import state_hash
from sandbox.session.commands import SetCoefficients
from sandbox.session.compare.comparison import verify
from sandbox.session.replay.reader import read_replay
from sandbox.session.session import Session
from tests.app.conftest import small_level
from tests.page.packed import data_of

FALLING = {"settings": {"solver": "single_pass", "gravity": [0.0, -9.81]}}


@pytest.fixture
def folder(tmp_path, documents, monkeypatch):
    """Where shared files go; the pictures in them are small, and no tool of the system's is there."""
    monkeypatch.setattr("sandbox.app.share.sharing.SIZES", ((160, 90), (320, 180)))
    monkeypatch.setattr("sandbox.app.share.page.SIZE_NAMES", [("160x90", "Small", ""), ("320x180", "Large", "")])
    monkeypatch.setattr("sandbox.app.share.sharing.PREVIEW_SIZE", (32, 18))
    # A slice a frame, so that there is time to do something.
    monkeypatch.setattr("sandbox.app.share.sharing.OPEN_BUDGET", 0.0)
    monkeypatch.setattr(desktop, "_clipboard_tool", lambda: None)
    COPIED.clear()
    monkeypatch.setattr(desktop.pygame.scrap, "put_text", COPIED.append)
    return tmp_path / "pictures" / "Spring Sandbox"


# What was put on the clipboard as text.
COPIED: list[str] = []


@pytest.fixture
def driver(open_app, folder):
    """Half a second of a rope that falls, with the page open."""
    driver = open_app(small_level(**FALLING))
    play_on(driver)
    driver.app.act("share")
    driver.frames()
    return driver


@pytest.fixture
def sharing(folder):
    """Half a second of a rope that falls, ready to be shared, without a window."""
    session, said = Session(small_level(**FALLING)), []
    for _ in range(30):
        session.advance()
    play = SimpleNamespace(film=lambda seconds: film_of_view(session, (160, 90), seconds))
    sharing = Sharing(SimpleNamespace(play=play, ready=True, say=said.append))
    assert sharing.begin()
    return sharing


def work_off(sharing):
    """Let it be written, and the clipboard be filled."""
    while sharing.step == "work" or sharing._copying is not None:
        sharing.update(0.0)


def play_on(driver):
    """Let half a second pass, unseen."""
    for _ in range(6):
        driver.playback.advance(0.08)


def finish(driver):
    """Let it be written, and the clipboard be filled, unseen."""
    work_off(driver.app.sharing)
    driver.frames(2)


def files(folder):
    return sorted(path.name for path in folder.iterdir())


def gif_frames(path):
    with Image.open(path) as gif:
        return gif.size, [
            (np.asarray(one.convert("RGB")).copy(), one.info["duration"]) for one in ImageSequence.Iterator(gif)
        ]


def test_a_gif_has_the_seconds_that_were_played_and_moves_and_its_path_is_on_the_clipboard(driver, folder):
    seconds = driver.app.sharing.film.seconds
    # A machine that is late leaves ticks out.
    assert 0.1 < seconds < 0.7
    driver.choose("Save")
    finish(driver)
    assert files(folder) == ["small.gif"]
    size, frames = gif_frames(folder / "small.gif")
    assert size == (160, 90)
    assert len(frames) == round(20 * seconds)
    assert sum(duration for _, duration in frames) == pytest.approx(1000 * seconds, abs=50)
    assert all((one[0] != other[0]).any() for one, other in pairwise(frames))
    assert [str(folder / "small.gif")] == COPIED
    assert "its path is copied" in driver.app.sharing.note


def test_an_mp4_of_a_part_in_the_other_size_without_the_name(driver, folder):
    driver.choose("MP4")
    driver.choose("Large")
    driver.choose("Hidden")
    slider, film = driver.app.share_page.page.slider, driver.app.sharing.film
    driver.press((slider.pixel_of(0.0), slider.rect.centery - 3))
    driver.release((slider.pixel_of(0.0), slider.rect.centery - 3))
    driver.app.ui.focus_on(slider)
    driver.app.sharing.choose(start=0.2)
    driver.frames(2)
    driver.fill(driver.app.share_page.page.field, "my own toy")
    finish(driver)
    assert files(folder) == ["my own toy.mp4"]
    path = str(folder / "my own toy.mp4")
    assert next(imageio_ffmpeg.read_frames(path))["source_size"] == (320, 180)
    frames, seconds = imageio_ffmpeg.count_frames_and_secs(path)
    assert frames == round(30 * (film.seconds - 0.2)) and seconds == pytest.approx(frames / 30, abs=0.01)
    # A player can begin before it has all of it.
    data = (folder / "my own toy.mp4").read_bytes()
    assert 0 < data.index(b"moov") < data.index(b"mdat")


def test_a_png_is_the_moment_of_the_knob(driver, folder):
    driver.choose("PNG")
    driver.choose("Hidden")
    driver.choose("Save")
    finish(driver)
    driver.choose("Another")
    slider = driver.app.share_page.page.slider
    driver.press((slider.pixel_of(slider.end), slider.rect.centery - 3))
    driver.move((slider.pixel_of(0.1), slider.rect.centery - 3))
    driver.release((slider.pixel_of(0.1), slider.rect.centery - 3))
    assert driver.app.sharing.choices.end == pytest.approx(0.1, abs=0.02)
    driver.choose("Save")
    finish(driver)
    assert files(folder) == ["small-2.png", "small.png"]
    first, second = (pygame.surfarray.array3d(pygame.image.load(folder / name)) for name in files(folder))
    assert (first != second).any()


def test_cancel_leaves_no_file_and_says_so(driver, folder):
    for kind in ("GIF", "MP4"):
        driver.choose(kind)
        driver.choose("Save")
        assert len(files(folder)) == 1 and files(folder)[0].startswith(".")
        driver.choose("Cancel")
        assert files(folder) == []
        assert driver.app.sharing.note == "Cancelled: no file was kept."


def test_the_work_goes_on_beside_the_run_once_the_page_is_left(driver, folder):
    driver.choose("Save")
    before = driver.playback.session.tick
    driver.choose("Play on")
    driver.frames(2)
    finish(driver)
    assert files(folder) == ["small.gif"]
    assert driver.playback.session.tick > before
    assert any(text.startswith("Saved as small.gif") for text in driver.notices)


def test_closing_the_app_leaves_no_file_that_is_not_whole(sharing, folder):
    sharing.save()
    sharing.update(0.0)
    assert len(files(folder)) == 1
    sharing.close()
    assert files(folder) == []


def _close_while_it_is_written(driver):
    driver.choose("Save")
    driver.app.quit()
    driver.app.quit()
    driver.frames(2)
    assert (
        driver.app.running and [button.text for button in driver.app.ui.buttons()].count("Close without the file") == 1
    )


def test_a_window_that_is_closed_while_a_file_is_written_finishes_it_first_if_asked_to(driver, folder):
    _close_while_it_is_written(driver)
    driver.choose("Finish writing, then close")
    assert driver.app.running
    finish(driver)
    assert files(folder) == ["small.gif"] and not driver.app.running


def test_a_window_that_is_closed_while_a_file_is_written_drops_it_if_asked_to(driver, folder):
    _close_while_it_is_written(driver)
    driver.choose("Close without the file")
    assert not driver.app.running
    driver.app.sharing.close()
    assert files(folder) == []


def test_a_window_that_is_closed_while_a_file_is_written_stays_if_asked_to(driver, folder):
    _close_while_it_is_written(driver)
    driver.choose("Finish writing, then close")
    # Closed once more, and thought better of.
    driver.app.quit()
    driver.frames(2)
    driver.key(pygame.K_ESCAPE)
    finish(driver)
    assert driver.app.running and files(folder) == ["small.gif"]
    driver.app.quit()
    assert not driver.app.running


def test_a_window_stays_open_where_the_file_cannot_be_finished(driver, folder, monkeypatch):
    _close_while_it_is_written(driver)
    driver.choose("Finish writing, then close")
    (folder / "small.gif").write_bytes(b"another's")
    finish(driver)
    assert driver.app.running and "small.gif cannot be written" in driver.app.sharing.note


def _pair(driver):
    """The two runs of a comparison, B much softer, with the page open again."""
    driver.app.share_page.leave()
    driver.key(pygame.K_F9)
    driver.app.play.other.session.submit(SetCoefficients(0.001, 0.001, None))
    play_on(driver)
    driver.frames(2)
    driver.app.act("share")
    driver.frames()


@pytest.mark.parametrize("kind", ["PNG", "GIF"])
def test_two_runs_side_by_side_are_both_in_the_picture(driver, folder, kind):
    _pair(driver)
    driver.choose(kind)
    driver.choose("Hidden")
    driver.choose("Save")
    finish(driver)
    (name,) = files(folder)
    if kind == "GIF":
        frames = gif_frames(folder / name)[1]
        picture = frames[-1][0].astype(int)
        assert len(frames) == round(20 * driver.app.sharing.film.seconds)
    else:
        picture = pygame.surfarray.array3d(pygame.image.load(folder / name)).swapaxes(0, 1).astype(int)
    assert picture.shape[:2] == (90, 160)
    # Where each run has a caption, and where its rope hangs in the other half.
    one, other = picture[:, :79], picture[:, 81:]
    assert all(np.abs(half - np.median(half, axis=(0, 1))).max() > 60 for half in (one, other))
    assert (np.abs(one[20:] - other[20:]).max(axis=2) > 40).sum() > 20


def test_a_page_of_two_runs_plays_both(driver, folder):
    _pair(driver)
    driver.choose("Page")
    driver.choose("Save")
    finish(driver)
    (path,) = folder.iterdir()
    text = path.read_text(encoding="utf-8")
    data = json.loads(re.search(r'<script type="application/json" id="data">(.*?)</script>', text, re.DOTALL)[1])
    assert [side["name"][0] for side in data["sides"]] == ["A", "B"] and len(data["ticks"]) > 5
    assert data["sides"][0]["frames"] != data["sides"][1]["frames"]


def test_nothing_is_written_over(sharing, folder):
    sharing.save()
    (folder / "small.gif").write_bytes(b"another's")
    work_off(sharing)
    assert "small.gif cannot be written: File exists" in sharing.note
    sharing.save()
    assert "exists already" in sharing.note
    assert (folder / "small.gif").read_bytes() == b"another's" and files(folder) == ["small.gif"]


def test_a_full_disk_is_a_line_and_leaves_nothing(sharing, folder, monkeypatch):
    def refuse(*_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(GifWriter, "add", refuse)
    sharing.save()
    work_off(sharing)
    assert sharing.note == "small.gif cannot be written: No space left on device."
    assert (sharing.step, files(folder)) == ("choose", [])


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="a device that is full is Linux's")
def test_a_film_says_what_the_system_refuses_and_not_what_its_writer_was_about():
    writer, picture = MovieWriter(Path("/dev/full"), (16, 16), 30.0), pygame.Surface((16, 16), 0, 32)
    with pytest.raises(OSError) as refusal:
        writer.add(picture)
        while not writer.is_closed():
            pass
    writer.give_up()
    assert refusal.value.strerror == "No space left on device"


def test_what_is_not_installed_is_named_and_a_picture_can_still_be_kept(sharing, folder, monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    sharing.save()
    assert sharing.note == 'GIF needs Pillow: pip install "spring-sandbox[export]"'
    sharing.choose(kind="png")
    sharing.save()
    work_off(sharing)
    assert files(folder) == ["small.png"]


def test_before_anything_has_moved_there_is_a_picture(open_app, folder):
    driver = open_app(small_level(**FALLING))
    driver.app.start(driver.playback.reset())
    driver.app.act("share")
    assert not driver.app.share_page.page.kinds.buttons["gif"].is_enabled
    driver.choose("Save")
    finish(driver)
    assert files(folder) == ["small.png"]


def test_a_film_shows_the_overlays_of_the_run_stability_among_them(driver):
    def picture():
        (one,) = driver.app.play.film(1.0).samples(0.0, 0.0, (160, 90))[:1]
        return pygame.surfarray.array3d(one)

    plain = picture()
    driver.app.act("stability")
    assert (picture() != plain).any()


def test_in_a_narrow_window_the_seconds_that_are_taken_end_before_the_button_beside_them(driver, folder):
    driver.key(pygame.K_ESCAPE)
    driver.app.display.window.size = (480, 360)
    for _ in range(90):
        driver.playback.advance(0.08)
    driver.app.act("share")
    driver.frames()
    caption = driver.app.share_page.page.caption
    lively = next(each for each in driver.app.ui.buttons() if each.text == "Liveliest 5 s")
    assert caption.text.endswith(", to the last moment")
    assert caption.rect.width > 0 and caption.rect.right <= lively.rect.left


def test_the_page_shows_the_film_and_outlives_a_new_size_of_the_window(driver, folder):
    while driver.app.sharing._filming is not None:
        driver.app.sharing.update(0.0)
    film = driver.app.sharing.film
    assert len(driver.app.sharing.pictures) == round(15 * film.seconds)
    driver.app.display.window.size = (640, 440)
    driver.frames(3)
    page = driver.app.share_page.page
    assert page.preview.picture is not None
    everything = [*driver.app.ui.buttons(), page.preview, page.slider, page.field, page.note]
    assert all(driver.app.display.surface.get_rect().contains(widget.rect) for widget in everything)
    driver.key(pygame.K_ESCAPE)
    driver.key(pygame.K_ESCAPE)
    assert not driver.app.sharing.is_open and not driver.app.sharing.pictures


def test_a_page_that_was_closed_holds_on_to_no_run(driver, folder):
    driver.key(pygame.K_ESCAPE)
    driver.frames()
    left = weakref.ref(driver.playback.session)
    driver.app.start(Playback(small_level()))
    driver.frames()
    gc.collect()
    assert left() is None


def test_a_run_has_the_same_bits_whether_it_is_shared_or_not_and_its_recording_verifies(open_app, folder, documents):
    driver = open_app(small_level(**FALLING))
    driver.key(pygame.K_r, pygame.KMOD_CTRL)
    driver.press(driver.pixel_of("rope.4"))
    driver.move((600, 300))
    driver.release((600, 300))
    play_on(driver)
    driver.key(pygame.K_F12)
    driver.choose("Save")
    driver.choose("Play on")
    play_on(driver)
    finish(driver)
    play_on(driver)
    path = driver.playback.stop_recording()
    replay = read_replay(path)
    assert verify(replay) is None
    plain = Session(replay.level, replay.script)
    while plain.tick < replay.ticks:
        plain.advance()
    assert state_hash(plain.world) == state_hash(driver.world)
    # A recording that is watched can be shared too, and goes on to its end.
    watching = open_app(replay=replay)
    play_on(watching)
    watching.app.act("share")
    watching.choose("Save")
    finish(watching)
    watching.choose("Close")
    while not watching.playback.verdict:
        play_on(watching)
    assert "every tick equal" in watching.playback.verdict
    assert len(files(folder)) == 2


@pytest.mark.skipif(os.name != "posix", reason="the tool of the test is a shell script")
def test_the_last_picture_goes_to_the_clipboard_where_a_tool_takes_it(sharing, folder, tmp_path, monkeypatch):
    tool, taken = tmp_path / "tool", tmp_path / "taken.png"
    tool.write_text(f'#!/bin/sh\ncat > "{taken}"\n')
    tool.chmod(tool.stat().st_mode | stat.S_IEXEC)
    monkeypatch.setattr(desktop, "_clipboard_tool", lambda: ([str(tool)], True))
    sharing.save()
    work_off(sharing)
    assert sharing.note.endswith("Its last picture is on the clipboard.")
    with Image.open(taken) as picture:
        assert picture.format == "PNG" and picture.size == (160, 90)


def test_the_path_is_copied_and_file_and_folder_are_opened_on_request(sharing, folder, monkeypatch):
    opened = []
    monkeypatch.setattr("sandbox.app.share.sharing.open_path", lambda path: opened.append(path) or True)
    sharing.choose(kind="png")
    sharing.save()
    work_off(sharing)
    COPIED.clear()
    sharing.open_it()
    sharing.open_folder()
    sharing.copy_path()
    assert (opened, COPIED) == ([folder / "small.png", folder], [str(folder / "small.png")])
    assert sharing.note == "The file's path is on the clipboard."


def test_a_page_plays_the_part_that_was_chosen_and_its_last_picture_is_left_for_the_clipboard(sharing, folder):
    film = sharing.film
    sharing.choose(kind="html", start=0.1, end=0.4)
    sharing.save()
    export = sharing._export
    work_off(sharing)
    (path,) = folder.iterdir()
    text = path.read_text(encoding="utf-8")
    data = data_of(text)
    assert (path.suffix, data["begin"], len(data["recording"]["hashes"])) == (".html", 6, 25)
    assert f"<title>{sharing.level_name}" in text
    assert export.picture.get_size() == sharing.choices.size
    world = next(iter(filter(None, film.states(0.4, 0.4))))
    assert state_hash(world).startswith(data["recording"]["hashes"][-1])


def test_a_page_has_no_size_to_choose(driver):
    page = driver.app.share_page.page
    driver.click_widget(page.kinds.buttons["html"])
    driver.frames()
    assert not any(button.is_enabled for button in page.sizes.buttons.values())
    driver.click_widget(page.kinds.buttons["gif"])
    driver.frames()
    assert all(button.is_enabled for button in page.sizes.buttons.values())


def test_what_lies_further_back_can_be_had_and_the_liveliest_seconds(open_app):
    ball = {"id": "ball", "position": [0, 0], "velocity": [0, 9.0], "radius": 0.2}
    floor = {"id": "floor", "polyline": [[-3, -0.25], [3, -0.25]]}
    settings = {"gravity": [0, -9.81]}
    level = small_level(bodies=[], particles=[ball], terrain=[floor], settings=settings, view=[-3, -1, 3, 5])
    driver = open_app(level)
    # It flies for 1.8 s, then it lies.
    driver.pass_unseen(60 * 14)
    driver.app.act("share")
    driver.frames(2)
    sharing = driver.app.sharing
    assert sharing.film.seconds == pytest.approx(14.0, abs=0.3)
    assert sharing.choices.end - sharing.choices.start == pytest.approx(10.0)
    assert sharing.choices.start == pytest.approx(sharing.film.seconds - 10.0)
    sharing.choose_liveliest()
    driver.frames(40)
    assert sharing.choices.start < 0.5 and sharing.choices.end == pytest.approx(sharing.choices.start + 5.0)
    assert 0 < len(sharing.pictures) <= 75


def streams_of(path):
    """What ffmpeg says of a file's streams."""
    command = [imageio_ffmpeg.get_ffmpeg_exe(), "-hide_banner", "-i", str(path)]
    told = subprocess.run(command, capture_output=True, text=True, check=False).stderr
    return [line.strip() for line in told.splitlines() if "Stream #" in line]


@pytest.mark.parametrize(("gravity", "is_heard"), [(-9.81, True), (0.0, False)])
def test_a_film_has_the_sound_of_what_lands_and_none_where_nothing_is_heard(tmp_path, gravity, is_heard):
    ball = {"id": "ball", "position": [0, 1.5], "radius": 0.2, "mass": 5.0}
    floor = {"id": "floor", "polyline": [[-3, 0], [3, 0]]}
    session = Session(small_level(bodies=[], particles=[ball], terrain=[floor], settings={"gravity": [0, gravity]}))
    for _ in range(90):
        session.advance()
    film = film_of_view(session, (160, 90), 10.0)
    path = tmp_path / "fall.mp4"
    for _ in Export(film, Excerpt("mp4", 0.0, film.seconds, 30.0, (160, 90)), path).slices():
        pass
    audio = [line for line in streams_of(path) if "Audio" in line]
    assert len(audio) == is_heard and all("aac" in line and "stereo" in line for line in audio)
