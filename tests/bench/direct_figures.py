"""Stretch, time and loss of the direct solver. Run by hand: python -m tests.bench.direct_figures."""

import time

import numpy as np

from sandbox.physics.step import step
from tests.bench import scenes


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


if __name__ == "__main__":
    main()
