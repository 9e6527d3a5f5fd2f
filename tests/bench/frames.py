"""Milliseconds of whole frames at 1280x720, ticks and panel included: `python -m tests.bench.frames [LEVEL ...]`.

By CPU. Of every shipped level, after a second of its run, and of a mesh of 10,000 springs that hangs by two corners.
"""

import json
import os
import sys
import tempfile
import time

os.environ["SDL_VIDEODRIVER"] = "dummy"
os.environ["SDL_AUDIODRIVER"] = "dummy"

import numpy as np
import pygame

from sandbox.app.base.display import Display, StartRequest
from sandbox.app.window.app import App
from sandbox.level.document.model import Level
from sandbox.level.reading.files import read_level, shipped_levels
from sandbox.level.reading.parse import parse_level

SIZE, RATE = (1280, 720), 60
WARM_UP, FRAMES = 60, 120
# Particles along a side of the mesh, and their distance [m].
SIDE, APART = 50, 0.2


def mesh() -> Level:
    """A square of particles, each with springs to those beside, below and across."""
    places = [[APART * i, -APART * j] for j in range(SIDE) for i in range(SIDE)]
    ways = ((1, 0), (0, 1), (1, 1), (-1, 1))
    springs = [
        [j * SIDE + i, (j + dj) * SIDE + i + di]
        for j in range(SIDE)
        for i in range(SIDE)
        for di, dj in ways
        if 0 <= i + di < SIDE and j + dj < SIDE
    ]
    body = {
        "type": "mesh", "id": "mesh", "particles": places, "springs": springs, "masses": [0.1] * len(places),
        "pinned": [0, SIDE - 1], "material": "net",
    }  # fmt: skip
    materials = {"net": {"stiffness": 0.3, "damping": 0.4}}
    level = {"format": "spring-sandbox/level", "version": 3, "name": "Mesh", "materials": materials, "bodies": [body]}
    return parse_level(json.dumps(level).encode(), "mesh")


def frame_times(app: App, level: Level) -> list[float]:
    """Times [ms] of frames of a level's run."""
    app.open(StartRequest(level, None))
    times = []
    for _ in range(WARM_UP + FRAMES):
        began = time.thread_time()
        app.frame(1 / RATE)
        times.append(1e3 * (time.thread_time() - began))
    return times[WARM_UP:]


def main(names: list[str]) -> None:
    """Print a line for each level."""
    levels = {path.stem: read_level(path) for path in shipped_levels()} | {"mesh": mesh()}
    with tempfile.TemporaryDirectory() as folder:
        for name in ("XDG_DATA_HOME", "XDG_CACHE_HOME", "XDG_CONFIG_HOME", "XDG_DOCUMENTS_DIR"):
            os.environ[name] = folder
        app = App(Display(1.0))
        app.display.window.size = SIZE
        print(f"{'level':24}{'median':>9}{'99 %':>9}{'best':>9}  ms")
        for name in names or levels:
            times = frame_times(app, levels[name])
            figures = np.median(times), np.quantile(times, 0.99), min(times)
            print(f"{name:24}" + "".join(f"{figure:9.2f}" for figure in figures), flush=True)
        app.close()
        pygame.quit()


if __name__ == "__main__":
    main(sys.argv[1:])
