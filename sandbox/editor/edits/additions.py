"""Additions: objects that a part of a level may have, such as a motor, with first values that fit it."""

from collections.abc import Callable, Iterable
from functools import partial
from typing import Any

import numpy as np

from sandbox.editor.document import Document, EditError
from sandbox.editor.edits.fields import change_items
from sandbox.editor.items import Definition, Item
from sandbox.editor.panel.typed import significant
from sandbox.editor.scene import Scene, make_scene
from sandbox.level.format.actuator_defs import HydraulicDef, MotorDef, MuscleDef
from sandbox.level.format.limits import TORQUE_LIMIT
from sandbox.level.format.look import BodyLook, ParticleLook
from sandbox.level.format.model import ParticleDef, SpringDef
from sandbox.level.kinds.bodies import expansion
from sandbox.level.kinds.body_def import BendingDef, FirmnessDef
from sandbox.level.kinds.wheel import WheelDef

# A new muscle swings by this share of its length, once in so many ticks: a second, at 60 ticks in one.
MUSCLE = MuscleDef(amplitude=0.2, period=60)
# A body is given this firmness first.
SOFT = FirmnessDef(sag=0.1)
# A new motor turns at this rate [rad/s], with the torque that holds this share of its wheel's weight at the rim.
MOTOR_SPEED = 3.0
MOTOR_SHARE = 0.5
WEIGHT = 9.81  # [N/kg]
# A new hydraulic begins as long as its spring is drawn, reaches this much of that, and needs a second for it.
HYDRAULIC_REACH = 1.5
# A spring without length could not be made longer by a share of it [m].
SHORTEST_HYDRAULIC = 0.1
# Digits of a value that is found so; a person reads it.
DIGITS = 3


def add_object(document: Document, items: Iterable[Item], field: str) -> Document:
    """Give items an object in a field, where they have none; all of them have the field. Raises EditError."""
    scene = make_scene(document.level) if field == "hydraulic" else None

    def with_object(part: Definition) -> Any:
        present = part.__dict__[field]
        return _FIRST[field](part, scene) if present is None else present

    return change_items(document, items, field, with_object)


def _motor(part: Definition, _: Scene | None) -> MotorDef:
    if not isinstance(part, WheelDef):
        raise EditError("only a wheel has a motor")
    weight = WEIGHT * float(np.sum(expansion(part).mass))
    torque = min(significant(MOTOR_SHARE * weight * part.radius, DIGITS), TORQUE_LIMIT)
    return MotorDef(speed=MOTOR_SPEED, torque=torque)


def _hydraulic(part: Definition, scene: Scene | None) -> HydraulicDef:
    assert isinstance(part, SpringDef) and scene is not None
    shortest = part.rest_length
    if shortest is None:
        a, b = (scene.position[scene.slot(end)] for end in (part.a, part.b))
        shortest = significant(float(np.hypot(*(a - b))), DIGITS)
    shortest = shortest or SHORTEST_HYDRAULIC
    longest = significant(HYDRAULIC_REACH * shortest, DIGITS)
    return HydraulicDef(shortest=shortest, longest=longest, rate=significant(longest - shortest, DIGITS))


def _look(part: Definition, _: Scene | None) -> BodyLook | ParticleLook:
    # All of it is automatic at first.
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
}
