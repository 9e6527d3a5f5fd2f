"""Box2D's benchmark scene joint grid, here and in Box2D v3, in one run: time and stretch as it begins and as it swings.

Run by hand: python -m tests.bench.joint_grid [side]. An engine that is not installed is left out.
"""

import importlib.util
import sys
import time
from collections.abc import Iterator

import numpy as np

from tests.bench.engines import Running, Setting, box2d_setting, sandbox_setting
from tests.bench.scenes import Scene, joint_grid

# Seconds of the run that are measured: it begins to fall, and it swings.
WINDOWS = ((0, 1), (4, 6))
RATE = 60


def settings() -> Iterator[Setting]:
    """What is compared."""
    yield sandbox_setting(1)
    yield sandbox_setting(1, stiffness=0.99, damping=0.999)
    yield sandbox_setting(4)
    if importlib.util.find_spec("pyb2d3"):
        yield from (box2d_setting(substeps) for substeps in (4, 16, 64, 256))


def strains(scene: Scene, running: Running) -> np.ndarray:
    """How far each link that bears load is from its length, as a share of that (m,)."""
    links = scene.links[~scene.pinned[scene.links].all(axis=1)]
    position, _ = running.state()
    rest, now = (np.linalg.norm(each[links[:, 1]] - each[links[:, 0]], axis=1) for each in (scene.position, position))
    return np.asarray(np.abs(now / rest - 1.0))


def measure(scene: Scene, setting: Setting) -> Iterator[str]:
    """By window: median milliseconds of a frame, RMS stretch, and that of the worst link."""
    running = setting.build(scene)
    for begin, end in WINDOWS:
        times, squares, largest = [], [], 0.0
        for frame in range(0 if begin == 0 else WINDOWS[0][1] * RATE, end * RATE):
            started = time.perf_counter()
            running.frame()
            if frame >= begin * RATE:
                times.append(time.perf_counter() - started)
                strain = strains(scene, running)
                squares.append(float(np.mean(strain**2)))
                largest = max(largest, float(np.max(strain)))
        yield f"{1e3 * np.median(times):.1f} | {np.sqrt(np.mean(squares)):.1e} | {largest:.1e}"


def main() -> None:
    """Print the table."""
    scene = joint_grid(*map(int, sys.argv[1:]))
    windows = [f"{begin} to {end} s: ms a frame | RMS stretch | worst" for begin, end in WINDOWS]
    print(f"| engine | setting | {' | '.join(windows)} |")
    print("|---" * (2 + 3 * len(WINDOWS)) + "|")
    for setting in settings():
        print(f"| {setting.engine} | {setting.name} | {' | '.join(measure(scene, setting))} |", flush=True)


if __name__ == "__main__":
    main()
