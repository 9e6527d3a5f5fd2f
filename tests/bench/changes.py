"""What a change of topology costs in the tick after it. Run by hand: python -m tests.bench.changes [LEVEL ...]

For each level the time of a tick, by how much more the tick after a grab, a release, a cut and a pin takes, all medians
in ms, and how many kernels Python calls in a tick; then a jelly of 64 x 64 cells: a grab of it, and how many times as
long as its falling a tick takes while it is held.
"""

import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from sandbox import load_level
from sandbox.physics.step import step
from sandbox.physics.world import World
from sandbox.session.session import Session
from tests.support.calls import counted_calls
from tests.support.contact_scenes import add_jelly, world

LEVELS = Path(__file__).resolve().parents[2] / "levels"
TIMES = 7
# Ticks between two changes: the second one after a change may still find too little room.
APART = 4
HAND = 0.3


def milliseconds(action: Callable[[], object]) -> float:
    """Wall-clock time of a call [ms]."""
    began = time.perf_counter()
    action()
    return 1e3 * (time.perf_counter() - began)


def rested(built: World) -> float:
    """The shortest of the ticks between two changes [ms]."""
    return min(milliseconds(lambda: step(built)) for _ in range(APART))


def costs(built: World) -> tuple[float, dict[str, float]]:
    """The median tick [ms], and by how much more the ticks after changes take, by kind."""
    free = np.flatnonzero((built.inverse_mass > 0.0) & built.particle_active)
    springs = np.flatnonzero(built.spring_active & (built.material >= 0))
    ticks: list[float] = []
    found: dict[str, list[float]] = {"grab": [], "release": [], "cut": [], "pin": []}

    def time_of(kind: str, change: Callable[[], object]) -> None:
        ticks.append(rested(built))
        change()
        found[kind].append(milliseconds(lambda: step(built)))

    for k in range(TIMES):
        held = int(free[37 * k % len(free)])
        x, y = built.position[held].tolist()
        time_of("grab", lambda held=held, x=x, y=y: built.hold(0, held, (x, y), radius=HAND))
        time_of("release", lambda: built.release(0))
    for k in range(TIMES):
        if len(springs):
            time_of("cut", lambda k=k: built.cut([int(springs[101 * k % len(springs)])]))
        time_of("pin", lambda k=k: built.pin(int(free[53 * k % len(free)])))
    tick = float(np.median(ticks))
    return tick, {kind: float(np.median(each)) - tick for kind, each in found.items() if each}


def played(name: str) -> str:
    """The line of a level."""
    built = Session(load_level(LEVELS / f"{name}.json")).world
    for _ in range(60):
        step(built)
    with counted_calls() as calls:
        step(built)
    tick, more = costs(built)
    cells = " | ".join(f"{more[kind]:+.2f}" if kind in more else "-" for kind in ("grab", "release", "cut", "pin"))
    return f"| {name} | {tick:.3f} | {cells} | {len(calls)} |"


def large_jelly() -> str:
    """A grab of a falling jelly of 64 x 64 cells [ms], and its tick while it is held in falling ticks."""
    built = world()
    jelly = add_jelly(built, (0.0, 0.0), size=(6.4, 6.4))
    built.reserve_grabs()
    for _ in range(20):
        step(built)
    falling = rested(built)
    middle = (jelly.start + jelly.stop) // 2
    x, y = built.position[middle].tolist()
    built.hold(0, middle, (x, y), radius=HAND)
    grab = milliseconds(lambda: step(built)) - falling
    return f"jelly of {jelly.stop - jelly.start} particles: grab {grab:+.2f} ms, held {rested(built) / falling:.2f}"


def main(names: list[str]) -> None:
    """Print the table."""
    print("| level | tick | grab | release | cut | pin | calls |\n|---|---|---|---|---|---|---|")
    for name in names or sorted(path.stem for path in LEVELS.glob("*.json")):
        print(played(name), flush=True)
    print(f"\n{large_jelly()}")


if __name__ == "__main__":
    main(sys.argv[1:])
