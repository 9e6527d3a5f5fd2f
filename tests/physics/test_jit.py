"""Kernels run from one source, compiled or not."""

import os
import subprocess
import sys

import numpy as np
import pytest

from sandbox.physics import jit
from sandbox.physics.jit.interpreted import interpreted


def accumulate(values, active, total):
    for k in range(values.shape[0]):
        if active[k]:
            total[k, 0] += values[k] * 0.1 + 0.2


def results(function):
    values, active = np.linspace(0.1, 7.7, 9), np.arange(9) % 3 > 0
    total = np.zeros((9, 2))
    function(values, active, total)
    return total


def test_an_interpreted_kernel_changes_the_arrays_that_it_was_given():
    total = results(interpreted(accumulate))
    assert total[1, 0] > 0.0 and not total[:, 1].any()


def test_a_bundle_hands_kernels_the_very_arrays_that_went_into_it():
    def add(items, factor):
        values, active, total = jit.unpack(items)
        for k in range(active.shape[0]):
            if active[k]:
                total[k, 0] += factor * values[k]

    values, total = np.linspace(0.1, 7.7, 9), np.zeros((9, 2))
    bundle, function = jit.bundle((values, np.arange(9) % 3 > 0, total)), jit.kernel(add)
    first = values.tolist()
    function(bundle, 2.0)
    values[:] = 1.0
    function(bundle, 0.5)
    assert total[:, 0].tolist() == [2.0 * value + 0.5 if k % 3 else 0.0 for k, value in enumerate(first)]


def test_kernels_are_interpreted_where_that_is_asked_for():
    script = "from sandbox.physics import jit; print(jit.COMPILED, jit.scalar_kernel(len) is len)"
    command = [sys.executable, "-c", script]
    environment = {**os.environ, "SANDBOX_KERNELS": "interpreted"}
    ended = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    assert ended.stdout.split() == ["False", "True"]


OWN = """
import numpy as np
from sandbox.physics import jit

@jit.kernel
def fill(items, share):
    values, others = jit.unpack(items)
    for k in range(values.shape[0]):
        values[k] = share * others[k]

values = np.zeros(2)
fill(jit.bundle((values, np.array([1.0, 3.0]))), 2.0)
print(jit.way(), *values)
"""


@pytest.mark.parametrize("way", ["library", "interpreted"])
def test_a_kernel_that_is_in_no_library_is_interpreted(way):
    environment = {**os.environ, "SANDBOX_KERNELS": way}
    command = [sys.executable, "-c", OWN]
    ended = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    assert ended.stdout.split() == [way, "2.0", "6.0"]


def test_a_wish_that_is_no_way_is_told_in_one_line():
    script = "from sandbox.physics import jit; print(jit.way())"
    environment = {**os.environ, "SANDBOX_KERNELS": "fast"}
    ended = subprocess.run([sys.executable, "-c", script], env=environment, capture_output=True, text=True, check=True)
    assert ended.stderr.splitlines()[0] == (
        "SANDBOX_KERNELS is library, generic, checked or interpreted, not 'fast': library is taken"
    )
    assert ended.stdout.strip() in ("library", "interpreted")


LAZY = """
import sys
import sandbox.physics.step, sandbox.physics.solvers.direct.solve, sandbox.physics.pipeline
from sandbox.physics import jit
from sandbox.physics.components import label_bodies
assert "sandbox.physics.jit.library" not in sys.modules
import numpy as np
none = np.zeros(0, dtype=np.int64)
label_bodies(none, none, none)
print(*(kernel.function.__name__ for kernel in jit.entries() if not isinstance(kernel.held, jit.Entry)))
"""


def test_a_kernel_costs_nothing_until_it_is_called():
    ended = subprocess.run([sys.executable, "-c", LAZY], capture_output=True, text=True, check=True)
    assert ended.stdout.split() == ["label_bodies"]


@jit.scalar_kernel
def doubled(value):
    return 2.0 * value


@jit.kernel
def fill(values, number):
    for k in range(values.shape[0]):
        values[k] = doubled(number)


@jit.kernel
def fill_both(values, others):
    fill(values, 1.0)
    fill(others, 0.5)


def test_python_and_kernels_call_the_same_kernels_and_modules_hold_them_as_they_are_after_the_first_call():
    values, others = np.zeros(2), np.zeros(1)
    first = fill_both
    first(values, others)
    assert values.tolist() == [2.0, 2.0] and others.tolist() == [1.0]
    fill(others, doubled(1.0))
    assert others.tolist() == [4.0]
    assert fill_both is not first and not isinstance(fill_both, jit.Entry)
    first(others, values)
    assert others.tolist() == [2.0]


@pytest.mark.parametrize("items", [(1.0,), (np.zeros((4, 4))[::2],), ([np.zeros(1)],)])
def test_a_bundle_of_what_kernels_cannot_point_to_is_refused(items):
    with pytest.raises(TypeError, match="bundle"):
        jit.bundle(items)
