"""Another tick rate at which springs and muscles move as fast per second as before."""

from dataclasses import replace
from typing import Any

from sandbox.editor.document import Document, EditError, checked
from sandbox.editor.edits.fields import set_setting
from sandbox.editor.items import Definition, with_same
from sandbox.level.document.model import NissenMaterial
from sandbox.level.format.level_error import shown
from sandbox.level.format.limits import DEFAULT_MATERIAL, PERIOD_RANGE
from sandbox.level.format.quantities import replaced, significant
from sandbox.physics.equation import at_other_step

# Significant digits of Cs and Cd that are worked out.
DIGITS = 6


def set_rate_in_pace(document: Document, tick_rate: int) -> Document:
    """Set the tick rate, and Cs and Cd of every material and bend so that each spring moves per second as before.

    Periods of muscles follow, to whole ticks; firmness is given per second already. Raises EditError where a spring
    swings too fast for the new rate.
    """
    old = document.level
    if tick_rate == old.settings.tick_rate:
        return document
    document = set_setting(document, "tick_rate", tick_rate)
    times = old.settings.tick_rate / tick_rate
    users = {part.__dict__.get("material", DEFAULT_MATERIAL) for part in (*old.bodies, *old.springs)}
    materials: dict[str, Any] = dict(old.materials)
    if DEFAULT_MATERIAL in users:
        materials.setdefault(DEFAULT_MATERIAL, NissenMaterial())
    materials = {
        name: _in_pace(each, times, f"the material {shown(name)}") if isinstance(each, NissenMaterial) else each
        for name, each in materials.items()
    }

    def follow(part: Definition) -> Definition:
        changes: dict[str, Any] = {}
        drive, bending = part.__dict__.get("drive"), part.__dict__.get("bending")
        if drive is not None:
            least, most = PERIOD_RANGE
            changes["drive"] = replaced(drive, period=min(max(round(drive.period / times), least), most))
        if bending is not None:
            changes["bending"] = _in_pace(bending, times, f"the bending of {shown(part.__dict__['id'])}")
        return replaced(part, **changes) if changes else part

    bodies, springs = tuple(map(follow, old.bodies)), tuple(map(follow, old.springs))
    level = with_same(replaced(document.level, materials=materials), bodies=bodies, springs=springs)
    return replace(document, level=checked(level))


def _in_pace(part: Any, times: float, whose: str) -> Any:
    try:
        pair = at_other_step(part.stiffness, part.damping, times)
    except ValueError as error:
        raise EditError(f"{whose}: {error}; soften it first, or take a higher rate") from None
    stiffness, damping = (significant(value, DIGITS) for value in pair)
    return replaced(part, stiffness=stiffness, damping=damping)
