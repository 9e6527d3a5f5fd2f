"""A hundred runs that are switched from interpreted to compiled kernels at random ticks: do their recordings verify?"""

import subprocess
import sys
import tempfile
from pathlib import Path

from tests.support.switching import LEVELS

ROOT = Path(__file__).resolve().parents[2]
RUNS, TICKS = 100, 60


def main() -> None:
    """Print a line for each run, and how many verified."""
    lines: list[str] = []
    for seed in range(RUNS):
        names = LEVELS[: RUNS - len(lines)]
        if not names:
            break
        with tempfile.TemporaryDirectory() as folder:
            command = [sys.executable, "-m", "tests.support.switching", folder, str(seed), str(TICKS), *names]
            ended = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
        lines += ended.stdout.splitlines()
        print(ended.stdout, end="", flush=True)
    print(f"{sum(line.endswith(': None') for line in lines)} of {len(lines)} runs verify")


if __name__ == "__main__":
    main()
