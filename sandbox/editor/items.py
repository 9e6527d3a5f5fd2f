"""Items: what can be selected in a level, how it is named, and what of it is hidden or locked on the sheet."""

import functools
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

from sandbox.level.document.model import Level, ParticleDef, SpringDef, TerrainDef, ZoneDef
from sandbox.level.format.quantities import replaced
from sandbox.level.kinds.bodies import AnyBody

Kind = Literal["body", "particle", "spring", "terrain", "zone"]
Definition = AnyBody | ParticleDef | SpringDef | TerrainDef | ZoneDef
# The part of a level that holds the items of each kind.
PARTS: dict[Kind, str] = {
    "body": "bodies", "particle": "particles", "spring": "springs", "terrain": "terrain", "zone": "zones",
}  # fmt: skip


class Item(NamedTuple):
    """A body, loose particle, loose spring, piece of terrain or zone; key: its id, of a spring its index."""

    kind: Kind
    key: str | int


Selection = frozenset[Item]


def items_of(level: Level) -> tuple[Item, ...]:
    """Every item of a level: bodies, loose particles, loose springs, terrain, zones, each in file order."""
    return (
        *(Item("body", body.id) for body in level.bodies),
        *(Item("particle", particle.id) for particle in level.particles),
        *(Item("spring", index) for index in range(len(level.springs))),
        *(Item("terrain", piece.id) for piece in level.terrain),
        *(Item("zone", zone.id) for zone in level.zones),
    )


def definitions(level: Level) -> tuple[Definition, ...]:
    """The definition of every item, in the order of `items_of`."""
    return (*level.bodies, *level.particles, *level.springs, *level.terrain, *level.zones)


def group_of(part: Definition) -> str | None:
    """The group that something is in; zones are in none."""
    return None if isinstance(part, ZoneDef) else part.group


def keys(selection: Selection, kind: Kind) -> frozenset[str | int]:
    """Keys of the selected items of a kind."""
    return _keys(id(selection), selection)[kind]


# A selection is asked many times, by every edit of it, and sorting 20,000 items out takes a fifth of a frame. So does
# comparing it with an equal one, hence the identity, which is compared first.
@functools.lru_cache(maxsize=4)
def _keys(_identity: int, selection: Selection) -> dict[Kind, frozenset[str | int]]:
    found: dict[Kind, list[str | int]] = {kind: [] for kind in PARTS}
    add = {kind: keys.append for kind, keys in found.items()}
    for kind, key in selection:
        add[kind](key)
    return {kind: frozenset(keys) for kind, keys in found.items()}


def marks(level: Level, selection: Selection, kind: Kind) -> list[bool]:
    """Which things of a kind are selected, in file order."""
    chosen, parts = keys(selection, kind), getattr(level, PARTS[kind])
    return [key in chosen for key in (range(len(parts)) if kind == "spring" else [part.id for part in parts])]


def chosen_bodies(level: Level, selection: Selection) -> list[AnyBody]:
    """The selected bodies in file order."""
    chosen = keys(selection, "body")
    return [body for body in level.bodies if body.id in chosen]


def chosen_particles(level: Level, selection: Selection) -> list[ParticleDef]:
    """The selected loose particles in file order."""
    chosen = keys(selection, "particle")
    if len(chosen) == len(level.particles):
        return list(level.particles)
    return [particle for particle in level.particles if particle.id in chosen]


def chosen_springs(level: Level, selection: Selection) -> list[SpringDef]:
    """The selected loose springs in file order."""
    chosen = keys(selection, "spring")
    if len(chosen) == len(level.springs):
        return list(level.springs)
    return [spring for index, spring in enumerate(level.springs) if index in chosen]


def chosen_terrain(level: Level, selection: Selection) -> list[TerrainDef]:
    """The selected pieces of terrain in file order."""
    chosen = keys(selection, "terrain")
    return [piece for piece in level.terrain if piece.id in chosen]


def chosen_zones(level: Level, selection: Selection) -> list[ZoneDef]:
    """The selected zones in file order."""
    chosen = keys(selection, "zone")
    return [zone for zone in level.zones if zone.id in chosen]


def chosen_definitions(level: Level, selection: Selection) -> list[Definition]:
    """Definitions of the selected items, by kind and in file order."""
    return [
        *chosen_bodies(level, selection),
        *chosen_particles(level, selection),
        *chosen_springs(level, selection),
        *chosen_terrain(level, selection),
        *chosen_zones(level, selection),
    ]


def chosen_items(level: Level, selection: Selection) -> dict[Item, Definition]:
    """The selected items with their definitions, in the order of `items_of`."""
    found: dict[Item, Definition] = {Item("body", body.id): body for body in chosen_bodies(level, selection)}
    found |= {Item("particle", particle.id): particle for particle in chosen_particles(level, selection)}
    springs = keys(selection, "spring")
    found |= {Item("spring", k): spring for k, spring in enumerate(level.springs) if k in springs}
    found |= {Item("terrain", piece.id): piece for piece in chosen_terrain(level, selection)}
    return found | {Item("zone", zone.id): zone for zone in chosen_zones(level, selection)}


def changed(level: Level, selection: Selection, change: Callable[[Definition], Definition]) -> Level:
    """The level with every selected item changed; what is not changed stays the same object."""
    new = {}
    for kind, name in PARTS.items():
        chosen = zip(getattr(level, name), marks(level, selection, kind), strict=True)
        new[name] = tuple([change(part) if is_chosen else part for part, is_chosen in chosen])
    return with_same(level, **new)


def exchanged(
    level: Level,
    selection: Selection,
    bodies: Iterable[AnyBody],
    particles: Iterable[ParticleDef],
    terrain: Iterable[TerrainDef],
    zones: Iterable[ZoneDef],
) -> Level:
    """The level with other bodies, loose particles, terrain and zones, in file order, for the selected ones."""
    return with_same(
        level,
        bodies=_exchanged(level.bodies, keys(selection, "body"), list(bodies)),
        particles=_exchanged(level.particles, keys(selection, "particle"), list(particles)),
        terrain=_exchanged(level.terrain, keys(selection, "terrain"), list(terrain)),
        zones=_exchanged(level.zones, keys(selection, "zone"), list(zones)),
    )


def _exchanged(old: Sequence[Any], chosen: frozenset[str | int], new: Sequence[Any]) -> tuple[Any, ...]:
    if len(new) == len(old):
        return tuple(new)
    turn = iter(new)
    return tuple([next(turn) if part.id in chosen else part for part in old])


def picked(level: Level, indices: Mapping[Kind, Iterable[int]]) -> dict[str, tuple[Any, ...]]:
    """Things of each kind by their indices, for the level's fields."""
    return {PARTS[kind]: tuple([getattr(level, PARTS[kind])[index] for index in at]) for kind, at in indices.items()}


def kept_springs(selection: Selection, kept: Iterable[int]) -> Selection:
    """A selection after loose springs have gone; kept: the old indices of those that stay, in their new order."""
    places = {old: new for new, old in enumerate(kept)}
    return frozenset(
        Item("spring", places[int(item.key)]) if item.kind == "spring" else item
        for item in selection
        if item.kind != "spring" or int(item.key) in places
    )


def with_same(level: Level, **parts: tuple[object, ...]) -> Level:
    """A level with other parts; a part of the very same items as before stays the same object, as does the level."""
    changes = {
        name: new
        for name, new in parts.items()
        if len(new) != len(getattr(level, name))
        or any(a is not b for a, b in zip(new, getattr(level, name), strict=True))
    }
    return replaced(level, **changes) if changes else level


NOTHING: Selection = frozenset()


@dataclass(frozen=True)
class Visibility:
    """Items that are not drawn (hidden), and items that a pointer does not pick (locked; hidden ones neither)."""

    hidden: Selection = NOTHING
    locked: Selection = NOTHING

    @property
    def closed(self) -> Selection:
        """Items that a pointer does not pick: hidden and locked ones."""
        return self.hidden | self.locked if self.locked else self.hidden

    def hide(self, items: Selection, on: bool) -> "Visibility":
        """Hide items, or show them again."""
        return Visibility(self.hidden | items if on else self.hidden - items, self.locked)

    def lock(self, items: Selection, on: bool) -> "Visibility":
        """Lock items, or unlock them."""
        return Visibility(self.hidden, self.locked | items if on else self.locked - items)

    def renamed(self, old: Item, new: Item) -> "Visibility":
        """The same visibility once an item has another name."""
        return Visibility(_renamed(self.hidden, old, new), _renamed(self.locked, old, new))

    def among(self, items: Selection) -> "Visibility":
        """The same for some items alone."""
        return Visibility(self.hidden & items, self.locked & items)


def _renamed(items: Selection, old: Item, new: Item) -> Selection:
    return items - {old} | {new} if old in items else items
