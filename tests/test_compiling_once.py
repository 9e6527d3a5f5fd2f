"""Who runs tests in a fresh clone is told that kernels are compiled, once, and how far that is."""

from types import SimpleNamespace

import pytest

from sandbox.app.kernels import compiling
from tests.support import compiling_once


@pytest.fixture
def cache(monkeypatch):
    """A cache that has no kernel until all are compiled; `works` says whether they can be."""
    state = SimpleNamespace(prepared=False, works=True)

    def compile_all(processes, groups, solvers, report):
        assert processes >= 1 and set(groups) == set(compiling.GROUPS) and solvers is None
        for done in range(3):
            report(done, 2)
        return state.works

    monkeypatch.setattr(compiling, "is_prepared", lambda: state.prepared)
    monkeypatch.setattr(compiling, "note_prepared", lambda: setattr(state, "prepared", True))
    monkeypatch.setattr(compiling, "compile_all", compile_all)
    monkeypatch.setattr(compiling_once, "may_compile", lambda: True)
    return state


def config(only_lists=False, **more):
    return SimpleNamespace(option=SimpleNamespace(collectonly=only_lists), **more)


def test_the_first_run_says_that_it_compiles_and_the_next_is_silent(cache):
    assert compiling_once.wants_kernels(config())
    said, shown = [], []
    compiling_once.compile_once(said.append, shown.append)
    assert said[0] == compiling_once.BEGINS and said[-1].startswith("Compiled in ")
    assert shown == ["0 of 2 kernels", "1 of 2 kernels", "2 of 2 kernels"]
    assert not compiling_once.wants_kernels(config())


def test_where_lines_stay_progress_is_a_line_now_and_then(cache, monkeypatch):
    said = []
    compiling_once.compile_once(said.append)
    assert len(said) == 2
    monkeypatch.setattr(compiling_once, "EVERY", 0.0)
    compiling_once.compile_once(said.append)
    assert said[3:6] == ["0 of 2 kernels", "1 of 2 kernels", "2 of 2 kernels"]


def test_neither_a_worker_nor_a_run_that_only_lists_tests_nor_one_without_numba_compiles(cache, monkeypatch):
    assert not compiling_once.wants_kernels(config(workerinput={}))
    assert not compiling_once.wants_kernels(config(only_lists=True))
    monkeypatch.setattr(compiling_once, "may_compile", lambda: False)
    assert not compiling_once.wants_kernels(config())


def test_what_cannot_be_compiled_is_said_and_asked_for_again(cache):
    cache.works = False
    said = []
    compiling_once.compile_once(said.append)
    assert said[-1].startswith("Not everything could be compiled")
    assert compiling_once.wants_kernels(config())


@pytest.mark.parametrize(("value", "expected"), [("1", False), ("0", True), ("", True)])
def test_numba_that_is_switched_off_compiles_nothing(value, expected, monkeypatch):
    monkeypatch.setenv("NUMBA_DISABLE_JIT", value)
    monkeypatch.setattr(compiling_once, "find_spec", lambda name: object())
    assert compiling_once.may_compile() is expected
    monkeypatch.setattr(compiling_once, "find_spec", lambda name: None)
    assert not compiling_once.may_compile()
