"""Motors that do nothing, or that can do too little."""

import numpy as np

from sandbox.editor.items import Item
from sandbox.editor.lint.finding import DIRECT, Finding, Rule, called, connected_parts
from sandbox.editor.scene import Scene
from sandbox.level.document.model import Level
from sandbox.level.kinds.wheel import WheelDef
from sandbox.physics.solvers import SOLVERS


def motors_in_vain(level: Level, scene: Scene) -> Rule:
    """Motors that turn nothing or push against nothing, that cannot climb, and all of them in a single pass."""
    driven = [
        (index, body)
        for index, body in enumerate(level.bodies)
        if isinstance(body, WheelDef) and body.motor is not None
    ]
    if not driven:
        return
    yield from _idle(scene, driven)
    if not SOLVERS[level.settings.solver].joints_bear_load:
        items = frozenset(Item("body", body.id) for _, body in driven)
        text = (
            f"the {level.settings.solver.replace('_', ' ')} solver cannot carry wheels under a load, so motors turn "
            "them on the spot; use the direct or the iterative solver"
        )
        yield Finding("warning", text, items, scene.place(scene.slot(f"{driven[0][1].id}.hub")), DIRECT)
    if level.has_contacts:
        yield None
        yield from _weak(level, scene, driven)


def _idle(scene: Scene, driven: list[tuple[int, WheelDef]]) -> Rule:
    first = scene.first_of_weld
    for index, body in driven:
        hub = scene.slot(f"{body.id}.hub")
        item = Item("body", body.id)
        if not _joined(scene, int(first[hub]), index, True):
            text = f"the motor of {called(scene.level, item)} turns nothing: no spoke joins its rim to its hub"
            many = "the motors of {count} wheels turn nothing: no spoke joins rim and hub"
            yield Finding("warning", text, frozenset([item]), scene.place(hub), many=many)
        elif not scene.pinned[hub] and not _joined(scene, int(first[hub]), index, False):
            text = (
                f"the motor of {called(scene.level, item)} does nothing: its hub is fixed to nothing; "
                "pin it, or join a spring to it"
            )
            many = "the motors of {count} wheels do nothing: their hubs are fixed to nothing; pin them, or join springs"
            yield Finding("warning", text, frozenset([item]), scene.place(hub), many=many)
        yield None


def _joined(scene: Scene, hub: int, wheel: int, inside: bool) -> bool:
    """Whether a spring of the wheel, or one from outside it, ends at its hub."""
    first = scene.first_of_weld
    at_hub = (first[scene.particle_a] == hub) | (first[scene.particle_b] == hub)
    return bool(np.any(at_hub & ((scene.spring_item == wheel) == inside)))


def _weak(level: Level, scene: Scene, driven: list[tuple[int, WheelDef]]) -> Rule:
    """Vehicles whose motors together cannot lift them over the corners of their wheels."""
    part = yield from connected_parts(scene)
    gravity = float(np.hypot(*level.settings.gravity))
    vehicles: dict[int, list[WheelDef]] = {}
    for _, body in driven:
        vehicles.setdefault(int(part[scene.slot(f"{body.id}.hub")]), []).append(body)
    for label, wheels in vehicles.items():
        mine = part == label
        if np.any(scene.pinned & mine) or not gravity > 0.0:
            continue
        weight = float(np.sum(scene.mass[mine])) * gravity
        torque = sum(wheel.motor.torque for wheel in wheels if wheel.motor is not None)
        needed = max(weight * wheel.radius * float(np.sin(np.pi / wheel.segments)) for wheel in wheels)
        if torque < needed:
            items = [Item("body", wheel.id) for wheel in wheels]
            whose = (
                " and ".join(called(scene.level, item) for item in items) if len(items) < 3 else f"{len(items)} wheels"
            )
            text = (
                f"the torque of {whose}, {torque:.3g} N m in all, does not lift {weight / gravity:.3g} kg over the "
                f"corners of its wheels: that takes {needed:.3g} N m; give more, or wheels of more segments"
            )
            yield Finding("hint", text, frozenset(items), scene.place(scene.slot(f"{wheels[0].id}.hub")))
        yield None
