"""Going back in time: how long a seek takes after ten minutes of play, what the states kept for it need, and playing
backwards. Run with `--quick` for one minute.
"""

import random
import sys
import time
from collections.abc import Sequence
from statistics import median

from sandbox.level.reading.files import load_level
from sandbox.physics.snapshot import state_hash
from sandbox.session.session import Session

LEVELS = ("truss_bridge", "jelly_pile")
MINUTES, SEEKS = 10.0, 200


def kept_bytes(session: Session) -> int:
    """What the states of a run that are kept need [bytes]; an array that several share counts once."""
    arrays = {
        id(array): array.nbytes for kept in session.keyframes(0, session.last_tick) for array in kept.arrays.values()
    }
    return sum(arrays.values())


def timed(session: Session, ticks: Sequence[int]) -> list[float]:
    """Processor times [ms] of seeking ticks one after another."""
    times = []
    for tick in ticks:
        start = time.process_time()
        session.seek(tick)
        times.append(1e3 * (time.process_time() - start))
    return times


def figures(name: str, minutes: float) -> None:
    """Print the figures of a level."""
    session = Session(load_level(name))
    ticks = round(minutes * 60.0 * session.world.settings.tick_rate)
    rng = random.Random(1)
    probes = {rng.randrange(ticks): "" for _ in range(5)}
    while session.tick < ticks:
        session.advance()
        if session.tick in probes:
            probes[session.tick] = state_hash(session.world)
    for tick, expected in probes.items():
        session.seek(tick)
        assert state_hash(session.world) == expected, f"{name}: tick {tick} is another one after a seek"
    sought = timed(session, [rng.randrange(ticks) for _ in range(SEEKS)])
    end = ticks - 30
    back = timed(session, range(end, end - 300, -1))
    print(
        f"{name}: {ticks:,} ticks, {len(session.keyframes(0, ticks)):,} states in {kept_bytes(session) / 1e6:.0f} MB; "
        f"a seek {median(sought):.1f} ms, longest {max(sought):.1f}; "
        f"a tick back {sum(back) / len(back):.2f} ms, longest {max(back):.1f}"
    )


if __name__ == "__main__":
    for level in LEVELS:
        figures(level, 1.0 if "--quick" in sys.argv else MINUTES)
