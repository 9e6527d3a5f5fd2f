"""Who runs tests after kernels were edited is told that numba compiles them, once, and how far that is."""

from types import SimpleNamespace

import pytest

from sandbox.app.kernels import compiling
from sandbox.physics import jit
from tests.support import compiling_once


@pytest.fixture
def numba(monkeypatch):
    """Kernels that numba compiles; `works` says whether it can."""
    state = SimpleNamespace(works=True)

    def compile_all(processes, report):
        assert processes >= 1
        for done in range(3):
            report(done, 2)
        return state.works

    monkeypatch.setattr(compiling, "compile_all", compile_all)
    monkeypatch.setattr(jit, "way", lambda: "numba")
    return state


def config(only_lists=False, **more):
    return SimpleNamespace(option=SimpleNamespace(collectonly=only_lists), **more)


def test_a_run_says_that_it_compiles_and_how_far_it_is(numba):
    assert compiling_once.wants_kernels(config())
    said, shown = [], []
    compiling_once.compile_once(said.append, shown.append)
    assert said[0] == compiling_once.BEGINS and said[-1].startswith("Compiled in ")
    assert shown == ["0 of 2 kernels", "1 of 2 kernels", "2 of 2 kernels"]


def test_where_lines_stay_progress_is_a_line_now_and_then(numba, monkeypatch):
    said = []
    compiling_once.compile_once(said.append)
    assert len(said) == 2
    monkeypatch.setattr(compiling_once, "EVERY", 0.0)
    compiling_once.compile_once(said.append)
    assert said[3:6] == ["0 of 2 kernels", "1 of 2 kernels", "2 of 2 kernels"]


@pytest.mark.parametrize("way", ["library", "interpreted"])
def test_neither_a_worker_nor_a_run_that_only_lists_tests_nor_another_way_compiles(way, numba, monkeypatch):
    assert not compiling_once.wants_kernels(config(workerinput={}))
    assert not compiling_once.wants_kernels(config(only_lists=True))
    monkeypatch.setattr(jit, "way", lambda: way)
    assert not compiling_once.wants_kernels(config())


def test_what_cannot_be_compiled_is_said(numba):
    numba.works = False
    said = []
    compiling_once.compile_once(said.append)
    assert said[-1].startswith("Not everything could be compiled")
