"""Additions: objects that a part of a level may have, such as a motor; muscles that swing one after another."""

import math
from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from sandbox.editor.document import Document, EditError, checked
from sandbox.editor.edits.fields import change_items
from sandbox.editor.items import Definition, Item, changed, chosen_items, definitions, items_of
from sandbox.editor.scene import Scene, make_scene
from sandbox.level.document.model import Level, ParticleDef, SpringDef, WaterDef, ZoneDef
from sandbox.level.format.actuator_defs import HydraulicDef, MotorDef, MuscleDef
from sandbox.level.format.limits import TORQUE_LIMIT
from sandbox.level.format.look import BodyLook, ParticleLook, ZoneLook
from sandbox.level.format.quantities import Point, replaced, significant
from sandbox.level.kinds.bodies import expansion
from sandbox.level.kinds.body_def import BendingDef, FirmnessDef
from sandbox.level.kinds.wheel import WheelDef
from sandbox.level.plan.surfaces import mount_of

# A new muscle swings by this share of its length, once in this many ticks: a second, at 60 ticks in one.
MUSCLE = MuscleDef(amplitude=0.2, period=60)
# A body is given this firmness first.
SOFT = FirmnessDef(sag=0.1)
# A new motor turns at this rate [rad/s]. It has this share of the torque that lifts its whole vehicle straight up at
# its rim: one wheel alone climbs from corner to corner of 16 with 0.2 of it, and 10 degrees with another 0.17.
MOTOR_SPEED = 3.0
MOTOR_SHARE = 0.75
# Of few segments it is at least this many times the torque that climbing from corner to corner takes.
CORNERS_SHARE = 2.0
WEIGHT = 9.81  # [N/kg], where a level has no gravity
# A new hydraulic begins as long as its spring is drawn, reaches this much of that, and needs a second for it.
HYDRAULIC_REACH = 1.5
# A spring without length could not be made longer by a share of it [m].
SHORTEST_HYDRAULIC = 0.1
# Digits of a value that is found so; a person reads it.
DIGITS = 3


# Digits of a phase behind the point: a part in 10,000 of a period is less than a tick.
DECIMALS = 4


def add_object(document: Document, items: Iterable[Item], field: str) -> Document:
    """Give items an object in a field, where they have none; all of them have the field. Raises EditError.

    A spring that becomes a hydraulic gets its drawn length as its rest length, so that it begins as drawn however short
    it may become.
    """
    items = frozenset(items)
    scene = make_scene(document.level) if field in ("hydraulic", "motor") else None

    def with_object(part: Definition) -> Any:
        present = part.__dict__[field]
        return _FIRST[field](part, scene) if present is None else present

    added = change_items(document, items, field, with_object)
    return _begun_as_drawn(document, added, items) if field == "hydraulic" else added


def _begun_as_drawn(before: Document, added: Document, items: Iterable[Item]) -> Document:
    springs = before.level.springs
    new = [item for item in items if springs[int(item.key)].hydraulic is None]

    def length(part: Definition) -> float | None:
        assert isinstance(part, SpringDef) and part.hydraulic is not None
        return part.hydraulic.shortest if part.rest_length is None else part.rest_length

    return change_items(added, new, "rest_length", length)


def first_torque(level: Level, index: int) -> float:
    """The torque [N m] of a new motor of the wheel of that index: what the weight of all that it is mounted on asks."""
    wheel = level.bodies[index]
    assert isinstance(wheel, WheelDef)
    vehicle = {index, *mount_of(level, index)}
    mass = sum(float(np.sum(expansion(body).mass)) for k, body in enumerate(level.bodies) if k in vehicle)
    mass += sum(part.mass for k, part in enumerate(level.particles, len(level.bodies)) if k in vehicle)
    fraction = max(MOTOR_SHARE, CORNERS_SHARE * math.sin(math.pi / wheel.segments))
    gravity = math.hypot(*level.settings.gravity) or WEIGHT
    return min(significant(fraction * mass * gravity * wheel.radius, DIGITS), TORQUE_LIMIT)


def _motor(part: Definition, scene: Scene | None) -> MotorDef:
    if not isinstance(part, WheelDef):
        raise EditError("only a wheel has a motor")
    assert scene is not None
    index = [body.id for body in scene.level.bodies].index(part.id)
    return MotorDef(speed=MOTOR_SPEED, torque=first_torque(scene.level, index))


def _hydraulic(part: Definition, scene: Scene | None) -> HydraulicDef:
    assert isinstance(part, SpringDef) and scene is not None
    shortest = part.rest_length
    if shortest is None:
        a, b = (scene.position[scene.slot(end)] for end in (part.a, part.b))
        shortest = significant(float(np.hypot(*(a - b))), DIGITS)
    shortest = shortest or SHORTEST_HYDRAULIC
    longest = significant(HYDRAULIC_REACH * shortest, DIGITS)
    return HydraulicDef(shortest=shortest, longest=longest, rate=significant(longest - shortest, DIGITS))


def _look(part: Definition, _: Scene | None) -> BodyLook | ParticleLook | ZoneLook:
    # All of it is automatic at first.
    if isinstance(part, ZoneDef):
        return ZoneLook()
    return ParticleLook() if isinstance(part, ParticleDef) else BodyLook()


def _same(first: Any, *_: Any) -> Any:
    return first


_FIRST: dict[str, Callable[[Definition, Scene | None], Any]] = {
    "drive": partial(_same, MUSCLE),
    "motor": _motor,
    "hydraulic": _hydraulic,
    "bending": partial(_same, BendingDef()),
    "firmness": partial(_same, SOFT),
    "look": _look,
    "water": partial(_same, WaterDef()),
}


def muscles(document: Document) -> list[Item]:
    """The selected muscles in file order, or all of the level where none is selected; bodies whose springs are, too."""
    level = document.level
    found = chosen_items(level, document.selection)
    chosen = [item for item, part in found.items() if part.__dict__.get("drive") is not None]
    every = zip(items_of(level), definitions(level), strict=True)
    return chosen or [item for item, part in every if part.__dict__.get("drive") is not None]


def wave_along(document: Document, start: Point, end: Point, waves: float = 1.0) -> Document:
    """Swing muscles the later the farther they lie on the way from start to end [m]: this many waves along it.

    The wave runs from start to end; what lies beside is measured along the way. Raises EditError.
    """
    way = np.subtract(end, start)
    squared = float(way @ way)
    if squared == 0.0:
        raise EditError("drag farther")
    scene = make_scene(document.level)

    def fraction(item: Item) -> float:
        own = frozenset([item])
        springs = np.flatnonzero(scene.springs_of(own))
        ends = np.concatenate([scene.particle_a[springs], scene.particle_b[springs]])
        return float((scene.position[ends].mean(axis=0) - start) @ way) / squared

    return _with_phases(document, fraction, waves)


def wave_in_order(document: Document, waves: float = 1.0) -> Document:
    """Swing muscles one after another in their order, this many waves once round. Raises EditError."""
    found = muscles(document)
    places = {item: index / len(found) for index, item in enumerate(found)}
    return _with_phases(document, places.__getitem__, waves)


def _with_phases(document: Document, fraction: Callable[[Item], float], waves: float) -> Document:
    """The document with the phase of every muscle by its share of the way."""
    if not math.isfinite(waves):
        raise EditError("waves: give a number")
    found = muscles(document)
    if not found:
        raise EditError("there is no muscle; select springs or bodies, and add one under Drive in Properties")
    level, phases = document.level, {item: _phase(-waves * fraction(item)) for item in found}
    for phase in set(phases.values()):
        alike = frozenset(item for item in found if phases[item] == phase)
        level = changed(level, alike, lambda part, phase=phase: _ahead(part, phase))  # type: ignore[misc]
    return document if level is document.level else replace(document, level=checked(level))


def _phase(turns: float) -> float:
    """A phase from 0 up to 1."""
    return round(turns % 1.0, DECIMALS) % 1.0


def _ahead(part: Definition, phase: float) -> Definition:
    drive = part.__dict__["drive"]
    return part if drive.phase == phase else replaced(part, drive=replaced(drive, phase=phase))
