"""Copies of what is selected: as text, pasted, duplicated, in a row, in a circle, and as parts of the catalogue.

A fragment is a level of its own: selected bodies, loose particles, terrain and zones, loose springs and welds between
them, the materials that they are made of, and the tick rate that these are for. The origin of a part is what the
pointer holds it by; of what is kept that is the middle of its lower edge.
"""

from collections.abc import Iterable, Mapping

import numpy as np

from sandbox.editor.document import Document, EditError, checked
from sandbox.editor.edits.grouping import group as grouped
from sandbox.editor.edits.grouping import taken_groups
from sandbox.editor.edits.materials import set_rate_in_pace, without_lost_groups
from sandbox.editor.edits.moving import mirror, move, rotate
from sandbox.editor.edits.names import free_ids, owner_of, renamed, rewired, taken_ids
from sandbox.editor.items import (
    Item,
    Selection,
    chosen_bodies,
    chosen_particles,
    chosen_terrain,
    chosen_zones,
    items_of,
    keys,
)
from sandbox.editor.scene import make_scene
from sandbox.editor.tools.snap import PLACE_DECIMALS
from sandbox.level.document.canonical import level_text
from sandbox.level.document.model import ContactsDef, Level, Material, NissenMaterial, ParticleDef, Settings, SpringDef
from sandbox.level.format.level_error import LevelError
from sandbox.level.format.limits import DEFAULT_MATERIAL, PARTICLE_LIMIT, SPRING_LIMIT, TEXT_LIMIT
from sandbox.level.format.picture import Picture
from sandbox.level.format.quantities import Point, replaced
from sandbox.level.kinds.bodies import AnyBody, expansion
from sandbox.level.reading.parse import parse_level
from sandbox.level.reading.pictures import pictures_of, take_pictures


def copy_text(document: Document) -> str:
    """The selection as the text of a level. Raises EditError where it is empty, or springs alone."""
    return level_text(fragment(document))


def paste(
    document: Document, text: str, at: Point | None = None, pictures: Mapping[str, Picture] | None = None
) -> Document:
    """Add what a text holds, a fragment or a whole level, and select it; at [m]: its middle, None = where it was.

    pictures: by the names that the text has for them; others are those of the document. Ids become free ones; materials
    of the same name and values are shared, others get a name of their own. Settings, checks and rules of a whole level
    are not taken. Raises EditError for a text that is no level, or is too large.
    """
    try:
        found = parse_level(text.encode("utf-8", "replace"), "what was copied")
    except LevelError as error:
        raise EditError(error.faults[0]) from None
    if not (found.bodies or found.particles or found.terrain or found.zones):
        raise EditError("the copied level is empty")
    take_pictures(found, pictures_of(document.level) | dict(pictures or {}))
    return put_in(document, found, at)


def put_in(document: Document, found: Level, at: Point | None = None) -> Document:
    """Add the things of another level, as `paste` does."""
    box = make_scene(found).bounds()
    if at is not None and box is not None:
        found = shifted(found, at[0] - (box[0] + box[2]) / 2.0, at[1] - (box[1] + box[3]) / 2.0)
    return Document(*inserted(document.level, [found]))


def duplicate(document: Document, dx: float, dy: float) -> Document:
    """Add a copy of what is selected, moved by dx, dy [m], and select it. Raises EditError."""
    return Document(*inserted(document.level, [shifted(fragment(document), dx, dy)]))


def array_line(document: Document, count: int, dx: float, dy: float) -> Document:
    """Make `count` in a row of what is selected, each dx, dy [m] from the one before, and select all of them."""
    first = _repeated(document, count)
    return _arrayed(document, [shifted(first, k * dx, k * dy) for k in range(1, count)])


def array_circle(document: Document, count: int, centre: Point, angle: float) -> Document:
    """Make `count` in a circle of what is selected, each turned by angle [rad] from the one before, and select all."""
    first = _repeated(document, count)
    whole = frozenset(items_of(first))
    return _arrayed(document, [rotate(Document(first, whole), k * angle, centre).level for k in range(1, count)])


def fragment(document: Document) -> Level:
    """The selection as a level of its own. Raises EditError where it is empty, or springs alone."""
    level, selection = document.level, document.selection
    bodies, particles = chosen_bodies(level, selection), chosen_particles(level, selection)
    terrain, zones = chosen_terrain(level, selection), chosen_zones(level, selection)
    if not (bodies or particles or terrain or zones):
        raise EditError("select something to copy; for springs, select their ends too")
    owners = keys(selection, "body") | keys(selection, "particle")
    inside = tuple(spring for spring in level.springs if _inside(owners, spring.a, spring.b))
    used = _used([*bodies, *inside])
    part = Level(
        format=level.format,
        version=level.version,
        name=level.name,
        settings=Settings(tick_rate=level.settings.tick_rate),
        materials={name: material for name, material in level.materials.items() if name in used},
        terrain=tuple(terrain),
        zones=tuple(zones),
        bodies=tuple(bodies),
        particles=tuple(particles),
        springs=inside,
        welds=tuple(pair for pair in level.welds if _inside(owners, *pair)),
    )
    return without_lost_groups(part)


def _inside(owners: frozenset[str | int], *references: str) -> bool:
    return all(owner_of(reference) in owners for reference in references)


def _used(parts: Iterable[AnyBody | SpringDef]) -> set[str]:
    return {part.material for part in parts}


def shifted(level: Level, dx: float, dy: float) -> Level:
    """A level with all that is in it moved by dx, dy [m]. Raises EditError where it would leave the world."""
    return move(Document(level, frozenset(items_of(level))), dx, dy).level


def _repeated(document: Document, count: int) -> Level:
    """The fragment to repeat. Raises EditError before anything is made that would be too much."""
    if count < 2:
        raise EditError("a row or circle needs two or more")
    first = fragment(document)
    total = [_size(level, part) for level in (document.level, first) for part in (0, 1)]
    for now, more, noun, limit in (
        (total[0], total[2], "particles", PARTICLE_LIMIT),
        (total[1], total[3], "springs", SPRING_LIMIT),
    ):
        if now + (count - 1) * more > limit:
            raise EditError(f"{count} of them bring the level above {limit:,} {noun}; make fewer")
    return first


def _size(level: Level, part: int) -> int:
    loose = (level.particles, level.springs)[part]
    return len(loose) + sum(expansion(body).count[part] for body in level.bodies)


def _arrayed(document: Document, copies: list[Level]) -> Document:
    level, selection = inserted(document.level, copies)
    return Document(level, selection | document.selection)


def inserted(level: Level, copies: Iterable[Level]) -> tuple[Level, Selection]:
    """A level with the contents of others, sound by themselves, and which items these became. Raises EditError.

    What was made for another tick rate goes on as fast per second as it did there.
    """
    ids, groups = taken_ids(level), taken_groups(level)
    bodies, particles, springs, welds = (
        list(part) for part in (level.bodies, level.particles, level.springs, level.welds)
    )
    terrain, zones = list(level.terrain), list(level.zones)
    materials = dict(level.materials)
    selection: set[Item] = set()
    for copy in copies:
        copy = set_rate_in_pace(Document(copy), level.settings.tick_rate).level
        copy = _renamed(copy, ids, groups, materials)
        selection |= {Item("body", body.id) for body in copy.bodies}
        selection |= {Item("particle", particle.id) for particle in copy.particles}
        selection |= {Item("spring", len(springs) + index) for index in range(len(copy.springs))}
        selection |= {Item("terrain", piece.id) for piece in copy.terrain}
        selection |= {Item("zone", zone.id) for zone in copy.zones}
        terrain += copy.terrain
        zones += copy.zones
        bodies += copy.bodies
        particles += copy.particles
        springs += copy.springs
        welds += copy.welds
    level = replaced(
        level,
        materials=materials,
        terrain=tuple(terrain),
        zones=tuple(zones),
        bodies=tuple(bodies),
        particles=tuple(particles),
        springs=tuple(springs),
        welds=tuple(welds),
    )
    return checked(level), frozenset(selection)


def _renamed(copy: Level, ids: set[str], groups: set[str], materials: dict[str, Material]) -> Level:
    """A level with free ids and groups, made of `materials`; all three grow by what it brings."""
    old = [part.id for items in (copy.bodies, copy.particles, copy.terrain, copy.zones) for part in items]
    names = dict(zip(old, free_ids(ids, old), strict=True))
    parts = sorted(taken_groups(copy))
    group_names: dict[str | None, str | None] = {None: None, **dict(zip(parts, free_ids(groups, parts), strict=True))}
    used = {name: _material(copy, name, materials) for name in sorted(_used([*copy.bodies, *copy.springs]))}
    copy, _ = rewired(replaced(copy, checks=(), rules=(), hands=None), renamed(names))

    def particle(part: ParticleDef) -> ParticleDef:
        return replaced(part, id=names[part.id], group=group_names[part.group])

    return replaced(
        copy,
        terrain=tuple(replaced(piece, id=names[piece.id], group=group_names[piece.group]) for piece in copy.terrain),
        zones=tuple(replaced(zone, id=names[zone.id]) for zone in copy.zones),
        bodies=tuple(
            replaced(body, id=names[body.id], group=group_names[body.group], material=used[body.material])
            for body in copy.bodies
        ),
        particles=tuple(map(particle, copy.particles)),
        springs=tuple(
            replaced(spring, group=group_names[spring.group], material=used[spring.material]) for spring in copy.springs
        ),
    )


def _material(copy: Level, name: str, materials: dict[str, Material]) -> str:
    """The name of a copy's material among `materials`, which gets it where it has none of its values."""
    built_in = {DEFAULT_MATERIAL: NissenMaterial()}
    own = copy.materials.get(name, built_in.get(name))
    assert own is not None
    if (materials.get(name, built_in.get(name)) or own) == own:
        if name != DEFAULT_MATERIAL or name in copy.materials:
            materials.setdefault(name, own)
        return name
    for other, material in materials.items():
        if material == own and other.rpartition(" ")[0] == name:
            return other
    free = free_ids(set(materials), [name])[0]
    materials[free] = own
    return free


def place_part(document: Document, part: Level, at: Point, mirrored: bool = False) -> Document:
    """Add a part with its origin at a point [m], as one group, and select it; mirrored: left for right.

    Names become free ones; materials of the same name and values are shared, others get a name of their own. Where
    nothing touches anything yet and the part is made to touch, things do from now on. Raises EditError.
    """
    whole = Document(part, frozenset(items_of(part)))
    if not whole.selection:
        raise EditError("there is nothing in this part")
    if mirrored:
        whole = mirror(whole, "x", (0.0, 0.0))
    if len(whole.selection) > 1:
        whole = grouped(whole, part.name)
    level = document.level
    if part.contacts is not None and not level.has_contacts:
        level = replaced(level, contacts=part.contacts)
    return Document(*inserted(level, [shifted(whole.level, *at)]))


def part_of(document: Document, name: str) -> Level:
    """The selection as a part of that name. Raises EditError where it is empty, or the name none."""
    name = name.strip()
    if not 0 < len(name) <= TEXT_LIMIT:
        raise EditError(f"a name has 1 to {TEXT_LIMIT} characters")
    part, level = fragment(document), document.level
    scene = make_scene(part)
    box = scene.bounds()
    assert box is not None
    left, bottom, right, _ = box
    # Particles stand on their rims.
    bottom = min(bottom, float(np.min(scene.position[:, 1] - scene.radius, initial=np.inf)))
    part = shifted(part, -round((left + right) / 2.0, PLACE_DECIMALS), -round(bottom, PLACE_DECIMALS))
    contacts = (level.contacts or ContactsDef()) if level.has_contacts else None
    return replaced(part, name=name, description="", contacts=contacts)
