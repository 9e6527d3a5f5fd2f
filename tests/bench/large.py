"""Large bodies under the direct solver, with pymunk's default step beside them where it is installed.

Run by hand: python -m tests.bench.large [sides] [seconds]. Lattices with diagonals, hung by one corner, at full
stiffness; each tick of this project is followed by one of pymunk's, so that both meet the same load of the machine.
"""

import importlib.util
import sys
import time
from collections.abc import Callable

import numpy as np

from sandbox.physics.arrays import Floats
from sandbox.physics.pipeline.block_owner import block_of
from sandbox.physics.step import step
from tests.bench import scenes
from tests.bench.engines import pymunk_setting

SIDES = (32, 64, 100, 128, 224)
SECONDS = 7
# Stretch is taken over the last seconds of a run, when the body swings.
MEASURED_TICKS = 120


def milliseconds(action: Callable[[], object]) -> float:
    """Wall-clock time of a call [ms]."""
    began = time.perf_counter()
    action()
    return 1e3 * (time.perf_counter() - began)


def stretch_of(scene: scenes.Scene, position: Floats) -> float:
    """RMS stretch of a scene's links at positions (n, 2) [m]."""
    lengths = []
    for place in (scene.position, position):
        separation = place[scene.links[:, 1]] - place[scene.links[:, 0]]
        lengths.append(np.sqrt(np.sum(separation * separation, axis=1)))
    return float(np.sqrt(np.mean((lengths[1] / lengths[0] - 1.0) ** 2)))


def row(side: int, seconds: int, with_pymunk: bool) -> str:
    """Run one lattice and state its figures."""
    scene = scenes.lattice(side)
    world = scene.world()
    peer = pymunk_setting(1, 10).build(scene) if with_pymunk else None
    first = milliseconds(lambda: step(world))
    world.change("spring_active", world.spring_active)
    symbolic = milliseconds(lambda: block_of(world))
    start = scenes.total_energy(world)
    times, peer_times, squares = [], [], []
    ticks = 60 * seconds
    for tick in range(ticks):
        times.append(milliseconds(lambda: step(world)))
        if peer is not None:
            peer_times.append(milliseconds(peer.frame))
        if tick >= ticks - MEASURED_TICKS:
            squares.append(scenes.square_strains(world))
    lost = (start - scenes.total_energy(world)) / scenes.swing_energy(scene)
    text = f"| {side}x{side} | {len(world.rest_length)} | {first:.0f} | {symbolic:.0f} "
    text += f"| {np.mean(times):.2f} | {np.quantile(times, 0.99):.2f} | {np.max(times):.2f} "
    text += f"| {np.sqrt(np.mean(squares)):.1e} | {np.sqrt(np.max(squares)):.1e} | {100 * lost:.3f} % "
    if peer is not None:
        text += f"| {np.mean(peer_times):.2f} | {np.mean(times) / np.mean(peer_times):.2f} "
        text += f"| {stretch_of(scene, peer.state()[0]):.1e} "
    return text + "|"


def main() -> None:
    """Print the table: the first tick, the symbolic work in it, then mean, 99th percentile and worst tick [ms]."""
    sides = [int(text) for text in sys.argv[1].split(",")] if len(sys.argv) > 1 else SIDES
    seconds = int(sys.argv[2]) if len(sys.argv) > 2 else SECONDS
    with_pymunk = importlib.util.find_spec("pymunk") is not None
    head = "| lattice | springs | first | symbolic | mean ms | p99 | worst | RMS stretch | maximum | energy lost |"
    head += " pymunk ms | ratio | its stretch |" if with_pymunk else ""
    print(f"{head}\n|{'---|' * (head.count('|') - 1)}")
    for side in sides:
        print(row(side, seconds, with_pymunk), flush=True)


if __name__ == "__main__":
    main()
