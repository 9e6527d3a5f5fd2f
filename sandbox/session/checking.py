"""Checking: runs a level and holds the checks that it carries against what was measured."""

from sandbox.level.checks import CheckDef, CheckResult, check_ticks, evaluate
from sandbox.level.format.model import Level
from sandbox.session.session import Session
from sandbox.session.summary import Summary, particle_metric, run


def run_checks(level: Level) -> list[CheckResult]:
    """Run the level by itself as long as each check asks for, and judge; in the order of the file."""
    measured: dict[int, tuple[Session, Summary]] = {}

    def measure(check: CheckDef) -> float:
        ticks = check_ticks(check, level.settings.tick_rate)
        if ticks not in measured:
            session = Session(level)
            measured[ticks] = session, run(session, ticks)
        session, summary = measured[ticks]
        if check.particle is not None:
            return particle_metric(session.world, check.particle, check.metric)
        return float(getattr(summary, check.metric))

    return evaluate(level.checks, measure)
