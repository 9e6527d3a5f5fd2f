"""Faults of firmness: a form that is not stiff without pins, or a firmness that no Cs and Cd give."""

from collections.abc import Iterator

from sandbox.level.document.model import HookeMaterial, Level
from sandbox.level.format.level_error import Fault, shown
from sandbox.level.plan.plan import Plan
from sandbox.physics.analysis.firmness import FirmnessRange, OutOfReach, lowest_mode_of


def firmness_faults(level: Level, plan: Plan) -> Iterator[Fault]:
    """Faults of the firmness of bodies; the level has no other faults."""
    for index, (body, made) in enumerate(zip(level.bodies, plan.bodies, strict=True)):
        if body.firmness is None:
            continue
        path = f"bodies.{index}.firmness"
        if isinstance(level.materials.get(body.material), HookeMaterial):
            yield path, f"is not for springs of Hooke's law, which {shown(body.material)} is; take another material"
            continue
        if lowest_mode_of(made.stiff_form) == 0.0:
            yield (
                path,
                f"is for forms that are stiff without pins, and this {body.type} is not: it gives way without any "
                "spring being stretched; brace it, or take firmness out",
            )
            continue
        try:
            FirmnessRange.of(made.stiff_form, level.settings.gravity, level.settings.tick_rate).coefficients(
                body.firmness.asked
            )
        except OutOfReach as error:
            yield path, str(error)
