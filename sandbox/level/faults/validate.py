"""check_level: finds the faults that involve several fields, before anything is built."""

import itertools
from collections.abc import Iterator

from sandbox.level.document.model import Level
from sandbox.level.faults.actuator_faults import actuator_faults
from sandbox.level.faults.collision_faults import collision_faults
from sandbox.level.faults.extras_faults import extras_faults
from sandbox.level.faults.firmness_faults import firmness_faults
from sandbox.level.faults.reference_faults import (
    check_faults,
    look_faults,
    material_faults,
    spring_faults,
    weld_reference_faults,
)
from sandbox.level.faults.rule_faults import cut_spring_faults, rule_faults
from sandbox.level.faults.size_faults import size_fault
from sandbox.level.faults.weld_faults import weld_faults
from sandbox.level.faults.zone_faults import zone_faults
from sandbox.level.format.level_error import Fault, LevelError, shown
from sandbox.level.plan.plan import Plan, kept_plan
from sandbox.level.rules.hands import hand_faults


def check_level(level: Level, source: str) -> Plan:
    """The plan of a sound level: the one that the level keeps, or a new one.

    Raises LevelError with every fault that involves several fields; source names the level in it.
    """
    plan = kept_plan(level)
    if plan is None:
        plan = Plan(level)
        faults = level_faults(level, plan)
        first = next(faults, None)
        if first is not None:
            raise LevelError(source, itertools.chain([first], faults))
    return plan


def level_faults(level: Level, plan: Plan) -> Iterator[Fault]:
    """Every fault that involves several fields, in the order of the file."""
    too_large = size_fault(level, plan)
    if too_large is not None:
        yield too_large
        return
    # Welds and forms of bodies can be checked only if everything else is sound.
    sound = True
    for fault in _all_faults(level, plan):
        sound = False
        yield fault
    if sound:
        yield from weld_faults(level, plan)
        yield from firmness_faults(level, plan)
        yield from cut_spring_faults(level, plan)


def _all_faults(level: Level, plan: Plan) -> Iterator[Fault]:
    layout = plan.layout
    if level.view is not None and not (level.view[0] < level.view[2] and level.view[1] < level.view[3]):
        yield "view", "left and bottom come first and must be below right and top"
    for path, name in layout.repeated:
        yield path, f"{shown(name)} is taken; every body and loose particle needs an id of its own"
    for index, body in enumerate(plan.bodies):
        path = f"bodies.{index}"
        yield from material_faults(level, path, body.body.material)
        yield from body.faults(path)
        if body.form_count[0]:
            yield from body.change_faults(path)
    yield from collision_faults(level)
    yield from zone_faults(level)
    yield from spring_faults(level, layout)
    yield from actuator_faults(level)
    yield from weld_reference_faults(level, layout)
    yield from rule_faults(level, layout)
    yield from hand_faults(level.hands, layout.owners)
    yield from check_faults(level, layout)
    yield from look_faults(level)
    yield from extras_faults(level)
