"""Changing fields of items, of the level and of its settings."""

from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Any

from pydantic import ValidationError

from sandbox.editor.document import Document, EditError, checked, first_fault, subject, validated
from sandbox.editor.edits.names import renamed, rewired, taken_ids, with_things_followed
from sandbox.editor.edits.remap import rebuilt
from sandbox.editor.items import (
    Definition,
    Item,
    Selection,
    changed,
    chosen_bodies,
    chosen_particles,
    chosen_terrain,
    chosen_zones,
)
from sandbox.editor.kinds.table import EDITING, editing
from sandbox.level.document.model import Level, ParticleDef, TerrainDef, ZoneDef
from sandbox.level.format.level_error import shown
from sandbox.level.format.limits import VERSION
from sandbox.level.format.quantities import replaced
from sandbox.level.kinds.bodies import AnyBody
from sandbox.level.kinds.body_def import BodyDef
from sandbox.level.rules.rule import WALLS

# Fields of bodies that their form does not depend on; a change of any other may take pins, cuts and references along.
_FORMLESS = frozenset(BodyDef.model_fields).union(*(each.formless for each in EDITING.values()))
# Parts of a level that other edits change.
_NO_FIELDS = frozenset(
    set(Level.model_fields)
    - {
        "name",
        "description",
        "goal",
        "author",
        "licence",
        "tags",
        "view",
        "contacts",
        "walls",
        "look",
        "hands",
        "extras",
    }
)


def set_field(document: Document, items: Iterable[Item], field: str, value: Any) -> Document:
    """Give a field of items a value; lists count as the format's lists. Raises EditError.

    Where it alters the form of a body, its pins, cuts, pose and what refers to its particles go to the nearest; a
    rope of a given rest length keeps its whole length.
    """
    chosen = frozenset(items)
    if field == "id":
        if len(chosen) != 1:
            raise EditError("several things cannot share a name; select one")
        return rename(document, next(iter(chosen)), value)
    if field == "type":
        raise EditError("a body cannot change its kind; draw another one")
    value = with_tuples(value) if field != "extras" else value
    read: dict[type, Any] = {}

    def with_value(part: Definition) -> Definition:
        kind = type(part)
        if field not in kind.model_fields:
            raise EditError(f"{subject(part)} has no {field}")
        if kind not in read:
            read[kind] = getattr(validated(replaced(part, **{field: value})), field)
        return part if getattr(part, field) == read[kind] else _with_field(part, field, read[kind])

    if not chosen:
        return document
    return _settled(document, chosen, field, with_value)


def change_field(document: Document, items: Iterable[Item], field: str, change: Callable[[Any], Any]) -> Document:
    """Give a field of each item, which all have it, what `change` makes of its value. Raises EditError.

    Else as `set_field`.
    """
    return change_items(document, items, field, lambda part: change(getattr(part, field)))


def change_items(
    document: Document, items: Iterable[Item], field: str, change: Callable[[Definition], Any]
) -> Document:
    """Give a field of each item, which all have it, what `change` makes of the whole item. Raises EditError."""

    def with_change(part: Definition) -> Definition:
        value = change(part) if field == "extras" else with_tuples(change(part))
        new = getattr(validated(replaced(part, **{field: value})), field)
        return part if getattr(part, field) == new else _with_field(part, field, new)

    return _settled(document, frozenset(items), field, with_change)


def _settled(document: Document, chosen: Selection, field: str, change: Callable[[Definition], Definition]) -> Document:
    """The document with a field of the chosen items changed, and what depends on it."""
    old = document.level
    level = changed(old, chosen, change)
    if level is old:
        return document
    if field not in _FORMLESS and level.bodies is not old.bodies:
        bodies = {body.id: body for body in chosen_bodies(level, chosen)}
        return replace(document, level=rebuilt(replaced(level, bodies=old.bodies), bodies))
    return replace(document, level=checked(level))


def rename(document: Document, item: Item, new_id: str) -> Document:
    """Give a body, loose particle, piece of terrain or zone another id, wherever it is named. Raises EditError."""
    level = document.level
    part = _named_part(level, item)
    if new_id == item.key:
        return document
    try:
        new = validated(replaced(part, id=new_id))
    except EditError as error:
        fault = str(error).partition(": id: ")[2]
        raise EditError(f"{shown(part.id)} cannot be called {shown(new_id)}: the name {fault}") from None
    if new_id in taken_ids(level):
        raise EditError(f"{shown(new_id)} is taken; each body, particle, piece of terrain and zone needs its own name")

    def with_id(_: Definition) -> Definition:
        return new

    level = changed(level, frozenset([item]), with_id)
    level, _ = rewired(level, renamed({part.id: new_id}))
    look = level.look
    if item.kind == "terrain" and look is not None and part.id in look.ground:
        ground = {new_id if name == part.id else name: stuff for name, stuff in look.ground.items()}
        level = replaced(level, look=replaced(look, ground=ground))
    selection = document.selection
    if item in selection:
        selection = selection - {item} | {Item(item.kind, new_id)}
    return Document(checked(level), selection)


def set_level_field(document: Document, field: str, value: Any) -> Document:
    """Give a field of the level itself (name, view, walls, ...) a value. Raises EditError."""
    if field in _NO_FIELDS:
        raise EditError(f"{field} is not changed here")
    level = document.level
    data = {"format": level.format, "version": VERSION, "name": level.name}
    data[field] = value if field == "extras" else with_tuples(value)
    new = getattr(_read(data, 0), field)
    if new == getattr(level, field):
        return document
    level = replaced(level, **{field: new})
    if field == "walls" and new is None:
        # What asks for a touch of the walls goes with them.
        level = with_things_followed(level, lambda name: None if name == WALLS else name)
    return replace(document, level=checked(level))


def set_setting(document: Document, field: str, value: Any) -> Document:
    """Give a field of the level's settings a value. Raises EditError."""
    level = document.level
    settings = {**level.settings.__dict__, field: with_tuples(value)}
    new = _read({"format": level.format, "version": VERSION, "name": "-", "settings": settings}, 1).settings
    if new == level.settings:
        return document
    level = replaced(level, settings=new)
    # What firmness bodies can have depends on gravity and ticks.
    is_firm = any(body.firmness is not None for body in level.bodies)
    return replace(document, level=checked(level) if is_firm else level)


def with_tuples(value: Any) -> Any:
    """A value with tuples for its lists, as models hold them."""
    if isinstance(value, list | tuple):
        return tuple(with_tuples(item) for item in value)
    if isinstance(value, dict):
        return {key: with_tuples(item) for key, item in value.items()}
    return value


def _with_field(part: Definition, field: str, value: Any) -> Definition:
    changes = editing(part).with_field(field, value) if isinstance(part, BodyDef) else {field: value}
    new = replaced(part, **changes)
    return validated(new) if len(changes) > 1 else new


def _named_part(level: Level, item: Item) -> AnyBody | ParticleDef | TerrainDef | ZoneDef:
    selection: Selection = frozenset([item])
    parts: list[AnyBody | ParticleDef | TerrainDef | ZoneDef] = [
        *chosen_bodies(level, selection), *chosen_particles(level, selection), *chosen_terrain(level, selection),
        *chosen_zones(level, selection),
    ]  # fmt: skip
    if not parts:
        raise EditError("a loose spring has no id" if item.kind == "spring" else f"there is no {shown(item.key)}")
    return parts[0]


def _read(data: dict[str, Any], depth: int) -> Level:
    try:
        return Level.model_validate(data)
    except ValidationError as error:
        raise EditError(first_fault(error, "", depth)) from None
