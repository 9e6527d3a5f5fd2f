"""Energy of random closed boxes: what they have at most against their start, what leaves them, and the slowest ticks.

Run by hand: python -m tests.bench.contact_energy [solver] [boxes] [seconds]. Prints a line for each box that has more
than it may or that something leaves, then Markdown.
"""

import sys
import time

import numpy as np

from sandbox.physics.step import step
from tests.support.closed_boxes import allowed, energy, outside, random_box


def run(seed: int, solver: str, seconds: float) -> tuple[float, float, int, float, float, bool]:
    """Most energy over what is allowed and over the start's, most particles outside, median and slowest tick [ms]."""
    box = random_box(seed, solver)
    over, most, left, spent = 0.0, 0.0, 0, []
    for _ in range(round(60 * seconds)):
        began = time.process_time()
        step(box.world)
        spent.append(1e3 * (time.process_time() - began))
        present = energy(box.world)
        over, most = max(over, present / allowed(box)), max(most, present / box.energy)
        left = max(left, outside(box.world))
    return over, most, left, float(np.median(spent)), max(spent[1:]), box.bouncy


def main(solver: str = "direct", boxes: str = "200", seconds: str = "5") -> None:
    """Print the table."""
    random_box(0, solver)
    rows = []
    for seed in range(int(boxes)):
        row = run(seed, solver, float(seconds))
        rows.append(row)
        if not row[0] <= 1.0 or row[2]:
            print(f"box {seed}: {row[0]:.3f} of the allowed, {row[1]:.3f} of the start, {row[2]} outside", flush=True)
    print("| springs | boxes | energy / allowed | / start | boxes over | outside | tick [ms] | 99 % | most |")
    print("|---|---|---|---|---|---|---|---|---|")
    for name, bouncy in (("all Cs <= Cd", False), ("any", True)):
        chosen = [row for row in rows if row[5] == bouncy]
        if chosen:
            over, most, left, middle, slow, _ = (np.array(column) for column in zip(*chosen, strict=True))
            print(
                f"| {name} | {len(chosen)} | {over.max():.4f} | {most.max():.4f} | {int((over > 1.0).sum())} | "
                f"{int(left.sum())} | {np.median(middle):.1f} | {np.quantile(slow, 0.99):.0f} | {slow.max():.0f} |"
            )


if __name__ == "__main__":
    main(*sys.argv[1:])
