"""Solutions: a recording beside a level's file that wins the level."""

from dataclasses import dataclass
from pathlib import Path

from sandbox.level.document.model import Level
from sandbox.session.commands import CommandError
from sandbox.session.outcome import Outcome, outcome, outcome_text
from sandbox.session.replay.reader import read_replay
from sandbox.session.replay.recording import ReplayError
from sandbox.session.session import Session

SUFFIX = ".solution.replay.gz"


@dataclass(frozen=True)
class GoalResult:
    """What came of a level's goal: a line that says it, and whether it passed; without a solution it does."""

    passed: bool
    text: str
    outcome: Outcome | None


def solution_of(path: Path) -> Path:
    """Where the solution of a level's file is kept."""
    return path.with_name(f"{path.name.removesuffix('.json')}{SUFFIX}")


def has_goal(level: Level) -> bool:
    """Whether a rule of a level wins it."""
    return any(action.win is not None for rule in level.rules for action in rule.then)


def try_goal(level: Level, path: Path) -> GoalResult | None:
    """Run a level by the solution beside its file, until it is won or lost; None for a level without a goal."""
    if not has_goal(level):
        return None
    solution = solution_of(path)
    if not solution.exists():
        return GoalResult(True, f"not tried: there is no {solution.name}", None)
    try:
        replay = read_replay(solution)
        session = Session(level, script=replay.script)
        while outcome(level, session.world) is None and session.tick < replay.ticks:
            session.advance()
    except (ReplayError, CommandError) as error:
        return GoalResult(False, f"FAILS: {solution.name}: {error.faults[0]}", None)
    found = outcome(level, session.world)
    if found is None:
        seconds = replay.ticks / level.settings.tick_rate
        return GoalResult(False, f"FAILS: not won in the {seconds:.2f} s of {solution.name}", None)
    said = outcome_text(found, level.settings.tick_rate)
    return GoalResult(found.is_won, f"{'' if found.is_won else 'FAILS: '}{said}, by {solution.name}", found)
