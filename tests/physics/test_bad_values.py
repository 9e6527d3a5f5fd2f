"""Whatever value an argument of a World's method is given, it raises and names it, or a tick can be made of it."""

import copy

import numpy as np
import pytest

from sandbox.physics.commands.command_table import RefusedCommand
from sandbox.physics.driving import Actuators
from sandbox.physics.snapshot import state_hash
from sandbox.physics.state import COLUMNS, Family
from sandbox.physics.step import step
from sandbox.physics.world import World
from tests.support.bad_commands import made, memory_of
from tests.support.bad_values import BAD, RAISED, bad_calls, called, public_methods

METHODS = public_methods(World)
# Right values of each argument.
_POINT = (0.5, 1.5)
RIGHT = {
    "add_constraints": {"kind": 0, "corners": [[0, 1, 2]], "form": None, "inflation": 1.0},
    "add_particles": {"names": ["e"], "position": [_POINT], "energy_bank": 0.0, "spin": 0.0},
    "add_springs": {"names": ["v"], "particle_a": [0], "particle_b": [2]},
    "append": {"family": Family.SPRING, "count": 1, "particle_a": 0, "particle_b": 1, "material": 0, "belt": 0.0},
    "break_springs": {"springs": [0]},
    "change": {"name": "mass", "values": 1.0, "slots": [0]},
    "command": {"name": "push", "giver": 2, "position": _POINT, "impulse": _POINT, "outward": 0.0, "radius": 2.0},
    "cut": {"springs": [0]},
    "disturb": {"particles": 0},
    "drive": {"part": 0, "value": 0.5},
    "fit": {"driven": Actuators(("engine",)), "values": [0.5]},
    "forget_names_beyond": {"particle_count": 14, "spring_count": 13},
    "hold": {"grab": 1, "particle": 0, "target": _POINT},
    "is_grab_particle": {"slot": 0},
    "is_grab_spring": {"slot": 0},
    "is_held": {"grab": 0},
    "move_grab": {"grab": 0, "target": _POINT},
    "name_areas": {"name": "x", "constraints": range(1)},
    "name_particle": {"slot": 0, "name": "second"},
    "name_slots": {"particles": [], "springs": []},
    "name_slots_to": {"particle_count": 14, "spring_count": 13},
    "particle_slot": {"name": "a"},
    "pin": {"particle": 0},
    "push": {"position": _POINT, "impulse": _POINT, "outward": 0.0, "radius": 2.0},
    "release": {"grab": 0},
    "set_air": {"wind": _POINT, "drag": 0.5},
    "set_coefficients": {"stiffness": 0.5, "damping": 0.5, "material": 0},
    "set_gravity": {"gravity": _POINT},
    "shake": {"acceleration": _POINT},
    "spring_slot": {"name": "s"},
    "unpin": {"particle": 1},
}
# They take functions, and are for kernels.
FOR_KERNELS = {"derived", "lasting"}


def test_each_method_of_the_class_is_tried():
    assert METHODS.keys() - FOR_KERNELS == RIGHT.keys()


def _tried(world, argument, value, act, fresh):
    before, hashed = memory_of(world), state_hash(world)
    try:
        act(world)
    except RAISED as error:
        # A right value can be refused for how things are, and a name for which there is none is said alone.
        assert isinstance(error, RefusedCommand | KeyError) or argument in str(error), (
            f"{argument} = {value!r:.60}: {type(error).__name__}: {error}"
        )
        assert memory_of(world) == before and state_hash(world) == hashed, f"{argument} = {value!r:.60}: {error}"
        return world
    for _ in range(2):
        step(world)
    assert np.isfinite(world.position).all() and not world.contained, f"{argument} = {value!r:.60} was taken"
    return copy.deepcopy(fresh)


@pytest.mark.parametrize("method", RIGHT)
def test_each_argument_raises_by_name_and_changes_nothing_or_a_tick_is_made_of_it(method):
    fresh = made()
    called(copy.deepcopy(fresh), method, RIGHT[method])
    world = copy.deepcopy(fresh)
    for argument, value, act in bad_calls(method, METHODS[method], RIGHT[method]):
        world = _tried(world, argument, value, act, fresh)


@pytest.mark.parametrize("column", COLUMNS, ids=lambda column: column.name)
def test_each_column_raises_by_name_and_changes_nothing_or_a_tick_is_made_of_it(column):
    fresh = made()
    world = copy.deepcopy(fresh)
    for value in BAD:
        world = _tried(world, column.name, value, lambda w, v=value: w.change(column.name, v), fresh)
