"""Properties of the level itself, and of how its time passes."""

from collections.abc import Callable
from functools import partial
from typing import Any

from sandbox.editor.document import Document
from sandbox.editor.edits.fields import set_level_field, set_setting
from sandbox.editor.panel.extra_values import extras_properties
from sandbox.editor.panel.field_info import FieldInfo, fields_of
from sandbox.editor.panel.hands_form import hands_properties
from sandbox.editor.panel.property import Property, Section, changing, part_properties, with_axes
from sandbox.editor.scene import make_scene
from sandbox.level.document.model import ContactsDef, Level, Settings

# Walls of a level in which nothing is yet [m]; around something they leave this share of its size, and of at least 1 m.
FIRST_ROOM = (-6.0, 0.0, 6.0, 6.0)
ROOM_SHARE, SMALLEST_ROOM = 0.25, 1.0
ROOM_DECIMALS = 2
_LEVEL_FIELDS = ("name", "goal", "description", "author", "licence", "tags", "view")


def level_properties(document: Document) -> tuple[Section, ...]:
    """Properties of the level itself and of its settings of time."""
    level = document.level
    about = fields_of(Level)
    of_level = [
        Property(name, about[name], getattr(level, name), changing(set_level_field, name)) for name in _LEVEL_FIELDS
    ]
    settings = []
    for name, each in fields_of(Settings).items():
        value = getattr(level.settings, name)
        settings.append(Property(name, each, str(value) if each.kind == "choice" else value, partial(_set_time, name)))
    return (
        Section("Level", (*of_level, *_object(document, "look"))),
        Section("Hands", hands_properties(level)),
        Section("Contacts", tuple(_contacts(document) + _object(document, "walls"))),
        Section("Time and solver", tuple(settings), is_rare=True),
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

    return part_properties(name, fields_of(Level)[name], [getattr(document.level, name)], change, add)


def _contacts(document: Document) -> list[Property]:
    """Properties of contacts: where ground or walls alone make things touch, the numbers that are in force."""
    level = document.level
    if level.contacts is not None or not level.has_contacts:
        return _object(document, "contacts")

    def write(field: str, document: Document, value: Any) -> Document:
        return set_level_field(document, "contacts", {field: value})

    usual = ContactsDef()
    about = FieldInfo("text", fields_of(Level)["contacts"].title, tooltip="Ground and walls make things touch.")
    numbers = fields_of(ContactsDef).items()
    return [
        Property("contacts", about, "on: there is ground" if level.terrain else "on: there are walls"),
        *(Property(f"contacts.{name}", each, getattr(usual, name), partial(write, name)) for name, each in numbers),
    ]


def _first_walls(document: Document) -> dict[str, Any]:
    """Walls around the level's view, or around everything with some room."""
    level = document.level
    around = make_scene(level).bounds()
    box = level.view or around or FIRST_ROOM
    margin = 0.0
    if level.view is None and around is not None:
        margin = ROOM_SHARE * max(box[2] - box[0], box[3] - box[1], SMALLEST_ROOM)
    return {"box": tuple(round(c + s * margin, ROOM_DECIMALS) for c, s in zip(box, (-1, -1, 1, 1), strict=True))}


_FIRST: dict[str, Callable[[Document], dict[str, Any]]] = {
    "contacts": lambda _: {}, "walls": _first_walls, "look": lambda _: {},
}  # fmt: skip


def _set_time(field: str, document: Document, value: Any) -> Document:
    old = getattr(document.level.settings, field)
    if field in ("gravity", "wind"):
        value = with_axes(value, old)
    elif field == "substeps" and str(value).isdecimal():
        value = int(value)
    return set_setting(document, field, value)
