"""The app on a driver that shows nothing, driven by posted events and frames of a fixed length."""

import os

os.environ["SDL_VIDEODRIVER"] = "dummy"
os.environ["SDL_AUDIODRIVER"] = "dummy"
os.environ["PYGAME_HIDE_SUPPORT_PROMPT"] = "1"

import json
import time

import pygame
import pytest

from sandbox.app.base.display import Display, StartRequest
from sandbox.app.base.idle import REST
from sandbox.app.panel.panel import MORE
from sandbox.app.play.play_screen import FOLD
from sandbox.app.window.app import App
from sandbox.editor.storage.preferences import set_preference
from sandbox.level.reading.files import parse_level
from tests.support.person import VirtualScreen

FRAME = 1 / 60
# In so many frames all is measured.
MOST_FRAMES = 3_000
# How much later each look at the clock is [s]: what works by slices, until its time is up, does as much on any machine.
LOOK = 5e-5


def small_level(**changes):
    """A rope of 4 links of 1 m, pinned at its start, and a loose pair of another material; no gravity."""
    data = {
        "format": "spring-sandbox/level",
        "version": 3,
        "name": "Small",
        "settings": {"solver": "single_pass", "gravity": [0.0, 0.0]},
        "view": [-3.0, -3.0, 7.0, 4.0],
        "materials": {"steel": {"stiffness": 0.3, "damping": 0.3}, "rubber": {"stiffness": 0.02, "damping": 0.1}},
        "bodies": [
            {"type": "rope", "id": "rope", "start": [0, 0], "end": [4, 0], "segments": 4, "pin": ["start"],
             "material": "steel"},
            {"type": "rope", "id": "pair", "start": [0, 2], "end": [1, 2], "segments": 1, "material": "rubber"},
        ],
        **changes,
    }  # fmt: skip
    return parse_level(json.dumps(data).encode(), "test")


class Clock:
    """The time that the app goes by here: only frames and looks let it pass, however long the machine takes."""

    def __init__(self):
        self._now = 1.0

    def pass_on(self, seconds):
        """Let so much time pass."""
        self._now += seconds

    def look(self):
        """What time it is [s]."""
        self._now += LOOK
        return self._now

    def ticks(self):
        """What time it is [ms]; looks at it let none pass."""
        return int(1000 * self._now)


@pytest.fixture(autouse=True)
def clock(monkeypatch):
    """In place of the machine's clocks: no test of the app depends on what else the machine has to do."""
    made, frame = Clock(), App.frame

    def timed_frame(app, frame_time):
        made.pass_on(frame_time)
        frame(app, frame_time)

    monkeypatch.setattr(App, "frame", timed_frame)
    monkeypatch.setattr(time, "perf_counter", made.look)
    monkeypatch.setattr(pygame.time, "get_ticks", made.ticks)
    return made


class Driver:
    """A person at the app: moves, clicks, types, and lets frames pass."""

    def __init__(self, level=None, replay=None, edit=False):
        self.app = App(Display(1.0))
        if edit and level is None:
            self.app.documents.new()
        elif edit:
            self.app.documents.edit_level(level)
        else:
            self.app.open(StartRequest(level, replay))
        self.frames(2)

    @property
    def stage(self):
        return self.app.play.stage

    @property
    def panel(self):
        return self.app.play.panel

    @property
    def editor(self):
        return self.app.documents.editor

    @property
    def playback(self):
        return self.app.play.playback

    @property
    def world(self):
        return self.playback.session.world

    @property
    def notices(self):
        return [notice.text for notice in self.app.status.notices]

    def frames(self, count=1):
        """Let frames pass, of which the last is drawn."""
        self.pass_unseen(count - 1)
        self._frame()

    def pass_unseen(self, count=1):
        """Let frames pass that nobody looks at."""
        self.app._draw = lambda: None
        try:
            for _ in range(count):
                self._frame()
        finally:
            del self.app._draw

    def _frame(self):
        self.app.frame(FRAME)

    def measure(self):
        """Let frames pass until the panel has measured what was asked, and all else that it shows."""
        for _ in range(MOST_FRAMES):
            self.pass_unseen(1)
            if not self.panel.firmness.is_measuring:
                break
        self.frames(20)

    def take_sliders(self):
        """Have the whole panel in sight, with sliders in place of the pad."""
        self.app.play._set_by("sliders")
        self.frames(2)

    def rest(self):
        """Do nothing for long enough that the app finds what it needs no more."""
        pygame.event.clear()
        self.app.frame(REST)

    def post(self, kind, **data):
        pygame.event.post(pygame.event.Event(kind, **data))

    def move(self, pixel):
        self._point_at(pixel)
        self.frames()

    def _point_at(self, pixel):
        at = tuple(round(value) for value in pixel)
        before = pygame.mouse.get_pos()
        pygame.mouse.set_pos(at)
        pygame.event.get(pygame.MOUSEMOTION)
        self.post(pygame.MOUSEMOTION, pos=at, rel=(at[0] - before[0], at[1] - before[1]), buttons=(0, 0, 0))

    def press(self, pixel, button=1):
        self._point_at(pixel)
        self.pass_unseen()
        self.post(pygame.MOUSEBUTTONDOWN, pos=tuple(round(value) for value in pixel), button=button)
        self.frames()

    def release(self, pixel, button=1):
        self.post(pygame.MOUSEBUTTONUP, pos=tuple(round(value) for value in pixel), button=button)
        self.frames(2)

    def stroke(self, *points):
        """Press at the first of some points [m] of the run, move along the others, and let go."""
        pixels = [self.stage.camera.to_pixels(point) for point in points]
        self.move(pixels[0])
        self.press(pixels[0])
        for pixel in pixels[1:]:
            self.move(pixel)
        self.release(pixels[-1])

    def click(self, pixel):
        self.press(pixel)
        self.release(pixel)

    def click_widget(self, widget):
        self.click(widget.rect.center)

    def key(self, key, mod=0):
        self.post(pygame.KEYDOWN, key=key, mod=mod, unicode="", scancode=0)
        self.pass_unseen()
        self.post(pygame.KEYUP, key=key, mod=mod, unicode="", scancode=0)
        self.frames(2)

    def tap(self, key):
        """Press and release a key within a frame, which nobody looks at."""
        for kind in (pygame.KEYDOWN, pygame.KEYUP):
            self.post(kind, key=key, mod=0, unicode="", scancode=0)
        self.pass_unseen()

    def type(self, text):
        for letter in text:
            self.post(pygame.TEXTINPUT, text=letter)
        self.frames()

    def press_letters(self, text):
        """Press the keys of letters, as a keyboard does: each key first, then what it types."""
        for letter in text:
            self.post(pygame.KEYDOWN, key=ord(letter), mod=0, unicode=letter, scancode=0)
            self.post(pygame.TEXTINPUT, text=letter)
            self.post(pygame.KEYUP, key=ord(letter), mod=0, unicode=letter, scancode=0)
        self.frames(2)

    def click_in_panel(self, widget):
        """Scroll the panel to a widget, and click it."""
        area = self.panel.area
        area.scroll_to(widget.place.top - area.view.rect.height / 2)
        self.frames(2)
        self.click_widget(widget)

    def entry(self, name):
        """The line of the panel that shows a number, by the name of its field."""
        panel = self.panel
        return next(form.fields[name] for form in (panel.engineers.form, panel.world.form) if name in form.fields)[0]

    def fill(self, field, text):
        """Focus a field that is there, replace its text and press Enter."""
        assert field.visible
        self.app.ui.focus_on(field)
        self.type(text)
        self.key(pygame.K_RETURN)

    # In the editor.

    def at(self, x, y):
        """Where a point [m] of the level that is edited is on the screen."""
        return self.editor.camera.to_pixels((x, y))

    def drag(self, *points, mods=0):
        """Press at the first of points [m], move along the others, release at the last."""
        pygame.key.set_mods(mods)
        self.press(self.at(*points[0]))
        for x, y in points[1:]:
            self.move(self.at(x, y))
        self.release(self.at(*points[-1]))
        pygame.key.set_mods(0)

    def click_at(self, x, y, mods=0):
        """Click a point [m]; a second click there is a click of its own."""
        pygame.key.set_mods(mods)
        self.click(self.at(x, y))
        pygame.key.set_mods(0)
        self.app.input._last_press = None

    def choose(self, label):
        """Press the button of that label on the page that is open."""
        button = next(button for button in self.app.ui.buttons() if button.text == label)
        self.click_widget(button)

    def pixel_of(self, name):
        """Where a particle is on the screen."""
        position = self.playback.current.position[self.world.particle_slot(name)]
        return self.stage.camera.to_pixels(tuple(position.tolist()))


@pytest.fixture
def documents(tmp_path, monkeypatch):
    """The person's documents, empty, and a data folder of their own."""
    monkeypatch.setattr(
        "sandbox.editor.storage.preferences.platformdirs.user_data_dir", lambda *_, **__: str(tmp_path / "data")
    )
    monkeypatch.setattr("sandbox.app.base.desktop.platformdirs.user_documents_dir", lambda: str(tmp_path))
    monkeypatch.setattr("sandbox.app.base.desktop.platformdirs.user_pictures_dir", lambda: str(tmp_path / "pictures"))
    monkeypatch.setattr(
        "sandbox.app.draw.picture_cache.platformdirs.user_cache_dir", lambda *_, **__: str(tmp_path / "cache")
    )
    # The system asks for the dark theme, which pictures and colours of these tests are of.
    monkeypatch.setattr("sandbox.app.settings.chosen._is_dark", lambda: True)
    return tmp_path / "Spring Sandbox"


@pytest.fixture
def open_app(documents):
    """Open the app on a level, a replay, or (None) its gallery; edit: in the editor, None = an empty sheet.

    more: whether the person has the whole panel open.
    """
    drivers = []

    def open_(level=None, replay=None, edit=False, more=True):
        if more and not edit:
            set_preference(f"{FOLD}{MORE}", True)
        drivers.append(Driver(level, replay, edit))
        return drivers[-1]

    yield open_
    for driver in drivers:
        driver.app.close()
        # Whoever has it may be kept until the next collection, and its pictures take 20 MB.
        del driver.app


@pytest.fixture
def edit(open_app):
    """Open the editor on a level, or (None) an empty sheet."""

    return lambda level=None: open_app(level, edit=True)


@pytest.fixture
def driver(open_app):
    """The app on the small level."""
    return open_app(small_level())


@pytest.fixture
def screen(tmp_path):
    """A virtual screen of the window's size."""
    virtual = VirtualScreen(tmp_path)
    yield virtual
    virtual.close()
