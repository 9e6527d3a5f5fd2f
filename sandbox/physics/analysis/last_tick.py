"""Last tick: a state with what was in force in its last tick in place of what is set, where that ramps (ramps.py)."""

import copy
from typing import TypeVar

import numpy as np

from sandbox.physics.ramps import COEFFICIENTS, CONSTRAINTS, SPRINGS, in_force
from sandbox.physics.settings import WorldSettings
from sandbox.physics.snapshot import Snapshot
from sandbox.physics.world import World

AnyState = TypeVar("AnyState", World, Snapshot, World | Snapshot)
_TICKS = ("ramp_ticks", "constraint_ramp_ticks", "constraint_area_ticks", "setting_ticks")


def of_last_tick(state: AnyState) -> AnyState:
    """The state as its last tick had it, for readings of energy and force; itself where nothing ramps.

    It shares all other arrays with the state, and is not to be stepped or changed.
    """
    if not any(getattr(state, name).any() for name in _TICKS):
        return state
    view = copy.copy(state)
    arrays = {name: np.zeros_like(getattr(state, name)) for name in _TICKS} | {
        f"{family}{name}": values
        for family in (SPRINGS, CONSTRAINTS)
        for name, values in zip(COEFFICIENTS, in_force(state, family), strict=True)
    }
    rest = state.constraint_rest.copy()
    rest[:, 0] = np.where(state.constraint_area_ticks > 0, state.constraint_area_now, rest[:, 0])
    numbers = np.where(state.setting_ticks > 0, state.setting_now, state.settings.numbers)
    settings = "_settings" if isinstance(state, World) else "settings"
    vars(view).update(
        arrays, constraint_rest=rest, **{settings: WorldSettings.of(numbers.tolist(), state.settings.choices)}
    )
    return view
