"""Recordings run again in a process of its own, where SANDBOX_KERNELS says how kernels run.

python -m tests.determinism.seeds.child FOLDER PLANT SEED:TICKS ...   PLANT: TICK:ARRAY:SLOT, or nothing, in quotes

For each recording SEED.replay.gz of the folder it prints a line of JSON: see `Answer`. Where a tick differs, the state
arrays of that tick are written to SEED.npz: only the process that recorded can say what they should be.
"""

import importlib.util
import json
import os
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from sandbox.session.replay.reader import read_replay
from sandbox.session.session import Session
from tests.determinism.elsewhere import Missing
from tests.determinism.seeds.difference import Difference, Plant, Watch, arrays_of, first_bit
from tests.determinism.seeds.ways import Result

ROOT = Path(__file__).resolve().parents[3]
# Ways that need another process, by what SANDBOX_KERNELS is for them.
CHILD_WAYS = ("interpreted", "generic", "checked")


@dataclass(frozen=True)
class Answer:
    """What came of one recording: ticks that were run, states compared, and the tick that differs, or None.

    put: a fault was planted.
    """

    seed: int
    ticks: int
    checks: int
    differs: int | None
    put: bool


def run_there(way: str, folder: Path, ticks_of: dict[int, int], plant: str = "") -> Iterator[tuple[int, Result]]:
    """Run recordings of a folder, for some ticks each, in one child process: seeds and results, as they come.

    Raises Missing where the way is not installed, RuntimeError where the process ends before its time.
    """
    if way == "checked" and importlib.util.find_spec("ziglang") is None:
        raise Missing("zig")
    wanted = [f"{seed}:{ticks}" for seed, ticks in ticks_of.items()]
    command = [sys.executable, "-m", f"{__package__}.child", str(folder), plant, *wanted]
    environment = os.environ | {"SANDBOX_KERNELS": way}
    with subprocess.Popen(command, cwd=ROOT, env=environment, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        for line in process.stdout:
            answer = Answer(**json.loads(line))
            yield answer.seed, _result(way, folder, ticks_of, answer)
    if process.returncode:
        raise RuntimeError(f"{way}: the process ended with {process.returncode}")


def _result(way: str, folder: Path, ticks_of: dict[int, int], answer: Answer) -> Result:
    result = Result(way, answer.ticks, answer.checks, put=answer.put)
    if answer.differs is not None:
        replay = read_replay(folder / f"{answer.seed}.replay.gz")
        with np.load(folder / f"{answer.seed}.npz") as arrays:
            divergence = first_bit(replay, answer.differs, dict(arrays))
        result.difference = Difference(answer.seed, way, replay.ticks, divergence)
    return result


def run_here(folder: Path, seed: int, ticks: int, plant: Plant | None) -> Answer:
    """Run a recording of a folder again in this process, up to the first tick that differs."""
    watch = Watch(read_replay(folder / f"{seed}.replay.gz"), plant)
    session, differs = Session(watch.replay.level, watch.replay.script), None
    with np.errstate(all="ignore"):
        equal = watch.is_equal(session.world)
        while equal and session.tick < ticks:
            session.advance()
            equal = watch.is_equal(session.world)
    if not equal:
        differs = session.tick
        np.savez(folder / f"{seed}.npz", **arrays_of(session.world))
    return Answer(seed, session.tick, watch.checks, differs, watch.put)


if __name__ == "__main__":
    place, fault, *seeds = sys.argv[1:]
    for each in seeds:
        number, _, length = each.partition(":")
        print(
            json.dumps(asdict(run_here(Path(place), int(number), int(length), Plant.read(fault) if fault else None))),
            flush=True,
        )
