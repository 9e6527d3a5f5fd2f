"""Large bodies and heaps on one thread and on two, with Box2D on as many and pymunk beside them, and a plot.

Run by hand: python -m tests.bench.large [sides]. An engine that is not installed is left out. All that stand in one row
take their ticks in turns, so that they meet the same load of the machine: read the ratios.
"""

import importlib.util
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np

from sandbox.level.assembly.build_world import build_world
from sandbox.level.reading.files import load_level
from sandbox.physics import jit
from sandbox.physics.step import step
from sandbox.physics.world import World
from tests.bench import scenes
from tests.bench.contacts import heap, pile
from tests.bench.engines import box2d_setting, pymunk_setting

SIDES = (32, 48, 64, 100, 128, 160, 224)
TICKS, MOST_SECONDS = 300, 25.0
PLOT = Path(__file__).resolve().parents[2] / "docs" / "readme" / "lattices.svg"
# Levels whose ticks take long, from tick 120 on.
LEVELS = ("jelly_pile", "rope_bridge_wheel", "trampoline", "curtain", "quad_mesh", "tumble_drum")


def in_turns(actions: Mapping[str, Callable[[], object]]) -> dict[str, float]:
    """Median milliseconds of each action, all of them in turns."""
    times: dict[str, list[float]] = {name: [] for name in actions}
    begun = time.perf_counter()
    while len(next(iter(times.values()))) < TICKS and time.perf_counter() - begun < MOST_SECONDS:
        for name, action in actions.items():
            started = time.perf_counter()
            action()
            times[name].append(1e3 * (time.perf_counter() - started))
    return {name: float(np.median(each)) for name, each in times.items()}


def with_threads(world: World, count: int) -> Callable[[], object]:
    """A tick of a world, on so many threads."""

    def tick() -> None:
        jit.use_threads(count)
        step(world)

    return tick


def both(build: Callable[[], World], skipped: int = 0) -> dict[str, Callable[[], object]]:
    """Ticks of two equal worlds, on one thread and on two, once so many ticks are over."""
    worlds = {f"{count}": build() for count in (1, 2)}
    for world in worlds.values():
        for _ in range(skipped):
            step(world)
    return {name: with_threads(world, int(name)) for name, world in worlds.items()}


def peers(scene: scenes.Scene) -> dict[str, Callable[[], object]]:
    """A frame of Box2D on one thread and on two, and of pymunk, at their defaults, where they are installed."""
    found: dict[str, Callable[[], object]] = {}
    if importlib.util.find_spec("pyb2d3"):
        found |= {f"box2d {count}": box2d_setting(4, threads=count).build(scene).frame for count in (1, 2)}
    if importlib.util.find_spec("pymunk"):
        found["pymunk"] = pymunk_setting(1, 10).build(scene).frame
    return found


def row(name: str, found: Mapping[str, float]) -> str:
    """A row of the table."""
    cells = [f"{found[key]:.2f}" if key in found else "" for key in ("1", "2")]
    cells.append(f"{found['1'] / found['2']:.2f}")
    cells += [f"{found[key]:.2f}" if key in found else "" for key in ("box2d 1", "box2d 2", "pymunk")]
    return f"| {name} | {' | '.join(cells)} |"


def plot(sides: Sequence[int], rows: Sequence[Mapping[str, float]]) -> None:
    """Draw the milliseconds of lattices by their side, both axes logarithmic."""
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(figsize=(6.4, 3.8))
    for key, words in (("1", "1 thread"), ("2", "2 threads"), ("box2d 1", "Box2D v3"), ("pymunk", "pymunk")):
        points = [(side, each[key]) for side, each in zip(sides, rows, strict=True) if key in each]
        axes.loglog(*np.array(points).reshape(-1, 2).T, marker="o", label=words)
    axes.set_xticks(sides, [f"{side}²" for side in sides])
    axes.minorticks_off()
    axes.set_ylabel("ms a tick")
    axes.legend()
    figure.tight_layout()
    figure.savefig(PLOT, metadata={"Date": None})


def main() -> None:
    """Print the table, and draw lattices if all sides are measured."""
    sides = tuple(map(int, sys.argv[1].split(","))) if len(sys.argv) > 1 else SIDES
    print("| scene | 1 thread [ms] | 2 threads | gain | Box2D, 1 thread | 2 threads | pymunk |")
    print("|---|---|---|---|---|---|---|")
    rows = []
    for side in sides:
        scene = scenes.lattice(side)
        rows.append(in_turns(both(scene.world) | peers(scene)))
        print(row(f"lattice {side} x {side}", rows[-1]), flush=True)
    if sides == SIDES:
        plot(sides, rows)
    net = scenes.joint_grid(100)
    print(row("joint grid, from the start", in_turns(both(net.world) | peers(net))), flush=True)
    print(row("joint grid that swings, 4 s on", in_turns(both(net.world, 240))), flush=True)
    print(row("pile of 30 jelly cubes", in_turns(both(pile, 60))), flush=True)
    print(row("heap of 2,000 discs", in_turns(both(lambda: heap(2000, 40), 60))), flush=True)
    print(row("500 blocks of 4 x 4, apart", in_turns(both(scenes.blocks(500).world))), flush=True)
    for name in LEVELS:
        level = load_level(name)
        print(row(f"level {name}", in_turns(both(lambda level=level: build_world(level), 120))), flush=True)


if __name__ == "__main__":
    main()
