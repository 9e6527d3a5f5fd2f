"""Groups, and the order in which things are drawn."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Literal

from sandbox.editor.document import Document, EditError
from sandbox.editor.edits.fields import set_field
from sandbox.editor.edits.names import followed, free_ids, with_springs_followed, with_things_followed
from sandbox.editor.items import (
    PARTS,
    Definition,
    Item,
    Selection,
    changed,
    definitions,
    group_of,
    items_of,
    kept_springs,
    keys,
    marks,
    picked,
    with_same,
)
from sandbox.level.document.model import Level, ZoneDef
from sandbox.level.format.level_error import shown
from sandbox.level.format.quantities import replaced

Place = Literal["front", "back", "forward", "backward"]


def group(document: Document, name: str = "group") -> Document:
    """Make one new group of everything selected, by a free name. Raises EditError for less than two things."""
    if len(document.selection) - len(keys(document.selection, "zone")) < 2:
        raise EditError("select two things or more to group them; zones are in no group")
    return _grouped(document, free_ids(taken_groups(document.level), [name])[0])


def ungroup(document: Document) -> Document:
    """Take everything selected out of its group."""
    return _grouped(document, None)


def groups_of(level: Level) -> dict[Item, str]:
    """The names of groups by the items that are in one."""
    return {
        item: name for item, part in zip(items_of(level), definitions(level), strict=True) if (name := group_of(part))
    }


def with_groups(level: Level, selection: Selection) -> Selection:
    """A selection with the whole of every group that one of it is in."""
    groups = groups_of(level)
    chosen = {groups[item] for item in selection if item in groups}
    return selection | {item for item, name in groups.items() if name in chosen} if chosen else selection


def taken_groups(level: Level) -> set[str]:
    """Names of the groups of a level."""
    return {name for part in definitions(level) if (name := group_of(part)) is not None}


def reorder(document: Document, to: Place) -> Document:
    """Draw what is selected last ("front"), first ("back"), or one place later or earlier among its kind."""
    level, selection = document.level, document.selection
    order = {kind: _order(marks(level, selection, kind), to) for kind in PARTS}
    level = with_same(level, **picked(level, order))
    level = with_springs_followed(level, level.rules, order["spring"])
    return Document(level, kept_springs(selection, order["spring"]))


def rename_group(document: Document, old: str, new: str) -> Document:
    """Give a group another name. Raises EditError where another one has it, or no group can."""
    level = document.level
    if new != old and new in taken_groups(level):
        raise EditError(f"there is a group {shown(new)} already")
    members = frozenset(item for item, name in groups_of(level).items() if name == old)
    rules = followed(level.rules, one_of=lambda name: new if name == old else name)
    return set_field(replace(document, level=with_same(level, rules=rules)), members, "group", new)


def shift(document: Document, later: bool) -> Document:
    """Put what is selected past the next thing of its kind in the file, or before the one ahead of it.

    A group counts as one thing, unless some of its members alone are selected. What comes later is drawn over the rest.
    """
    groups = groups_of(document.level)
    homes = {groups.get(item) for item in document.selection}
    within = next(iter(homes)) if len(homes) == 1 else None
    inside = {item for item, name in groups.items() if name == within} if within is not None else set()
    is_within = bool(inside - document.selection)
    for kind in sorted({item.kind for item in document.selection}):
        items = [item for item in items_of(document.level) if item.kind == kind and (not is_within or item in inside)]
        units: dict[object, list[Item]] = {}
        for item in items:
            units.setdefault(item if is_within else groups.get(item, item), []).append(item)
        order = list(units.values()) if later else list(units.values())[::-1]
        taken = [place for place, unit in enumerate(order) if document.selection.intersection(unit)]
        past = order[taken[-1] + 1 : taken[-1] + 2]
        if past:
            document = _moved_beside(document, past[0][-1 if later else 0], later)
    return document


def _moved_beside(document: Document, other: Item, after: bool) -> Document:
    """The selected items of the kind of another, put before or after that one in the file, in their own order."""
    level, selection = document.level, document.selection
    items = [item for item in items_of(level) if item.kind == other.kind]
    moved = [index for index, item in enumerate(items) if item in selection]
    stay = [index for index, item in enumerate(items) if item not in selection]
    place = stay.index(items.index(other)) + after
    order = [*stay[:place], *moved, *stay[place:]]
    field = PARTS[other.kind]
    parts = getattr(level, field)
    level = with_same(level, **{field: tuple(parts[index] for index in order)})
    if other.kind != "spring":
        return Document(level, selection)
    return Document(with_springs_followed(level, level.rules, order), kept_springs(selection, order))


def _grouped(document: Document, name: str | None) -> Document:
    def regrouped(part: Definition) -> Definition:
        return part if isinstance(part, ZoneDef) or part.group == name else replaced(part, group=name)

    level = changed(document.level, document.selection, regrouped)
    # Rules let go of a group that is gone.
    return Document(with_things_followed(level, lambda name: name), document.selection)


def _order(chosen: Sequence[bool], to: Place) -> list[int]:
    """Indices of things in their new order; chosen: which of them move."""
    order = list(range(len(chosen)))
    if to in ("front", "back"):
        return sorted(order, key=lambda index: chosen[index] == (to == "front"))
    step = 1 if to == "forward" else -1
    for place in order[-2::-1] if step > 0 else order[1:]:
        if chosen[order[place]] and not chosen[order[place + step]]:
            order[place], order[place + step] = order[place + step], order[place]
    return order
