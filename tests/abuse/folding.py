"""Does anything fold? Drops, squeezes, throws and stirs of soft bodies; every triangle is looked at in every tick.

Run by hand: python -m tests.abuse.folding [--all] [--solver NAME]. Without --all, a seeded sample. Prints a
line for each run that breaks a limit, and a summary: least area of any triangle as a share of that wanted, and for the
direct solver with Cs <= Cd the highest energy as a multiple of the start (not of what is stirred: a hand does work).
No outline stays wound either, but in a single pass, in which stiff springs explode.
"""

import argparse
import itertools
import sys
import time

import numpy as np

from sandbox.physics.solvers import SOLVERS
from tests.support.folding import COEFFICIENTS, DEEDS, SHAPES, WOUND_AT_MOST, play

SUBSTEPS = (1, 4)
SECONDS = 3.0
SAMPLE = 24


def main(arguments: list[str] | None = None) -> int:
    """Run the table; 1 where a triangle turned over, an outline stayed wound, or energy was gained."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--all", action="store_true")
    parser.add_argument("--solver", choices=list(SOLVERS))
    given = parser.parse_args(arguments)
    solvers = [given.solver] if given.solver else list(SOLVERS)
    cases = list(itertools.product(solvers, DEEDS, SHAPES, COEFFICIENTS, SUBSTEPS))
    chosen = np.random.default_rng(0).choice(len(cases), size=min(SAMPLE, len(cases)), replace=False)
    failed, least, most, began = 0, 1.0, 0.0, time.process_time()
    for seed in range(len(cases)) if given.all else sorted(chosen.tolist()):
        solver, deed, shape, coefficients, substeps = cases[seed]
        found = play(deed, shape, coefficients, seconds=SECONDS, seed=seed, solver=solver, substeps=substeps)
        bounded = solver == "direct" and deed != "stirred"
        least, most = min(least, found.least_area), max(most, found.most_energy if bounded else 0.0)
        gained = bounded and not found.most_energy <= 1.0 + 1e-9
        wound = found.wound > WOUND_AT_MOST and solver != "single_pass"
        if not found.least_area > 0.0 or wound or gained:
            failed += 1
            print(f"{solver} {deed} {shape} {coefficients} {substeps} substeps: {found}", flush=True)
    runs = len(cases) if given.all else len(chosen)
    print(f"{failed} of {runs} runs break a limit; least area {least:.2g}, most energy {most:.9f} (direct)")
    print(f"{time.process_time() - began:.0f} s")
    return int(failed > 0)


if __name__ == "__main__":
    sys.exit(main())
