"""Checks level files: stability, checks, and whether the solution beside a level wins it; and golden files."""

import time
from collections.abc import Generator, Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from sandbox.level.assembly.build_world import build_world
from sandbox.level.checks import CheckResult
from sandbox.level.document.model import Level
from sandbox.level.plan.surfaces import zones_with_water
from sandbox.level.reading.files import LevelError, level_path, read_level
from sandbox.physics.analysis.beginning import overlap_text, overlaps, sinking, sinking_text
from sandbox.physics.analysis.stability import report
from sandbox.physics.step import step
from sandbox.physics.world import World
from sandbox.session.check_run import checks_as_they_end
from sandbox.session.compare.rollback import roll_back_level
from sandbox.session.golden import SUFFIX, GoldenError, differences, read_golden
from sandbox.session.looking import SECONDS, Looking
from sandbox.session.outcome import outcome_data, vain_goal
from sandbox.session.probe import finite
from sandbox.session.replay.reader import read_replay
from sandbox.session.replay.recording import ReplayError
from sandbox.session.solution import Proof, Verdict, keep_solution, solution_of, try_goal
from sandbox.session.worker_pool import done_in_order

# Said of a level with a goal that lets hands do everything.
OPEN = "may do everything, so whoever pauses puts things where they win: say in hands what the level is about"


@dataclass(frozen=True)
class LevelReport:
    """The report on a level: lines about it, or the faults for which it was refused.

    passed: whether its checks held. data: the same for programs, ready for JSON.
    """

    data: dict[str, Any]
    lines: tuple[str, ...] = ()
    faults: tuple[str, ...] = ()
    passed: bool = False


def check_level(name: str, rollback: int | None = None) -> LevelReport:
    """Validate a level file or a shipped level, report its stability and run its checks; of a golden file compare.

    rollback: random hands play it besides, and it goes back so many ticks at each.
    """
    start = time.perf_counter()
    if name.endswith(SUFFIX):
        return _check_golden(name, start)
    try:
        path = level_path(name)
        level = read_level(path)
    except LevelError as error:
        return LevelReport({"file": name, "result": "refused", "faults": error.faults}, faults=tuple(error.faults))
    world = build_world(level)
    stability, beginning = report(world), tuple(_beginning(level, world))
    timed = _timed(level)
    results, goal, vain = [result for result, _ in timed], try_goal(level, Path(path)), vain_goal(level)
    again = None if rollback is None else roll_back_level(level, rollback)
    lines = (
        f"{name}: valid: {level.name}",
        f"  stability  {stability.text}",
        f"  in a single pass Cs = Cd would be stable up to {stability.proven_limit:.3g} proven, "
        f"{stability.estimated_limit:.3g} estimated, {stability.article_limit:.3g} by the article's 1/(n+1)",
        *(f"  start      {line}" for line in beginning),
        *(f"  check      {result.text}" for result in results),
        *([f"  goal       {goal.text if goal else vain}"] if goal or vain else []),
        *([f"  hands      {OPEN}"] if level.leaves_all_open else []),
        *([f"  rollback   {again}"] if again else []),
    )
    passed = all(result.passed for result in results) and (goal is None or goal.passed)
    passed = passed and (again is None or again.found is None)
    data: dict[str, Any] = {
        "file": name, "result": "passed" if passed else "failed", "level": level.name, "stability": asdict(stability),
        "start": list(beginning),
        "checks": [{**_as_data(result), "wall_seconds": wall} for result, wall in timed],
        "wall_seconds": time.perf_counter() - start,
    }  # fmt: skip
    if goal is not None:
        won = outcome_data(goal.outcome, level.settings.tick_rate)
        data["goal"] = {"passed": goal.passed, "outcome": won, "text": goal.text}
    elif vain:
        data["goal"] = {"passed": True, "outcome": None, "text": vain}
    if level.leaves_all_open:
        data["hands"] = OPEN
    if again is not None:
        data["rollback"] = {"passed": again.found is None, "ticks": again.ticks, "text": str(again)}
    return LevelReport(finite(data), lines, passed=passed)


def proved_level(name: str, look: bool = False) -> Generator[float, None, LevelReport | None]:
    """Run the solution beside a level, a slice at a time: the part that is done, 0..1; None: no rule wins the level.

    look: where it does not win, look for a way that does, from it on, and keep that in its place. Raises OSError.
    """
    try:
        path = Path(level_path(name))
        level = read_level(path)
    except LevelError as error:
        return LevelReport({"file": name, "result": "refused", "faults": error.faults}, faults=tuple(error.faults))
    if not level.has_goal:
        return None
    found, lines, replay, where = Verdict(False, "has no solution"), [], None, solution_of(path)
    if where.exists():
        try:
            replay = read_replay(where)
            proof = Proof(level, replay)
            for _ in proof.work:
                yield proof.done
            found = proof.verdict or found
        except ReplayError as error:
            found = Verdict(False, f"{where.name}: {error.faults[0]}")
    lines.append(f"{name}: {found.text}")
    if look and not found.passed:
        looking = Looking(level, *((replay.script, replay.ticks) if replay else ()))
        for _ in looking.work:
            yield looking.done
        if looking.found is not None:
            found = yield from keep_solution(path, looking.found.script, looking.found.ticks)
            lines.append(f"  found      {found.text}, after {looking.runs:,} runs")
        else:
            lines.append(f"  found      no way in {looking.runs:,} runs, {SECONDS:g} s of the processor")
    data = {
        "file": name, "result": "won" if found.passed else "failed", "level": level.name, "text": found.text,
        "outcome": outcome_data(found.outcome, level.settings.tick_rate),
    }  # fmt: skip
    return LevelReport(finite(data), tuple(lines), passed=found.passed)


def _beginning(level: Level, world: World) -> Iterator[str]:
    """What the beginning of a run shows that its author may not have meant, in sentences; it takes the first tick."""
    pools = zones_with_water(level)
    for sinks in sinking(world):
        if sinks is not None:
            yield sinking_text(world, *sinks, pools[sinks[1].pool].id)
    step(world)
    found = overlaps(world)
    if found:
        yield overlap_text(world, found)


def _check_golden(name: str, start: float) -> LevelReport:
    """Run a golden file, and compare within its tolerances."""
    try:
        golden = read_golden(Path(name))
        found = differences(golden.file, golden.measured())
    except (GoldenError, LevelError, ReplayError) as error:
        return LevelReport({"file": name, "result": "refused", "faults": error.faults}, faults=tuple(error.faults))
    data = {
        "file": name,
        "result": "failed" if found else "passed",
        "level": golden.level.name,
        "differences": found,
        "wall_seconds": time.perf_counter() - start,
    }
    lines = [f"  FAILS      {line}" for line in found] or ["  all is within its tolerance"]
    return LevelReport(data, (f"{name}: {golden.level.name}", *lines), passed=not found)


def _timed(level: Level) -> list[tuple[CheckResult, float]]:
    """The results of the checks, in the order of the file, and how long each took [s] after the one known before it."""
    found: dict[int, tuple[CheckResult, float]] = {}
    before = time.perf_counter()
    for known in checks_as_they_end(level):
        if known is not None:
            now = time.perf_counter()
            found[known[0]], before = (known[1], now - before), now
    return [found[number] for number in sorted(found)]


def _as_data(result: CheckResult) -> dict[str, Any]:
    """A check that was run, for programs."""
    check = result.check
    return {
        "name": check.name, "metric": check.metric, "passed": result.passed, "value": result.value, "at": result.at,
        "text": result.text,
    }  # fmt: skip


def check_levels(
    names: Sequence[str], processes: int, rollback: int | None = None
) -> Generator[LevelReport, None, None]:
    """The report on each level, as `check_level` gives it: see `done_in_order`."""
    return done_in_order(check_level, [(name, rollback) for name in names], processes)
