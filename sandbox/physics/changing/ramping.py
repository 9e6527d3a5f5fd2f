"""Ramping: begins ramps (ramps.py) of what programs and people name otherwise than by material: bodies, or everything."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from sandbox.physics.arrays import Slots
from sandbox.physics.keeping import arguments
from sandbox.physics.marks import BANK_UNOPENED, GRAB_MATERIAL
from sandbox.physics.world import World

# Cs and Cd from which what is made whole firms up: soft, and so damped that it creeps to its form rather than leaps.
SOFT_STIFFNESS, SOFT_DAMPING = 0.05, 0.9
# The families of rows that have Cs and Cd, by how names of their arrays begin.
SPRINGS, CONSTRAINTS = "", "constraint_"
_NAMES = ("stiffness", "damping", "lowest_mode")


def ramp_rows(world: World, family: str, slots: Slots, values: Sequence[Any], duration: int) -> None:
    """Bring Cs, Cd and lowest mode of rows to values, one or (k,), in so many ticks; 0: at once.

    family: SPRINGS or CONSTRAINTS. A lowest mode above 0 holds from the start, none only from the end: what becomes
    rigid moves as a body until then. Raises as `World.change` does.
    """
    duration = arguments.ticks("duration", duration)
    at_once = duration == 0
    for name, value in zip(_NAMES, values, strict=True):
        world.change(f"{family}{name}_goal", 0.0 if at_once else value, slots)
        if at_once or (name == "lowest_mode" and np.any(np.asarray(value) > 0.0)):
            world.change(f"{family}{name}", value, slots)
    world.change(f"{family}ramp_ticks", duration, slots)
    if family == SPRINGS:
        world.disturb(world.particle_a[slots], world.particle_b[slots])


def goals(world: Any, family: str = SPRINGS) -> tuple[Any, ...]:
    """Cs, Cd and lowest mode of a World's or Snapshot's rows at the end of their ramps; where there is none, now."""
    ramps = getattr(world, f"{family}ramp_ticks") > 0
    return tuple(
        np.where(ramps, getattr(world, f"{family}{name}_goal"), getattr(world, f"{family}{name}")) for name in _NAMES
    )


def inflate(world: World, body: int, inflation: float, duration: int = 0) -> None:
    """Let each area of a body, by its place in `area_names`, want this multiple of its form's in so many ticks."""
    body = arguments.slot("body", body, "bodies that keep areas", len(world.area_constraints))
    inflation = arguments.number("inflation", inflation, 0.0)
    duration = arguments.ticks("duration", duration)
    slots = np.array(world.area_constraints[body], dtype=np.int64)
    wanted = inflation * world.constraint_rest[slots, 1]
    world.constraint_rest_goal[slots] = wanted if duration else 0.0
    world.constraint_rest_ticks[slots] = duration
    if duration == 0:
        world.constraint_rest[slots, 0] = world.good["constraint_rest"][slots, 0] = wanted
    first, last = slots[0], slots[-1]
    corners = world.constraint_first[first], world.constraint_first[last] + world.constraint_corners[last]
    world.disturb(world.corner_particle[corners[0] : corners[1]])


def firm_up(world: World, duration: int) -> None:
    """Make every spring and constraint soft at once, and let it have its Cs and Cd back in so many ticks."""
    for family in (SPRINGS, CONSTRAINTS):
        values = goals(world, family)
        material = getattr(world, f"{family}material")
        slots = np.flatnonzero(material != GRAB_MATERIAL) if family == SPRINGS else np.arange(len(material))
        ramp_rows(world, family, slots, [value[slots] for value in values], duration)
        stiffness, damping = getattr(world, f"{family}stiffness"), getattr(world, f"{family}damping")
        world.change(f"{family}stiffness", np.minimum(stiffness[slots], SOFT_STIFFNESS), slots)
        world.change(f"{family}damping", np.maximum(damping[slots], SOFT_DAMPING), slots)
    world.energy_bank[:] = BANK_UNOPENED
