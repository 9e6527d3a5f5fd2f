"""Objects: what a level has, as lines of a list, groups with their members below them; and finding some by words."""

from typing import NamedTuple

from sandbox.editor.document import Document
from sandbox.editor.items import Definition, Item, Selection, chosen_definitions, definitions, group_of, items_of
from sandbox.level.document.model import Level, ParticleDef, SpringDef, TerrainDef, ZoneDef
from sandbox.level.kinds.body_def import BodyDef

# Of more things than these nobody asks whether they are one group.
MOST_NAMED = 1_000


class ObjectLine(NamedTuple):
    """A line: what it is called, what kind of thing it is, its items, and its material; group: that it is in.

    The line of a group has all of its members as items.
    """

    name: str
    kind: str
    items: Selection
    material: str | None = None
    group: str | None = None


def object_lines(level: Level, query: str = "") -> list[ObjectLine]:
    """Everything in a level, in file order; a group stands where its first member does, and its members below it.

    query: words, in any case, that a line has in its name, its kind, its material or its group; a group whose own line
    has them stays whole.
    """
    groups: dict[str, list[ObjectLine]] = {}
    order: list[ObjectLine | str] = []
    for item, part in zip(items_of(level), definitions(level), strict=True):
        line = ObjectLine(name_of(level, item), _kind(part), frozenset([item]), _material(part), group_of(part))
        if line.group is None:
            order.append(line)
            continue
        if line.group not in groups:
            groups[line.group] = []
            order.append(line.group)
        groups[line.group].append(line)
    words = query.casefold().split()
    found: list[ObjectLine] = []
    for entry in order:
        if isinstance(entry, ObjectLine):
            found += [entry] if _has(entry, words) else []
            continue
        members = groups[entry]
        head = ObjectLine(entry, f"group of {len(members)}", frozenset().union(*(line.items for line in members)))
        shown = members if _has(head, words) else [line for line in members if _has(line, words)]
        found += [head, *shown] if shown else []
    return found


def name_of(level: Level, item: Item) -> str:
    """The name of an item in lists: its id; of a loose spring its name, or its ends."""
    if item.kind != "spring":
        return str(item.key)
    spring = level.springs[int(item.key)]
    return spring.name or f"{spring.a} to {spring.b}"


def called_together(document: Document) -> str:
    """The selection in a few words: a name, that of the group, or how many things; "" = none."""
    level, selection = document.level, document.selection
    if len(selection) > MOST_NAMED or not selection:
        return f"{len(selection):,} things" if selection else ""
    if len(selection) == 1:
        return name_of(level, next(iter(selection)))
    groups = {group_of(part) for part in chosen_definitions(level, selection)}
    group = groups.pop() if len(groups) == 1 else None
    return group if group is not None else f"{len(selection)} things"


def _kind(part: Definition) -> str:
    if isinstance(part, BodyDef):
        return part.type
    if isinstance(part, ParticleDef):
        return "pinned particle" if part.pinned else "particle"
    if isinstance(part, TerrainDef):
        return "terrain" if part.polygon is not None else "line of terrain"
    if isinstance(part, ZoneDef):
        return "zone" if part.water is None else "water"
    driven = "muscle" if part.drive is not None else "hydraulic" if part.hydraulic is not None else "spring"
    return driven


def _material(part: Definition) -> str | None:
    return part.material if isinstance(part, BodyDef | SpringDef) else None


def _has(line: ObjectLine, words: list[str]) -> bool:
    text = f"{line.name} {line.kind} {line.material or ''} {line.group or ''}".casefold()
    return all(word in text for word in words)
