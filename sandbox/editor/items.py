"""Items: what can be selected in a level, and how it is named."""

from collections.abc import Iterable
from typing import Literal, NamedTuple

from sandbox.level.bodies import AnyBody
from sandbox.level.model import Level, ParticleDef, SpringDef

Kind = Literal["body", "particle", "spring"]


class Item(NamedTuple):
    """A body, a loose particle or a loose spring of a level; key: its id, of a spring its index in `springs`."""

    kind: Kind
    key: str | int


Selection = frozenset[Item]
Definition = AnyBody | ParticleDef | SpringDef


def items_of(level: Level) -> tuple[Item, ...]:
    """Every item of a level in file order: bodies, loose particles, loose springs."""
    return (
        *(Item("body", body.id) for body in level.bodies),
        *(Item("particle", particle.id) for particle in level.particles),
        *(Item("spring", index) for index in range(len(level.springs))),
    )


def definitions(level: Level, items: Iterable[Item]) -> dict[Item, Definition]:
    """What the level says of each of the items that it has, in file order."""
    wanted = items if isinstance(items, frozenset | set) else set(items)
    everything = (*level.bodies, *level.particles, *level.springs)
    return {item: definition for item, definition in zip(items_of(level), everything, strict=True) if item in wanted}
