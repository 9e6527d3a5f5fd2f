"""What is set comes about in so many ticks: ramps of Cs, Cd, firmness, areas, gravity and air."""

import itertools
from dataclasses import replace

import numpy as np
import pytest

from sandbox.physics.analysis.energy import of_last_tick, spring_energy, total_energy
from sandbox.physics.keeping.equipment import Firmness
from sandbox.physics.ramps import CONSTRAINTS, SPRINGS, in_force, next_pair
from sandbox.physics.settings import DIRECT, ITERATIVE, SINGLE_PASS, SOLVER_NAMES, WorldSettings
from sandbox.physics.snapshot import hash_by_array, restore, state_hash, take
from sandbox.physics.softness.firmness import FirmnessRange, set_firmness
from sandbox.physics.state import COLUMNS
from sandbox.physics.step import step
from tests.support.physics_scenes import rope, run
from tests.support.wobbles import firm_world, standing_box

VALUES = (0.0, 0.003, 0.05, 0.4, 0.9, 0.999, 1.0)
PAIRS = [(cs, cd) for cs, cd in itertools.product(VALUES, VALUES) if cs <= cd]
RAMPS = {column.stored for column in COLUMNS if column.stored.endswith(("_now", "_ticks"))}


def is_moving(world):
    """Whether anything still ramps."""
    return bool(RAMPS & hash_by_array(world).keys())


def in_ticks(pair, goal, ticks, solver):
    """Cs and Cd of each tick of a ramp."""
    for left in range(ticks, 0, -1):
        pair = next_pair(*pair, *goal, left, solver)
        yield pair


def test_a_ramp_stays_between_its_ends_and_makes_no_energy_of_nothing():
    for solver, first, goal in itertools.product((SINGLE_PASS, ITERATIVE, DIRECT), PAIRS, PAIRS):
        before = first
        for pair in in_ticks(first, goal, 12, solver):
            for was, now, end in zip(before, pair, goal, strict=True):
                assert min(was, end) <= now <= max(was, end)
            assert pair[0] <= pair[1] * (1.0 + 1e-12)
            before = pair
        assert before == goal


def test_what_sags_rises_and_sinks_evenly_and_not_in_the_last_ticks():
    soft, firm = (0.05, 0.2), (0.5, 0.6)
    sags = [(1.0 - cd) / cs for cs, cd in in_ticks(firm, soft, 30, DIRECT)]
    assert max(np.diff(sags)) < 0.1 * (sags[-1] - sags[0])
    # What firms up gives nothing back at once.
    ways = [cs / cd for cs, cd in in_ticks(soft, (1.0, 1.0), 45, DIRECT)]
    assert max(ways[:40]) < 0.35


@pytest.mark.parametrize("solver", SOLVER_NAMES)
def test_a_ramp_ends_with_what_is_set_at_once_else_and_leaves_nothing_behind(solver):
    worlds = [standing_box(1.0, 3, {"sag": 0.1}, settings={"solver": solver, "substeps": 2}) for _ in range(2)]
    for world, duration in zip(worlds, (0, 9), strict=True):
        world.set_coefficients(0.3, 0.7, 0, duration)
        world.set_gravity((1.0, -3.0), duration)
        world.set_air((2.0, 0.5), 0.25, duration)
        world.command("set_inflation", body=0, value=1.25, duration=duration)
        arrays = ("stiffness", "damping", "lowest_mode", "constraint_stiffness", "constraint_rest")
        # What is read of a world is what was set, from the start.
        assert set(world.stiffness[:-10]) == {0.3} and world.settings.gravity == (1.0, -3.0)
        for tick in range(9):
            assert is_moving(world) == (duration > 0), tick
            step(world)
        assert not is_moving(world)
    for name in arrays:
        assert np.array_equal(getattr(worlds[0], name), getattr(worlds[1], name))
    assert worlds[0].settings == worlds[1].settings
    assert not np.array_equal(worlds[0].position, worlds[1].position)


def test_worlds_in_which_nothing_ramps_have_no_ramp_in_their_hashes():
    world = standing_box(1.0, 3, {"sag": 0.1})
    world.set_coefficients(0.3, 0.7, None)
    world.set_gravity((0.0, -3.0))
    run(world, 3)
    assert not is_moving(world) and len(world.setting_ticks) == len(world.settings.numbers)


def test_a_new_goal_takes_a_ramp_over_from_where_it_is():
    world = rope(links=4)
    world.set_coefficients(0.02, 0.05, None)
    world.set_coefficients(0.9, 0.95, None, 20)
    run(world, 10)
    before = [each[0] for each in in_force(world, SPRINGS)]
    assert 0.02 < before[0] < 0.9
    # Cd alone: Cs goes on to its goal.
    world.set_coefficients(None, 0.5, None, 20)
    assert [each[0] for each in in_force(world, SPRINGS)] == before
    step(world)
    after = [each[0] for each in in_force(world, SPRINGS)]
    assert before[0] <= after[0] < 0.9 and abs(after[1] - before[1]) < 0.2
    run(world, 19)
    assert (world.stiffness[0], world.damping[0]) == (0.9, 0.5) and not is_moving(world)
    # At once: the ramp is over.
    world.set_coefficients(0.1, 0.2, None, 20)
    step(world)
    world.set_coefficients(0.3, None, None)
    assert not is_moving(world) and (world.stiffness[0], world.damping[0]) == (0.3, 0.2)


def test_gravity_and_air_come_to_what_is_set_and_settings_end_their_ramps():
    world = rope(links=4)
    world.set_gravity((3.0, 0.0), 10)
    seen = []
    for _ in range(10):
        step(world)
        seen.append(of_last_tick(world).settings.gravity)
    assert np.all(np.diff(np.array(seen)[:, 0]) > 0.0) and seen[-1] == (3.0, 0.0) == world.settings.gravity
    world.set_air((5.0, 0.5), 1.0, 10)
    step(world)
    world.settings = WorldSettings.of((0.0, -9.0, 0.0, 0.0, 0.0, 0.5), world.settings.choices)
    step(world)
    assert world.settings.wind == (0.0, 0.0) and not is_moving(world)


def test_a_state_in_the_middle_of_a_ramp_is_brought_back_bit_for_bit():
    world = standing_box(1.0, 3, {"sag": 0.2})
    set_firmness(world, 0, 1.0, 1.0, 30)
    world.set_gravity((2.0, -5.0), 25)
    run(world, 11)
    kept = take(world)
    run(world, 30)
    ended = state_hash(world)
    world.set_gravity((0.0, 0.0))
    restore(world, kept)
    run(world, 30)
    assert state_hash(world) == ended


def test_firmness_is_set_over_a_duration_for_all_that_a_body_is_of():
    world, firm = (firm_world({"sag": 0.2}, floor=True, shape={"box": [1, 1]}, spacing=0.25) for _ in range(2))
    reach = FirmnessRange.of(world.forms[0].shape, world.settings.gravity, world.settings.tick_rate)
    for sag in (0.02, 0.0, 0.1):
        pair = reach.coefficients(Firmness(sag=sag))
        set_firmness(world, 0, *pair, 12)
        set_firmness(firm, 0, *pair)
        for _ in range(12):
            step(world)
            for family in (SPRINGS, CONSTRAINTS):
                stiffness, damping, mode = in_force(world, family)
                chosen = world.material >= 0 if family == SPRINGS else slice(None)
                assert np.all(stiffness[chosen] <= damping[chosen])
                # Rigid springs are so alone as well; until then they move as a body.
                assert np.all(mode[chosen] > 0.0) or not is_moving(world)
        for name in ("stiffness", "damping", "lowest_mode", "constraint_stiffness", "constraint_lowest_mode"):
            assert np.array_equal(getattr(world, name), getattr(firm, name))


def test_energy_is_read_with_what_is_in_force():
    world = standing_box(1.0, 3, {"sag": 0.2})
    run(world, 120)
    before, stored = total_energy(world), spring_energy(world)
    assert stored > 0.0
    world.set_coefficients(1.0, 1.0, None, 60)
    assert total_energy(world) == pytest.approx(before, abs=1e-9 * abs(before))
    step(world)
    assert spring_energy(world) < 1.5 * stored
    world.set_coefficients(1.0, 1.0, None)
    assert spring_energy(world) > 100.0 * stored


def test_what_is_made_whole_is_soft_at_first_and_has_its_own_cs_and_cd_again():
    world = standing_box(1.0, 3, {"sag": 0.02})
    own = world.stiffness.copy(), world.damping.copy()
    world.settings = replace(world.settings, solver="iterative")
    world.command("set_solver", solver="direct", iterations=None, substeps=None, warm_start=None, duration=15)
    assert in_force(world, SPRINGS)[0][0] <= 0.05
    run(world, 15)
    assert np.array_equal(world.stiffness, own[0]) and np.array_equal(world.damping, own[1]) and not is_moving(world)
