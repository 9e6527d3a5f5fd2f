"""Ramping: begins ramps (ramps.py) of the bodies of a world, and of everything in it."""

from typing import Any

import numpy as np

from sandbox.physics.arrays import Slots
from sandbox.physics.command import carry_out, lend
from sandbox.physics.keeping import arguments
from sandbox.physics.marks import GRAB_MATERIAL
from sandbox.physics.ramps import COEFFICIENTS, CONSTRAINTS, SPRINGS, in_force
from sandbox.physics.state import good_of, state_of
from sandbox.physics.world import World

# Cs and Cd from which what is made whole firms up: soft, and so damped that it creeps to its form rather than leaps.
SOFT_STIFFNESS, SOFT_DAMPING = 0.05, 0.9


def set_rows(
    world: World,
    springs: Slots,
    constraints: Slots,
    stiffness: float,
    damping: float,
    lowest_mode: float,
    duration: int = 0,
) -> None:
    """Set Cs, Cd and lowest mode of springs and constraints of a body, to be in force in so many ticks; 0: at once.

    Raises IndexError and ValueError; nothing is changed then.
    """
    springs = arguments.slots("springs", springs, arguments.SPRINGS, world.spring_count)
    constraints = arguments.slots("constraints", constraints, arguments.CONSTRAINTS, world.constraint_count)
    given: dict[str, Any] = {
        "stiffness": arguments.number("stiffness", stiffness, 0.0, 1.0),
        "damping": arguments.number("damping", damping, 0.0, 1.0),
        "lowest_mode": arguments.number("lowest_mode", lowest_mode, 0.0),
        "duration": arguments.ticks("duration", duration),
    }
    pointer = lend(state_of(world), good_of(world), np.array(world.settings.numbers, np.float64))
    carry_out(pointer, "firm_springs", given | {"springs": springs}, world)
    carry_out(pointer, "firm_constraints", given | {"constraints": constraints}, world)


def inflate(world: World, body: int, inflation: float, duration: int = 0) -> None:
    """Let each area of a body, by its place in `area_names`, want this multiple of its form's, in so many ticks."""
    body = arguments.slot("body", body, "bodies that keep areas", len(world.area_constraints))
    inflation = arguments.number("inflation", inflation, 0.0)
    duration = arguments.ticks("duration", duration)
    slots = np.array(world.area_constraints[body], dtype=np.int64)
    rest, now, ticks = world.constraint_rest, world.constraint_area_now, world.constraint_area_ticks
    now[slots] = np.where(ticks[slots] > 0, now[slots], rest[slots, 0]) if duration else 0.0
    ticks[slots] = duration
    rest[slots, 0] = world.good["constraint_rest"][slots, 0] = inflation * rest[slots, 1]
    first, last = slots[0], slots[-1]
    corners = world.constraint_first[first], world.constraint_first[last] + world.constraint_corners[last]
    world.disturb(world.corner_particle[corners[0] : corners[1]])


def firm_up(world: World, duration: int) -> None:
    """Make every spring and constraint soft at once, and let what is set be in force again in so many ticks."""
    for family in (SPRINGS, CONSTRAINTS):
        stiffness, damping, mode = in_force(world, family)
        chosen = world.material != GRAB_MATERIAL if family == SPRINGS else world.constraint_active
        soft = np.minimum(stiffness, SOFT_STIFFNESS), np.maximum(damping, SOFT_DAMPING), mode
        for name, now in zip(COEFFICIENTS, soft, strict=True):
            world.change(f"{family}{name}_now", now[chosen], chosen)
        world.change(f"{family}ramp_ticks", duration, chosen)
    world.disturb(np.arange(world.particle_count))
