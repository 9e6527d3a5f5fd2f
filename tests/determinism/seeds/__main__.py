"""Random levels and random commands, run several ways: every bit of every tick must be that of the reference.

Run by hand: python -m tests.determinism.seeds [--seeds 1000] [--first N] [--ticks T] [--ways a,b|all] [--jobs 1]

Each seed gives a level and commands, which are recorded: the reference. Then the recording is run again:

library      in another session, with the kernels of the reference
undone       with gestures undone and redone, time taken back, and other futures that are left again
saved        verified whole, from the middle, and continued where it was cut off; with its level written and read
cramped      with the room that a step needs found anew in every tick
web          with the calls of kernels made in WebAssembly too, by node
interpreted  with interpreted kernels, for a few ticks
generic      with the library that every processor of this kind runs
checked      with kernels that are compiled here and look at every index, some 20 s the first time

--plant TICK:ARRAY:SLOT puts one ulp into each of these, which must be named. Exit code 1: a bit differs.
"""

import argparse
import functools
import sys
import tempfile
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from sandbox.physics import jit
from sandbox.physics.settings import AUTO
from sandbox.session.replay.recording import Replay
from tests.determinism.elsewhere import WEB, Missing
from tests.determinism.seeds.child import CHILD_WAYS, run_there
from tests.determinism.seeds.difference import Plant, Watch
from tests.determinism.seeds.player import recording
from tests.determinism.seeds.ways import WAYS, Result, failure, run_way

ALL_WAYS = (*WAYS, *CHILD_WAYS)
# Ways that take long run with a sample: with every 20th or 50th seed, from the first one on.
EVERY = {"web": 20, "interpreted": 50}
# Interpreted kernels are some hundred times slower: particles times steps, where things touch and where they do not.
TOUCHING_WORK, WORK = 600, 3_000
# Of the line that says how far it is [characters].
WIDTH = 60


@dataclass(frozen=True)
class Task:
    """What is to be done with each seed: ticks, ways, the fault to plant, and where recordings are kept."""

    first: int
    seeds: int
    ticks: int
    ways: tuple[str, ...]
    plant: str
    folder: Path

    def ways_of(self, seed: int) -> list[str]:
        """The ways of a seed: those that take long run with a sample."""
        return [way for way in self.ways if (seed - self.first) % EVERY.get(way, 1) == 0]


@dataclass
class Seed:
    """What came of one seed. interpreted: ticks that interpreted kernels are to run."""

    seed: int
    results: list[Result] = field(default_factory=list)
    interpreted: int = 0


@dataclass
class Tally:
    """What came of each way."""

    results: dict[str, list[Result]]
    plant: str
    done: int = 0

    def add(self, result: Result) -> None:
        """Count a result; a difference gets two lines."""
        self.results.setdefault(result.way, []).append(result)
        if result.difference is not None:
            clear_line()
            print(f"{result.difference}\n    {result.difference.command(self.plant)}", flush=True)

    @property
    def differing(self) -> int:
        """Runs that differ."""
        return sum(each.difference is not None for found in self.results.values() for each in found)

    def say(self, seeds: int, doing: str) -> None:
        """Tell how far it is, on one line."""
        told = f"{self.done:,} of {seeds:,} seeds, {self.differing:,} differ, {doing}"
        print(f"\r{told:<{WIDTH}}", end="", file=sys.stderr, flush=True)

    def lines(self) -> Iterator[str]:
        """The summary, a line for each way."""
        for way, found in self.results.items():
            ticks, checks = sum(each.ticks for each in found), sum(each.checks for each in found)
            differ = sum(each.difference is not None for each in found)
            planted = f", planted in {sum(each.put for each in found):,}" if self.plant else ""
            yield f"{way}: {len(found):,} seeds, {ticks:,} ticks, {checks:,} checks, {differ:,} differ{planted}"


def clear_line() -> None:
    """Take the line away that says how far it is."""
    print(f"\r{'':<{WIDTH}}\r", end="", file=sys.stderr, flush=True)


def check_seed(seed: int, task: Task) -> Seed:
    """Record a seed and run it in the ways that need no other process."""
    found = Seed(seed)
    try:
        with np.errstate(all="ignore"):
            replay = recording(seed, task.ticks, task.folder)
    except Exception as error:
        found.results.append(Result("recording", 0, 0, failure(seed, "recording", task.ticks, error)))
        return found
    found.interpreted = _interpreted_ticks(replay)
    plant, ways = Plant.read(task.plant) if task.plant else None, task.ways_of(seed)
    found.results += [run_way(way, Watch(replay, plant), seed, task.folder) for way in ways if way in WAYS]
    if not set(ways) & set(CHILD_WAYS):
        Path(replay.source).unlink()
    return found


def _interpreted_ticks(replay: Replay) -> int:
    settings, particles = replay.level.settings, max(len(replay.state(0).mass), 1)
    work = TOUCHING_WORK if replay.level.has_contacts else WORK
    steps = 2 if settings.substeps == AUTO else settings.substeps
    return min(replay.ticks, max(1, work // (particles * int(steps))))


def _each(task: Task, jobs: int) -> Iterator[Seed]:
    """What comes of every seed, in some processes."""
    seeds, run = range(task.first, task.first + task.seeds), functools.partial(check_seed, task=task)
    if jobs == 1:
        yield from map(run, seeds)
        return
    with ProcessPoolExecutor(jobs) as pool:
        yield from pool.map(run, seeds)


def check(task: Task, jobs: int, tally: Tally) -> None:
    """Run every seed every way."""
    interpreted = {}
    for found in _each(task, jobs):
        tally.done += 1
        interpreted[found.seed] = found.interpreted
        for result in found.results:
            tally.add(result)
        tally.say(task.seeds, "in this process" if jobs == 1 else f"in {jobs} processes")
    for way in (way for way in CHILD_WAYS if way in task.ways):
        chosen = {seed: ticks for seed, ticks in interpreted.items() if ticks and way in task.ways_of(seed)}
        ticks_of = chosen if way == "interpreted" else dict.fromkeys(chosen, task.ticks)
        tally.say(task.seeds, way)
        try:
            for number, (_, result) in enumerate(run_there(way, task.folder, ticks_of, task.plant)):
                tally.add(result)
                tally.say(task.seeds, f"{way} {number + 1}")
        except Missing as fault:
            clear_line()
            print(f"{way}: left out for want of {fault}", flush=True)
        except RuntimeError as error:
            tally.add(Result(way, 0, 0, failure(task.first, way, task.ticks, error)))


def _ways(text: str) -> tuple[str, ...]:
    chosen = ALL_WAYS if text == "all" else tuple(text.split(","))
    unknown = set(chosen) - set(ALL_WAYS)
    if unknown:
        raise argparse.ArgumentTypeError(f"unknown: {', '.join(sorted(unknown))}; there are {', '.join(ALL_WAYS)}")
    return chosen


def _plant(text: str) -> str:
    try:
        Plant.read(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from None
    return text


def _installed(ways: tuple[str, ...]) -> tuple[str, ...]:
    """The ways without WebAssembly where it cannot be run, with a line that says why."""
    if "web" not in ways:
        return ways
    try:
        if jit.way() != "library":
            raise Missing("the library, which is not used here")
        WEB.command()
    except Missing as fault:
        print(f"web: left out for want of {fault}", flush=True)
        return tuple(way for way in ways if way != "web")
    return ways


def main(arguments: list[str] | None = None) -> int:
    """Run what is asked for, print the differences and the figures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=1000)
    parser.add_argument("--first", type=int, default=0, metavar="SEED")
    parser.add_argument("--ticks", type=int, default=60, help="of each seed")
    parser.add_argument("--ways", type=_ways, default=ALL_WAYS, help=f"{','.join(ALL_WAYS)}; default: all")
    parser.add_argument("--jobs", type=int, default=1, help="processes")
    parser.add_argument("--plant", type=_plant, metavar="TICK:ARRAY:SLOT", help="put one ulp there")
    given = parser.parse_args(arguments)
    began, tally = time.monotonic(), Tally({}, given.plant or "")
    with tempfile.TemporaryDirectory() as folder:
        ways = _installed(given.ways)
        task = Task(given.first, given.seeds, given.ticks, ways, tally.plant, Path(folder))
        check(task, given.jobs, tally)
    clear_line()
    print("\n".join(tally.lines()))
    print(
        f"{given.seeds:,} seeds from {given.first} on, {given.ticks} ticks each, reference: {jit.way()}; "
        f"{tally.differing:,} differ; {time.monotonic() - began:.0f} s"
    )
    return int(tally.differing > 0)


if __name__ == "__main__":
    sys.exit(main())
