"""A tick of one substep against pymunk's step at its defaults.

Run by hand: python -m tests.bench.step_ratio [name of a scene ...]. Both engines step the same scene in turns, tick by
tick, in one process; a run's figure is the median tick between second 5 and 7. Prints Markdown and ends with 1 where
the median ratio of the runs is above what is required.
"""

import statistics
import sys
import time

from tests.bench.engines import Running, pymunk_setting, sandbox_setting
from tests.bench.peers import MEASURED_FROM, SECONDS
from tests.bench.scenes import Scene, bridge, lattice, rope

RUNS = 7
# Time of a tick over pymunk's, at most; fixed costs rule the two small ropes.
REQUIRED = ((rope(50, 1000.0), 2.0), (rope(100), 2.0), (bridge(), 1.0), (rope(1000), 1.0), (lattice(32), 6.0))


def seconds_of(running: Running) -> float:
    """Time [s] of one frame."""
    began = time.perf_counter()
    running.frame()
    return time.perf_counter() - began


def run(scene: Scene) -> tuple[float, float]:
    """Median tick [us] of this project and of pymunk, in one run of both."""
    ours, theirs = sandbox_setting(1).build(scene), pymunk_setting(1, 10).build(scene)
    pairs = [(seconds_of(ours), seconds_of(theirs)) for _ in range(60 * SECONDS)][60 * MEASURED_FROM :]
    return 1e6 * statistics.median(pair[0] for pair in pairs), 1e6 * statistics.median(pair[1] for pair in pairs)


def main() -> int:
    """Print the table, and say whether every scene keeps to what is required."""
    kept = True
    print(f"| scene | tick, least..most of {RUNS} runs [us] | pymunk [us] | ratio, median (least..most) | required |")
    print("|---|---|---|---|---|")
    for scene, required in REQUIRED:
        if sys.argv[1:] and scene.name not in sys.argv[1:]:
            continue
        runs = [run(scene) for _ in range(RUNS)]
        ratios = [ours / theirs for ours, theirs in runs]
        ratio = statistics.median(ratios)
        spans = " | ".join(f"{min(column):.1f}..{max(column):.1f}" for column in zip(*runs, strict=True))
        spread = f"{min(ratios):.2f}..{max(ratios):.2f}"
        print(f"| {scene.name} | {spans} | {ratio:.2f} ({spread}) | {required:g} |", flush=True)
        kept = kept and ratio <= required
    return 0 if kept else 1


if __name__ == "__main__":
    sys.exit(main())
