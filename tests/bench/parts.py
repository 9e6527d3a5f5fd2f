"""What it costs that things join a running level: `python -m tests.bench.parts`, in seconds and milliseconds of CPU.

Adding and undoing must grow with what is added: the last column of the first table is the time per particle of the
larger run over that of the smaller. The second table is of frames of the window (drawing, ticks and panel) while
jellies are dropped into the level jelly_pile: before, those of the drops, those that lay out the ticks to come, and
those of the first tick.
"""

import os
import statistics
import tempfile
import time

os.environ["SDL_VIDEODRIVER"] = "dummy"

import pygame

from sandbox.app.base.display import Display, StartRequest
from sandbox.app.window.app import App
from sandbox.level.reading.files import load_level
from sandbox.session.commands import AddParticle
from sandbox.session.session import Session
from sandbox.tools.dropping import PARTS

FRAME = 1 / 60
DROPS, SETTLING, BETWEEN = 12, 120, 20


def adding(count: int, undone: int) -> tuple[float, float]:
    """Seconds of adding so many particles at one tick, and of undoing and redoing so many of them one by one."""
    session = Session(load_level("rope"))
    for k in range(count):
        session.submit(AddParticle((50.0 + 0.01 * (k % 1000), 10.0 + 0.1 * (k // 1000))))
    began = time.process_time()
    session.apply_pending()
    added = time.process_time() - began
    for act in (session.undo, session.redo):
        for _ in range(undone):
            act()
            session.apply_pending()
    return added, time.process_time() - began - added


def dropping() -> list[list[float]]:
    """Milliseconds of frames before drops of jellies, of those, and of the two after each."""
    app = App(Display(1.0))
    app.open(StartRequest(load_level("jelly_pile"), None))

    def frame() -> float:
        began = time.process_time()
        app.frame(FRAME)
        return 1e3 * (time.process_time() - began)

    before = [frame() for _ in range(SETTLING)][SETTLING // 2 :]
    app.act("tool_jelly")
    for _ in range(2):
        frame()
    assert app.play is not None
    drops: list[list[float]] = []
    for k in range(DROPS):
        command = PARTS["jelly"].make(1.5, (-5.0 + 0.8 * k, 9.0), (0.0, 0.0), "raspberry")
        app.play.playback.submit(command)
        drops.append([frame() for _ in range(3)])
        for _ in range(BETWEEN):
            frame()
    app.close()
    pygame.quit()
    return [before, *map(list, zip(*drops, strict=True))]


def main() -> None:
    """Print the tables."""
    small, large = adding(2_000, 200), adding(20_000, 200)
    print(
        f"adding 2,000 particles {small[0]:.2f} s, 20,000 {large[0]:.2f} s, {large[0] / small[0] / 10:.2f} a particle"
    )
    print(f"2,000 undone and redone {adding(2_000, 2_000)[1]:.2f} s")
    with tempfile.TemporaryDirectory() as folder:
        for name in ("XDG_DATA_HOME", "XDG_CACHE_HOME", "XDG_DOCUMENTS_DIR"):
            os.environ[name] = folder
        for name, frames in zip(("before", "at a drop", "laid out", "first tick"), dropping(), strict=True):
            print(f"frames {name:10} median {statistics.median(frames):5.1f} ms, slowest {max(frames):5.1f} ms")


if __name__ == "__main__":
    main()
