"""How heavy things are, as a panel shows and sets it: mass of the whole, density, and how deep they lie in water."""

from collections.abc import Mapping
from functools import partial
from typing import Any

import numpy as np

from sandbox.editor.document import Document, empty_level
from sandbox.editor.edits.fields import change_items
from sandbox.editor.edits.weighing import mass_of, masses_for
from sandbox.editor.items import Definition, Item
from sandbox.editor.panel.field_info import FieldInfo
from sandbox.editor.panel.property import Property, in_range, same
from sandbox.level.assembly.build_world import build_world
from sandbox.level.document.model import Level, ParticleDef, Settings, WaterDef, ZoneDef
from sandbox.level.format.limits import BODY_RADIUS, MASS_RANGE
from sandbox.level.format.quantities import replaced, significant
from sandbox.level.kinds.bodies import expansion
from sandbox.level.kinds.body_def import BodyDef
from sandbox.physics.analysis.beginning import draught_of, lift_of, parts_of

# Digits of what is shown.
DIGITS = 6
# Worlds of more particles take so long to make that a person waits for them; then nothing is said.
LARGEST = 1_000
_MASS = FieldInfo(
    "number",
    "Whole mass",
    "kg",
    *MASS_RANGE,
    tooltip="Mass of the whole body, shared by its particles.",
)
_DENSITY = FieldInfo(
    "number", "Density", "kg/m²", *MASS_RANGE,
    tooltip="Mass of a square metre of what water cannot enter. What has less than the water floats.",
)  # fmt: skip
_FLOATS = FieldInfo(
    "text", "In water",
    tooltip="How deep it lies in the water that it is in or above, or what share of its weight that bears. As it is "
    "drawn, with what it is joined to; what is tall turns over.",
)  # fmt: skip


def weight_properties(level: Level, parts: Mapping[Item, Definition]) -> list[Property]:
    """Mass of the whole and density of bodies and balls; of a single one also how it lies in water."""
    things = {item: part for item, part in parts.items() if isinstance(part, BodyDef | ParticleDef)}
    bodies = {item: part for item, part in things.items() if isinstance(part, BodyDef)}
    made = []
    if bodies:
        mass = same(significant(mass_of(part), DIGITS) for part in bodies.values())
        made.append(Property("weight.mass", _MASS, mass, partial(_weigh, bodies, _MASS, dict.fromkeys(bodies, 1.0))))
    if things and sum(map(_size, things.values())) <= LARGEST:
        areas = dict(zip(things, _areas(level, things), strict=True))
        if all(areas.values()):
            density = same(significant(mass_of(part) / areas[item], DIGITS) for item, part in things.items())
            write = partial(_weigh, things, _DENSITY, areas)
            made.append(Property("weight.density", _DENSITY, density, write))
        if len(parts) == 1 and (said := in_water(level, next(iter(things)))):
            made.append(Property("weight.floats", _FLOATS, said))
    return made


def in_water(level: Level, item: Item) -> str:
    """How a body or ball lies in the water that it is in or above, in words; "" where it is in none, or is held."""
    names = [*(body.id for body in level.bodies), *(ball.id for ball in level.particles)]
    if not level.has_water or len(level.particles) + sum(map(_size, level.bodies)) > LARGEST:
        return ""
    world = build_world(level)
    part, mine = parts_of(world), np.flatnonzero(world.owner == names.index(str(item.key)))
    found = draught_of(world, np.flatnonzero(part == part[mine[0]])) if len(mine) else None
    if found is None:
        return ""
    if found.depth is None:
        return f"sinks: {found.borne:.0%} is borne"
    return f"floats, {found.depth:.2f} m under"


def _size(part: Definition) -> int:
    return expansion(part).form_count[0] if isinstance(part, BodyDef) else 1


def _areas(level: Level, things: Mapping[Item, BodyDef | ParticleDef]) -> list[float]:
    """Areas [m^2] of what water cannot enter of things that nothing holds, as water has them."""
    free = [_freed(part, f"thing {number}") for number, part in enumerate(things.values())]
    bodies = [part for part in free if isinstance(part, BodyDef)]
    balls = [part for part in free if isinstance(part, ParticleDef)]
    dry = replaced(empty_level(), materials=level.materials, settings=Settings(gravity=(0.0, -1.0)))
    dry = replaced(dry, bodies=tuple(bodies), particles=tuple(balls))
    places = np.concatenate([*(expansion(part).position for part in bodies), *([part.position] for part in balls)])
    room = 1.0 + max(
        part.radius if isinstance(part, ParticleDef) else part.particle_radius or BODY_RADIUS for part in free
    )
    low, high = (places.min(axis=0) - room).tolist(), (places.max(axis=0) + room).tolist()
    world = build_world(replaced(dry, zones=(ZoneDef(id="water", box=(*low, *high), water=WaterDef(density=1.0)),)))
    ids = [*(part.id for part in bodies), *(part.id for part in balls)]
    owners = [ids.index(part.id) for part in free]
    moving = world.inverse_mass > 0.0
    return [significant(lift_of(world, np.flatnonzero((world.owner == owner) & moving)), DIGITS) for owner in owners]


def _freed(part: Any, name: str) -> Any:
    """A thing as water has it, without what holds it or names other things of its level."""
    changes: dict[str, Any] = (
        {"pinned": (), "pin": (), "firmness": None} if isinstance(part, BodyDef) else {"pinned": False}
    )
    changes |= {"collides": True, "collision_group": None, "id": name}
    return replaced(part, **{field: value for field, value in changes.items() if field in part.__dict__})


def _weigh(
    things: Mapping[Item, BodyDef | ParticleDef],
    about: FieldInfo,
    per: Mapping[Item, float],
    document: Document,
    value: float,
) -> Document:
    for item, part in things.items():
        for field, masses in masses_for(part, in_range(about, value) * per[item]).items():
            document = change_items(document, [item], field, partial(_give, masses))
    return document


def _give(value: Any, _: Definition) -> Any:
    return value
