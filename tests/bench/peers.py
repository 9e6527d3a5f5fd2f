"""This project against other engines on the same scenes: time, stretch, energy, as one Markdown table.

Run by hand: python -m tests.bench.peers [name of a scene ...]. Each engine runs at its defaults, and at the setting
of least stretch that keeps its energy and fits a frame of 16.6 ms; an engine that is not installed is left out.
"""

import importlib.util
import sys
import time
from dataclasses import dataclass

import numpy as np

from tests.bench.engines import Setting, box2d_setting, pymunk_setting, sandbox_setting
from tests.bench.scenes import GRAVITY, Scene, bench_scenes, swing_energy

SECONDS = 7
MEASURED_FROM = 5
LONGEST_FRAME = 16.6e-3
# A run that gains more than this share of the scene's swing energy is not stable.
LARGEST_GAIN = 0.05


@dataclass(frozen=True)
class Figures:
    """One row: ms per frame (median of the measured seconds), RMS and maximum strain then, energy gained."""

    setting: Setting
    milliseconds: float
    rms: float
    largest: float
    gain: float

    @property
    def stable(self) -> bool:
        """Whether the run stayed finite and made no energy."""
        return bool(np.isfinite(self.rms) and self.gain <= LARGEST_GAIN and self.milliseconds <= 1e3 * LONGEST_FRAME)


def measure(scene: Scene, setting: Setting) -> Figures | None:
    """Run a scene for 7 s; None where a frame takes too long to be of interest."""
    running = setting.build(scene)
    free = ~scene.pinned
    bearing = scene.links[free[scene.links].any(axis=1)]
    rest = np.sqrt(np.sum((scene.position[bearing[:, 1]] - scene.position[bearing[:, 0]]) ** 2, axis=1))
    times, squares, energy = [], [], []
    for tick in range(60 * SECONDS):
        began = time.perf_counter()
        running.frame()
        times.append(time.perf_counter() - began)
        # The best of a few frames: the first ones may be cold, or another process may take the machine.
        if 2 <= tick <= 9 and min(times) > 1.2 * LONGEST_FRAME:
            return None
        if tick % 5 == 0 or tick >= 60 * MEASURED_FROM:
            position, velocity = running.state()
            moving = 0.5 * np.sum(scene.mass[free, None] * velocity[free] ** 2)
            energy.append(moving + GRAVITY * np.sum(scene.mass[free] * (position - scene.position)[free, 1]))
            if tick >= 60 * MEASURED_FROM:
                length = np.sqrt(np.sum((position[bearing[:, 1]] - position[bearing[:, 0]]) ** 2, axis=1))
                squares.append((length / rest - 1.0) ** 2)
    measured = times[60 * MEASURED_FROM :]
    return Figures(
        setting,
        1e3 * float(np.median(measured)),
        float(np.sqrt(np.mean(squares))),
        float(np.sqrt(np.max(squares))),
        max(0.0, float(np.max(energy))) / swing_energy(scene),
    )


def candidates() -> list[tuple[Setting, list[Setting]]]:
    """For each engine that is installed: its default, and the settings among which the stiffest is looked for."""
    found = [(sandbox_setting(1), [sandbox_setting(count) for count in (4, 8, 16, 32, 64)])]
    if importlib.util.find_spec("pymunk"):
        pairs = ((1, 20), (2, 10), (1, 50), (4, 10), (16, 10), (64, 10), (16, 50), (4, 200))
        joints = [pymunk_setting(*pair) for pair in pairs]
        springs = [
            pymunk_setting(substeps, 10, spring) for substeps in (2, 16, 64, 256, 1024) for spring in (0.05, 0.3, 1.0)
        ]
        found.append((pymunk_setting(1, 10), joints + springs))
    if importlib.util.find_spec("pyb2d3"):
        rigid = [box2d_setting(count) for count in (8, 16, 64, 256, 1024)]
        soft = [box2d_setting(count, hertz) for count in (8, 16, 64, 256, 1024, 4096) for hertz in (0.125, 0.25, 0.5)]
        found.append((box2d_setting(4), rigid + soft))
    return found


def search(scene: Scene, settings: list[Setting]) -> list[Figures]:
    """The runs that were stable and in time; none of a setting that works as much as one that was far too slow."""
    runs: list[Figures] = []
    late: list[Setting] = []
    for setting in settings:
        if any(setting.works_as_much_as(other) for other in late):
            continue
        figures = measure(scene, setting)
        if figures is None:
            late.append(setting)
        elif figures.stable:
            runs.append(figures)
    return runs


def rows(scene: Scene) -> list[Figures]:
    """Each engine's default and its stiffest stable setting, this project's settings first."""
    chosen = []
    for number, (default, others) in enumerate(candidates()):
        plain = measure(scene, default)
        runs = search(scene, others)
        chosen += [plain] if plain is not None else []
        chosen += runs if number == 0 else sorted(runs, key=lambda figures: figures.rms)[:1]
    return chosen


def main() -> None:
    """Print the table."""
    print("| scene | engine | setting | ms per frame | RMS stretch | maximum | energy gained | time, times ours |")
    print("|---|---|---|---|---|---|---|---|")
    for scene in bench_scenes():
        if sys.argv[1:] and scene.name not in sys.argv[1:]:
            continue
        measured = rows(scene)
        for figures in measured:
            row = f"| {scene.name} | {figures.setting.engine} | {figures.setting.name} | {figures.milliseconds:.4f} "
            row += f"| {figures.rms:.1e} | {figures.largest:.1e} | {100 * figures.gain:.1f} % "
            print(row + f"| {figures.milliseconds / measured[0].milliseconds:.1f} |", flush=True)


if __name__ == "__main__":
    main()
