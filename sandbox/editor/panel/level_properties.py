"""Properties of the level itself, of how its time passes, and of its checks."""

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

from pydantic import ValidationError

from sandbox.editor.document import Document, EditError, first_fault
from sandbox.editor.edits.fields import set_level_field, set_setting
from sandbox.editor.edits.materials import set_checks, set_material
from sandbox.editor.items import chosen_bodies, chosen_particles
from sandbox.editor.panel.extra_values import extras_properties
from sandbox.editor.panel.field_info import abouts
from sandbox.editor.panel.property import Property, Section, part_properties, with_axes
from sandbox.editor.scene import make_scene
from sandbox.level.checks import METRICS, SUBJECTS, CheckDef
from sandbox.level.document.model import Level, Material, MaterialDef, NissenMaterial, Settings
from sandbox.level.format.look import BodyLook
from sandbox.level.format.quantities import replaced
from sandbox.level.kinds.bodies import AnyBody, expansion

# Walls of a level in which nothing is yet [m]; around something they leave this share of its size, and of at least 1 m.
FIRST_ROOM = (-6.0, 0.0, 6.0, 6.0)
ROOM_SHARE, SMALLEST_ROOM = 0.25, 1.0
ROOM_DECIMALS = 2
_LEVEL_FIELDS = ("name", "description", "author", "licence", "tags", "view")


def level_properties(document: Document) -> tuple[Section, ...]:
    """What can be changed of the level itself and of how its time passes."""
    level = document.level
    about = abouts(Level)
    of_level = [Property(name, about[name], getattr(level, name), partial(_set_level, name)) for name in _LEVEL_FIELDS]
    settings = []
    for name, each in abouts(Settings).items():
        value = getattr(level.settings, name)
        settings.append(Property(name, each, str(value) if each.kind == "choice" else value, partial(_set_time, name)))
    return (
        Section("Level", (*of_level, *_object(document, "look"))),
        Section("Time and solver", tuple(settings)),
        Section("Contacts", tuple(_object(document, "contacts") + _object(document, "walls"))),
        Section("Other", tuple(extras_properties(about["extras"], [level.extras], _change_extras))),
    )


def _change_extras(document: Document, change: Callable[[dict[str, Any]], dict[str, Any]]) -> Document:
    return set_level_field(document, "extras", change(document.level.extras))


def _object(document: Document, name: str) -> list[Property]:
    """Properties of an object that a level may have."""

    def change(document: Document, new: Callable[[Any], Any]) -> Document:
        return set_level_field(document, name, new(getattr(document.level, name)))

    def add(document: Document) -> Document:
        return change(document, lambda old: _FIRST[name](document) if old is None else old)

    return part_properties(name, abouts(Level)[name], [getattr(document.level, name)], change, add)


def look_properties(name: str, material: Material) -> list[Property]:
    """What can be changed of how things of a material look."""

    def change(document: Document, new: Callable[[Any], Any]) -> Document:
        now = document.level.materials.get(name, NissenMaterial())
        look = new(now.look)
        try:
            wanted = None if look is None else BodyLook.model_validate(look)
        except ValidationError as error:
            raise EditError(first_fault(error, "look", 0)) from None
        return set_material(document, name, replaced(now, look=wanted))

    def add(document: Document) -> Document:
        return change(document, lambda old: {} if old is None else old.__dict__)

    return part_properties("look", abouts(MaterialDef)["look"], [material.look], change, add)


def _first_walls(document: Document) -> dict[str, Any]:
    """Walls around the level's view, or around everything with some room."""
    level = document.level
    around = make_scene(level).bounds()
    box = level.view or around or FIRST_ROOM
    room = 0.0
    if level.view is None and around is not None:
        room = ROOM_SHARE * max(box[2] - box[0], box[3] - box[1], SMALLEST_ROOM)
    return {"box": tuple(round(c + s * room, ROOM_DECIMALS) for c, s in zip(box, (-1, -1, 1, 1), strict=True))}


_FIRST: dict[str, Callable[[Document], dict[str, Any]]] = {
    "contacts": lambda _: {}, "walls": _first_walls, "look": lambda _: {},
}  # fmt: skip


def _set_level(field: str, document: Document, value: Any) -> Document:
    return set_level_field(document, field, value)


def _set_time(field: str, document: Document, value: Any) -> Document:
    old = getattr(document.level.settings, field)
    if field in ("gravity", "wind"):
        value = with_axes(value, old)
    elif field == "substeps" and str(value).isdecimal():
        value = int(value)
    return set_setting(document, field, value)


# Checks.


def check_properties(document: Document, index: int) -> tuple[Section, ...]:
    """What can be changed of a check of the level, by its index; () where there is none."""
    if not 0 <= index < len(document.level.checks):
        return ()
    check = document.level.checks[index]
    made = [
        Property(name, about, getattr(check, name), partial(_set_check, index, name))
        for name, about in abouts(CheckDef).items()
        if name not in SUBJECTS or METRICS[check.metric].takes(name)
    ]
    return (Section("Check", tuple(made)),)


def _set_check(index: int, field: str, document: Document, value: Any) -> Document:
    checks = list(document.level.checks)
    windows = {"always": "eventually", "eventually": "always"}
    check = replaced(checks[index], **{field: tuple(value) if isinstance(value, list) else value})
    if field in windows and value is not None:
        check = replaced(check, **{windows[field]: None})
    if field == "metric":
        measured = METRICS.get(value)
        kept = {name: getattr(check, name) for name in SUBJECTS if measured is not None and measured.takes(name)}
        for name in measured.needs if measured is not None else ():
            if kept[name] is None:
                kept[name] = FIRST_ROOM if name == "box" else _some_particle(document)
        momentary = measured is None or measured.momentary
        check = replaced(check, **{name: kept.get(name) for name in SUBJECTS})
        check = check if momentary else replaced(check, always=None, eventually=None)
    checks[index] = check
    return set_checks(document, checks)


def _some_particle(document: Document) -> str | None:
    """A particle to measure: of what is selected, else of the level."""
    level, selection = document.level, document.selection
    loose = [*chosen_particles(level, selection), *(() if selection else level.particles)]
    bodies: Sequence[AnyBody] = [*chosen_bodies(level, selection), *(() if selection else level.bodies)]
    if loose:
        return loose[0].id
    return f"{bodies[0].id}.{expansion(bodies[0]).count[0] - 1}" if bodies else None


def add_check(document: Document) -> Document:
    """Add a check that holds of every sound level. Raises EditError where it has too many."""
    taken = {check.name for check in document.level.checks}
    number = next(k for k in range(1, len(taken) + 2) if f"check {k}" not in taken)
    check = CheckDef(name=f"check {number}", metric="non_finite", at_most=0.0)
    return set_checks(document, [*document.level.checks, check])


def delete_check(document: Document, index: int) -> Document:
    """Delete a check by its index."""
    return set_checks(document, [check for k, check in enumerate(document.level.checks) if k != index])
