"""SceneActuators: which springs and hubs of a scene are driven, and where a picture of the level says so."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from sandbox.editor.items import Item
from sandbox.editor.scene import Scene
from sandbox.level.format.actuator_defs import HydraulicDef, MotorDef
from sandbox.level.kinds.wheel import WheelDef
from sandbox.level.plan.actuators import actuators


class SceneActuators(NamedTuple):
    """Springs that are muscles, one for each body of them; hydraulics; hubs with motors, and inner radii [m]."""

    muscles: list[int]
    hydraulics: list[tuple[int, HydraulicDef]]
    motors: list[tuple[int, float, MotorDef]]


def scene_actuators(scene: Scene) -> SceneActuators:
    """Find what is driven in a scene."""
    level = scene.level
    found = SceneActuators([], [], [])
    for index, body in enumerate(level.bodies):
        if body.drive is not None:
            start, end = np.searchsorted(scene.spring_item, [index, index + 1]).tolist()
            if start < end:
                found.muscles.append(_middle(scene, start, end))
        if isinstance(body, WheelDef) and body.motor is not None:
            found.motors.append((scene.slot(f"{body.id}.hub"), body.radius - body.thickness, body.motor))
    first = len(scene.rest_length) - len(level.springs)
    for index, spring in enumerate(level.springs, first):
        if spring.drive is not None:
            found.muscles.append(index)
        if spring.hydraulic is not None:
            found.hydraulics.append((index, spring.hydraulic))
    return found


def driven_items(scene: Scene) -> Iterator[Item]:
    """Items that move by themselves: muscles, and wheels with a motor that runs from the start."""
    level = scene.level
    running = {part.name for part in actuators(level) if part.start_value}
    for body in level.bodies:
        if (body.drive is not None and body.drive.amplitude) or body.id in running:
            yield Item("body", body.id)
    for index, spring in enumerate(level.springs):
        if spring.drive is not None and spring.drive.amplitude:
            yield Item("spring", index)


def _middle(scene: Scene, start: int, end: int) -> int:
    """The spring of a range that lies nearest to the middle of all of them."""
    a, b = scene.particle_a[start:end], scene.particle_b[start:end]
    middles = (scene.position[a] + scene.position[b]) / 2.0
    apart = middles - middles.mean(axis=0)
    return start + int(np.argmin(np.sum(apart * apart, axis=1)))
