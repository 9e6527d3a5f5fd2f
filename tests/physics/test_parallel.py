"""Large bodies in two halves: one thread or two, the same bits."""

import copy
import multiprocessing
import os
import pickle
import subprocess
import sys
import threading

import numpy as np
import pytest

from sandbox.physics.jit import COMPILED, waiting_kernel
from sandbox.physics.pipeline import making
from sandbox.physics.pipeline.making import block_of
from sandbox.physics.snapshot import state_hash
from sandbox.physics.solvers.linear import dissection, parallel
from sandbox.physics.solvers.linear.locks import give, has_locks, take
from tests.bench import scenes
from tests.physics.test_large import mesh, play, run
from tests.support.laid_out import laid_out


@waiting_kernel
def give_offer(call):
    # Not taken back: only the second thread can take it.
    give(call[parallel.OFFERED])
    take(call[parallel.DONE], 1)


@pytest.fixture(autouse=True)
def small_bodies_have_halves(monkeypatch):
    monkeypatch.setattr(parallel, "WORTH_HALVING", 1)
    monkeypatch.setattr(parallel, "_processor_count", lambda: 2)


@pytest.fixture
def hired(monkeypatch):
    """The second threads that a test brings about."""
    helpers, start_helper = [], parallel.start_helper

    def hire_and_tell(*arguments):
        helpers.append(start_helper(*arguments))
        return helpers[-1]

    monkeypatch.setattr(making, "start_helper", hire_and_tell)
    return helpers


def hash_after_play(seed):
    return state_hash(play(mesh(seed), 8))


@pytest.mark.parametrize("build", [lambda: mesh(1), lambda: mesh(2), lambda: scenes.lattice(24).world()])
def test_neither_half_of_a_body_is_joined_to_the_other(build):
    fronts = block_of(build()).arrays.system.fronts
    begin, end = fronts.fork[-1]
    assert 0 < begin < end < len(fronts.first)
    half = np.select([np.arange(len(fronts.first)) < begin, np.arange(len(fronts.first)) < end], [0, 1], 2)
    of_border = half[fronts.of_row[fronts.border]]
    of_owner = np.repeat(half, np.diff(fronts.border_start))
    joined = set(zip(of_owner.tolist(), of_border.tolist(), strict=True))
    assert {(0, 2), (1, 2)} < joined
    assert not joined & {(0, 1), (1, 0)}


@pytest.mark.parametrize("build", [lambda: mesh(1), lambda: scenes.lattice(24).world()])
def test_halves_wait_for_what_is_above_them_in_places_of_their_own(build):
    fronts = block_of(build()).arrays.system.fronts
    begin, end = fronts.fork[-1]
    border = 2 * np.diff(fronts.border_start)
    ends = fronts.remains + border * border
    assert ends.max() <= len(fronts.remainder)
    assert max(ends[:begin].max(), ends[end:].max()) <= fronts.remains[begin:end].min()


def test_the_second_half_is_the_one_that_leaves_the_least_to_do_in_turn():
    child = np.array([[-1, -1], [-1, -1], [0, 1], [-1, -1], [-1, -1], [3, 4], [2, 5]])
    before = np.zeros(8, dtype=np.int64)
    fronts = laid_out(dissection.new_dissection, 7, 0)._replace(child=child)
    for last, halves in (np.arange(10, 80, 10), (3, 6)), (np.array([1, 2, 3, 13, 23, 33, 43]), (4, 5)):
        fronts = fronts._replace(first=np.append(0, last[:-1]), last=last)
        assert parallel.find_fork(0, 7, fronts, before, 1) == halves


def test_a_body_that_gains_too_little_has_one_half_only(monkeypatch):
    monkeypatch.undo()
    assert not block_of(scenes.lattice(24).world()).arrays.system.fronts.fork.any()
    assert block_of(scenes.lattice(64).world()).arrays.system.fronts.fork.any()


@pytest.mark.parametrize("seed", [11, 12])
def test_one_thread_and_two_give_the_same_bits(seed, monkeypatch):
    helped = hash_after_play(seed)
    monkeypatch.setattr(parallel, "_processor_count", lambda: 1)
    assert hash_after_play(seed) == helped


def test_halves_and_the_sparse_factorisation_agree(monkeypatch):
    world = play(mesh(4), 8)
    assert block_of(world).arrays.system.fronts.fork.any()
    monkeypatch.setattr(dissection, "SMALLEST_BODY", 10**9)
    assert np.abs(play(mesh(4), 8).position - world.position).max() < 1e-9


@pytest.mark.slow
@pytest.mark.parametrize("interpreted", ["0", "1"])
def test_a_fresh_process_computes_the_same_bits_of_halves(interpreted):
    code = "from tests.physics.test_parallel import *; parallel.WORTH_HALVING = 1; print(hash_after_play(8))"
    environment = {**os.environ, "NUMBA_DISABLE_JIT": interpreted, "PYTHONPATH": os.pathsep.join(sys.path)}
    fresh = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True)
    assert fresh.stdout.strip() == hash_after_play(8)


@pytest.mark.skipif(not has_locks(), reason="there is one thread only")
def test_the_second_thread_ends_with_the_pattern_that_it_serves(hired):
    world = mesh(13)
    run(world, 2)
    assert [helper.thread.is_alive() for helper in hired] == [True]
    world.cut([10])
    run(world, 2)
    assert [helper.thread.is_alive() for helper in hired] == [False, True]
    del world
    hired[1].thread.join()
    assert not hired[1].thread.is_alive()


@pytest.mark.skipif(not has_locks(), reason="there is one thread only")
def test_the_second_thread_takes_the_half_that_is_offered_and_touches_no_other_row():
    world, alone = mesh(14), mesh(14)
    fronts = block_of(world).arrays.system.fronts
    change = block_of(world).arrays.system.rows.delta_v
    run(world, 1)
    run(alone, 1)
    body = len(fronts.first) - 1
    rows = slice(fronts.first[fronts.fork[body, 0]], fronts.last[fronts.fork[body, 1] - 1])
    change[:] = 1.0
    fronts.call[[parallel.WANTED, parallel.BODY]] = parallel.SUBSTITUTE, body
    give_offer(fronts.call)
    assert (change[rows] != 1.0).any()
    assert (change[: rows.start] == 1.0).all() and (change[rows.stop :] == 1.0).all()
    assert state_hash(run(world, 3)) == state_hash(run(alone, 3))


@pytest.mark.skipif(not COMPILED, reason="interpreted kernels take minutes")
def test_worlds_in_several_threads_keep_their_bits():
    expected, found = [hash_after_play(seed) for seed in (15, 16, 17)], {}
    threads = [
        threading.Thread(target=lambda seed: found.setdefault(seed, hash_after_play(seed)), args=(seed,))
        for seed in (15, 16, 17)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert [found[seed] for seed in (15, 16, 17)] == expected


@pytest.mark.skipif(
    not COMPILED or "fork" not in multiprocessing.get_all_start_methods(), reason="processes are not forked here"
)
def test_a_forked_process_goes_on_with_the_same_bits():
    world = play(mesh(18), 3)
    receiver, sender = multiprocessing.Pipe(duplex=False)
    child = multiprocessing.get_context("fork").Process(
        target=lambda: sender.send((state_hash(run(world, 5)), threading.active_count()))
    )
    child.start()
    reached = receiver.recv()
    child.join()
    assert reached == (state_hash(run(world, 5)), 1)


def test_a_copy_of_a_world_goes_on_with_the_same_bits():
    world = play(mesh(19), 3)
    copies = [copy.deepcopy(world), pickle.loads(pickle.dumps(world))]
    ticks = 5 if COMPILED else 1
    assert {state_hash(run(other, ticks)) for other in copies} == {state_hash(run(world, ticks))}
