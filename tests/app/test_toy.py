"""The desk toy: its window feels how it is moved, sleeps while nothing moves, and remembers its place."""

import math
from types import SimpleNamespace

import pygame
import pytest

from sandbox.app.base.idle import RestTimer
from sandbox.app.settings.chosen import Chosen
from sandbox.app.toy import toy_start
from sandbox.app.toy.toy import DROWSY, FARTHEST, FASTEST, HARDEST, WATCHED, FrameMotion, Toy
from sandbox.app.toy.toy_window import KEPT, MOST_PLACES, SIDE, Desk, ToyWindow
from sandbox.cli import main
from sandbox.editor.storage.preferences import preference, preferences_file, set_preference
from sandbox.session.compare.comparison import verify
from sandbox.session.replay.reader import read_replay
from tests.app.conftest import small_level

FRAME = 1 / 30
BOX = {
    "settings": {"solver": "direct", "drag": 2},
    "contacts": {"friction": 0.6},
    "walls": {"box": [0, 0, 4, 4]},
    "view": [0, 0, 4, 4],
    "bodies": [],
    "particles": [{"id": "ball", "position": [2, 0.3], "radius": 0.3, "mass": 2, "rolling": 0.05}],
}


class Person:
    """A toy on a desktop that shows nothing, driven by frames of a fixed length."""

    def __init__(self, record=None, level=None):
        chosen, level = Chosen(), level or small_level(**BOX)
        self.toy = Toy(ToyWindow(1.0, level=level.name), level, chosen, record)
        self.frames(1)

    @property
    def world(self):
        return self.toy.playback.session.world

    @property
    def tick(self):
        return self.toy.playback.session.tick

    def frames(self, count):
        for _ in range(count):
            self.toy.frame(FRAME)

    def post(self, kind, **data):
        pygame.event.post(pygame.event.Event(kind, **data))

    def move(self, dx, dy, steps=5):
        """Move the window by so many pixels in so many frames."""
        for _ in range(steps):
            x, y = self.toy.window.place
            self.toy.window.move_to((x + dx // steps, y + dy // steps))
            self.frames(1)

    def sleep(self):
        for _ in range(1200):
            if self.toy.asleep:
                return
            self.frames(1)
        raise AssertionError("it does not sleep")


@pytest.fixture
def desk(documents):
    desks = []

    def make(**given):
        desks.append(Person(**given))
        return desks[-1]

    yield make
    for one in desks:
        one.toy.close()


def test_a_frame_follows_its_window_and_comes_to_rest_there():
    motion = FrameMotion()
    motion.see((500, 500), 50.0)
    velocity = way = [0.0, 0.0]
    for tick in range(120):
        if tick < 10:
            motion.see((500 + 8 * tick, 500 - 4 * tick), 50.0)
        x, y = motion.accelerate(60.0)
        assert math.hypot(x, y) <= HARDEST * (1 + 1e-9)
        velocity = [velocity[0] + x / 60, velocity[1] + y / 60]
        way = [way[0] + velocity[0] / 60, way[1] + velocity[1] / 60]
    assert motion.rests
    assert velocity == pytest.approx([0.0, 0.0], abs=1e-9)
    # 72 and 36 pixels, the second upward.
    assert way == pytest.approx([1.44, 0.72], abs=0.01)


def test_a_window_that_leaps_across_the_desktop_carries_its_frame_no_faster_than_things_can_bear():
    motion = FrameMotion()
    motion.see((0, 0), 50.0)
    motion.see((100_000, 0), 50.0)
    assert motion.behind[0] == pytest.approx(FARTHEST)
    fastest = 0.0
    for _ in range(100):
        motion.accelerate(60.0)
        fastest = max(fastest, motion.velocity[0])
    assert motion.rests and 0.0 < fastest <= FASTEST


def test_moving_the_window_shakes_the_world_and_one_move_is_one_gesture(desk):
    one = desk()
    one.frames(30)
    slot = one.world.particle_slot("ball")
    before = one.world.position[slot, 0]
    one.move(120, 0, 2)
    # What is loose stays where it was on the desktop, so in the box it goes to the left.
    assert one.world.velocity[slot, 0] < -1.0
    one.frames(40)
    assert one.world.position[slot, 0] < before - 0.2
    session = one.toy.playback.session
    assert session.can_undo
    one.post(pygame.KEYDOWN, key=pygame.K_z, mod=pygame.KMOD_CTRL, unicode="", scancode=0)
    one.frames(1)
    assert not session.can_undo
    assert one.world.position[slot, 0] == pytest.approx(before, abs=1e-6)


def test_what_was_shaken_is_recorded_and_verifies(desk, tmp_path):
    file = tmp_path / "toy.replay"
    one = desk(record=file)
    one.frames(10)
    one.move(80, -60)
    one.move(-80, 60, 2)
    one.frames(20)
    one.toy.close()
    lines = [line for line in file.read_text().splitlines() if '"shake"' in line]
    assert len(lines) > 10
    assert verify(read_replay(file)) is None


def test_it_sleeps_while_nothing_moves_and_wakes_when_the_pointer_comes(desk, monkeypatch):
    one = desk()
    one.sleep()
    assert one.toy.stage.renderer.asleep
    tick, flips = one.tick, []
    monkeypatch.setattr(one.toy.window, "flip", lambda: flips.append(1))
    one.frames(100)
    assert one.tick == tick and not flips
    one.post(pygame.WINDOWENTER)
    one.frames(3)
    assert not one.toy.asleep and not one.toy.stage.renderer.asleep and len(flips) == 3
    # With the pointer over it, it takes longer to nod off again.
    one.frames(round((DROWSY + 1) / FRAME))
    assert not one.toy.asleep
    one.frames(round((WATCHED + 1) / FRAME))
    assert one.toy.asleep


def test_its_stillness_is_that_of_its_stage_measured_once_a_frame_for_all_of_its_time(desk, monkeypatch):
    one = desk()
    measured, follow = [], RestTimer.follow
    monkeypatch.setattr(RestTimer, "follow", lambda *given: measured.append(given[3]) or follow(*given))
    tick = one.tick
    for seconds in (0.004, 0.05, 0.03):
        one.toy.frame(seconds)
    assert one.tick > tick + 2 and measured == pytest.approx([0.004, 0.05, 0.03])
    one.sleep()
    assert one.toy.stage.rest_timer.lasted >= DROWSY


def test_what_has_slept_has_forgotten_its_history(desk):
    one = desk()
    one.move(60, 0)
    one.sleep()
    assert one.tick > 0 and not one.toy.playback.session.can_undo
    one.move(60, 0)
    assert not one.toy.asleep and one.toy.playback.session.can_undo


def test_a_drag_of_the_empty_box_moves_the_window_and_one_of_a_thing_holds_it(desk):
    one = desk()
    one.frames(5)
    place = one.toy.window.place
    one.post(pygame.MOUSEBUTTONDOWN, button=1, pos=(60, 60))
    one.post(pygame.MOUSEMOTION, pos=(90, 50), rel=(30, -10), buttons=(1, 0, 0))
    one.frames(1)
    one.post(pygame.MOUSEBUTTONUP, button=1, pos=(60, 60))
    one.frames(1)
    assert one.toy.window.place == (place[0] + 30, place[1] - 10)
    assert preference(KEPT)["places"] == {"Small": list(one.toy.window.place)}
    at = one.toy.camera.to_pixels(tuple(one.world.position[one.world.particle_slot("ball")].tolist()))
    at = tuple(map(round, at))
    one.post(pygame.MOUSEBUTTONDOWN, button=1, pos=at)
    one.frames(1)
    assert one.toy.stage.drag.holds
    one.post(pygame.MOUSEBUTTONUP, button=1, pos=at)
    one.frames(2)
    assert not one.toy.stage.drag.holds
    # The right button moves the window wherever it is pressed.
    one.post(pygame.MOUSEBUTTONDOWN, button=3, pos=at)
    one.post(pygame.MOUSEMOTION, pos=(at[0] - 8, at[1]), rel=(-8, 0), buttons=(0, 0, 1))
    one.frames(1)
    assert one.toy.window.place[0] == place[0] + 22


def test_keys_of_the_level_drive_it_in_a_window_of_its_shape(desk):
    wheel = {"type": "wheel", "id": "mill", "position": [4, 1], "radius": 0.5, "thickness": 0.2, "segments": 8,
             "pin": ["hub"], "motor": {"speed": 5, "torque": 50, "key": "d"}}  # fmt: skip
    one = desk(level=small_level(**BOX | {"bodies": [wheel], "particles": [], "view": [0, 0, 8, 2]}))
    one.post(pygame.KEYDOWN, key=pygame.K_d, mod=0, unicode="d", scancode=0)
    one.frames(2)
    assert one.world.actuator_value[0] == 1.0
    one.post(pygame.KEYUP, key=pygame.K_d, mod=0, unicode="d", scancode=0)
    one.frames(2)
    assert one.world.actuator_value[0] == 0.0
    window = ToyWindow(1.0, 4.0)
    width, height = window.size
    window.window.destroy()
    assert width == pytest.approx(2.5 * height, rel=0.01) and width * height == pytest.approx(SIDE * SIDE, rel=0.01)


def test_it_opens_where_that_of_its_level_was_left_and_on_the_desktop_where_that_is_gone(desk):
    one = desk()
    one.toy.window.move_to((37, 41))
    one.toy.close()
    other = desk(level=small_level(**BOX | {"name": "Other"}))
    width, height = pygame.display.get_desktop_sizes()[0]
    assert other.toy.window.place == (width - SIDE - 48, height - SIDE - 48)
    other.toy.close()
    again = desk()
    assert again.toy.window.place == (37, 41)
    again.toy.close()
    for lost in ([99_999, 5], [1], "left", [1.5, 2], None):
        set_preference(KEPT, {"places": {"Small": lost}, "open": lost})
        window = ToyWindow(1.0, level="Small")
        assert 0 <= window.place[0] <= width - SIDE and 0 <= window.place[1] <= height - SIDE
        window.close()
    for number in range(MOST_PLACES + 3):
        sheet = Desk(f"level {number}")
        sheet.keep((number, 0), (10, 10))
        sheet.leave()
    assert len(preference(KEPT)["places"]) == MOST_PLACES and "level 3" in preference(KEPT)["places"]


def test_toys_that_are_open_at_once_stand_side_by_side_and_never_one_on_another(documents):
    windows = [ToyWindow(1.0, level=name) for name in ("one", "two", "two", "three", "four")]
    for window in windows:
        window.keep(sound="on")
    places = [pygame.Rect(window.place, window.size) for window in windows]
    screen = pygame.Rect((0, 0), pygame.display.get_desktop_sizes()[0])
    assert all(screen.contains(place) for place in places)
    assert all(place.collidelist(places[:number]) < 0 for number, place in enumerate(places))
    assert places[1].right < places[0].left and places[1].top == places[0].top
    assert preference(KEPT)["sound"] == "on" and set(preference(KEPT)["places"]) == {"one", "two", "three", "four"}
    # What is closed is in nobody's way, also where the one that has its seat now stands elsewhere.
    windows[0].close()
    anew = ToyWindow(1.0, level="five")
    assert anew.place == places[0].topleft
    for window in (anew, *windows[1:]):
        window.close()


def test_a_broken_file_of_preferences_is_set_aside(desk, documents):
    file = preferences_file()
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text("{")
    one = desk()
    assert len(one.toy.chosen.faults) == 1 and "kept as" in one.toy.chosen.faults[0]


@pytest.mark.parametrize("key", [pygame.K_ESCAPE, "button"])
def test_escape_and_the_button_close_it(desk, key):
    one = desk()
    if key == "button":
        one.post(pygame.MOUSEBUTTONDOWN, button=1, pos=(SIDE - 16, 16))
    else:
        one.post(pygame.KEYDOWN, key=key, mod=0, unicode="", scancode=0)
    one.frames(1)
    assert not one.toy.running


def test_where_no_window_can_stay_on_top_it_says_so_and_arrow_keys_shake_a_plain_one(desk, monkeypatch, capsys):
    monkeypatch.setattr(pygame.display, "get_driver", lambda: "wayland")
    one = desk()
    assert not one.toy.window.floats and not one.toy.window.window.borderless
    assert one.toy.window.refusal.startswith("Wayland does not let windows stay on top")
    one.frames(30)
    one.post(pygame.KEYDOWN, key=pygame.K_RIGHT, mod=0, unicode="", scancode=0)
    one.frames(3)
    assert one.toy.playback.session.can_undo
    one.toy.close()
    assert main(["toy", "rope", "--seconds", "0.01"]) == 0
    assert capsys.readouterr().err.count("plain small window") == 1


def test_a_window_manager_that_refuses_gets_a_plain_window(documents, monkeypatch):
    make = pygame.Window

    def refusing(*arguments, always_on_top=False, **named):
        if always_on_top:
            raise pygame.error("not supported")
        return make(*arguments, **named)

    monkeypatch.setattr(pygame, "Window", refusing)
    window = ToyWindow(1.0)
    assert not window.floats and "not supported" in window.refusal
    window.close()


def test_sound_is_off_at_first_and_what_was_chosen_is_remembered(desk):
    one = desk()
    assert one.toy.choices["sound"] == "off"
    one.post(pygame.KEYDOWN, key=pygame.K_m, mod=0, unicode="m", scancode=0)
    one.frames(1)
    one.toy.close()
    assert desk().toy.choices["sound"] == "on"


def test_the_app_starts_a_toy_of_the_level_that_is_played(driver, monkeypatch):
    started, ended = [], []

    def popen(command, **_):
        started.append(command)
        return SimpleNamespace(poll=lambda: 0 if ended else None)

    monkeypatch.setattr(toy_start.subprocess, "Popen", popen)
    driver.key(pygame.K_t, pygame.KMOD_CTRL)
    assert started[0][2:4] == ["sandbox", "toy"]
    assert toy_start.data_folder() / "toy.json" == toy_start.Path(started[0][4])
    assert any("desk toy opens" in notice for notice in driver.notices)
    driver.app.act("toy")
    assert len(started) == 1 and "is open already" in driver.notices[-1]
    ended.append(True)
    monkeypatch.setattr(toy_start.subprocess, "Popen", lambda *_, **__: (_ for _ in ()).throw(OSError(2, "no such")))
    driver.app.act("toy")
    assert any("cannot be started: no such" in notice for notice in driver.notices)


def test_without_a_display_it_is_refused_in_one_line(monkeypatch, capsys):
    monkeypatch.setattr("sandbox.app.base.display.has_display", lambda: False)
    assert main(["toy"]) == 2
    assert "needs a display" in capsys.readouterr().err
