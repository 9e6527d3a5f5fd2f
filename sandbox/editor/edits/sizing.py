"""Sizing: a part this many times larger, as a thing of the same stuff is: heavier by its area, and driven along."""

from typing import Any

from sandbox.editor.document import Document, EditError
from sandbox.editor.edits.moving import scale_exactly
from sandbox.editor.items import items_of
from sandbox.editor.panel.field_info import fields_of
from sandbox.level.document.canonical import level_text
from sandbox.level.document.model import HydraulicDef, Level
from sandbox.level.format.level_error import LevelError, one_line
from sandbox.level.format.limits import BODY_RADIUS
from sandbox.level.format.quantities import Description, replaced
from sandbox.level.kinds.bodies import AnyBody
from sandbox.level.kinds.mesh import MeshDef
from sandbox.level.reading.parse import parse_level

# How often a quantity takes up the factor of lengths, by its unit: times stay as they are, so forces go with masses.
POWERS = {"kg": 2, "N": 2, "N/m": 2, "N s/m": 2, "N m": 3}


def sized(part: Level, factor: float) -> Level:
    """A part whose lengths are `factor` times as large about its origin, as the editor scales them.

    Masses go with its area, forces and torques with these, so that it drives and swings as it did, in the same time;
    start velocities stay. Raises EditError where that is beyond a limit.
    """
    if factor == 1.0:
        return part
    scaled = scale_exactly(Document(part, frozenset(items_of(part))), factor).level
    made = replaced(
        scaled,
        materials={name: _heavier(each, factor) for name, each in scaled.materials.items()},
        bodies=tuple(_heavier(_with_masses(body, factor), factor) for body in scaled.bodies),
        particles=tuple(_heavier(each, factor) for each in scaled.particles),
        springs=tuple(_heavier(each, factor) for each in scaled.springs),
    )
    try:
        return parse_level(level_text(made).encode(), part.name)
    except LevelError as error:
        raise EditError(one_line(error.faults[0])) from None


def _with_masses(body: AnyBody, factor: float) -> AnyBody:
    """A body that says the radius of its particles, and their masses, where these go without saying else."""
    radius = BODY_RADIUS if body.particle_radius is None else body.particle_radius
    more: dict[str, Any] = {}
    if isinstance(body, MeshDef) and body.masses is None:
        more["masses"] = (1.0,) * len(body.particles)
    return replaced(body, particle_radius=factor * radius, **more)


def _heavier(part: Any, factor: float) -> Any:
    """A description with its masses and forces, and those of what it holds, for lengths this many times as large."""
    changes: dict[str, Any] = {}
    model: type[Description] = type(part)
    known = fields_of(model)
    for name, value in part.__dict__.items():
        power = POWERS.get(known[name].unit, 0)
        if isinstance(part, HydraulicDef) and name == "rate":
            power = 1
        if isinstance(value, Description):
            changes[name] = _heavier(value, factor)
        elif power and value is not None:
            times = factor**power
            changes[name] = tuple(times * each for each in value) if isinstance(value, tuple) else times * value
    return replaced(part, **changes)
