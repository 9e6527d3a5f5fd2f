"""Putting things into a level: bodies, particles, springs, welds, pins and cuts."""

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sandbox.editor.document import Document, EditError, checked, validated
from sandbox.editor.edits.names import free_id, with_springs_followed
from sandbox.editor.items import Item, kept_springs, with_same
from sandbox.editor.scene import Scene, make_scene
from sandbox.level.document.model import Level, ParticleDef, SpringDef
from sandbox.level.format.limits import DEFAULT_MATERIAL
from sandbox.level.format.quantities import replaced
from sandbox.level.kinds.bodies import AnyBody, expansion

Mask = NDArray[np.bool_]


def add_body(document: Document, body: AnyBody) -> Document:
    """Add a body, by a free id, and select it. Raises EditError where the level could not be saved with it."""
    level = document.level
    body = validated(replaced(body, id=free_id(level, body.id)))
    level = checked(replaced(level, bodies=(*level.bodies, body)))
    return Document(level, frozenset([Item("body", body.id)]))


def add_particle(document: Document, particle: ParticleDef) -> Document:
    """Add a loose particle, by a free id, and select it. Raises EditError where the level could not be saved then."""
    level = document.level
    particle = validated(replaced(particle, id=free_id(level, particle.id)))
    level = checked(replaced(level, particles=(*level.particles, particle)))
    return Document(level, frozenset([Item("particle", particle.id)]))


def add_spring(
    document: Document, a: str, b: str, material: str | None = None, rest_length: float | None = None
) -> Document:
    """Join two particles, by name, with a spring and select it; rest_length [m], None = as placed. Raises EditError."""
    level = document.level
    used = DEFAULT_MATERIAL if material is None else material
    spring = validated(SpringDef.model_construct(a=a, b=b, rest_length=rest_length, material=used))
    level = checked(replaced(level, springs=(*level.springs, spring)))
    return Document(level, frozenset([Item("spring", len(level.springs) - 1)]))


def weld(document: Document, a: str, b: str) -> Document:
    """Make one of two particles, by name. Raises EditError where they are one, or a spring would join it to itself."""
    level = document.level
    scene = make_scene(level)
    first, second = _slot(scene, a), _slot(scene, b)
    if scene.first_of_weld[first] == scene.first_of_weld[second]:
        raise EditError(f'"{a}" and "{b}" are one particle already')
    return replace(document, level=checked(replaced(level, welds=(*level.welds, (a, b)))))


def unweld(document: Document, name: str) -> Document:
    """Take a particle, by name, out of its weld. Raises EditError where it is welded to none."""
    level = document.level
    scene = make_scene(level)
    slot = _slot(scene, name)
    welds = tuple(pair for pair, ends in zip(level.welds, scene.welds.tolist(), strict=True) if slot not in ends)
    if len(welds) == len(level.welds):
        raise EditError(f'"{name}" is welded to nothing')
    return replace(document, level=checked(replaced(level, welds=welds)))


def set_pinned(document: Document, names: Iterable[str], pinned: bool) -> Document:
    """Hold particles, by name, or let go of them and of all that they are welded to. Raises EditError."""
    level = document.level
    scene = make_scene(level)
    slots = {_slot(scene, name) for name in names}
    if not pinned and len(scene.welds):
        firsts = {int(scene.first_of_weld[slot]) for slot in slots}
        slots |= {slot for slot, first in enumerate(scene.first_of_weld.tolist()) if first in firsts}
    return replace(document, level=repinned(level, scene, dict.fromkeys(slots, pinned)))


def repinned(level: Level, scene: Scene, pinned: dict[int, bool]) -> Level:
    """A level with particles held or not, by index in its scene; nothing changes for those that are so already."""
    bodies: dict[str | int, dict[int, bool]] = {}
    particles: dict[str | int, bool] = {}
    for slot, held in pinned.items():
        kind, key = scene.items[int(scene.particle_item[slot])]
        if kind == "particle":
            particles[key] = held
        else:
            bodies.setdefault(key, {})[int(scene.names(slot).rpartition(".")[2])] = held

    def body_with(body: AnyBody) -> AnyBody:
        before = pins_of(body)
        after = before.copy()
        for index, held in bodies[body.id].items():
            after[index] = held
        return body if (before == after).all() else with_pins(body, after)

    def particle_with(part: ParticleDef) -> ParticleDef:
        held = particles.get(part.id, part.pinned)
        return part if held == part.pinned else replaced(part, pinned=held)

    return with_same(
        level,
        bodies=tuple(body_with(body) if body.id in bodies else body for body in level.bodies),
        particles=tuple(particle_with(part) for part in level.particles) if particles else level.particles,
    )


def without_springs(document: Document, cut: dict[str, set[int]], gone: set[int]) -> Document:
    """The document with springs of bodies cut and loose springs, by index, taken out."""
    level = document.level
    bodies = tuple(
        replaced(body, cut=tuple(sorted({*body.cut, *cut[body.id]})))
        if cut.get(body.id, set()) - set(body.cut)
        else body
        for body in level.bodies
    )
    kept = [index for index in range(len(level.springs)) if index not in gone]
    springs = tuple(level.springs[index] for index in kept)
    level = with_springs_followed(with_same(level, bodies=bodies, springs=springs), level.rules, kept)
    return Document(level, kept_springs(document.selection, kept))


def _slot(scene: Scene, name: str) -> int:
    try:
        return scene.slot(name)
    except LookupError as error:
        raise EditError(str(error.args[0])) from None


def pins_of(body: AnyBody) -> Mask:
    """Which particles of a body (n,) are held."""
    return expansion(body).pinned


def with_pins(body: AnyBody, pinned: Mask) -> AnyBody:
    """The body with those particles (n,) held and no others; an end that was named stays so where all of it is held."""
    named = np.zeros(len(pinned), dtype=np.bool_)
    changes = {}
    if "pin" in body.__dict__:
        kept = []
        for end in body.__dict__["pin"]:
            held = pins_of(replaced(body, pin=(end,), pinned=(), cut=(), pose=None))
            if np.all(pinned[held]):
                kept.append(end)
                named |= held
        changes["pin"] = tuple(kept)
    return replaced(body, pinned=tuple(np.flatnonzero(pinned & ~named).tolist()), **changes)
