"""Compiled kernels on disk: never stale, never in the way, and valid wherever they lie."""

import errno
import functools
import importlib
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from sandbox.physics import jit

pytestmark = [pytest.mark.whole_world, pytest.mark.skipif(not jit.COMPILED, reason="nothing is compiled here")]
ROOT = Path(__file__).resolve().parents[2]

CALLEE = """from sandbox.physics.jit import inner_kernel

FACTOR = {factor}

@inner_kernel
def share(value):
    return value * FACTOR
"""
CALLER = """import numpy as np
from callee import share
from sandbox.physics.jit import kernel

@kernel
def fill(values):
    for k in range(values.shape[0]):
        values[k] = share(2.0)

values = np.zeros(1)
fill(values)
print(values[0], sum(fill.stats.cache_hits.values()), sum(fill.stats.cache_misses.values()))
"""


def write_programme(folder, factor=3.0, caller=CALLER, callee=CALLEE):
    folder.mkdir(exist_ok=True)
    (folder / "caller.py").write_text(caller)
    (folder / "callee.py").write_text(callee.format(factor=factor))


def outcome(folder, cache, *options):
    """What a fresh process computes there, how many kernels it loads, and how many it compiles."""
    environment = {
        **os.environ,
        "PYTHONDONTWRITEBYTECODE": "1",
        "PYTHONPATH": os.pathsep.join([str(folder), str(ROOT)]),
        "NUMBA_CACHE_DIR": str(cache),
    }
    command = [sys.executable, *options, "-m", "caller"]
    ended = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    assert ended.returncode == 0, ended.stderr
    value, loaded, compiled = ended.stdout.split()
    return float(value), int(loaded), int(compiled), ended.stderr


def test_a_change_in_what_a_kernel_calls_reaches_its_machine_code_and_the_way_back_is_kept(tmp_path):
    seen = []
    for factor in (3.0, 5.0, 3.0):
        write_programme(tmp_path / "one", factor)
        seen.append(outcome(tmp_path / "one", tmp_path / "cache")[:3])
    assert seen == [(6.0, 0, 1), (10.0, 0, 1), (6.0, 1, 0)]


def test_what_no_kernel_reads_compiles_nothing_anew_and_neither_does_another_place_or_time(tmp_path):
    write_programme(tmp_path / "one")
    outcome(tmp_path / "one", tmp_path / "cache")
    words = CALLEE.replace("    return", '    """Share of a value."""\n    # said at length\n    return')
    write_programme(tmp_path / "two", caller=f'"""Fills."""\n\n\n{CALLER}', callee=f"def other(): ...\n\n\n{words}")
    for file in (tmp_path / "two").iterdir():
        os.utime(file, (1e9, 1e9))
    shutil.move(tmp_path / "cache", tmp_path / "elsewhere")
    assert outcome(tmp_path / "two", tmp_path / "elsewhere")[:3] == (6.0, 1, 0)


def test_no_path_of_this_machine_is_written_into_a_kernel_file(tmp_path):
    write_programme(tmp_path / "one")
    outcome(tmp_path / "one", tmp_path / "cache")
    (file,) = (tmp_path / "cache" / "kernels").iterdir()
    assert str(tmp_path).encode() not in file.read_bytes()
    assert str(ROOT).encode() not in file.read_bytes()


def test_where_no_folder_can_be_written_kernels_are_compiled_and_one_line_says_so(tmp_path):
    write_programme(tmp_path / "one")
    (tmp_path / "file").touch()
    value, _, compiled, said = outcome(tmp_path / "one", tmp_path / "file", "-W", "always")
    assert (value, compiled) == (6.0, 1)
    assert said.count("RuntimeWarning: compiled kernels cannot be kept") == 1


def accumulate(values, active, total):
    for k in range(values.shape[0]):
        if active[k]:
            total[k, 0] += values[k] * 0.1 + 0.2


def run(function):
    total = np.zeros((9, 2))
    function(np.linspace(0.1, 7.7, 9), np.arange(9) % 3 > 0, total)
    return total


def loads(kernel):
    """How often a kernel was loaded."""
    return sum(jit.kernel_of(kernel).ready().stats.cache_hits.values())


@pytest.fixture
def folders(monkeypatch, tmp_path):
    """Two folders for kernels in place of those of this installation."""
    from sandbox.physics.jit import cache

    chosen = [tmp_path / "__pycache__" / "kernels", tmp_path / "own" / "kernels"]
    monkeypatch.setattr(cache, "cache_folders", lambda: chosen)
    monkeypatch.setattr(cache, "_said", [])
    cache._sweep.cache_clear()
    return chosen


@pytest.mark.parametrize("damage", ["empty", "cut", "changed", "foreign", "folder"])
def test_a_damaged_kernel_file_is_compiled_anew_and_replaced(folders, damage):
    first = run(jit.kernel(accumulate))
    (file,) = folders[0].iterdir()
    whole = bytearray(file.read_bytes())
    if damage == "folder":
        file.unlink()
        (file / "inside").mkdir(parents=True)
    elif damage == "changed":
        whole[len(whole) // 2] ^= 1
        file.write_bytes(whole)
    else:
        file.write_bytes({"empty": b"", "cut": whole[:-100], "foreign": b"nothing of numba's"}[damage])
    kernels = [jit.kernel(accumulate), jit.kernel(accumulate)]
    assert [run(kernel).tobytes() for kernel in kernels] == [first.tobytes()] * 2
    assert list(map(loads, kernels)) == [0, 1]


def test_a_full_disk_is_said_once_and_leaves_no_half_written_file(folders, monkeypatch):
    def write_half(path, content):
        with open(path, "wb") as file:
            file.write(content[: len(content) // 2])
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(path))

    monkeypatch.setattr(Path, "write_bytes", write_half)
    with pytest.warns(RuntimeWarning, match="No space left") as said:
        run(jit.kernel(accumulate))
        run(jit.kernel(accumulate))
    assert len(said) == 1
    assert [list(folder.iterdir()) for folder in folders] == [[], []]


def test_kernels_go_to_the_users_own_folder_where_the_first_cannot_be_written(folders):
    folders[0].parent.mkdir()
    folders[0].touch()
    run(jit.kernel(accumulate))
    assert len(list(folders[1].iterdir())) == 1
    again = jit.kernel(accumulate)
    run(again)
    assert loads(again) == 1


def test_old_versions_and_what_nobody_loads_are_removed_and_recent_ones_stay(folders):
    from sandbox.physics.jit import cache

    old = folders[0].parent / "kernels-0123456789abcdef" / "solvers_0"
    old.mkdir(parents=True)
    folders[0].mkdir()
    (old / "any.nbi").touch()
    forgotten, recent, foreign = (folders[0] / name for name in ("gone.kernel", "other.kernel", "notes.txt"))
    for file in (forgotten, recent, foreign):
        file.touch()
        os.utime(file, (1e9, 1e9) if file is not recent else None)
    run(jit.kernel(accumulate))
    (newest,) = folders[0].glob("*accumulate*")
    begin = newest.name.rpartition("-")[0]
    versions = [newest.with_name(f"{begin}-{k}.kernel") for k in range(6)]
    for age, file in enumerate(versions):
        file.touch()
        os.utime(file, (time.time() - age - 1,) * 2)
    newest.unlink()
    run(jit.kernel(accumulate))
    assert {*folders[0].iterdir()} == {newest, recent, foreign, *versions[: cache._KEPT_VERSIONS - 1]}
    assert not old.parent.exists()


@pytest.mark.parametrize("place", ["unlink", "rmdir"])
def test_nothing_depends_on_whether_old_files_can_be_removed(folders, monkeypatch, place):
    (folders[0].parent / "kernels-0123456789abcdef").mkdir(parents=True)
    folders[0].mkdir()
    (folders[0] / "gone.kernel").touch()
    os.utime(folders[0] / "gone.kernel", (1e9, 1e9))

    def refuse(*_, **__):
        raise PermissionError(errno.EACCES, "in use")

    monkeypatch.setattr(os, place, refuse)
    monkeypatch.setattr(Path, place, refuse)
    run(jit.kernel(accumulate))
    assert list(folders[0].glob("*accumulate*"))


def test_a_kernel_needs_the_values_of_its_names_and_those_of_what_it_calls(monkeypatch):
    from sandbox.physics.jit.needs import digest_of_needs

    contacts = importlib.import_module("sandbox.physics.solvers.contact.free_contacts")
    kernels = [kernel.function for kernel in jit.KERNELS if kernel.function.__module__ == contacts.__name__]
    before = list(map(digest_of_needs, kernels))
    assert len(set(before)) == len(kernels) and list(map(digest_of_needs, kernels)) == before
    constants = [name for name, value in vars(contacts).items() if type(value) in (int, float)]
    changed = set()
    for name in constants:
        with monkeypatch.context() as patch:
            patch.setattr(contacts, name, getattr(contacts, name) + 1)
            changed |= {k for k, digest in enumerate(map(digest_of_needs, kernels)) if digest != before[k]}
    assert changed


def test_the_digest_of_a_kernel_follows_defaults_closures_and_nested_functions():
    from sandbox.physics.jit.needs import digest_of_needs

    def made(factor, default=1.0):
        def scaled(value, offset=default):
            return sum(value * factor + k for k in (1.0, 2.0)) + offset

        return scaled

    digests = [*map(digest_of_needs, (made(2.0), made(2.0), made(-2.0), made(2.0, 3.0)))]
    assert digests[0] == digests[1] and len(set(digests)) == 3
    assert digest_of_needs(functools.wraps(made)(made(0.0))) != digest_of_needs(functools.wraps(made)(made(-0.0)))
