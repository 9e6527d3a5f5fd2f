"""Collisions of a step: their arrays are made once, have room that grows, and change no bit of a run."""

import copy

import numpy as np
import pytest

from sandbox.physics.collision.types import new_contacts, sort_contacts
from sandbox.physics.pipeline.block_owner import block_of
from sandbox.physics.settings import AUTO
from sandbox.physics.snapshot import restore, state_hash, take
from sandbox.physics.step import step
from sandbox.physics.terrain import Chain
from tests.bench import scenes
from tests.support.calls import counted_calls
from tests.support.contact_scenes import add_discs, add_jelly, world
from tests.support.contacts import NO_CONTACTS, last_contacts
from tests.support.laid_out import laid_out
from tests.support.physics_scenes import run, scaled

PIT = Chain([(-0.9, 6.0), (-0.9, 0.0), (0.9, 0.0), (0.9, 6.0)])


def heap(jelly=True, **settings):
    """Discs that fall into a pit, with a block of jelly or alone."""
    w, count = world(PIT, **settings), scaled(60, 10)
    generator = np.random.default_rng(4)
    k = np.arange(count)
    points = np.stack([-0.7 + 0.28 * (k % 6), 0.5 + 0.25 * (k // 6)], axis=1)
    add_discs(w, points + generator.uniform(0.0, 0.05, points.shape), radius=generator.uniform(0.07, 0.11, count))
    if jelly:
        add_jelly(w, (0.0, 3.5), size=(0.3, 0.3))
    return w


def hashes(w, ticks):
    """The hash of the state after each tick."""
    found = []
    for _ in range(ticks):
        step(w)
        found.append(state_hash(w))
    return found


@pytest.mark.parametrize("substeps", [1, 4])
@pytest.mark.parametrize("jelly", [False, True])
def test_a_run_whose_arrays_grow_on_the_way_has_the_bits_of_one_with_room_from_the_start(substeps, jelly):
    ticks = scaled(120, 30)
    ample = heap(jelly, substeps=substeps)
    block_of(ample).inputs.demand[:] = 5000
    ample.pin(0)
    ample.unpin(0)
    expected = hashes(ample, ticks)
    assert (block_of(ample).inputs.demand == 5000).all()
    w = heap(jelly, substeps=substeps)
    w.pin(0)
    w.unpin(0)
    asked_for = set()
    for one in expected:
        step(w)
        assert state_hash(w) == one
        asked_for.add(tuple(block_of(w).inputs.demand.tolist()))
    assert len(asked_for) > 1


def test_a_tick_of_a_heap_at_rest_makes_no_array():
    w = world(PIT)
    add_discs(w, [(-0.4 + 0.3 * k, 0.1) for k in range(4)])
    run(w, 60)
    made = block_of(w)
    before = made, made.arrays, made.pointer, w.contact_particle, w.contact_feature, w.contact_impulse
    run(w, 10)
    made = block_of(w)
    after = made, made.arrays, made.pointer, w.contact_particle, w.contact_feature, w.contact_impulse
    assert len(w.contact_particle) == 4
    assert all(one is other for one, other in zip(before, after, strict=True))


def test_a_tick_calls_one_kernel_whatever_is_in_its_world(monkeypatch):
    jelly, discs, rope = heap(substeps=4), heap(jelly=False, solver="iterative"), scenes.rope(4).world(substeps=AUTO)
    rope.hold(0, 2, (0.1, 0.1))
    for w in (jelly, discs, rope):
        run(w, 20)
    with counted_calls() as calls:
        for w in (jelly, discs, rope):
            run(w, 5)
    assert calls == ["tick"] * 15


def test_a_run_goes_on_with_the_same_bits_after_slots_were_added_and_taken_back_while_things_touch():
    w = heap()
    run(w, scaled(60, 25))
    kept = take(w)
    expected = hashes(w, 8)
    assert len(w.contact_particle) > 2
    restore(w, kept)
    add_discs(w, [(0.1, 2.6), (0.2, 2.9)], velocity=(0.0, -8.0))
    with_more = hashes(w, 8)
    assert not set(with_more) & set(expected)
    restore(w, kept)
    assert hashes(w, 8) == expected
    restore(w, kept)
    add_discs(w, [(0.1, 2.6), (0.2, 2.9)], velocity=(0.0, -8.0))
    assert hashes(w, 8) == with_more


def test_a_copy_of_a_world_in_which_things_touch_goes_its_own_way_with_the_same_bits():
    w = heap()
    run(w, scaled(60, 25))
    other = copy.deepcopy(w)
    expected = hashes(w, 5)
    assert len(other.contact_particle) > 2
    assert hashes(other, 5) == expected


def test_impulses_that_are_dropped_between_ticks_are_not_remembered():
    w = heap()
    run(w, scaled(60, 25))
    other = copy.deepcopy(w)
    for changed in (w, other):
        changed.contact_impulse[:] = 0.0
    for name in ("contact_particle", "contact_feature", "contact_impulse", "contact_impact"):
        setattr(other, name, getattr(other, name).copy())
    assert hashes(w, 3) == hashes(other, 3)


def test_the_contacts_of_the_last_step_are_those_of_the_state():
    w = heap()
    run(w, scaled(60, 25))
    contacts = last_contacts(w)
    assert len(contacts.gap) > 2
    assert contacts.particle.tolist() == w.contact_particle.tolist()
    assert contacts.impulse.tolist() == w.contact_impulse.tolist()
    w.cut([0])
    assert len(last_contacts(w).gap) == 0
    assert last_contacts(world()) is NO_CONTACTS


@pytest.mark.parametrize("seed", range(5))
def test_sorting_moves_each_contact_as_a_whole_and_says_where_it_is(seed):
    generator, count = np.random.default_rng(seed), 12
    contacts = laid_out(lambda arena: new_contacts(arena, count))
    moved = ("particle", "feature", "end_a", "end_b", "share", "normal", "gap", "friction", "restitution", "rolling",
             "impulse", "partner", "impact")  # fmt: skip
    found = {name: generator.integers(1, 1000, getattr(contacts, name)[:count].shape) for name in moved}
    for name, values in found.items():
        getattr(contacts, name)[:count] = values
    wanted, place = generator.permutation(count), np.zeros(count, np.int64)
    sort_contacts(contacts, wanted.copy(), place)
    for name, values in found.items():
        assert (getattr(contacts, name)[:count] == values[wanted]).all(), name
        assert (getattr(contacts, name)[place] == values).all(), name
