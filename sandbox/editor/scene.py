"""Scene: a level as arrays to draw, pick from and measure, made anew after every edit from what did not change."""

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sandbox.editor.items import Item, Selection, items_of
from sandbox.level.bodies import AnyBody, JellyDef, RingDef, WebDef, WheelDef
from sandbox.level.expansion import Expansion, expansion
from sandbox.level.layout import Layout
from sandbox.level.limits import BODY_RADIUS, DEFAULT_MATERIAL
from sandbox.level.model import Level
from sandbox.level.quantities import replaced
from sandbox.level.shapes import distances
from sandbox.level.welds import united

Floats = NDArray[np.float64]
Slots = NDArray[np.int64]
Mask = NDArray[np.bool_]
Box = tuple[float, float, float, float]


class _Loose(NamedTuple):
    """Arrays of the loose particles."""

    position: Floats
    mass: Floats
    radius: Floats
    pinned: Mask


class _Names:
    """Who has which name: the same in every scene whose items and counts are the same."""

    def __init__(self, level: Level, items: tuple[Item, ...], counts: list[int]) -> None:
        self.level, self.items, self.counts = level, items, counts

    @cached_property
    def layout(self) -> Layout:
        return Layout(self.level, self.counts)

    @cached_property
    def item_index(self) -> dict[Item, int]:
        return {item: index for index, item in enumerate(self.items)}

    def serve(self, level: Level, counts: list[int]) -> bool:
        """Whether another level has the same items with the same names of particles."""
        old = self.level
        return (
            counts == self.counts
            and len(level.springs) == len(old.springs)
            and (level.bodies is old.bodies or _alike(level.bodies, old.bodies))
            and (level.particles is old.particles or _alike(level.particles, old.particles))
        )


def _alike(new: tuple[Any, ...], old: tuple[Any, ...]) -> bool:
    return [part.id for part in new] == [part.id for part in old] and [*map(type, new)] == [*map(type, old)]


@dataclass(frozen=True, eq=False)
class _Parts:
    """What the next scene may take over."""

    bodies: list[Expansion]
    forms: dict[tuple[Any, ...], Expansion]
    loose: _Loose
    names: _Names
    ends: Slots  # (k, 2) particles of the loose springs


@dataclass(frozen=True, eq=False)
class Scene:
    """Arrays of what a level expands to, before welds: n particles, those of bodies first, and m springs.

    position [m] (n, 2), of welded particles that of the first; mass [kg] and radius [m] (n,), each its own; pinned
    (n,), whether it or one it is welded to is held; particle_item (n,), spring_item (m,): indices into items;
    particle_a, particle_b (m,): particles; rest_length [m] (m,); number (m,): the k of the spring's name; material
    (m,): index into materials; welds (w, 2): particles; first_of_weld (n,): the first particle of each one's weld.
    """

    level: Level
    items: tuple[Item, ...]
    position: Floats
    mass: Floats
    radius: Floats
    pinned: Mask
    particle_item: Slots
    particle_a: Slots
    particle_b: Slots
    rest_length: Floats
    spring_item: Slots
    number: Slots
    material: Slots
    materials: tuple[str, ...]
    welds: Slots
    first_of_weld: Slots
    parts: _Parts = field(repr=False)

    @cached_property
    def _firsts(self) -> Slots:
        return np.cumsum([0, *self.parts.names.counts])

    def names(self, slot: int) -> str:
        """Name of a particle: `deck.20`, of a loose one its id."""
        index = int(self.particle_item[slot])
        kind, key = self.items[index]
        return f"{key}.{slot - int(self._firsts[index])}" if kind == "body" else str(key)

    def slot(self, name: str) -> int:
        """Index of the particle of that name. Raises LookupError."""
        return self.parts.names.layout.slot(name)

    def spring_name(self, spring: int) -> str:
        """Name of a spring: `deck:20`, of a loose one `:20`."""
        kind, key = self.items[int(self.spring_item[spring])]
        return f"{key}:{self.number[spring]}" if kind == "body" else f":{key}"

    def chosen(self, selection: Selection) -> Mask:
        """Which of `items` are selected (k,)."""
        mask = np.zeros(len(self.items), dtype=np.bool_)
        if len(selection) == len(self.items):
            mask[:] = True
            return mask
        index = self.parts.names.item_index
        mask[[index[item] for item in selection]] = True
        return mask

    def particles_of(self, selection: Selection) -> Mask:
        """Which particles (n,) belong to selected items, all of which the level has."""
        return self.chosen(selection)[self.particle_item]

    def springs_of(self, selection: Selection) -> Mask:
        """Which springs (m,) belong to selected items, all of which the level has."""
        return self.chosen(selection)[self.spring_item]

    def bounds(self, selection: Selection | None = None) -> Box | None:
        """Left, bottom, right, top [m] of the particles of a selection (None = all) and the ends of its springs."""
        points = self.position
        if selection is not None:
            shown, springs = self.particles_of(selection), self.springs_of(selection)
            shown[self.particle_a[springs]] = True
            shown[self.particle_b[springs]] = True
            points = points[shown]
        if not len(points):
            return None
        (left, bottom), (right, top) = points.min(axis=0).tolist(), points.max(axis=0).tolist()
        return left, bottom, right, top


def make_scene(level: Level, before: Scene | None = None) -> Scene:
    """Expand a sound level; before: the scene of another state of it, of which all that did not change is reused."""
    parts = _parts(level, before)
    bodies, loose, names = parts.bodies, parts.loose, parts.names
    firsts = np.cumsum([0, *names.counts])
    mass = np.concatenate([*(made.mass for made in bodies), loose.mass])
    position = np.concatenate([*(made.position for made in bodies), loose.position])
    pinned = np.concatenate([*(made.pinned for made in bodies), loose.pinned])
    layout = names.layout if level.welds else None
    welds = [(layout.slot(a), layout.slot(b)) for a, b in level.welds] if layout else []
    first_of_weld = united(len(mass), welds)
    if welds:
        position = position[first_of_weld]
        pinned = np.bincount(first_of_weld, weights=pinned, minlength=len(mass))[first_of_weld] > 0
    ends = [made.pairs + first for made, first in zip(bodies, firsts.tolist(), strict=False)]
    pairs = np.concatenate([*ends, parts.ends])
    springs_of_bodies = [len(made.pairs) for made in bodies]
    numbers = np.arange(len(names.items), dtype=np.int64)
    owners = len(level.bodies) + len(level.particles)
    materials = tuple({DEFAULT_MATERIAL: None} | dict.fromkeys(level.materials))
    index = {name: number for number, name in enumerate(materials)}
    used = np.array([index[body.material] for body in level.bodies], dtype=np.int64)
    return Scene(
        level=level,
        items=names.items,
        position=position,
        mass=mass,
        radius=np.concatenate([np.full(int(firsts[-1]), BODY_RADIUS), loose.radius]),
        pinned=pinned,
        particle_item=np.concatenate([np.repeat(numbers[: len(bodies)], names.counts), numbers[len(bodies) : owners]]),
        particle_a=pairs[:, 0],
        particle_b=pairs[:, 1],
        rest_length=np.concatenate([*(made.rest_length for made in bodies), _loose_lengths(level, position, parts)]),
        spring_item=np.concatenate([np.repeat(numbers[: len(bodies)], springs_of_bodies), numbers[owners:]]),
        number=np.concatenate([*(made.numbers for made in bodies), numbers[: len(level.springs)]]),
        material=np.concatenate(
            [np.repeat(used, springs_of_bodies), np.array([index[s.material] for s in level.springs], dtype=np.int64)]
        ),
        materials=materials,
        welds=np.array(welds, dtype=np.int64).reshape(-1, 2),
        first_of_weld=first_of_weld,
        parts=parts,
    )


def transformed(scene: Scene, selection: Selection, matrix: Floats) -> Scene:
    """The scene with the particles of a selection mapped by matrix (2, 3), as a preview: rest lengths stay."""
    moved = scene.particles_of(selection)
    position = scene.position.copy()
    position[moved] = position[moved] @ matrix[:, :2].T + matrix[:, 2]
    return replace(scene, position=position[scene.first_of_weld] if len(scene.welds) else position)


def _parts(level: Level, before: Scene | None) -> _Parts:
    old = before.parts if before is not None else None
    if before is not None and old is not None and level.bodies is before.level.bodies:
        bodies, forms = old.bodies, old.forms
    else:
        bodies, forms = _expand(level, before)
    if before is not None and old is not None and level.particles is before.level.particles:
        loose = old.loose
    else:
        loose = _loose(level)
    counts = [len(made.mass) for made in bodies]
    same_names = old is not None and old.names.serve(level, counts)
    names = old.names if old is not None and same_names else _Names(level, items_of(level), counts)
    if before is not None and old is not None and same_names and level.springs is before.level.springs:
        ends = old.ends
    else:
        slots = [(names.layout.slot(s.a), names.layout.slot(s.b)) for s in level.springs]
        ends = np.array(slots, dtype=np.int64).reshape(-1, 2)
    return _Parts(bodies, forms, loose, names, ends)


def _loose(level: Level) -> _Loose:
    loose = level.particles
    return _Loose(
        position=np.array([particle.position for particle in loose], dtype=np.float64).reshape(-1, 2),
        mass=np.array([particle.mass for particle in loose], dtype=np.float64),
        radius=np.array([particle.radius for particle in loose], dtype=np.float64),
        pinned=np.array([particle.pinned for particle in loose], dtype=np.bool_),
    )


def _loose_lengths(level: Level, position: Floats, parts: _Parts) -> Floats:
    given = np.array([np.nan if s.rest_length is None else s.rest_length for s in level.springs], dtype=np.float64)
    return np.where(np.isnan(given), distances(position, parts.ends), given)


def _expand(level: Level, before: Scene | None) -> tuple[list[Expansion], dict[tuple[Any, ...], Expansion]]:
    """Expansions of the bodies, taken over for those that did not change, and forms that several bodies share."""
    known: dict[int, Expansion] = {}
    old_forms: dict[tuple[Any, ...], Expansion] = {}
    if before is not None:
        known = {id(body): made for body, made in zip(before.level.bodies, before.parts.bodies, strict=True)}
        old_forms = before.parts.forms
    forms: dict[tuple[Any, ...], Expansion] = {}
    made = []
    for body in level.bodies:
        key = _form_key(body)
        if key is not None:
            if key not in forms:
                forms[key] = old_forms[key] if key in old_forms else expansion(replaced(body, position=(0.0, 0.0)))
            made.append(known.get(id(body)) or _placed(forms[key], body))
        else:
            made.append(known.get(id(body)) or expansion(body))
    return made, forms


def _form_key(body: AnyBody) -> tuple[Any, ...] | None:
    """All that shapes a body but its place; None where a move alters more than one point."""
    if not isinstance(body, JellyDef | RingDef | WebDef | WheelDef) or body.pose is not None:
        return None
    return type(body), *(value for name, value in body.__dict__.items() if name not in _PLACED)


# Fields of a body that its particles do not depend on, but for the place that is added to each of them.
_PLACED = ("type", "id", "position", "velocity", "material", "group", "extras")


def _placed(form: Expansion, body: AnyBody) -> Expansion:
    # A form about (0, 0) moved by its position has the very bits of one that is expanded there.
    assert isinstance(body, JellyDef | RingDef | WebDef | WheelDef)
    place = form.position + np.array(body.position)
    return replace(form, position=place, form=place)
