"""Random sessions with bodies that join, leave and are pushed, dragged, cut, set, undone and redone: all must verify.

Run by hand: python -m tests.abuse.parts [--seeds 100] [--ticks 150] [--interpreted 5]. The first seeds are verified by
interpreted kernels as well, over their first ticks, which takes a minute each.
"""

import argparse
import os
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

from sandbox.physics.solvers import SOLVERS
from sandbox.session.compare.comparison import verify
from sandbox.session.replay.reader import read_replay
from sandbox.session.session import Session
from tests.support.parts import RandomPlayer, furnished

# Ticks of a session that interpreted kernels verify.
INTERPRETED_TICKS = 25


def play(seed: int, ticks: int, path: Path) -> Session:
    """Record a random session, of a solver that goes by the seed."""
    session = Session(furnished(sorted(SOLVERS)[seed % len(SOLVERS)]))
    player = RandomPlayer(session, seed)
    session.record_to(path)
    for _ in range(ticks):
        player.act()
        session.advance()
    session.stop_recording()
    return session


def main(arguments: list[str] | None = None) -> int:
    """Print a line for each session that does not verify, then how many commands of each kind; 1 where one does not."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--all", action="store_true", help="the usual")
    parser.add_argument("--seeds", type=int, default=100)
    parser.add_argument("--ticks", type=int, default=150)
    parser.add_argument("--interpreted", type=int, default=5)
    given = parser.parse_args(arguments)
    counts: Counter[str] = Counter()
    failed, interpreted, began = 0, 0, time.process_time()
    with tempfile.TemporaryDirectory() as folder:
        for seed in range(given.seeds):
            path = Path(folder) / f"{seed}.replay"
            session = play(seed, given.ticks, path)
            counts.update(entry.command.type for entry in session.history.log)
            found = verify(read_replay(path))
            if found is not None:
                failed += 1
                print(f"seed {seed}: {found}", flush=True)
            if seed < given.interpreted:
                play(seed, INTERPRETED_TICKS, path)
                plain = os.environ | {"SANDBOX_KERNELS": "interpreted"}
                command = [sys.executable, "-m", "sandbox", "replay", str(path)]
                ended = subprocess.run(command, env=plain, capture_output=True, text=True, check=False)
                interpreted += ended.returncode == 0
                if ended.returncode:
                    print(f"seed {seed}, interpreted: {ended.stdout}{ended.stderr}", flush=True)
    print(
        f"{given.seeds - failed} of {given.seeds} sessions verify, {interpreted} of them interpreted as well; ", end=""
    )
    print(f"{time.process_time() - began:.0f} s; " + ", ".join(f"{n} {name}" for name, n in counts.most_common()))
    return int(failed > 0 or interpreted < min(given.interpreted, given.seeds))


if __name__ == "__main__":
    sys.exit(main())
