"""Large bodies in two halves."""

import copy
import multiprocessing
import os
import pickle
import subprocess
import sys
import threading

import numpy as np
import pytest

from sandbox.physics.jit import COMPILED
from sandbox.physics.pipeline.block_owner import block_of
from sandbox.physics.snapshot import state_hash
from sandbox.physics.solvers.linear import elimination, fronts
from tests.bench import scenes
from tests.physics.test_large import mesh, play, run
from tests.support.laid_out import laid_out
from tests.support.wholes import part_and_whole


@pytest.fixture(autouse=True)
def small_bodies_have_halves(monkeypatch):
    monkeypatch.setattr(fronts, "WORTH_HALVING", 1)


def hash_after_play(seed):
    return state_hash(play(mesh(seed), 8))


@pytest.mark.parametrize("build", [lambda: mesh(1), lambda: mesh(2), lambda: scenes.lattice(24).world()])
def test_neither_half_of_a_body_is_joined_to_the_other(build):
    made = block_of(build()).arrays.system.fronts
    begin, end = made.fork[-1]
    assert 0 < begin < end < len(made.first)
    half = np.select([np.arange(len(made.first)) < begin, np.arange(len(made.first)) < end], [0, 1], 2)
    of_border = half[made.of_row[made.border]]
    of_owner = np.repeat(half, np.diff(made.border_start))
    joined = set(zip(of_owner.tolist(), of_border.tolist(), strict=True))
    assert {(0, 2), (1, 2)} < joined
    assert not joined & {(0, 1), (1, 0)}


def test_the_shorter_half_is_as_long_as_it_can_be():
    child = np.array([[-1, -1], [-1, -1], [0, 1], [-1, -1], [-1, -1], [3, 4], [2, 5]])
    before = np.zeros(8, dtype=np.int64)
    made = laid_out(elimination.new_dissection, 7, 0)._replace(child=child)
    for last, fork in (np.arange(10, 80, 10), (3, 6)), (np.array([1, 2, 3, 13, 23, 33, 43]), (4, 5)):
        made = made._replace(first=np.append(0, last[:-1]), last=last)
        assert fronts.find_fork(0, 7, made, before, 1) == fork


def test_a_body_that_gains_too_little_has_one_half_only(monkeypatch):
    monkeypatch.undo()
    assert not block_of(scenes.lattice(24).world()).arrays.system.fronts.fork.any()
    assert block_of(scenes.lattice(64).world()).arrays.system.fronts.fork.any()


def test_halves_and_the_sparse_factorisation_agree(monkeypatch):
    world = play(mesh(4), 8)
    assert block_of(world).arrays.system.fronts.fork.any()
    monkeypatch.setattr(elimination, "SMALLEST_BODY", 10**9)
    assert np.abs(play(mesh(4), 8).position - world.position).max() < 1e-9


@pytest.mark.slow
@pytest.mark.parametrize("way", part_and_whole("library", "interpreted"))
def test_a_fresh_process_computes_the_same_bits_of_halves(way):
    code = "from tests.physics.test_halves import *; fronts.WORTH_HALVING = 1; print(hash_after_play(8))"
    environment = {**os.environ, "SANDBOX_KERNELS": way, "PYTHONPATH": os.pathsep.join(sys.path)}
    fresh = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True)
    assert fresh.stdout.strip() == hash_after_play(8)


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
    child = multiprocessing.get_context("fork").Process(target=lambda: sender.send(state_hash(run(world, 5))))
    child.start()
    reached = receiver.recv()
    child.join()
    assert reached == state_hash(run(world, 5))


def test_a_copy_of_a_world_goes_on_with_the_same_bits():
    world = play(mesh(19), 3)
    copies = [copy.deepcopy(world), pickle.loads(pickle.dumps(world))]
    ticks = 5 if COMPILED else 1
    assert {state_hash(run(other, ticks)) for other in copies} == {state_hash(run(world, ticks))}
