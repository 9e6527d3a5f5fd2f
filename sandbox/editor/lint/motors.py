"""Motors that do nothing."""

import numpy as np

from sandbox.editor.items import Item
from sandbox.editor.lint.finding import Finding, Rule, called, place_of
from sandbox.editor.scene import Scene
from sandbox.level.kinds.wheel import WheelDef


def idle_motors(scene: Scene) -> Rule:
    """Motors of wheels whose hub is fixed to nothing."""
    first = scene.first_of_weld
    for index, body in enumerate(scene.level.bodies):
        if not isinstance(body, WheelDef) or body.motor is None:
            continue
        hub = scene.slot(f"{body.id}.hub")
        if not scene.pinned[hub] and not _mounted(scene, int(first[hub]), index):
            item = Item("body", body.id)
            text = (
                f"the motor of {called(item)} does nothing: its hub is fixed to nothing; pin it, or join a spring to it"
            )
            yield Finding("warning", text, frozenset([item]), place_of(scene, hub))
        yield None


def _mounted(scene: Scene, hub: int, wheel: int) -> bool:
    """Whether a spring from outside the wheel ends at its hub."""
    first = scene.first_of_weld
    at_hub = (first[scene.particle_a] == hub) | (first[scene.particle_b] == hub)
    return bool(np.any(at_hub & (scene.spring_item != wheel)))
