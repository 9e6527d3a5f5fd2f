"""Stretch, time and loss of the direct solver. Run by hand: python -m tests.bench.direct_figures."""

import time

import numpy as np

from sandbox.physics.settings import AUTO, Substeps
from sandbox.physics.step import step
from tests.bench import scenes
from tests.support.tick_parts import parts_taken


def drag(substeps: Substeps, hand: bool) -> str:
    """A line for a rope of 100 links dragged at 20 m/s with reversals for 3 s by a hand (or moved pin), and let go."""
    world = scenes.rope(100).world(substeps=substeps)
    target, squares, parts = np.zeros(2), [], []
    if hand:
        world.unpin(0)
        world.hold(0, 0, (0.0, 0.0))
    for tick in range(180):
        velocity = 20.0 * np.array([(1, 0), (-1, 0), (0, 1), (0, -1)][tick // 15 % 4])
        target = target + velocity / world.settings.tick_rate
        if hand:
            world.move_grab(0, tuple(target))
        else:
            world.velocity[0] = velocity
        step(world)
        parts.append(parts_taken(world))
        squares.append(scenes.square_strains(world))
    if hand:
        world.release(0)
    else:
        world.velocity[0] = 0.0
    for _ in range(60):
        step(world)
    after = np.sqrt(np.mean(scenes.square_strains(world)))
    who = "hand" if hand else "pin"
    return f"| {who} | {substeps} | {np.mean(parts):.2f} | {np.sqrt(np.mean(squares)):.2e} | {after:.2e} |"


def swing(scene: scenes.Scene, seconds: int) -> str:
    """A line for a rope let go from level: energy lost at one substep and at auto, and the ratio of their times."""
    ticks = 60 * seconds
    # Whole runs, every tick counted; the best of three, since others use the machine too.
    best, lost, parts = [np.inf, np.inf], [0.0, 0.0], 0
    for _ in range(3):
        for k, substeps in enumerate((1, AUTO)):
            world, spent, taken = scene.world(substeps=substeps), 0.0, 0
            start = scenes.total_energy(world)
            for _ in range(ticks):
                began = time.perf_counter()
                step(world)
                spent += time.perf_counter() - began
                taken += parts_taken(world)
            best[k], parts = min(best[k], spent), taken
            lost[k] = 100 * (start - scenes.total_energy(world)) / scenes.swing_energy(scene)
    name = f"{scene.name}, {seconds} s"
    return f"| {name} | {lost[0]:.2f} % | {lost[1]:.2f} % | {parts / ticks:.3f} | {best[1] / best[0]:.2f} |"


def auto() -> None:
    """Print what ticks that choose their parts cost and keep."""
    print("\n| swing | lost at 1 | lost at auto | parts | time, auto / 1 |\n|" + "---|" * 5)
    for scene, seconds in ((scenes.rope(50, 1000.0), 7), (scenes.rope(1000), 7), (scenes.rope(100), 2)):
        print(swing(scene, seconds), flush=True)
    print("\n| dragged at 20 m/s by a | substeps | parts | RMS stretch | 1 s after |\n|" + "---|" * 5)
    for hand in (True, False):
        for substeps in (1, 8, AUTO):
            print(drag(substeps, hand), flush=True)


def main() -> None:
    """Print one line per scene: ms per tick, RMS and maximum stretch in seconds 5..7, energy lost after 2 s and 7 s."""
    chosen = [*scenes.bench_scenes()[:-1], scenes.rope(100, 5e4), scenes.rope(100, 5e4, vertical=True)]
    print(f"| scene | substeps | ms | RMS stretch | maximum | lost in 2 s | in 7 s |\n|{'---|' * 7}")
    for scene in chosen:
        for substeps in (1, 4) if len(scene.mass) < 200 else (1,):
            world = scene.world(substeps=substeps)
            start, scale = scenes.total_energy(world), scenes.swing_energy(scene)
            squares, times, lost = [], [], {}
            for tick in range(1, 421):
                began = time.perf_counter()
                step(world)
                times.append(time.perf_counter() - began)
                if tick in (120, 420):
                    lost[tick] = (start - scenes.total_energy(world)) / scale
                if tick > 300:
                    squares.append(scenes.square_strains(world))
            row = f"| {scene.name} | {substeps} | {1e3 * np.median(times):.4f} | {np.sqrt(np.mean(squares)):.2e} "
            row += f"| {np.sqrt(np.max(squares)):.2e} | {100 * lost[120]:.2f} % | {100 * lost[420]:.2f} % |"
            print(row, flush=True)
    auto()


if __name__ == "__main__":
    main()
