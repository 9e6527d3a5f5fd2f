"""A program: runs of several levels that are interpreted until some tick and compiled from there; recordings verify.

python -m tests.support.switching FOLDER SEED TICKS LEVEL.. ; one process can switch once only, all its runs with it.
"""

import random
import sys
from pathlib import Path

import numpy as np

from sandbox.physics import jit

LEVELS = (
    "rope", "truss_bridge", "suspension_bridge", "ferris_wheel", "spider_web", "breaking_bridge", "girder",
    "hooke_comparison", "side_by_side", "mast", "walker", "hourglass",
)  # fmt: skip


def main(folder: str, seed: str, ticks: str, *names: str) -> None:
    """Play each level until a tick of its own, switch, play on to the end, and verify what was recorded."""
    jit.start_interpreted()
    from sandbox.level.reading.files import load_level
    from sandbox.session.replay.reader import read_replay
    from sandbox.session.replay.verify import verify
    from sandbox.session.session import Session
    from tests.support.play import play

    at = random.Random(int(seed))
    sessions = {name: Session(load_level(name)) for name in names}
    switched = {name: at.randrange(1, int(ticks)) for name in names}
    with np.errstate(over="ignore", invalid="ignore"):
        for name, session in sessions.items():
            session.record_to(Path(folder) / f"{name}.replay.jsonl")
            play(session, switched[name])
        assert jit.switch_to_compiled()
        for name, session in sessions.items():
            session.world.drop_caches()
            play(session, int(ticks))
            path = session.stop_recording()
            assert path is not None
            print(f"{name}, switched at tick {switched[name]}:", verify(read_replay(path)))


if __name__ == "__main__":
    main(*sys.argv[1:])
