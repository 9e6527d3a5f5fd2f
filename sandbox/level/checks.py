"""Acceptance checks: what a level promises of its own run, and how measured values are held against it."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Literal

from pydantic import Field

from sandbox.level.format.quantities import Description, Name, Seconds

PARTICLE_METRICS = ("x", "y", "speed")
Metric = Literal[
    "max_strain",
    "rms_strain",
    "kinetic_energy",
    "potential_energy",
    "max_speed",
    "non_finite",
    "broken_springs",
    "x",
    "y",
    "speed",
]


class CheckDef(Description):
    """A metric of the level's run and the bounds that it must keep; at least one bound."""

    name: Name = Field(description="What the check is about.")
    metric: Metric = Field(
        description="What is measured, as `sandbox run --json` names it; or x, y [m], speed [m/s] of a particle."
    )
    particle: Name | None = Field(default=None, description="The particle that x, y and speed are measured of.")
    after: Seconds = Field(default=5.0, description="How long the level runs by itself first.")
    at_most: float | None = Field(default=None, description="Upper bound, in the metric's unit.")
    at_least: float | None = Field(default=None, description="Lower bound, in the metric's unit.")


@dataclass(frozen=True)
class CheckResult:
    """A check, the value measured for it, whether it holds, and one line that says so."""

    check: CheckDef
    value: float
    passed: bool
    text: str


def check_ticks(check: CheckDef, tick_rate: int) -> int:
    """Tick after which a check is measured; tick_rate [1/s]."""
    return round(check.after * tick_rate)


def evaluate(checks: Iterable[CheckDef], measure: Callable[[CheckDef], float]) -> list[CheckResult]:
    """Hold each check against the value that `measure` gives for it; a value that is no number fails."""
    return [_judge(check, float(measure(check))) for check in checks]


def _judge(check: CheckDef, value: float) -> CheckResult:
    bounds = []
    passed = value == value
    if check.at_least is not None:
        bounds.append(f"at least {check.at_least:g}")
        passed = passed and value >= check.at_least
    if check.at_most is not None:
        bounds.append(f"at most {check.at_most:g}")
        passed = passed and value <= check.at_most
    subject = check.metric if check.particle is None else f"{check.metric} of {check.particle}"
    verdict = "holds" if passed else "FAILS"
    text = f"{check.name}: {verdict}: {subject} after {check.after:g} s is {value:.6g}, wanted {' and '.join(bounds)}"
    return CheckResult(check, value, passed, text)
