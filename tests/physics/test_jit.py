"""Kernels run from one source, compiled or not."""

import importlib
import sys

import numpy as np
import pytest

from sandbox.physics import jit


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
    total = results(jit._interpreted(accumulate))
    assert total[1, 0] > 0.0 and not total[:, 1].any()


@pytest.mark.skipif(not jit.COMPILED, reason="nothing is compiled here")
def test_a_compiled_kernel_gives_the_same_bits_as_its_source():
    assert results(jit.kernel(accumulate)).tobytes() == results(jit._interpreted(accumulate)).tobytes()


@pytest.mark.skipif(not jit.COMPILED, reason="nothing is compiled here")
def test_a_kernel_is_compiled_uncached_where_the_cache_refuses(monkeypatch):
    asked = []

    def njit_without_cache(*, cache=False, error_model):
        asked.append((cache, error_model))
        if cache:
            raise RuntimeError("cannot cache function: no locator available")
        return lambda function: function

    monkeypatch.setattr(jit, "_njit", njit_without_cache)
    assert jit.kernel(accumulate) is accumulate
    assert asked == [(True, "numpy"), (False, "numpy")]


def test_kernels_are_interpreted_when_compiling_is_switched_off_or_numba_is_missing(monkeypatch):
    try:
        monkeypatch.setenv("NUMBA_DISABLE_JIT", "1")
        assert importlib.reload(jit).COMPILED is False
        monkeypatch.setenv("NUMBA_DISABLE_JIT", "0")
        monkeypatch.setitem(sys.modules, "numba", None)
        assert importlib.reload(jit).COMPILED is False
        assert jit.scalar_kernel(accumulate) is accumulate
    finally:
        monkeypatch.undo()
        importlib.reload(jit)
