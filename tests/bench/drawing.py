"""Milliseconds that drawing a frame of each shipped level takes at 1280x720: no ticks, no panel, no flip.

Levels run for a second and are drawn between each of the ticks that follow; `drawing.py NAME ...` for some of them.
"""

import os
import sys
import time

os.environ.setdefault("SDL_VIDEODRIVER", "dummy")
os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")

import numpy as np
import pygame

from sandbox.app.draw.camera import Camera
from sandbox.app.draw.picture import view_of
from sandbox.app.draw.renderer import Overlay, Renderer
from sandbox.level.reading.files import read_level, shipped_levels
from sandbox.session.session import Session

SIZE = (1280, 720)
WARM_UP, FRAMES = 5, 120


def frame_times(path):
    """Times [ms] of frames, of this thread."""
    level = read_level(path)
    session, renderer = Session(level), Renderer(1.0, level)
    surface, camera = pygame.Surface(SIZE, 0, 32), Camera(viewport=(0, 0, *SIZE))
    before = session.snapshot()
    camera.fit(view_of(level, before))
    times = []
    for tick in range(level.settings.tick_rate + WARM_UP + FRAMES):
        session.advance()
        if tick < level.settings.tick_rate:
            continue
        now = session.snapshot()
        # A cursor far away that moves: a world at rest would not be drawn again.
        overlay = Overlay(cursor=(1e6 + tick, 0.0))
        start = time.thread_time()
        renderer.draw(surface, camera, before, now, 0.5, overlay)
        times.append(1e3 * (time.thread_time() - start))
        before = now
    return np.array(times[WARM_UP:])


def main(names):
    """Print a line for each level."""
    print(f"{'level':24}{'median':>9}{'99 %':>9}{'best':>9}  ms")
    for path in shipped_levels():
        if not names or path.stem in names:
            times = frame_times(path)
            figures = (np.median(times), np.quantile(times, 0.99), times.min())
            print(f"{path.stem:24}" + "".join(f"{figure:9.2f}" for figure in figures), flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
