"""Faults of firmness: a form that is not stiff without pins, or a firmness that no Cs and Cd give."""

from collections.abc import Iterator
from typing import Any

from sandbox.level.document.model import HookeMaterial, Level
from sandbox.level.format.level_error import Fault, shown
from sandbox.level.kinds.bodies import AnyBody
from sandbox.level.kinds.expansion import Expansion
from sandbox.level.plan.plan import Plan
from sandbox.physics.softness.firmness import Firmness, FirmnessRange, OutOfReach, lowest_mode_of


def firmness_faults(level: Level, plan: Plan) -> Iterator[Fault]:
    """Faults of the firmness of bodies, and of that which rules give them; the level has no other faults."""
    made = dict(zip((body.id for body in level.bodies), zip(level.bodies, plan.bodies, strict=True), strict=True))
    for index, body in enumerate(level.bodies):
        if body.firmness is not None:
            yield from _faults_of(level, *made[body.id], body.firmness.asked, f"bodies.{index}.firmness")
    for number, rule in enumerate(level.rules):
        for at, action in enumerate(rule.then):
            if action.sag is not None:
                asked, path = Firmness(sag=action.sag), f"rules.{number}.then.{at}.sag"
                yield from _faults_of(level, *made[str(action.body)], asked, path)


def _faults_of(level: Level, body: AnyBody, made: Expansion[Any], asked: Firmness, path: str) -> Iterator[Fault]:
    if isinstance(level.materials.get(body.material), HookeMaterial):
        yield path, f"is not for springs of Hooke's law, which {shown(body.material)} is; take another material"
    elif lowest_mode_of(made.stiff_form) == 0.0:
        yield (
            path,
            f"is for forms that are stiff without pins, and this {body.type} is not: it gives way without any "
            "spring being stretched; brace it, or take firmness out",
        )
    else:
        try:
            FirmnessRange.of(made.stiff_form, level.settings.gravity, level.settings.tick_rate).coefficients(asked)
        except OutOfReach as error:
            yield path, str(error)
