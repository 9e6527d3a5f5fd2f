"""Materials and checks of a level."""

from collections.abc import Iterable
from dataclasses import replace
from typing import Any

from pydantic import ValidationError

from sandbox.editor.document import Document, EditError, checked, first_fault
from sandbox.editor.items import Definition, changed, with_same
from sandbox.level.checks import CheckDef
from sandbox.level.document.model import Level, Material
from sandbox.level.format.level_error import shown, suggestion
from sandbox.level.format.limits import DEFAULT_MATERIAL, VERSION
from sandbox.level.format.quantities import replaced

# How many users of a material a message names.
NAMED_USERS = 3


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


def set_checks(document: Document, checks: Iterable[CheckDef]) -> Document:
    """Replace the level's checks. Raises EditError for one that could not be saved."""
    level = document.level
    checks = tuple(checks)
    if checks == level.checks:
        return document
    data = {"format": level.format, "version": VERSION, "name": "-", "checks": tuple(map(_plain, checks))}
    try:
        checks = Level.model_validate(data).checks
    except ValidationError as error:
        raise EditError(first_fault(error, "a check")) from None
    return replace(document, level=checked(replaced(level, checks=checks)))


def _plain(check: CheckDef) -> dict[str, Any]:
    """The fields of a check; an object inside would be taken over unseen."""
    return {**check.__dict__, "hold": tuple(dict(hold.__dict__) for hold in check.hold)}


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
