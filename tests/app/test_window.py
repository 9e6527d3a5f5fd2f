"""A real window on a virtual screen, driven by xdotool: drag, slide, pause, record, save; the replay verifies."""

import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from conftest import Driver, small_level

from sandbox.app.display import WINDOW_SIZE
from sandbox.level.files import write_level
from sandbox.session.reading import read_replay
from sandbox.session.replay import verify
from sandbox.session.session import Session

# How long something that must happen may take before it counts as not happening [s].
DEADLINE = 90.0

pytestmark = pytest.mark.skipif(
    not (shutil.which("Xvfb") and shutil.which("xdotool")), reason="needs Xvfb and xdotool (apt install xvfb xdotool)"
)


@pytest.fixture
def screen():
    """DISPLAY of a virtual screen of the window's size."""
    read, write = os.pipe()
    size = f"{WINDOW_SIZE[0]}x{WINDOW_SIZE[1]}x24"
    command = ["Xvfb", "-displayfd", str(write), "-screen", "0", size, "-nolisten", "tcp", "-noreset"]
    server = subprocess.Popen(command, pass_fds=[write], stderr=subprocess.DEVNULL)
    os.close(write)
    with os.fdopen(read) as pipe:
        number = pipe.readline().strip()
    try:
        yield f":{number}"
    finally:
        server.terminate()
        server.wait()


class Person:
    """Drives the app's window from outside, and sees nothing but its title."""

    def __init__(self, display: str, level: Path, documents: Path) -> None:
        self.environment = {
            **os.environ,
            "DISPLAY": display,
            "XDG_DOCUMENTS_DIR": str(documents),
            "SDL_VIDEODRIVER": "x11",
            "PYTHONPATH": os.pathsep.join(sys.path),
        }
        command = [sys.executable, "-m", "sandbox", "play", str(level), "--scale", "1"]
        self.app = subprocess.Popen(
            command, env=self.environment, cwd=level.parent, stdout=subprocess.PIPE, stderr=subprocess.STDOUT
        )

    def do(self, *arguments: object) -> str:
        words = ["xdotool", *map(str, arguments)]
        return subprocess.run(words, env=self.environment, capture_output=True, text=True).stdout.strip()

    def title(self) -> str:
        return self.do("search", "--onlyvisible", "--class", "spring-sandbox", "getwindowname")

    def wait_for(self, *words: str, without: str = "\0") -> None:
        """Poll the title until it has the words."""
        give_up = time.monotonic() + DEADLINE
        while time.monotonic() < give_up:
            title = self.title()
            if all(word in title for word in words) and without not in title:
                return
            assert self.app.poll() is None, self.app.communicate()[0].decode()
        raise AssertionError(f"the title is {title!r}, without {words}")

    def drag(self, points: list[tuple[float, float]], while_held: str | None = None) -> None:
        self.do("mousemove", *map(round, points[0]))
        self.do("mousedown", 1)
        if while_held:
            self.wait_for(while_held)
        for point in points[1:]:
            self.do("mousemove", *map(round, point))
        self.do("mouseup", 1)


def test_a_person_drags_slides_pauses_records_and_saves_and_the_replay_verifies(screen, tmp_path, open_app):
    level = small_level()
    write_level(level, tmp_path / "small.json")
    # The same app without a display says where things are on the screen.
    twin: Driver = open_app(level)
    twin.app.display.window.size = WINDOW_SIZE
    twin.frames(2)
    start = twin.pixel_of("rope.4")
    slider = twin.panel.stiffness
    places = [(slider.pixel_of(value), slider.rect.centery) for value in (0.1, 0.05, 0.01)]

    person = Person(screen, tmp_path / "small.json", tmp_path / "documents")
    try:
        person.wait_for("Small", "playing")
        person.do("key", "ctrl+r")
        person.wait_for("recording")
        person.drag([start, *((start[0] - 9 * k, start[1] - 15 * k) for k in range(8))], while_held="holding 1")
        person.wait_for("Small", without="holding")
        person.drag(places)
        person.do("key", "k")
        person.wait_for("paused")
        person.do("key", "ctrl+r")
        person.wait_for("dialog")
        person.do("type", "by hand")
        person.do("key", "Return")
        person.wait_for("paused", without="dialog")
        person.do("key", "ctrl+q")
        assert person.app.wait(DEADLINE) == 0
    finally:
        person.app.kill()

    replay = read_replay(tmp_path / "documents" / "Spring Sandbox" / "by hand.replay.jsonl")
    assert verify(replay) is None
    session = Session(replay.level, replay.script)
    while session.tick < replay.ticks:
        session.advance()
    session.apply_pending()
    moved = session.world.position[4] - (4.0, 0.0)
    assert np.abs(moved).max() > 0.2
    assert 0.005 < session.world.stiffness[0] < 0.02
