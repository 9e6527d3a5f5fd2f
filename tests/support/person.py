"""Person: drives a real window on a virtual screen from outside by xdotool; sees its title and its pixels alone."""

import os
import shlex
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping
from contextlib import suppress
from pathlib import Path

import numpy as np
import pygame

from sandbox.app.base.display import WINDOW_SIZE
from tests.support.wants import needs

# How long something that must happen may take before it counts as not happening [s].
DEADLINE = 90.0
# A movement that changes no pixel is given up after this [s].
PATIENCE = 1.0
# Between two looks at the window's pixels, and at its title, which takes a process [s]: whoever looks without a pause
# takes the processor from what is looked at.
BLINK, GLANCE = 0.02, 0.1
# How xdotool finds the app's window.
WINDOW = ("search", "--onlyvisible", "--class", "spring-sandbox")
# So long a drag is held on to where it ends.
HELD_TICKS = 20

HAS_A_SCREEN = bool(shutil.which("Xvfb") and shutil.which("xdotool"))
needs_a_screen = needs("Xvfb and xdotool", HAS_A_SCREEN)
# Variables of the person who runs this, and no stranger's.
OWN = ("XDG_", "SANDBOX_", "PYTEST", "VIRTUAL_ENV", "PYTHONPATH", "MAKE", "MFLAGS")


def stranger_environment(home: Path) -> dict[str, str]:
    """The variables of somebody who has never been here; home: a folder that is made."""
    home.mkdir(exist_ok=True)
    kept = {name: value for name, value in os.environ.items() if not name.startswith(OWN)}
    return {**kept, "HOME": str(home)}


def looks(patience: float, pause: float) -> Iterator[None]:
    """Moments to look at something, until it was looked at for so long [s]; pause: between two [s]."""
    give_up = time.monotonic() + patience
    while time.monotonic() < give_up:
        yield
        time.sleep(pause)


class VirtualScreen:
    """A screen of the window's size; display: its DISPLAY; its pixels are in a file of X's own picture format."""

    def __init__(self, folder: Path) -> None:
        read, write = os.pipe()
        size = f"{WINDOW_SIZE[0]}x{WINDOW_SIZE[1]}x24"
        command = ["Xvfb", "-displayfd", str(write), "-screen", "0", size, "-fbdir", str(folder), "-nolisten", "tcp"]
        self.server = subprocess.Popen([*command, "-noreset"], pass_fds=[write], stderr=subprocess.DEVNULL)
        os.close(write)
        with os.fdopen(read) as pipe:
            self.display = f":{pipe.readline().strip()}"
        self._file = folder / "Xvfb_screen0"

    def dump(self) -> bytes:
        """All that is seen now, to be compared."""
        return self._file.read_bytes()

    def pixels(self) -> np.ndarray:
        """What is seen now: red, green, blue (height, width, 3)."""
        data = self.dump()
        header = np.frombuffer(data, ">u4", 25).tolist()
        start, width, height, line = header[0] + 12 * header[19], header[4], header[5], header[12]
        rows = np.frombuffer(data, np.uint8, line * height, start).reshape(height, line)
        return rows[:, : 4 * width].reshape(height, width, 4)[:, :, 2::-1]

    def save(self, path: Path) -> None:
        """Keep what is seen now as a picture."""
        pygame.image.save(pygame.surfarray.make_surface(self.pixels().swapaxes(0, 1)), path)

    def close(self) -> None:
        """Take the screen away."""
        self.server.terminate()
        self.server.wait()


class Visitor:
    """Drives a window from outside that a line of the shell opens; a process group of its own."""

    def __init__(self, screen: VirtualScreen, line: str, folder: Path, environment: Mapping[str, str]) -> None:
        self.screen = screen
        self.environment = {**environment, "DISPLAY": screen.display, "SDL_VIDEODRIVER": "x11"}
        self.app = subprocess.Popen(
            line, shell=True, env=self.environment, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
            start_new_session=True,
        )  # fmt: skip

    def do(self, *arguments: object) -> str:
        words = ["xdotool", *map(str, arguments)]
        return subprocess.run(words, env=self.environment, capture_output=True, text=True).stdout.strip()

    def title(self) -> str:
        return self.do(*WINDOW, "getwindowname")

    def size(self) -> tuple[int, int]:
        """Width and height of the window [pixels]."""
        told = dict(line.split("=") for line in self.do(*WINDOW, "getwindowgeometry", "--shell").splitlines())
        return int(told["WIDTH"]), int(told["HEIGHT"])

    def click_inside(self) -> None:
        """Click into the window, above its middle: on a card of the gallery, beside a dialog; the window shows it."""
        width, height = self.size()
        # Whoever was here before may have left the mouse at that very place.
        self.move((0, 0))
        click = "mousemove", "--window", "%1", width // 2, height // 3, "click", 1
        assert self.seen(*WINDOW, *click), "a click changes no pixel"
        assert self.app.poll() is None, "a click ends it"

    def leave(self) -> None:
        """Close the window by its key; the program ends well and says nothing on the standard error."""
        for _ in looks(DEADLINE, GLANCE):
            self.do("key", "ctrl+q")
            if self.app.poll() is not None:
                break
        _, said = self.app.communicate(timeout=DEADLINE)
        assert (self.app.returncode, said) == (0, b""), f"exit code {self.app.returncode}\n{said.decode()}"

    def end(self) -> None:
        """End what is left of the process group."""
        with suppress(ProcessLookupError):
            os.killpg(self.app.pid, signal.SIGKILL)
        self.app.wait()

    def wait_for(self, *words: str, without: str = "\0", patience: float = DEADLINE) -> None:
        """Poll the title until it has the words, for so long [s]. Raises AssertionError."""
        title = ""
        for _ in looks(patience, GLANCE):
            title = self.title()
            if all(word in title for word in words) and without not in title:
                return
            assert self.app.poll() is None, b"\n".join(self.app.communicate()).decode()
        raise AssertionError(f"the title is {title!r}, without {words}")

    def seen(self, *arguments: object, patience: float = DEADLINE) -> bool:
        """Do something and poll the pixels until they change; whether they did."""
        before = self.screen.dump()
        self.do(*arguments)
        return any(self.screen.dump() != before for _ in looks(patience, BLINK))

    def move(self, pixel: tuple[float, float]) -> None:
        """Move the mouse; the app has seen it once what is under the mouse looks otherwise."""
        self.seen("mousemove", *map(round, pixel), patience=PATIENCE)

    def click(self, pixel: tuple[float, float]) -> None:
        """Click; the app has seen the press before the button goes up again."""
        self.move(pixel)
        self.seen("mousedown", 1, patience=PATIENCE)
        self.do("mouseup", 1)

    def tick(self) -> int:
        """The tick of the run, as the title has it."""
        return int(self.title().partition("tick ")[2].split()[0])

    def wait_for_tick(self, tick: int) -> None:
        """Wait until the run is that far."""
        for _ in looks(DEADLINE, GLANCE):
            if self.tick() >= tick:
                return
            assert self.app.poll() is None
        raise AssertionError(f"the run stays at tick {self.tick()}")

    def drag(self, points: list[tuple[float, float]], while_held: str | None = None) -> None:
        """Drag along points; while_held: what the title says of what is held, which then is held on for some ticks."""
        self.do("mousemove", *map(round, points[0]))
        self.do("mousedown", 1)
        if while_held:
            self.wait_for(while_held)
        for point in points[1:]:
            self.do("mousemove", *map(round, point))
        if while_held:
            self.wait_for_tick(self.tick() + HELD_TICKS)
        self.do("mouseup", 1)


class Person(Visitor):
    """Drives the app's window and reads its states; arguments: of `sandbox`; folder: holds documents and data."""

    def __init__(self, screen: VirtualScreen, arguments: list[str], folder: Path) -> None:
        line = shlex.join(["exec", sys.executable, "-m", "sandbox", *arguments, "--scale", "1", "--states"])
        own = {
            "XDG_DOCUMENTS_DIR": str(folder / "documents"),
            "XDG_DATA_HOME": str(folder / "data"),
            "PYTHONPATH": os.pathsep.join(sys.path),
        }
        super().__init__(screen, line, folder, {**os.environ, **own})
