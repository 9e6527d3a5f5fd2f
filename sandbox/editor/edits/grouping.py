"""Groups, and the order in which things are drawn."""

from collections.abc import Sequence
from typing import Literal

from sandbox.editor.document import Document, EditError
from sandbox.editor.edits.names import free_ids
from sandbox.editor.items import (
    Definition,
    Item,
    Selection,
    changed,
    definitions,
    items_of,
    kept_springs,
    keys,
    with_same,
)
from sandbox.level.document.model import Level
from sandbox.level.format.quantities import replaced

Place = Literal["front", "back", "forward", "backward"]


def group(document: Document, name: str = "group") -> Document:
    """Make one new group of everything selected, by a free name. Raises EditError for less than two things."""
    if len(document.selection) < 2:
        raise EditError("select two things or more to group them")
    return _grouped(document, free_ids(taken_groups(document.level), [name])[0])


def ungroup(document: Document) -> Document:
    """Take everything selected out of its group."""
    return _grouped(document, None)


def groups_of(level: Level) -> dict[Item, str]:
    """The names of groups by the items that are in one."""
    return {item: part.group for item, part in zip(items_of(level), definitions(level), strict=True) if part.group}


def with_groups(level: Level, selection: Selection) -> Selection:
    """A selection with the whole of every group that one of it is in."""
    groups = groups_of(level)
    wanted = {groups[item] for item in selection if item in groups}
    return selection | {item for item, name in groups.items() if name in wanted} if wanted else selection


def taken_groups(level: Level) -> set[str]:
    """Names of the groups of a level."""
    return {part.group for part in definitions(level) if part.group is not None}


def reorder(document: Document, to: Place) -> Document:
    """Draw what is selected last ("front"), first ("back"), or one place later or earlier among its kind."""
    level, selection = document.level, document.selection
    bodies, particles, springs = keys(selection, "body"), keys(selection, "particle"), keys(selection, "spring")
    terrain = keys(selection, "terrain")
    order = _order([index in springs for index in range(len(level.springs))], to)
    level = with_same(
        level,
        bodies=tuple(level.bodies[index] for index in _order([body.id in bodies for body in level.bodies], to)),
        particles=tuple(level.particles[index] for index in _order([p.id in particles for p in level.particles], to)),
        springs=tuple(level.springs[index] for index in order),
        terrain=tuple(level.terrain[index] for index in _order([piece.id in terrain for piece in level.terrain], to)),
    )
    return Document(level, kept_springs(selection, order))


def _grouped(document: Document, name: str | None) -> Document:
    def regrouped(part: Definition) -> Definition:
        return part if part.group == name else replaced(part, group=name)

    level = changed(document.level, document.selection, regrouped)
    return Document(level, document.selection)


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
