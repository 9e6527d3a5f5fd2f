"""Materials, checks and collision groups of a level, and another tick rate at which all keeps its pace."""

from collections.abc import Iterable
from dataclasses import replace
from typing import Any

from pydantic import ValidationError

from sandbox.editor.document import Document, EditError, checked, first_fault
from sandbox.editor.edits.fields import set_setting
from sandbox.editor.items import Definition, changed, with_same
from sandbox.level.checks import CheckDef
from sandbox.level.document.model import Level, Material, NissenMaterial, ParticleDef
from sandbox.level.format.level_error import shown, suggestion
from sandbox.level.format.limits import DEFAULT_MATERIAL, PERIOD_RANGE, VERSION
from sandbox.level.format.quantities import Described, replaced, significant
from sandbox.level.kinds.body_def import BodyDef
from sandbox.level.plan.surfaces import group_bits
from sandbox.physics.equation import at_other_step

# How many users of a material a message names.
NAMED_USERS = 3


# Significant digits of Cs and Cd that are worked out.
RATE_DIGITS = 6


def add_material(document: Document, name: str, material: Material) -> Document:
    """Add a material. Raises EditError where the name is taken or the level has too many."""
    level = document.level
    if name in level.materials:
        raise EditError(f"there is a material {shown(name)} already")
    return _with_materials(document, {**level.materials, name: material})


def rename_material(document: Document, name: str, new_name: str) -> Document:
    """Rename a material, for all that are made of it. Raises EditError."""
    level = document.level
    _exists(level, name)
    if new_name == name:
        return document
    if new_name in level.materials:
        raise EditError(f"there is a material {shown(new_name)} already")
    named = {new_name if key == name else key: value for key, value in level.materials.items()}
    document = _with_materials(document, named, unchecked=True)

    def follow(part: Definition) -> Definition:
        return replaced(part, material=new_name) if part.__dict__.get("material") == name else part

    level = document.level
    bodies, springs = tuple(map(follow, level.bodies)), tuple(map(follow, level.springs))
    return replace(document, level=checked(with_same(level, bodies=bodies, springs=springs)))


def delete_material(document: Document, name: str) -> Document:
    """Delete a material. Raises EditError, which says by whom it is used, where it is."""
    level = document.level
    _exists(level, name)
    users = [shown(body.id) for body in level.bodies if body.material == name]
    users += [
        f"the spring :{index}" if spring.name is None else shown(spring.name)
        for index, spring in enumerate(level.springs)
        if spring.material == name
    ]
    if users:
        others = f" and {len(users) - NAMED_USERS} more" if len(users) > NAMED_USERS else ""
        raise EditError(f"{shown(name)} is used by {', '.join(users[:NAMED_USERS])}{others}; give them another first")
    return _with_materials(document, {key: value for key, value in level.materials.items() if key != name})


def set_material(document: Document, name: str, material: Material) -> Document:
    """Give a material other coefficients, or "default" its first ones. Raises EditError."""
    level = document.level
    if name != DEFAULT_MATERIAL:
        _exists(level, name)
    return _with_materials(document, {**level.materials, name: material})


def assign(document: Document, material: str) -> Document:
    """Make every selected body and spring of a material. Raises EditError."""
    if material != DEFAULT_MATERIAL:
        _exists(document.level, material)
    if all(item.kind in ("particle", "terrain", "zone") for item in document.selection):
        raise EditError("select a body or a spring to give it a material")

    def assigned(part: Definition) -> Definition:
        return part if part.__dict__.get("material", material) == material else replaced(part, material=material)

    level = changed(document.level, document.selection, assigned)
    return replace(document, level=level)


def _exists(level: Level, name: str) -> None:
    if name not in level.materials:
        raise EditError(f"there is no material {shown(name)}" + suggestion(name, level.materials))


def _with_materials(document: Document, materials: dict[str, Material], *, unchecked: bool = False) -> Document:
    level = document.level
    if list(materials.items()) == list(level.materials.items()):
        return document
    data = {
        "format": level.format,
        "version": VERSION,
        "name": "-",
        "materials": {name: dict(material.__dict__) for name, material in materials.items()},
    }
    try:
        materials = Level.model_validate(data).materials
    except ValidationError as error:
        raise EditError(first_fault(error, "", depth=0)) from None
    level = replaced(level, materials=materials)
    return replace(document, level=level if unchecked else checked(level))


def set_checks(document: Document, checks: Iterable[CheckDef]) -> Document:
    """Replace the level's checks. Raises EditError for one that could not be saved."""
    level = document.level
    checks = tuple(checks)
    if checks == level.checks:
        return document
    data = {"format": level.format, "version": VERSION, "name": "-", "checks": tuple(map(_plain_check, checks))}
    try:
        checks = Level.model_validate(data).checks
    except ValidationError as error:
        raise EditError(first_fault(error, "a check")) from None
    return replace(document, level=checked(replaced(level, checks=checks)))


def _plain_check(check: CheckDef) -> dict[str, Any]:
    """The fields of a check; an object inside would be taken over unseen."""
    return {**check.__dict__, "hold": tuple(dict(hold.__dict__) for hold in check.hold)}


def collision_groups(level: Level) -> tuple[str, ...]:
    """Names of the collision groups of a level, those that every level has first."""
    return tuple(group_bits(level))


def without_lost_groups(level: Level) -> Level:
    """A level in which nothing collides by a group that no body and no particle is in."""
    known = set(collision_groups(level))

    def kept(part: Described) -> Described:
        assert isinstance(part, BodyDef | ParticleDef)
        names = part.collides
        if isinstance(names, bool) or known.issuperset(names):
            return part
        return replaced(part, collides=tuple(name for name in names if name in known))

    return with_same(level, bodies=tuple(map(kept, level.bodies)), particles=tuple(map(kept, level.particles)))


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
    stiffness, damping = (significant(value, RATE_DIGITS) for value in pair)
    return replaced(part, stiffness=stiffness, damping=damping)
