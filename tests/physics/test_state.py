"""The table of state arrays, and what is derived from the arrays that are topology."""

import copy
import itertools
from pathlib import Path

import numpy as np
import pytest

from sandbox.physics.constraints import AREA
from sandbox.physics.pipeline.block_owner import outline_of
from sandbox.physics.snapshot import hash_by_array, restore, state_hash, take
from sandbox.physics.state import BY_NAME, BY_STORED, COLUMNS, reference
from sandbox.physics.step import step
from sandbox.physics.terrain import Chain, make_terrain
from tests.support.physics_scenes import network, rope

# The replay contract: this list may only grow.
STORED = [
    "position", "velocity", "origin", "mass", "inverse_mass", "radius", "gravity_scale", "particle_active",
    "slow_velocity", "energy_bank", "friction", "restitution", "owner", "group", "collides", "particle_a", "particle_b",
    "rest_length", "natural_length", "stiffness", "damping", "law", "hooke_stiffness", "hooke_damping", "material",
    "spring_active", "impulse", "tension", "edge", "element_kind", "element_first", "element_corners", "element_rest",
    "element_stiffness", "element_damping", "element_material", "element_active", "corner_particle", "corner_weight",
    "corner_form", "part_value", "contact_particle", "contact_feature", "contact_impulse",
]  # fmt: skip
# Those that are no part of a state where all of them are as usual.
SPARSE = [
    "parting_reserve", "angle", "spin", "rolls", "rolling", "slow_change", "unmoved", "untouchable",
    "unreturnable", "split_from", "lowest_mode", "stiffness_now", "damping_now", "lowest_mode_now", "ramp_ticks",
    "belt", "spring_untouchable", "split",
    "element_lowest_mode", "element_stiffness_now", "element_damping_now", "element_lowest_mode_now",
    "element_ramp_ticks", "element_area_now", "element_area_ticks", "part_impulse", "contact_impact", "hand_strength",
    "hand_radius", "hand_force", "setting_now", "setting_ticks", "rule_held", "rule_fired", "rule_first", "rule_last",
    "rule_due", "rule_stars", "counter", "probe_position", "still_ticks", "key_down", "deed_refused", "deed_budget",
]  # fmt: skip


def made_of(world):
    """A new object for each time that something is derived."""
    return object()


def test_names_and_order_of_arrays_in_files_are_those_of_the_first_version():
    assert [name for name in BY_STORED if not BY_STORED[name].sparse] == STORED
    assert [name for name in BY_STORED if BY_STORED[name].sparse] == SPARSE


def test_an_array_that_nothing_uses_is_no_part_of_a_state_s_hash():
    world = rope(links=4)
    world.set_coefficients(0.3, 0.4, None)
    before = hash_by_array(world)
    assert "lowest_mode" not in before
    world.change("lowest_mode", 0.5, 0)
    assert hash_by_array(world).keys() - before.keys() == {"lowest_mode"}
    assert state_hash(world) != state_hash(world, before)
    world.set_coefficients(0.3, None, None)
    assert hash_by_array(world) == before


def test_the_page_of_arrays_is_what_the_table_says():
    page = Path(__file__).resolve().parents[2] / "docs" / "state.md"
    assert page.read_text(encoding="utf-8") == reference(), "python -m sandbox.physics.state > docs/state.md"


def test_each_array_says_what_it_means_and_stands_beside_its_family():
    families = [column.family for column in COLUMNS]
    assert all(column.meaning for column in COLUMNS) and len(BY_NAME) == len(BY_STORED) == len(COLUMNS)
    assert all(column.unit for column in COLUMNS if column.dtype is np.float64)
    assert sum(a is not b for a, b in itertools.pairwise(families)) == len(set(families)) - 1


def test_what_is_derived_is_kept_while_a_world_moves_and_is_driven():
    world = rope(links=4)
    world.reserve_grabs()
    world.hold(0, 3, (1.0, 1.0))
    made = world.derived(made_of)
    for tick in range(5):
        world.move_grab(0, (1.0 + tick, 1.0))
        step(world)
    world.set_coefficients(0.3, None, None)
    world.position += 1.0
    world.change("radius", 0.5)
    assert world.derived(made_of) is made


CHANGES = {
    "a particle": lambda world: world.add_particles(["new"], [(0.0, 0.0)]),
    "a spring": lambda world: world.add_springs(["new"], [0], [2]),
    "an element": lambda world: world.add_constraints(AREA, [[0, 1, 2]]),
    "a pin": lambda world: world.pin(2),
    "no pin": lambda world: world.unpin(0),
    "a cut": lambda world: world.cut([0]),
    "a break": lambda world: world.break_springs(np.array([0])),
    "a hold": lambda world: world.hold(1, 1, (0.0, 0.0)),
    "a release": lambda world: world.release(0),
    "terrain": lambda world: setattr(world, "terrain", make_terrain([Chain([(-1.0, 0.0), (1.0, 0.0)])])),
    "a law": lambda world: world.change("law", 1, 0),
    "another array": lambda world: setattr(world, "position", world.position.copy()),
}


@pytest.mark.parametrize("change", CHANGES.values(), ids=list(CHANGES))
def test_what_is_derived_is_made_anew_after(change):
    world = rope(links=4)
    world.hold(0, 3, (1.0, 1.0))
    made = world.derived(made_of)
    change(world)
    assert world.derived(made_of) is not made


def test_what_is_derived_outlives_a_restored_state_of_the_same_topology_alone():
    world = network([(0, 0), (1, 0), (2, 0)], [(0, 1), (1, 2)])
    start, made, arrays = take(world), world.derived(made_of), {name: getattr(world, name) for name in BY_NAME}
    step(world)
    restore(world, start)
    assert world.derived(made_of) is made
    assert all(getattr(world, name) is array for name, array in arrays.items())
    world.cut([1])
    cut = take(world)
    restore(world, start)
    assert world.spring_active.all() and world.derived(made_of) is not made
    made = world.derived(made_of)
    restore(world, cut)
    assert not world.spring_active[1] and world.derived(made_of) is not made


def test_a_copied_world_derives_for_itself():
    world = rope(links=4)
    outline = outline_of(world)
    other = copy.deepcopy(world)
    assert outline_of(other) is not outline and outline_of(world) is outline


def test_a_changed_constant_is_trusted():
    world = rope(links=4)
    world.change("rest_length", 0.7, 2)
    world.rest_length[2] = np.nan
    step(world)
    assert world.rest_length[2] == 0.7
